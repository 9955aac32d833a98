//! The walk of a triangle: with the quad beside it, it forms a pentagon, which is cut into a quad and a triangle anew.

use super::draft::Draft;

/// The ways to cut the pentagon of a triangle and the quad beyond its side from `x` to `y`: the quad's id goes to the
/// triangle that results, which has stepped there.
pub(super) fn steps<'a>(draft: &Draft<'a>, triangle: u32, side: usize, next: u32) -> Vec<Draft<'a>> {
    let corners = draft.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let quad = draft.face(next);
    let Some(at) = quad.iter().position(|&v| v == y) else { return Vec::new() };
    let [u, v] = [2, 3].map(|k| quad[(at + k) % 4]);
    // Counter-clockwise round the pentagon; the triangle as it is lies about the first.
    let ring = [z, x, u, v, y];
    (1..5)
        .map(|tip| {
            let turned: [u32; 5] = std::array::from_fn(|k| ring[(tip + k) % 5]);
            let mut step = draft.clone();
            step.set_face(next, &[turned[4], turned[0], turned[1]]);
            step.set_face(triangle, &[turned[1], turned[2], turned[3], turned[4]]);
            step
        })
        .collect()
}

/// The quad of a triangle and the one beyond its side.
pub(super) fn meet<'a>(draft: &Draft<'a>, triangle: u32, side: usize, other: u32) -> Option<Draft<'a>> {
    let corners = draft.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let tip = *draft.face(other).iter().find(|v| ![x, y].contains(v))?;
    let mut met = draft.clone();
    met.set_face(triangle, &[z, x, tip, y]);
    met.set_face(other, &[]);
    Some(met)
}
