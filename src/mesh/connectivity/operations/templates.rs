//! Quadrangulations of convex polygons: quads inside an outline whose sides have given numbers of edges.
//!
//! # Theory
//! An outline of four sides, opposite ones of the same length, is filled by a grid. One of three or five sides is filled about one
//! vertex of that valence: from it a leg of quads' edges runs to each side, and each corner gets a grid between two legs. The side
//! `i` is as long as the legs to the sides before and after it, `l_i = h_(i-1) + h_(i+1)`, which has one solution; it must be
//! positive. Other outlines are cut by a chord of edges between two sides, into two such outlines, or into three grids. See K. Takayama,
//! D. Panozzo, O. Sorkine-Hornung: Pattern-based quadrangulation for N-sided patches (2014).

use std::ops::RangeInclusive;

/// A quadrangulation of an outline.
#[derive(Clone, Debug)]
pub(super) struct Template {
    /// The quads, counter-clockwise. The vertices of the outline come first, in order, from its first corner on.
    pub quads: Vec<[usize; 4]>,
    /// The number of vertices.
    pub vertices: usize,
    /// The number of irregular vertices inside.
    pub irregular: usize,
}

/// The numbers of sides of the outlines that templates fill.
pub(super) const SIDES: RangeInclusive<usize> = 2..=MOST_SIDES;
const MOST_SIDES: usize = 6;

/// The least number of irregular vertices of a quadrangulation.
pub(super) fn least_irregular(sides: usize) -> usize {
    sides.abs_diff(4)
}

/// The quadrangulations of a convex polygon by the numbers of edges of its sides: with one chord at most, and no more irregular
/// vertices than two. Of those with a chord, the first ones have nearly as many quads as `faces`. At most `most`.
pub(super) fn templates(sides: &[usize], faces: usize, most: usize) -> Vec<Template> {
    if sides.len() == 3 || sides.len() == 5 || is_rectangle(sides) {
        return Vec::from_iter(filled(sides, None));
    }
    let chords = all_chords(sides).filter_map(|chord| {
        let [first, second] = chord.parts(sides);
        let count = quads_of(first.sides())? + quads_of(second.sides())?;
        Some((count.abs_diff(faces), chord))
    });
    let mut chords: Vec<(usize, Chord)> = chords.collect();
    chords.sort_by_key(|(difference, _)| *difference);
    let with_chords = chords.into_iter().filter_map(|(_, chord)| filled(sides, Some(chord)));
    shifted(sides).into_iter().chain(with_chords).take(most).collect()
}

/// The filling of a rectangle two of whose sides have `by` edges more than those opposite: with a vertex of valence 3 and one of valence
/// 5 on a line, `by` edges apart.
///
/// ```text
///     o---x---o-----------o
///     |       |           |
///     |       |           |
///     |       5-----------o  the end of the line
///     |       | by        |
///     o---x---3           |  the line from the left turns up here; seen from below, it is straight from 3 over 5 to its end
///     |                   |
///     o-------------------o
/// ```
fn shifted(sides: &[usize]) -> Option<Template> {
    let side = |k: usize| sides[k % 4];
    // From the corner between the longer sides on.
    let is_longer = |k: usize| side(k) > side(k + 2);
    let first = (0..4).find(|&k| sides.len() == 4 && is_longer(k) && is_longer(k + 3))?;
    let [south, east, north] = [0, 1, 2].map(|k| side(first + k));
    let by = south - north;
    if side(first + 3) != east + by || north < 2 || east < 2 {
        return None;
    }
    let (x, y) = (north / 2, east / 2);
    let count: usize = sides.iter().sum();
    let begin: usize = sides[..first].iter().sum();
    let rim = |from: usize, to: usize| -> Vec<usize> {
        let places: Vec<usize> = if from <= to { (from..=to).collect() } else { (to..=from).rev().collect() };
        places.into_iter().map(|k| (begin + k) % count).collect()
    };
    let corners = [0, south, south + east, south + east + north];
    let [left, right, above] = [count - y, corners[1] + y, corners[3] - x];
    let mut template = Template { quads: Vec::new(), vertices: count, irregular: 2 };
    let line = template.line(rim(left, left)[0], rim(right, right)[0], south);
    let upwards = template.line(line[x + by], rim(above, above)[0], east - y);
    template.grid(&rim(0, corners[1]), &rim(corners[1], right), &line, &rim(count, left));
    let turned = [&line[x..x + by], &upwards].concat();
    template.grid(&line[..=x], &turned, &rim(corners[3], above), &rim(left, corners[3]));
    template.grid(&line[x + by..], &rim(right, corners[2]), &rim(above, corners[2]), &upwards);
    Some(template)
}

/// The sides of a part of an outline. There are many parts to look at, so they take no memory of their own.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    lengths: [usize; MOST_SIDES],
    count: usize,
}

impl Part {
    fn of(lengths: impl Iterator<Item = usize>) -> Self {
        let mut part = Self::default();
        for length in lengths {
            part.lengths[part.count] = length;
            part.count += 1;
        }
        part
    }

    fn sides(&self) -> &[usize] {
        &self.lengths[..self.count]
    }
}

/// A chord between two different sides.
#[derive(Clone, Copy, Debug)]
struct Chord {
    /// The sides, the smaller first.
    sides: [usize; 2],
    /// Its ends, in edges from the first corner of their sides.
    at: [usize; 2],
    /// The number of its edges.
    length: usize,
}

impl Chord {
    /// The sides of the two parts, each from the chord's end on its first side on.
    fn parts(&self, sides: &[usize]) -> [Part; 2] {
        let ([i, j], [s, t]) = (self.sides, self.at);
        let first = [sides[i] - s].into_iter().chain(sides[i + 1..j].iter().copied()).chain([t, self.length]);
        let rest = sides[j + 1..].iter().chain(&sides[..i]).copied();
        let second = [sides[j] - t].into_iter().chain(rest).chain([s, self.length]);
        [Part::of(first), Part::of(second)]
    }
}

/// All chords between inner vertices of two different sides, no longer than the longest side, whose parts have three or five sides and
/// an even number of edges. A part of three sides is filled if none of them is as long as the two others.
fn all_chords(sides: &[usize]) -> impl Iterator<Item = Chord> {
    let longest = sides.iter().copied().max().unwrap_or(0);
    let may_fill = |between: usize| between == 1 || between == 3;
    let pairs = (0..sides.len()).flat_map(move |i| (i + 1..sides.len()).map(move |j| [i, j]));
    let pairs = pairs.filter(move |[i, j]| may_fill(j - i) && may_fill(sides.len() - (j - i)));
    pairs.flat_map(move |[i, j]| {
        (1..sides[i]).flat_map(move |s| (1..sides[j]).map(move |t| [s, t])).flat_map(move |at| {
            let [before, after] = [[at[0], sides[j] - at[1]], [sides[i] - at[0], at[1]]];
            let range = |between: usize, [a, b]: [usize; 2]| {
                if between == 1 { [a.abs_diff(b) + 2, a + b - 2] } else { [1, longest] }
            };
            let [first, second] = [range(j - i, after), range(sides.len() - (j - i), before)];
            let rest = after.iter().sum::<usize>() + sides[i + 1..j].iter().sum::<usize>();
            let least = first[0].max(second[0]);
            let lengths = (least + (least + rest) % 2..=first[1].min(second[1]).min(longest)).step_by(2);
            lengths.map(move |length| Chord { sides: [i, j], at, length })
        })
    })
}

fn is_rectangle(sides: &[usize]) -> bool {
    matches!(*sides, [a, b, c, d] if a == c && b == d)
}

/// The leg to a side of an outline of three or five sides; `None` where it is not positive.
fn leg(sides: &[usize], i: usize) -> Option<usize> {
    let count = sides.len();
    // Every second side from i + 1 on, with alternating signs, leaves twice the leg.
    let signed = (0..count).map(|k| sides[(i + 1 + 2 * k) % count] as i64 * if k % 2 == 0 { 1 } else { -1 });
    let twice: i64 = signed.sum();
    (twice > 0 && twice % 2 == 0).then_some((twice / 2) as usize)
}

/// The number of quads of an outline that is filled without a chord; `None` where it cannot be.
fn quads_of(sides: &[usize]) -> Option<usize> {
    if is_rectangle(sides) {
        return Some(sides[0] * sides[1]);
    }
    if sides.len() == 4 {
        return None;
    }
    (0..sides.len()).map(|i| Some(leg(sides, i)? * leg(sides, (i + 1) % sides.len())?)).sum()
}

fn filled(sides: &[usize], chord: Option<Chord>) -> Option<Template> {
    let outline: Vec<usize> = (0..sides.iter().sum()).collect();
    let mut template = Template { quads: Vec::new(), vertices: outline.len(), irregular: 0 };
    let Some(chord) = chord else {
        template.fill(&outline, sides)?;
        return Some(template);
    };
    let count = outline.len();
    let begin = |side: usize| sides[..side].iter().sum::<usize>();
    let [from, to] = [0, 1].map(|k| begin(chord.sides[k]) + chord.at[k]);
    let between = template.line(from, to, chord.length);
    let first = outline[from..to].iter().copied().chain(between[1..].iter().rev().copied());
    let second = (to..from + count).map(|k| k % count).chain(between[..between.len() - 1].iter().copied());
    let [first_part, second_part] = chord.parts(sides);
    template.fill(&first.collect::<Vec<usize>>(), first_part.sides())?;
    template.fill(&second.collect::<Vec<usize>>(), second_part.sides())?;
    Some(template)
}

impl Template {
    fn vertex(&mut self) -> usize {
        self.vertices += 1;
        self.vertices - 1
    }

    /// A line of new vertices between two vertices, with both.
    fn line(&mut self, from: usize, to: usize, length: usize) -> Vec<usize> {
        let mut line = vec![from];
        line.extend((1..length).map(|_| self.vertex()));
        line.push(to);
        line
    }

    /// Fills an outline, which begins at the first corner; `None` where it cannot be filled without a chord.
    fn fill(&mut self, outline: &[usize], sides: &[usize]) -> Option<()> {
        let count = outline.len();
        let starts: Vec<usize> = sides.iter().scan(0, |sum, side| Some(std::mem::replace(sum, *sum + side))).collect();
        // The vertices from one place on the outline to another one, in its direction.
        let part =
            |from: usize, edges: usize| (from..=from + edges).map(|k| outline[k % count]).collect::<Vec<usize>>();
        if is_rectangle(sides) {
            let side = |k: usize| part(starts[k], sides[k]);
            let reversed = |k: usize| side(k).into_iter().rev().collect::<Vec<usize>>();
            self.grid(&side(0), &side(1), &reversed(2), &reversed(3));
            return Some(());
        }
        let legs = (0..sides.len()).map(|i| leg(sides, i)).collect::<Option<Vec<usize>>>()?;
        let last = |i: usize| (i + sides.len() - 1) % sides.len();
        let centre = self.vertex();
        self.irregular += 1;
        let ends: Vec<usize> = (0..sides.len()).map(|i| starts[i] + legs[last(i)]).collect();
        let lines: Vec<Vec<usize>> =
            (0..sides.len()).map(|i| self.line(outline[ends[i] % count], centre, legs[i])).collect();
        for i in 0..sides.len() {
            let south = part(starts[i], legs[last(i)]);
            let west: Vec<usize> = part(ends[last(i)], legs[i]).into_iter().rev().collect();
            self.grid(&south, &lines[i], &lines[last(i)], &west);
        }
        Some(())
    }

    /// A grid of quads between four lines: `south` and `north` run to the east, `west` and `east` to the north.
    fn grid(&mut self, south: &[usize], east: &[usize], north: &[usize], west: &[usize]) {
        let mut below = south.to_vec();
        for row in 1..west.len() {
            let above =
                if row + 1 == west.len() { north.to_vec() } else { self.line(west[row], east[row], south.len() - 1) };
            let quads = (1..south.len()).map(|k| [below[k - 1], below[k], above[k], above[k - 1]]);
            self.quads.extend(quads);
            below = above;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    /// The number of quads at each vertex.
    fn valences(template: &Template) -> BTreeMap<usize, usize> {
        let mut valences = BTreeMap::new();
        template.quads.iter().flatten().for_each(|&v| *valences.entry(v).or_insert(0) += 1);
        valences
    }

    /// A template is a disc whose rim is the outline, with one quad at its corners and two at other vertices of the rim.
    fn expect_disc(template: &Template, sides: &[usize]) {
        let count: usize = sides.iter().sum();
        let edges: BTreeSet<[usize; 2]> =
            template.quads.iter().flat_map(|q| (0..4).map(|k| [q[k], q[(k + 1) % 4]])).collect();
        assert_eq!(edges.len(), 4 * template.quads.len(), "no edge is run through twice: {sides:?}");
        let rim: BTreeSet<[usize; 2]> = edges.iter().copied().filter(|&[a, b]| !edges.contains(&[b, a])).collect();
        assert_eq!(rim, (0..count).map(|k| [k, (k + 1) % count]).collect(), "{sides:?}");
        let inner = (edges.len() - count) / 2;
        assert_eq!(template.vertices + template.quads.len(), count + inner + 1, "{sides:?}");
        let starts: BTreeSet<usize> = (0..sides.len()).map(|k| sides[..k].iter().sum()).collect();
        let mut irregular = 0;
        for (v, valence) in valences(template) {
            let wanted = if starts.contains(&v) {
                1
            } else if v < count {
                2
            } else {
                4
            };
            assert!(v >= count || valence == wanted, "{sides:?}: {v} has {valence}");
            irregular += usize::from(valence != wanted);
        }
        assert_eq!(irregular, template.irregular, "{sides:?}");
    }

    #[test]
    fn sides_of_three_to_six_corners_are_filled() {
        for (sides, irregular) in [
            (vec![2, 3, 2, 3], 0),
            (vec![1, 1, 1, 1], 0),
            (vec![2, 2, 2], 1),
            (vec![3, 4, 5], 1),
            (vec![2, 2, 2, 2, 2], 1),
            (vec![3, 2, 4, 2, 3], 1),
            (vec![4, 4], 2),
            (vec![3, 4, 4, 5], 2),
            (vec![4, 2, 2, 4, 2, 2], 2),
            (vec![6, 4, 4, 6], 2),
            (vec![4, 6, 7, 3], 2),
        ] {
            let found = templates(&sides, 20, 3);
            assert!(!found.is_empty(), "{sides:?}");
            for template in &found {
                expect_disc(template, &sides);
                assert_eq!(template.irregular, irregular, "{sides:?}");
            }
        }
    }

    #[test]
    fn sides_without_a_solution_are_not() {
        // An odd sum; a side as long as the two others; legs of no length.
        for sides in [vec![2, 2, 3], vec![4, 2, 2], vec![1, 1, 1, 1, 2], vec![2, 3, 2, 4]] {
            assert!(templates(&sides, 20, 3).is_empty(), "{sides:?}");
        }
    }
}
