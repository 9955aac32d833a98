//! The ONERA D wing section as a smooth curve.

use glam::DVec2;

/// Upper side of the symmetric ONERA D section, leading edge to trailing edge, in chords. Source: V. Schmitt and
/// F. Charpin, "Pressure distributions on the ONERA M6 wing at transonic Mach numbers", AGARD AR-138, 1979, B1.
const UPPER_SIDE: [[f64; 2]; 72] = [
    [0.0, 0.0],
    [0.0000165, 0.0006914],
    [0.0000696, 0.0014416],
    [0.0001675, 0.0022554],
    [0.0003232, 0.0031382],
    [0.0005508, 0.0040959],
    [0.0008657, 0.0051343],
    [0.0012868, 0.0062598],
    [0.0018364, 0.0074784],
    [0.0025441, 0.0087958],
    [0.0034428, 0.0102163],
    [0.0045704, 0.0117419],
    [0.0059751, 0.0133708],
    [0.0077112, 0.0150951],
    [0.0098413, 0.0168984],
    [0.0124479, 0.0187537],
    [0.0156171, 0.020622],
    [0.0194609, 0.0224545],
    [0.0241067, 0.0242004],
    [0.0297008, 0.0258245],
    [0.0364261, 0.0273317],
    [0.0444852, 0.0287912],
    [0.0541248, 0.0303278],
    [0.0656303, 0.0320138],
    [0.0793366, 0.0338372],
    [0.0956354, 0.0357742],
    [0.1149796, 0.0377923],
    [0.1378963, 0.0398522],
    [0.1649976, 0.0419089],
    [0.1919327, 0.0436214],
    [0.2187096, 0.0450507],
    [0.245331, 0.0462358],
    [0.2717978, 0.0471987],
    [0.2981113, 0.0479494],
    [0.3242726, 0.0484902],
    [0.350283, 0.0488183],
    [0.3761446, 0.0489296],
    [0.4018567, 0.0488202],
    [0.4274223, 0.0484833],
    [0.4528441, 0.0479351],
    [0.4781197, 0.0471661],
    [0.5032514, 0.0461903],
    [0.5282426, 0.0450209],
    [0.5530937, 0.0436741],
    [0.5778043, 0.0421684],
    [0.6023757, 0.0405241],
    [0.6268104, 0.0387613],
    [0.6511093, 0.036899],
    [0.6752726, 0.0349542],
    [0.6993027, 0.0329402],
    [0.7231995, 0.0308662],
    [0.7469658, 0.0287365],
    [0.7705998, 0.0265505],
    [0.7941055, 0.0243027],
    [0.8174828, 0.0219842],
    [0.8407324, 0.0195838],
    [0.8638564, 0.0170915],
    [0.8868235, 0.0145051],
    [0.9061905, 0.0122389],
    [0.9225336, 0.0102727],
    [0.9363346, 0.0085827],
    [0.9479946, 0.0071423],
    [0.9578511, 0.0059224],
    [0.966186, 0.0048907],
    [0.9732361, 0.004018],
    [0.979202, 0.0032796],
    [0.9842508, 0.0026547],
    [0.9885252, 0.0021257],
    [0.9921438, 0.0016778],
    [0.995208, 0.0012985],
    [0.997803, 0.0009773],
    [1.0, 0.0007052],
];

/// Samples of the curve to place stations by: some ten to a station at the finest resolution in use.
const SAMPLES: usize = 8192;

/// Half of a symmetric section: the natural cubic spline in arc length through the whole contour, lower trailing edge to
/// upper trailing edge, so that the leading edge is smooth. Lengths are in published (blunt) chords.
pub struct Section {
    /// Arc length of the knots, from the leading edge (0) along the upper side.
    knots: Vec<f64>,
    points: Vec<DVec2>,
    /// Second derivatives by arc length at the knots.
    bends: Vec<DVec2>,
}

impl Section {
    /// The published section; `blunt` keeps its open trailing edge, otherwise its last segment is extended until both
    /// sides meet.
    pub fn onera_d(blunt: bool) -> Self {
        let mut upper: Vec<_> = UPPER_SIDE.iter().map(|&point| DVec2::from_array(point)).collect();
        if !blunt {
            let [before, end] = [upper[upper.len() - 2], upper[upper.len() - 1]];
            upper.push(end + (end - before) * (end.y / (before.y - end.y)));
            if let Some(tail) = upper.last_mut() {
                tail.y = 0.0;
            }
        }
        let lower = upper[1..].iter().rev().map(|point| DVec2::new(point.x, -point.y));
        let contour: Vec<_> = lower.chain(upper.iter().copied()).collect();
        let mut knots = vec![0.0];
        for pair in contour.windows(2) {
            knots.push(knots[knots.len() - 1] + pair[0].distance(pair[1]));
        }
        let bends = natural_bends(&knots, &contour);
        let nose = upper.len() - 1;
        let knots = knots[nose..].iter().map(|knot| knot - knots[nose]).collect();
        Self { knots, points: upper, bends: bends[nose..].to_vec() }
    }

    /// Arc length from the leading edge to the trailing edge.
    fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    /// Position and derivative at an arc length.
    fn at(&self, arc: f64) -> (DVec2, DVec2) {
        let right = self.knots.partition_point(|&knot| knot <= arc).clamp(1, self.knots.len() - 1);
        let left = right - 1;
        let width = self.knots[right] - self.knots[left];
        let (a, b) = ((self.knots[right] - arc) / width, (arc - self.knots[left]) / width);
        let [p, q] = [self.points[left], self.points[right]];
        let [bend_p, bend_q] = [self.bends[left], self.bends[right]];
        let sixth = width * width / 6.0;
        let position = a * p + b * q + sixth * ((a * a * a - a) * bend_p + (b * b * b - b) * bend_q);
        let slope = (q - p) / width + width / 6.0 * ((3.0 * b * b - 1.0) * bend_q - (3.0 * a * a - 1.0) * bend_p);
        (position, slope)
    }

    /// A curve on which to place stations, denser by curvature: arc length plus `turn_weight` chords for every radian turned.
    pub fn placing(&self, turn_weight: f64) -> Placing<'_> {
        let arcs: Vec<_> = (0..=SAMPLES).map(|sample| self.length() * sample as f64 / SAMPLES as f64).collect();
        let mut measure = vec![0.0];
        for pair in arcs.windows(2) {
            let turn = self.at(pair[0]).1.angle_to(self.at(pair[1]).1).abs();
            measure.push(measure[measure.len() - 1] + (pair[1] - pair[0]) + turn_weight * turn);
        }
        Placing { section: self, arcs, measure }
    }
}

/// Where stations go along a section.
pub struct Placing<'a> {
    section: &'a Section,
    arcs: Vec<f64>,
    measure: Vec<f64>,
}

/// A point of the upper side.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// Distance behind the leading edge and height over the chord line, in chords.
    pub point: DVec2,
    /// Mean distance to its neighbours along the section, in chords.
    pub spacing: f64,
}

impl Placing<'_> {
    /// The ends of `parts` parts of equal measure: leading edge first, trailing edge last.
    pub fn stations(&self, parts: usize) -> Vec<Station> {
        let whole = self.measure[SAMPLES];
        let arcs: Vec<_> = (0..=parts).map(|part| self.arc(whole * part as f64 / parts as f64)).collect();
        (0..=parts)
            .map(|part| {
                let (before, after) = (part.saturating_sub(1), (part + 1).min(parts));
                let spacing = (arcs[after] - arcs[before]) / (after - before) as f64;
                Station { point: self.section.at(arcs[part]).0, spacing }
            })
            .collect()
    }

    fn arc(&self, measure: f64) -> f64 {
        let right = self.measure.partition_point(|&known| known < measure).clamp(1, SAMPLES);
        let share = (measure - self.measure[right - 1]) / (self.measure[right] - self.measure[right - 1]);
        self.arcs[right - 1] + share * (self.arcs[right] - self.arcs[right - 1])
    }
}

/// Second derivatives of the natural cubic spline through `points` at `knots`, by the tridiagonal algorithm.
fn natural_bends(knots: &[f64], points: &[DVec2]) -> Vec<DVec2> {
    let last = points.len() - 1;
    let slope = |i: usize| (points[i + 1] - points[i]) / (knots[i + 1] - knots[i]);
    let mut ratios = vec![0.0; last];
    let mut bends = vec![DVec2::ZERO; last + 1];
    for i in 1..last {
        let (before, after) = (knots[i] - knots[i - 1], knots[i + 1] - knots[i]);
        let pivot = 2.0 * (before + after) - before * ratios[i - 1];
        ratios[i] = after / pivot;
        bends[i] = (6.0 * (slope(i) - slope(i - 1)) - before * bends[i - 1]) / pivot;
    }
    for i in (1..last).rev() {
        let next = bends[i + 1];
        bends[i] -= ratios[i] * next;
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spline_meets_its_points_and_is_smooth_at_the_nose() {
        let section = Section::onera_d(true);
        for (knot, point) in section.knots.iter().zip(&section.points) {
            // The section is one chord long: 1e-14 is a few roundings.
            assert!(section.at(*knot).0.distance(*point) < 1e-14);
        }
        let (nose, direction) = section.at(0.0);
        assert_eq!(nose, DVec2::ZERO);
        // Straight up: the lower half is the mirror image.
        assert!(direction.x.abs() < 1e-9 && direction.y > 0.9, "{direction}");
    }

    #[test]
    fn a_spline_of_a_cubic_with_straight_ends_is_that_cubic() {
        // x^3 - 3 x^2 + x has second derivative 6 x - 6: not straight at 0, so it must not be met there.
        let knots = [0.0, 0.7, 1.1, 2.0];
        let bends = |curve: fn(f64) -> f64| natural_bends(&knots, &knots.map(|x| DVec2::new(x, curve(x))));
        let straight = bends(|x| 2.0 * x - 1.0);
        assert!(straight.iter().all(|bend| bend.length() < 1e-12), "{straight:?}");
        let bent = bends(|x| x * x * x - 3.0 * x * x + x);
        assert!(bent[1].length() > 0.1, "{bent:?}");
    }

    #[test]
    fn sharp_sides_meet_where_the_cad_has_them() {
        let section = Section::onera_d(false);
        let tail = section.points[section.points.len() - 1];
        assert_eq!(tail.y, 0.0);
        // NASA's CAD of the wing with a sharp trailing edge has a root chord of 0.8104915 m; ours is 0.8059 chords long.
        assert!((tail.x * 0.8059 - 0.8104915).abs() < 1e-5, "{tail}");
    }

    #[test]
    fn no_part_turns_more_than_its_share() {
        let section = Section::onera_d(false);
        let sharpest = |placing: &Placing| {
            let points: Vec<_> = placing.stations(60).iter().map(|station| station.point).collect();
            let turns = points.windows(3).map(|p| (p[1] - p[0]).angle_to(p[2] - p[1]).abs());
            turns.fold(0.0, f64::max)
        };
        let placing = section.placing(0.04);
        // A chord's direction is one its part has, so two neighbours differ by no more than both parts turn.
        let share = 2.0 * placing.measure[SAMPLES] / 60.0 / 0.04;
        assert!(sharpest(&placing) < share, "{} of {share}", sharpest(&placing));
        assert!(sharpest(&section.placing(0.0)) > share / 2.0, "without the weight the nose is coarser");
    }

    #[test]
    fn stations_run_from_edge_to_edge() {
        let section = Section::onera_d(false);
        let stations = section.placing(0.04).stations(60);
        assert_eq!(stations[0].point, DVec2::ZERO);
        assert!((stations[60].point - section.points[72]).length() < 1e-12);
        assert!(stations.windows(2).all(|pair| pair[0].point.x < pair[1].point.x));
    }
}
