//! The distortion of a parametrization: how far rows are from squares, and where they fold.

use super::{NEARLY_INVERTED, Parametrization};
use crate::surface::Surface;
use rayon::prelude::*;
use serde::Serialize;

/// A fold smaller than this share of a tile holds no grid point.
const SMALL_FOLD: f64 = 0.02;
/// Irregular vertices that a fold brings into the mesh.
const IRREGULAR_PER_FOLD: f64 = 4.0;
/// The shape that one share of irregular vertices is worth (docs/experiments.md, parametrization).
const WORTH: f64 = 4.0;

/// The distortion of rows that pass over the whole surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distortion {
    /// The mean over the surface of `2 a b / (a^2 + b^2)`, `a` and `b` being the singular values of the map to the rows: 1 for
    /// squares, 0 where rows are inverted.
    pub shape: f64,
    /// Connected parts of the surface where rows are inverted, or nearly.
    pub folds: usize,
}

impl Distortion {
    /// What the distortion costs a mesh of `count` vertices: the loss of shape, and of regularity by folds.
    pub fn cost(&self, count: usize) -> f64 {
        1.0 - self.shape + WORTH * IRREGULAR_PER_FOLD * self.folds as f64 / count.max(1) as f64
    }
}

impl Parametrization<'_> {
    /// The distortion, tiles having the side `h` in the mean, in unit-sized coordinates.
    pub fn distortion(&self, surface: &Surface, h: f64) -> Distortion {
        let count = surface.triangle_count() as u32;
        let images: Vec<[f64; 2]> = (0..count).into_par_iter().map(|t| self.singular_values(t)).collect();
        let area = |t: u32| f64::from(surface.double_area(t as usize)) / 2.0;
        let shape = |&[large, small]: &[f64; 2]| {
            let squares = large * large + small * small;
            if squares > 0.0 { (2.0 * large * small / squares).max(0.0) } else { 0.0 }
        };
        let shapes: f64 = (0..count).zip(&images).map(|(t, image)| area(t) * shape(image)).sum();
        let mut is_left: Vec<bool> = images.iter().map(|&[_, small]| small < NEARLY_INVERTED).collect();
        let mut folds = 0;
        for first in 0..count {
            let mut folded = 0.0;
            let mut stack = vec![first];
            while let Some(t) = stack.pop() {
                if std::mem::take(&mut is_left[t as usize]) {
                    folded += area(t);
                    stack.extend((3 * t..3 * t + 3).filter_map(|h| surface.twin(h)).map(|twin| twin / 3));
                }
            }
            folds += usize::from(folded > SMALL_FOLD * h * h);
        }
        Distortion { shape: shapes / (0..count).map(area).sum::<f64>().max(f64::MIN_POSITIVE), folds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::Cpu;
    use crate::field::{Field, FieldOptions};
    use crate::parametrize::Rows;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    #[test]
    fn rows_without_area_are_one_fold_without_shape_and_solved_rows_have_nearly_squares() {
        let surface = Surface::new(&Example::Torus.generate(4_000), &FeatureOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
        let h = 0.02;
        let mut rows = Parametrization::solve(&surface, &field, |_| h, &[], Rows::Continuous, &Cpu).expect("solved");
        let solved = rows.distortion(&surface, h);
        assert!(solved.shape > 0.8 && solved.shape < 1.0, "{solved:?}");
        rows.coordinates.iter_mut().for_each(|pair| *pair = [0.0; 2]);
        rows.jumps.iter_mut().for_each(|pair| *pair = [0; 2]);
        let folded = rows.distortion(&surface, h);
        assert_eq!(folded.shape, 0.0, "all rows at one place have no shape");
        assert_eq!(folded.folds, 1, "the whole surface is one fold");
        assert!((folded.cost(1_000) - (1.0 + WORTH * IRREGULAR_PER_FOLD / 1_000.0)).abs() < 1e-12);
    }
}
