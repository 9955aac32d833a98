//! Connection: the neighbours that a tile has an edge to (the paper, section 2).
//!
//! # Theory
//! A tile selects at most one neighbour in each of the four directions of its cross. The candidates are nearer than L tile
//! sides and within theta of the direction; the best by distance and angle together is selected.
//!
//! # Changes versus the paper
//! The candidates are the neighbours in the [triangulation](super::triangulate) of the tiles, with distances and angles
//! measured on the surface. So edges cannot cross, and faces follow from the order of the edges round a tile. An edge needs the
//! selection of one end only, if it meets the constraints at both.
//!
//! # Practice
//! Keep the defaults: L and theta change little, as most edges meet both constraints. Smaller values give larger holes.

use super::triangulate::Triangulation;
use crate::surface::NONE;
use std::f64::consts::FRAC_PI_2;

/// The constraints of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConnectOptions {
    /// L: the largest distance, in tile sides. Default 1.6.
    pub max_distance: f64,
    /// Theta: the largest angle from a direction of the cross, in degrees. Default 30.
    pub max_angle: f64,
}

impl Default for ConnectOptions {
    fn default() -> Self {
        Self { max_distance: 1.6, max_angle: 30.0 }
    }
}

/// For each half-edge of the triangulation, whether its edge is an edge of the mesh. Edges on features always are.
pub fn connect(triangulation: &Triangulation, options: &ConnectOptions) -> Vec<bool> {
    let faces = &triangulation.faces;
    let constraints = Constraints { max_angle: options.max_angle.to_radians(), max_distance: options.max_distance };
    let mut selected = vec![false; faces.origin.len()];
    let mut allowed = vec![false; faces.origin.len()];
    let mut ring = Vec::new();
    for v in 0..faces.leaving.len() as u32 {
        if faces.leaving[v as usize] == NONE {
            continue;
        }
        faces.ring(v, &mut ring);
        // The best candidate so far in each direction, between two features.
        let mut best: Vec<(i32, f64, u32)> = Vec::new();
        let start = ring.iter().position(|&h| faces.is_feature(h)).unwrap_or(0);
        ring.rotate_left(start);
        let quarters = |edges: &[u32]| {
            let total: f64 = edges.iter().map(|&h| faces.width(h)).sum();
            ((total / FRAC_PI_2).round() as i32).max(1)
        };
        let mut directions = Directions::All(quarters(&ring));
        for (i, &h) in ring.iter().enumerate() {
            if faces.is_feature(h) {
                select(&mut best, &mut selected);
                let next = ring[i + 1..].iter().position(|&h| faces.is_feature(h));
                directions = Directions::Between(quarters(&ring[i..next.map_or(ring.len(), |next| i + 1 + next)]));
                continue;
            }
            let w = faces.target(h);
            let side = (triangulation.sides[v as usize] + triangulation.sides[w as usize]) / 2.0;
            if let Some((direction, cost)) =
                constraints.evaluate(faces.begin[h as usize], faces.length[h as usize] / side, directions)
            {
                allowed[h as usize] = true;
                match best.iter_mut().find(|b| b.0 == direction) {
                    Some(b) if b.1 <= cost => {}
                    Some(b) => *b = (direction, cost, h),
                    None => best.push((direction, cost, h)),
                }
            }
        }
        select(&mut best, &mut selected);
    }
    (0..faces.origin.len())
        .map(|h| {
            let t = faces.twin[h] as usize;
            faces.curve[h] != NONE || t != NONE as usize && (selected[h] && allowed[t] || selected[t] && allowed[h])
        })
        .collect()
}

/// Selects the half-edges of the best candidates.
fn select(best: &mut Vec<(i32, f64, u32)>, selected: &mut [bool]) {
    for (_, _, h) in best.drain(..) {
        selected[h as usize] = true;
    }
}

/// The directions of a tile's cross, in quarter turns.
#[derive(Clone, Copy)]
enum Directions {
    /// All directions of a tile off features, by their number.
    All(i32),
    /// The directions strictly between a feature and the next one, by the quarter turns between the two.
    Between(i32),
}

/// The constraints of an edge: an angle in radians and a distance in tile sides.
struct Constraints {
    max_angle: f64,
    max_distance: f64,
}

impl Constraints {
    /// The direction of the cross nearest to an edge, and the edge's cost; `None` where it does not meet the constraints.
    fn evaluate(&self, angle: f64, sides: f64, directions: Directions) -> Option<(i32, f64)> {
        let turn = (angle / FRAC_PI_2).round();
        let off = (angle - turn * FRAC_PI_2).abs();
        if off > self.max_angle || sides > self.max_distance {
            return None;
        }
        let cost = (off / self.max_angle).powi(2) + (sides - 1.0).powi(2);
        let direction = match directions {
            Directions::All(quarters) => (turn as i32).rem_euclid(quarters),
            Directions::Between(quarters) => Some(turn as i32).filter(|turn| (1..quarters).contains(turn))?,
        };
        Some((direction, cost))
    }
}
