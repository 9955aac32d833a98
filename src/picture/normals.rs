//! Normals for shading: a smooth surface looks smooth, a crease stays a crease.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Faces that turn by less than this are one smooth surface: the cosine of 40 degrees.
pub(super) const CREASE_COSINE: f64 = 0.766;

/// A unit normal for each corner of triangles: the mean over the triangles at its point that turn little from its own.
pub(super) fn corner_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let normals: Vec<DVec3> = triangles
        .par_iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|v| points[v as usize]);
            (b - a).cross(c - a)
        })
        .collect();
    let units: Vec<DVec3> = normals.par_iter().map(|normal| normal.normalize_or_zero()).collect();
    let mut starts = vec![0_u32; points.len() + 1];
    triangles.as_flattened().iter().for_each(|&v| starts[v as usize + 1] += 1);
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut cursors = starts.clone();
    let mut around = vec![0_u32; 3 * triangles.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        for &v in triangle {
            around[cursors[v as usize] as usize] = t as u32;
            cursors[v as usize] += 1;
        }
    }
    let corner = |at: usize| {
        let (own, v) = (units[at / 3], triangles[at / 3][at % 3] as usize);
        let near = &around[starts[v] as usize..starts[v + 1] as usize];
        let alike = near.iter().filter(|&&t| units[t as usize].dot(own) > CREASE_COSINE);
        alike.map(|&t| normals[t as usize]).sum::<DVec3>().try_normalize().unwrap_or(own).as_vec3()
    };
    (0..3 * triangles.len()).into_par_iter().map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_pair_is_smooth_and_a_folded_one_is_not() {
        let pair = |height: f64| {
            let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, 0.0], [1.0, 0.5, height]].map(DVec3::from);
            corner_normals(&points, &[[0, 1, 2], [1, 0, 3]])
        };
        let bent = pair(-0.5);
        assert_eq!(bent[0], bent[4], "they share a normal at the edge");
        assert!(bent[2].abs_diff_eq(Vec3::Z, 1e-6));
        let folded = pair(-5.0);
        assert!(folded[0].abs_diff_eq(Vec3::Z, 1e-6) && folded[4].x > 0.9);
    }
}
