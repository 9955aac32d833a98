//! Triangles that walk along their rows until two meet and become a quad.

use super::Cleaner;
use super::patch::Patch;

/// How many partners are looked for: where the nearest is refused, one behind it may do.
const PARTNERS: usize = 4;

/// Passes over all triangles: a pair that was made may have touched the path of another.
const PASSES: usize = 3;

/// Faces from a triangle to a triangle, all others quads, each joined to the next by an edge that is no feature.
type Path = Vec<u32>;

/// Pairs the triangles, nearest first, and returns how many pairs became quads.
pub(super) fn pair(cleaner: &mut Cleaner) -> usize {
    let mut pairs = 0;
    for _ in 0..PASSES {
        let mut paths = paths(cleaner);
        paths.sort_by_key(Vec::len);
        let mut touched = vec![false; cleaner.editor.face_count()];
        let before = pairs;
        for path in paths {
            if path.iter().any(|face| touched[*face as usize]) {
                continue;
            }
            let change = Patch::of(&cleaner.editor, &cleaner.worth, &path).and_then(Patch::into_quads);
            if cleaner.apply(change) {
                pairs += 1;
                for face in path {
                    touched[face as usize] = true;
                }
            }
        }
        if pairs == before {
            break;
        }
    }
    pairs
}

/// The shortest paths from every triangle to its nearest partners, by breadth-first search through the quads.
fn paths(cleaner: &Cleaner) -> Vec<Path> {
    let editor = &cleaner.editor;
    let mut paths = Vec::new();
    let mut seen = vec![u32::MAX; editor.face_count()];
    let mut queue: Vec<(u32, usize, usize)> = Vec::new();
    for start in cleaner.triangles() {
        queue.clear();
        queue.push((start, 0, 1));
        seen[start as usize] = start;
        let (mut head, mut found) = (0, 0);
        while head < queue.len() && found < PARTNERS {
            let (face, _, length) = queue[head];
            let corners = editor.face(face);
            if face != start && corners.len() == 3 {
                found += 1;
                paths.push(trace(&queue, head));
            } else if length < cleaner.worth.options.reach {
                for k in 0..corners.len() {
                    if let Some(next) = cleaner.across(face, k)
                        && seen[next as usize] != start
                        && editor.face(next).len() <= 4
                    {
                        seen[next as usize] = start;
                        queue.push((next, head, length + 1));
                    }
                }
            }
            head += 1;
        }
    }
    paths
}

fn trace(queue: &[(u32, usize, usize)], end: usize) -> Path {
    let mut path = vec![queue[end].0];
    let mut place = end;
    while place != 0 {
        place = queue[place].1;
        path.push(queue[place].0);
    }
    path
}
