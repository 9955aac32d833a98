//! Local stiffening: triangles whose image is inverted, or nearly, weigh more in the next solve.
//!
//! After Bommer, Zimmer and Kobbelt 2009 (*Mixed-integer quadrangulation*, section 5).

use super::{NEARLY_INVERTED, Parametrization};
use crate::compute::{Backend, ComputeError};
use crate::surface::Surface;
use rayon::prelude::*;

/// Rounds (docs/experiments.md, parametrization).
const ROUNDS: usize = 2;
/// How far the two singular values of a triangle may be from 1, together, before it is stiffened.
const TOLERATED_DISTORTION: f64 = 0.6;
/// By how much a triangle is stiffened at most in a round.
const MOST_STIFFENING: f64 = 5.0;

impl Parametrization<'_> {
    /// Stiffens and solves again until no triangle is inverted, in a few rounds.
    ///
    /// # Errors
    /// Where the backend fails.
    pub(super) fn stiffen_inverted(&mut self, surface: &Surface, backend: &dyn Backend) -> Result<(), ComputeError> {
        for _ in 0..ROUNDS {
            if !self.stiffen(surface) {
                break;
            }
            let cones = self.cones(surface);
            self.solve_offsets(surface, &cones, backend)?;
        }
        Ok(())
    }

    /// Gives more weight to triangles whose image is distorted; whether any image is inverted, or nearly.
    fn stiffen(&mut self, surface: &Surface) -> bool {
        let images: Vec<[f64; 2]> =
            (0..surface.triangle_count() as u32).into_par_iter().map(|t| self.singular_values(t)).collect();
        self.stiffness.resize(images.len(), 1.0);
        for (stiffness, [large, small]) in self.stiffness.iter_mut().zip(&images) {
            *stiffness +=
                ((large - 1.0).abs() + (small - 1.0).abs() - TOLERATED_DISTORTION).clamp(0.0, MOST_STIFFENING);
        }
        images.iter().any(|&[_, small]| small < NEARLY_INVERTED)
    }

    /// The singular values of the map from a triangle to its image, the larger first; the smaller one is negative where the
    /// image is inverted.
    pub(super) fn singular_values(&self, triangle: u32) -> [f64; 2] {
        if let Some(cone) = self.cone(triangle) {
            // A cone in the middle is undistorted.
            let least = 3.0 * cone.raw_barycentric(self).into_iter().fold(f64::INFINITY, f64::min);
            return [1.0 + (1.0 - least).max(0.0), least.min(1.0)];
        }
        let [first, last] = [3 * triangle, 3 * triangle + 2];
        let reversed = |step: [f64; 2]| step.map(|x| -x);
        let transition = self.transitions[last as usize];
        let [a, b] = [self.transitions[first as usize].wanted, reversed(transition.forward(transition.wanted))];
        let [p, q] = [self.step(first), reversed(self.step_at_end(last))];
        let area = a[0] * b[1] - a[1] * b[0];
        if area <= 0.0 {
            return [1.0; 2];
        }
        // The columns of the map that leads from the sides to their images, and its singular values.
        let x = [0, 1].map(|k| (p[k] * b[1] - q[k] * a[1]) / area);
        let y = [0, 1].map(|k| (q[k] * a[0] - p[k] * b[0]) / area);
        let (sum, difference) = ((x[0] + y[1]).hypot(x[1] - y[0]), (x[0] - y[1]).hypot(x[1] + y[0]));
        [(sum + difference) / 2.0, (sum - difference) / 2.0]
    }
}
