//! Lines along which sheets of a mesh meet.

use super::{Edge, Mesh};
use rustc_hash::FxHashMap;

/// The edges of more than two faces along which sheets meet. A line of them is a joint, and so is one edge from boundary to boundary;
/// another one alone is a fault.
pub fn joints(mesh: &Mesh) -> Vec<[u32; 2]> {
    let edges = mesh.edges();
    // A vertex that is missing is another fault.
    let is_shared = |edge: &&Edge| edge.along + edge.against > 2 && (edge.ends[1] as usize) < mesh.points.len();
    let shared = || edges.iter().filter(is_shared).map(|edge| edge.ends);
    // How many such edges end at a vertex, and whether it lies on the boundary.
    let mut ends: FxHashMap<u32, (u32, bool)> = FxHashMap::default();
    shared().flatten().for_each(|end| ends.entry(end).or_default().0 += 1);
    for end in edges.iter().filter(|edge| edge.along + edge.against == 1).flat_map(|edge| edge.ends) {
        if let Some(known) = ends.get_mut(&end) {
            known.1 = true;
        }
    }
    let is_joint = |edge: &[u32; 2]| {
        let [first, last] = edge.map(|end| ends[&end]);
        first.0 > 1 || last.0 > 1 || (first.1 && last.1)
    };
    shared().filter(is_joint).collect()
}
