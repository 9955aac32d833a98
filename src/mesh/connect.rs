//! Connection: which of a tile's neighbours it is joined to (the paper, section 2).
//!
//! # Theory
//! In each of the four directions of a tile's cross exactly one neighbour is selected, the best by distance and angle
//! together, among those nearer than L tile sides and within theta of the direction.
//!
//! # Changes versus the paper
//! The candidates are the neighbours in the [triangulation](super::triangulate) of the tiles, with distances and angles
//! measured on the surface. So edges cannot cross, and faces follow from the surface's own order of edges round a tile.
//! An edge that only one of its ends has selected is made too, where the angle suits both.

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

/// For each half-edge of the triangulation whether its edge is an edge of the mesh. Edges on features always are.
pub fn connect(triangulation: &Triangulation, options: &ConnectOptions) -> Vec<bool> {
    let faces = &triangulation.faces;
    let suits = Suits { theta: options.max_angle.to_radians(), reach: options.max_distance };
    let mut selected = vec![false; faces.origin.len()];
    let mut allowed = vec![false; faces.origin.len()];
    let mut ring = Vec::new();
    for v in 0..faces.leaving.len() as u32 {
        if faces.leaving[v as usize] == NONE {
            continue;
        }
        faces.ring(v, &mut ring);
        // The best so far in each direction of the present side; a feature begins the next side.
        let mut best: Vec<(i32, f64, u32)> = Vec::new();
        let start = ring.iter().position(|&h| faces.is_feature(h)).unwrap_or(0);
        ring.rotate_left(start);
        let quarters = |edges: &[u32]| {
            let round: f64 = edges.iter().map(|&h| faces.width(h)).sum();
            ((round / FRAC_PI_2).round() as i32).max(1)
        };
        let mut directions = Directions::Round(quarters(&ring));
        for (i, &h) in ring.iter().enumerate() {
            if faces.is_feature(h) {
                settle(&mut best, &mut selected);
                let next = ring[i + 1..].iter().position(|&h| faces.is_feature(h));
                directions = Directions::Between(quarters(&ring[i..next.map_or(ring.len(), |next| i + 1 + next)]));
                continue;
            }
            let w = faces.target(h);
            let side = (triangulation.sides[v as usize] + triangulation.sides[w as usize]) / 2.0;
            if let Some((direction, cost)) =
                suits.judge(faces.begin[h as usize], faces.length[h as usize] / side, directions)
            {
                allowed[h as usize] = true;
                match best.iter_mut().find(|b| b.0 == direction) {
                    Some(b) if b.1 <= cost => {}
                    Some(b) => *b = (direction, cost, h),
                    None => best.push((direction, cost, h)),
                }
            }
        }
        settle(&mut best, &mut selected);
    }
    (0..faces.origin.len())
        .map(|h| {
            let t = faces.twin[h] as usize;
            faces.curve[h] != NONE || t != NONE as usize && (selected[h] && allowed[t] || selected[t] && allowed[h])
        })
        .collect()
}

fn settle(best: &mut Vec<(i32, f64, u32)>, selected: &mut [bool]) {
    for (_, _, h) in best.drain(..) {
        selected[h as usize] = true;
    }
}

/// The directions of a tile's cross, in quarter turns.
#[derive(Clone, Copy)]
enum Directions {
    /// All round it: so many.
    Round(i32),
    /// Those between a feature and the next one, so many quarter turns from it: the features take their own.
    Between(i32),
}

struct Suits {
    theta: f64,
    reach: f64,
}

impl Suits {
    /// The direction of the cross that an edge is nearest to, and how badly it suits; `None` where it does not.
    fn judge(&self, angle: f64, sides: f64, directions: Directions) -> Option<(i32, f64)> {
        let turn = (angle / FRAC_PI_2).round();
        let off = (angle - turn * FRAC_PI_2).abs();
        if off > self.theta || sides > self.reach {
            return None;
        }
        let cost = (off / self.theta).powi(2) + (sides - 1.0).powi(2);
        let direction = match directions {
            Directions::Round(quarters) => (turn as i32).rem_euclid(quarters),
            Directions::Between(quarters) => Some(turn as i32).filter(|turn| (1..quarters).contains(turn))?,
        };
        Some((direction, cost))
    }
}
