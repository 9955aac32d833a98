//! The unit sphere: an icosahedron whose faces are divided into equal triangles and blown up.

use std::collections::HashMap;

use glam::DVec3;

use super::Soup;
use super::strip::nearest_size;

/// Stands for a corner without weight.
const NOWHERE: (usize, usize) = (12, 0);

/// Twelve vertices: two poles, and two rings of five, the lower one turned by half a step.
fn icosahedron() -> ([DVec3; 12], [[usize; 3]; 20]) {
    let mut corners = [DVec3::Z; 12];
    let height = 0.2_f64.sqrt();
    for step in 0..5 {
        let angle = std::f64::consts::TAU * step as f64 / 5.0;
        for (ring, turn, z) in [(1, 0.0, height), (6, std::f64::consts::PI / 5.0, -height)] {
            let (sin, cos) = (angle + turn).sin_cos();
            corners[ring + step] = DVec3::new(2.0 * height * cos, 2.0 * height * sin, z);
        }
    }
    corners[11] = DVec3::NEG_Z;
    let mut faces = [[0; 3]; 20];
    for step in 0..5 {
        let next = (step + 1) % 5;
        let (upper, upper_next, lower, lower_next) = (1 + step, 1 + next, 6 + step, 6 + next);
        faces[4 * step] = [0, upper, upper_next];
        faces[4 * step + 1] = [upper, lower, upper_next];
        faces[4 * step + 2] = [upper_next, lower, lower_next];
        faces[4 * step + 3] = [11, lower_next, lower];
    }
    (corners, faces)
}

/// About `triangles` triangles, near equilateral.
pub fn generate(triangles: usize) -> Soup {
    let parts = nearest_size(1, triangles, |parts| 20 * parts * parts);
    let (corners, faces) = icosahedron();
    let mut soup = Soup::default();
    // A point on an icosahedron's edge belongs to two faces, so it is known by its weights at the corners.
    let mut known = HashMap::new();
    for face in faces {
        let mut index = |row: usize, column: usize| {
            let mut weights = [(face[0], parts - row), (face[1], row - column), (face[2], column)]
                .map(|(corner, weight)| if weight == 0 { NOWHERE } else { (corner, weight) });
            weights.sort_unstable();
            *known.entry(weights).or_insert_with(|| {
                let weighted = weights.iter().filter(|&&weight| weight != NOWHERE);
                let flat: DVec3 = weighted.map(|&(corner, weight)| corners[corner] * weight as f64).sum();
                soup.points.push(flat.normalize().to_array());
                (soup.points.len() - 1) as u32
            })
        };
        for row in 0..parts {
            for column in 0..=row {
                let [above, left, right] = [index(row, column), index(row + 1, column), index(row + 1, column + 1)];
                soup.triangles.push([above, left, right]);
                if column < row {
                    let beside = index(row, column + 1);
                    soup.triangles.push([above, right, beside]);
                }
            }
        }
    }
    soup
}
