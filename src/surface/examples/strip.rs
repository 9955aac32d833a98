//! Surfaces as chains of lines: neighbouring lines, which need not have equally many points, are joined by strips of
//! triangles.

use glam::DVec3;

use super::Soup;

/// How much longer a diagonal may be and still count as equally long: far above rounding, far below what a
/// triangle's shape would show, so that equal diagonals all run the same way.
const TIE: f64 = 1.0 + 1e-6;

/// A soup under construction.
#[derive(Default)]
pub struct Strips {
    soup: Soup,
}

impl Strips {
    /// Adds one point.
    pub fn point(&mut self, position: DVec3) -> u32 {
        self.soup.points.push(position.to_array());
        (self.soup.points.len() - 1) as u32
    }

    /// Adds a line of points.
    pub fn line(&mut self, positions: impl IntoIterator<Item = DVec3>) -> Vec<u32> {
        positions.into_iter().map(|position| self.point(position)).collect()
    }

    /// Adds a line of points that ends where it begins.
    pub fn ring(&mut self, positions: impl IntoIterator<Item = DVec3>) -> Vec<u32> {
        let mut ring = self.line(positions);
        ring.extend(ring.first().copied());
        ring
    }

    /// Joins two lines that run the same way, always across the shorter diagonal. Seen from outside, `left` lies to the
    /// left of `right`. Lines that share their first or last point are joined without the triangle that would be
    /// degenerate; a line of one point gives a fan.
    pub fn join(&mut self, right: &[u32], left: &[u32]) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < right.len() || j + 1 < left.len() {
            let step_right = i + 1 < right.len()
                && (j + 1 == left.len()
                    || self.distance(right[i + 1], left[j]) <= TIE * self.distance(right[i], left[j + 1]));
            if step_right {
                self.triangle([right[i], right[i + 1], left[j]]);
                i += 1;
            } else {
                self.triangle([right[i], left[j + 1], left[j]]);
                j += 1;
            }
        }
    }

    /// Joins every line to the next.
    pub fn chain(&mut self, lines: &[Vec<u32>]) {
        for pair in lines.windows(2) {
            self.join(&pair[0], &pair[1]);
        }
    }

    /// The finished soup.
    pub fn finish(self) -> Soup {
        self.soup
    }

    fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        if a != b && b != c && c != a {
            self.soup.triangles.push([a, b, c]);
        }
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        let [a, b] = [a, b].map(|index| DVec3::from_array(self.soup.points[index as usize]));
        a.distance(b)
    }
}

/// The size, from `coarsest` up, whose `count` of triangles comes nearest to `triangles`; `count` grows with the size.
pub fn nearest_size(coarsest: usize, triangles: usize, count: impl Fn(usize) -> usize) -> usize {
    let enough = (coarsest..).find(|&size| count(size) >= triangles).unwrap_or(coarsest);
    if enough > coarsest && triangles - count(enough - 1) < count(enough) - triangles { enough - 1 } else { enough }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_unequal_length_are_joined_without_a_gap() {
        let mut strips = Strips::default();
        let right = strips.line((0..=4).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)));
        let left = strips.line((0..=7).map(|i| DVec3::new(f64::from(i) * 4.0 / 7.0, 1.0, 0.0)));
        strips.join(&right, &left);
        let soup = strips.finish();
        assert_eq!(soup.triangles.len(), 4 + 7);
        let doubled_area: f64 = soup
            .triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|index| DVec3::from_array(soup.points[index as usize]));
                (b - a).cross(c - a).z
            })
            .inspect(|&area| assert!(area > 0.0, "every triangle faces up"))
            .sum();
        // The strip is the rectangle 4 x 1; eleven additions round off by far less than this.
        assert!((doubled_area - 8.0).abs() < 1e-12, "{doubled_area}");
    }

    #[test]
    fn the_nearest_size_is_nearest_from_both_sides() {
        let square = |size: usize| size * size;
        assert_eq!(nearest_size(1, 20, square), 4);
        assert_eq!(nearest_size(1, 21, square), 5);
        assert_eq!(nearest_size(3, 0, square), 3);
    }
}
