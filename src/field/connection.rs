//! The connection Laplacian of a surface's crosses.
//!
//! # Theory
//! The smoothest field minimises `sum_ij w_ij |z_i - r_ij z_j|^2 / 2` against the constraints, with cotangent weights `w` and
//! the connection `r` (Knöppel et al. 2013, *Globally optimal direction fields*). Where no constraint reaches, diffusion
//! begins with the direction of the surface's greatest bending: on a torus that gives a field without singularities, which no
//! diffusion finds from elsewhere, for curvature holds pairs of singularities on the outer and the inner side apart.

use super::Sectors;
use super::constraints::Constraint;
use crate::compute::{Complex, Link, add, conjugate, scaled};
use crate::solver::{Problem, Terms};
use crate::surface::{Surface, next, next_corner, previous};
use rayon::prelude::*;

/// The time step of diffusion, in areas of the surface: so long that constraints decide, and short enough that without any
/// the equations have one solution.
const DIFFUSION: f64 = 10.0;

/// The equations of the smoothest field under these constraints, one for each sector; links run along the surface's edges.
pub(super) fn problem(surface: &Surface, sectors: &Sectors, constraints: &[Constraint]) -> Problem {
    let area = surface.area();
    let normals: Vec<_> = (0..surface.triangle_count()).into_par_iter().map(|t| surface.normal(t)).collect();
    let links_of_edges: Vec<Complex> = (0..3 * surface.triangle_count() as u32)
        .into_par_iter()
        .map(|h| {
            let weight = sectors.edge_weight(h);
            let (s, c) = (4.0 * sectors.transport(h)).sin_cos();
            [(weight * c) as f32, (weight * s) as f32]
        })
        .collect();
    let right_hand_side = constraints.iter().map(|constraint| {
        if constraint.is_fixed() { constraint.target } else { scaled(constraint.target, constraint.weight) }
    });
    Problem::new(right_hand_side.collect(), |i, links| {
        let first = sectors.first_corner[i];
        let mut around = 0.0;
        let mut bend = [0.0f64; 2];
        let own = links.len();
        let mut at = first;
        loop {
            around += surface.double_area(at as usize / 3);
            // The edge that leaves this corner was the last corner's other side, and this one's other side comes next.
            let out = links_of_edges[at as usize];
            if let Some(twin) = surface.twin(at) {
                let e = surface.points[surface.target(at) as usize] - surface.points[surface.origin(at) as usize];
                let turn = normals[at as usize / 3].cross(normals[twin as usize / 3]).dot(e) / 2.0;
                let (s, c) = (2.0 * sectors.direction(at, 0.0)).sin_cos();
                bend = [bend[0] + f64::from(turn) * c, bend[1] + f64::from(turn) * s];
            }
            let back = conjugate(links_of_edges[previous(at) as usize]);
            match links.last_mut().filter(|_| at != first) {
                Some(last) => last.weight = add(last.weight, out),
                None => links.push(Link { neighbour: sectors.of_corner[next(at) as usize], weight: out }),
            }
            match next_corner(surface, |h| surface.features().is_feature(h), at) {
                Some(corner) if corner == first => {
                    links[own].weight = add(links[own].weight, back);
                    break;
                }
                more => {
                    links.push(Link { neighbour: sectors.of_corner[previous(at) as usize], weight: back });
                    let Some(corner) = more else { break };
                    at = corner;
                }
            }
        }
        Terms {
            curvature: 0.0,
            constraint: constraints[i].weight,
            mass: (f64::from(around) / 6.0 / (DIFFUSION * area)) as f32,
            fixed: constraints[i].is_fixed(),
            guess: {
                let a = f64::from(around) / 6.0;
                [((bend[0] * bend[0] - bend[1] * bend[1]) / a) as f32, (2.0 * bend[0] * bend[1] / a) as f32]
            },
        }
    })
}

#[cfg(test)]
mod hierarchy_tests;
#[cfg(test)]
mod solver_tests;
