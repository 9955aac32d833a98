//! The cheapest cut of a polygon into quads and triangles, by dynamic programming over its chords.

/// The cost of the cheapest cut of a polygon of `count` corners, and the corners of its faces; `None` where every cut has an
/// infinite cost. `face` gives the cost of a face by its corners in ascending order, `chord` the cost of a chord by its ends.
pub(crate) fn cut(
    count: usize,
    face: impl Fn(&[usize]) -> f64,
    chord: impl Fn(usize, usize) -> f64,
) -> Option<(f64, Vec<Vec<usize>>)> {
    const NONE: usize = usize::MAX;
    let at = |i: usize, j: usize| i * count + j;
    // The least cost of the part from corner `i` to corner `j`, with the chord between them, and its first face.
    let mut cost = vec![0.0; count * count];
    let mut cuts = vec![[NONE; 2]; count * count];
    for span in 2..count {
        for i in 0..count - span {
            let j = i + span;
            let own = if span + 1 < count { chord(i, j) } else { 0.0 };
            let mut best = (f64::INFINITY, [NONE; 2]);
            for m in if own < f64::INFINITY { i + 1..j } else { 0..0 } {
                let mut keep = |rest: f64, corners: &[usize], cut: [usize; 2]| {
                    // The cost of a face takes long; it is skipped where the rest alone is too expensive.
                    if rest < best.0 {
                        let total = rest + face(corners);
                        if total < best.0 {
                            best = (total, cut);
                        }
                    }
                };
                keep(cost[at(i, m)] + cost[at(m, j)], &[i, m, j], [m, NONE]);
                for n in m + 1..j {
                    keep(cost[at(i, m)] + cost[at(m, n)] + cost[at(n, j)], &[i, m, n, j], [m, n]);
                }
            }
            cost[at(i, j)] = best.0 + own;
            cuts[at(i, j)] = best.1;
        }
    }
    let total = cost[at(0, count - 1)];
    if total == f64::INFINITY {
        return None;
    }
    let mut faces = Vec::new();
    let mut open = vec![[0, count - 1]];
    while let Some([i, j]) = open.pop() {
        if j < i + 2 {
            continue;
        }
        match cuts[at(i, j)] {
            [m, NONE] => {
                faces.push(vec![i, m, j]);
                open.extend([[m, j], [i, m]]);
            }
            [m, n] => {
                faces.push(vec![i, m, n, j]);
                open.extend([[n, j], [m, n], [i, m]]);
            }
        }
    }
    Some((total, faces))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a face costs that should be a quad.
    fn quads(face: &[usize]) -> f64 {
        if face.len() == 4 { 0.0 } else { 1.0 }
    }

    #[test]
    fn even_polygons_fall_into_quads_and_odd_ones_into_quads_and_a_triangle() {
        for count in 3..12 {
            let (cost, faces) = cut(count, quads, |_, _| 0.0).expect("a cut");
            assert_eq!(cost, (count % 2) as f64);
            assert_eq!(faces.iter().map(|face| face.len() - 2).sum::<usize>(), count - 2, "all of the polygon");
        }
    }

    #[test]
    fn a_chord_that_may_not_be_is_not_taken() {
        let taken = |i: usize, j: usize| if [i, j] == [0, 2] { f64::INFINITY } else { 0.0 };
        let only = |face: &[usize]| if face.len() == 3 { 0.0 } else { f64::INFINITY };
        let (_, faces) = cut(4, only, taken).expect("the other diagonal");
        assert!(faces.contains(&vec![1, 2, 3]) && faces.contains(&vec![0, 1, 3]), "{faces:?}");
        assert_eq!(cut(4, only, |_, _| f64::INFINITY), None);
        assert_eq!(cut(5, |face| if face.len() == 4 { 0.0 } else { f64::INFINITY }, |_, _| 0.0), None);
    }
}
