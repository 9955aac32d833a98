//! A step of a triangle: the pentagon that it forms with the quad beside it is cut into a quad and a triangle in another way.

use super::super::edit::Edit;

/// A cut of the pentagon that a triangle and a quad form.
#[derive(Clone, Copy)]
pub(super) struct Step {
    triangle: u32,
    quad: u32,
    /// The pentagon counter-clockwise, from the middle corner of the new triangle.
    ring: [u32; 5],
    /// The ends of the edge between the two, which is removed.
    removed: [u32; 2],
}

/// The other four cuts of the pentagon of a triangle and the quad across one of its sides; none where the quad has all three
/// corners of the triangle.
pub(super) fn steps(edit: &Edit, triangle: u32, side: usize, quad: u32) -> impl Iterator<Item = Step> {
    let corners = edit.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let beyond = edit.face(quad);
    let at = beyond.iter().position(|&v| v == y).expect("the quad has the triangle's side");
    // The present triangle lies about the first corner.
    let ring = [z, x, beyond[(at + 2) % 4], beyond[(at + 3) % 4], y];
    let cuts = if beyond.contains(&z) { 1..1 } else { 1..5 };
    cuts.map(move |tip| {
        let ring = std::array::from_fn(|k| ring[(tip + k) % 5]);
        Step { triangle, quad, ring, removed: [x, y] }
    })
}

impl Step {
    /// The growth of the squared differences between valences and the wanted ones.
    pub(super) fn cost(&self, edit: &Edit) -> f64 {
        let added = [self.ring[1], self.ring[4]];
        let ends = [self.removed[0], self.removed[1], added[0], added[1]];
        (0..4)
            .filter(|&k| !ends[..k].contains(&ends[k]))
            .map(|k| {
                let more = added.contains(&ends[k]) as i32 - self.removed.contains(&ends[k]) as i32;
                edit.irregularity(ends[k], more) - edit.irregularity(ends[k], 0)
            })
            .sum()
    }

    /// The corners of the new triangle, sorted.
    pub(super) fn key(&self) -> [u32; 3] {
        let mut key = [self.ring[4], self.ring[0], self.ring[1]];
        key.sort_unstable();
        key
    }

    /// The edit that makes the step, and the new triangle, which has the quad's id.
    pub(super) fn take<'a>(&self, edit: &Edit<'a>) -> (Edit<'a>, u32) {
        let [tip, after, p, q, before] = self.ring;
        let mut stepped = edit.clone();
        stepped.set_face(self.quad, &[before, tip, after]);
        stepped.set_face(self.triangle, &[after, p, q, before]);
        (stepped, self.quad)
    }
}

/// The edit that merges a triangle and the triangle across one of its sides into a quad, and its cost; `None` where both have
/// the same corners.
pub(super) fn meet<'a>(edit: &Edit<'a>, triangle: u32, side: usize, other: u32) -> Option<(f64, Edit<'a>)> {
    let corners = edit.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let tip = *edit.face(other).iter().find(|v| !corners.contains(v))?;
    let mut met = edit.clone();
    met.set_face(triangle, &[z, x, tip, y]);
    met.set_face(other, &[]);
    let cost = [x, y].map(|v| edit.irregularity(v, -1) - edit.irregularity(v, 0)).iter().sum();
    Some((cost, met))
}
