//! The quality of a layout of tiles.
//!
//! # Theory
//! The aim of the paper's references 1 and 2: tiles that almost cover the surface, without overlaps. Areas are measured at points
//! that are spread evenly over the surface: each counts the tiles that see it within their squares.

use super::Mosaic;
use super::anisotropic::see_anisotropic;
use super::quarters::quarter_count;
use crate::compute::Tile;
use crate::compute::cell;
use crate::compute::cpu::grid::Grid;
use crate::surface::sampling::sample_evenly;
use crate::surface::{Surface, SurfacePoint};
use rayon::prelude::*;
use serde::Serialize;

/// Points per tile at which areas are measured.
const POINTS: usize = 25;
/// The least number of points.
const LEAST_POINTS: usize = 50_000;

/// Measures of the tiles of a mosaic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TileQuality {
    /// The area under tiles, as a share of the surface's.
    pub coverage: f64,
    /// The area under two tiles or more, as a share of the surface's.
    pub overlap: f64,
    /// The mean angle between an axis of a tile and the direction of its neighbour there, in degrees.
    pub straightness: f64,
    /// For each tile: 1 where its neighbours are at their lattice points, 0 where they are half a tile off or missing.
    #[serde(skip)]
    pub of_tiles: Vec<f64>,
}

impl TileQuality {
    /// Measures a mosaic whose tiles have no grout.
    pub fn of(surface: &Surface, mosaic: &Mosaic) -> Self {
        let tiles = &mosaic.tiles;
        let largest = tiles.iter().map(|tile| tile.h).fold(f32::MIN_POSITIVE, f32::max);
        let longest = mosaic.longest();
        let grid = Grid::build(|tile| tiles[tile].position, tiles.len(), longest * cell(largest));

        let points = sample_evenly(surface, (POINTS * tiles.len()).max(LEAST_POINTS));
        let layers = |point: &SurfacePoint| {
            let mut layers = 0;
            grid.around(point.position.into(), |tile| {
                let factor = mosaic.factor(tile as usize);
                layers += usize::from(covers(surface, &tiles[tile as usize], factor, longest, point))
            });
            [usize::from(layers > 0), usize::from(layers > 1)]
        };
        let sum = |a: [usize; 2], b: [usize; 2]| [a[0] + b[0], a[1] + b[1]];
        let [covered, twice] = points.par_iter().map(layers).reduce(|| [0; 2], sum);

        let neighbourhoods: Vec<Vec<Neighbour>> =
            (0..tiles.len()).into_par_iter().map(|tile| neighbours(mosaic, tile, longest, &grid)).collect();
        let angles = neighbourhoods.iter().flatten().map(|neighbour| neighbour.angle);
        let count = neighbourhoods.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let fit = |neighbours: &Vec<Neighbour>| match neighbours.len() {
            0 => 0.0,
            count => {
                let miss = neighbours.iter().map(|neighbour| neighbour.miss).sum::<f64>() / count as f64;
                (1.0 - 2.0 * miss).clamp(0.0, 1.0)
            }
        };
        let whole = points.len().max(1) as f64;
        Self {
            coverage: covered as f64 / whole,
            overlap: twice as f64 / whole,
            straightness: angles.sum::<f64>() / count,
            of_tiles: neighbourhoods.iter().map(fit).collect(),
        }
    }
}

/// Whether a point lies under a tile.
fn covers(surface: &Surface, tile: &Tile, factor: f32, longest: f32, point: &SurfacePoint) -> bool {
    let normal = surface.normal(point.triangle as usize).into();
    let here = Tile { position: point.position.into(), normal, triangle: point.triangle, quarters: 0, ..*tile };
    let Some([u, v]) = see_anisotropic(tile, factor, &here, longest) else { return false };
    // In which quarter of the square, counter-clockwise from the axis.
    let quarter = match (u >= 0.0, v >= 0.0) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    };
    u.abs() <= 0.5 && v.abs() <= 0.5 && quarter < quarter_count(tile)
}

/// The tile next to another along one of its axes.
struct Neighbour {
    /// Between the axis and the direction to it, in degrees.
    angle: f64,
    /// How far it is from its lattice point, along or across, in tile sides.
    miss: f64,
}

/// The neighbours of a tile along its axes, as far as it has any.
fn neighbours(mosaic: &Mosaic, number: usize, longest: f32, grid: &Grid) -> Vec<Neighbour> {
    let (tile, factor) = (&mosaic.tiles[number], mosaic.factor(number));
    let mut best: [Option<Neighbour>; 4] = [const { None }; 4];
    grid.around(tile.position, |other| {
        let seen = see_anisotropic(tile, factor, &mosaic.tiles[other as usize], longest);
        let Some([u, v]) = seen.map(|u| u.map(f64::from)) else { return };
        let (turn, along, across) = match (u.abs() >= v.abs(), u > 0.0, v > 0.0) {
            (true, true, _) => (0, u, v),
            (false, _, true) => (1, v, u),
            (true, false, _) => (2, -u, v),
            (false, _, false) => (3, -v, u),
        };
        let miss = (along - 1.0).abs().max(across.abs());
        // Nearer to another lattice point, or behind a feature.
        if miss >= 0.5 || (tile.quarters > 0 && turn as u32 > tile.quarters) {
            return;
        }
        if best[turn].as_ref().is_none_or(|best| miss < best.miss) {
            // In space, where a tile's two sides differ.
            let skew = if turn % 2 == 0 { 1.0 / (factor * factor) } else { factor * factor };
            let angle = (across.abs() * f64::from(skew)).atan2(along).to_degrees();
            best[turn] = Some(Neighbour { angle, miss });
        }
    });
    best.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, Soup};

    const CELLS: usize = 12;

    /// A flat square of cells, and a tile on each of them, moved by `shift`, in cells, and turned by `turn`, in radians.
    fn lattice(shift: impl Fn(usize, usize) -> [f32; 2], turn: f32) -> (Surface, Mosaic) {
        let at = |i: usize, j: usize| (j * (CELLS + 1) + i) as u32;
        let mut soup = Soup::default();
        for j in 0..=CELLS {
            soup.points.extend((0..=CELLS).map(|i| [i as f64, j as f64, 0.0]));
        }
        for j in 0..CELLS {
            for i in 0..CELLS {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                soup.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let h = (1.0 / surface.frame().diagonal) as f32;
        let tiles = (0..CELLS * CELLS).map(|cell| {
            let (i, j) = (cell % CELLS, cell / CELLS);
            let [x, y] = shift(i, j);
            let middle = CELLS as f32 / 2.0 - 0.5;
            let position = [(i as f32 + x - middle) * h, (j as f32 + y - middle) * h, 0.0];
            let axis = [turn.cos(), turn.sin(), 0.0];
            Tile { position, h, normal: [0.0, 0.0, 1.0], triangle: 2 * cell as u32, axis, quarters: 0 }
        });
        let tiles = tiles.collect();
        (surface, Mosaic { tiles, ..Mosaic::default() })
    }

    /// The shares are of 50,000 points; borders of tiles are 2 x 144 sides, and a point is on one only by rounding.
    const TOLERANCE: f64 = 1e-3;

    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() < TOLERANCE
    }

    #[test]
    fn a_perfect_lattice_covers_all_once() {
        let (surface, mosaic) = lattice(|_, _| [0.0; 2], 0.0);
        let fit = TileQuality::of(&surface, &mosaic);
        assert!(close(fit.coverage, 1.0) && close(fit.overlap, 0.0), "{fit:?}");
        assert!(fit.straightness < 1e-3);
        assert!(fit.of_tiles.iter().all(|&fit| fit > 0.9999));
    }

    #[test]
    fn a_shifted_tile_leaves_a_gap_and_lies_on_its_neighbour() {
        let (surface, mosaic) = lattice(|i, j| if (i, j) == (5, 6) { [0.25, 0.0] } else { [0.0; 2] }, 0.0);
        let fit = TileQuality::of(&surface, &mosaic);
        let share = 0.25 / (CELLS * CELLS) as f64;
        // A quarter of a tile is 87 points of 50,000; a few less or more lie in it.
        let close = |found: f64, expected: f64| (found - expected).abs() < 0.05 * share;
        assert!(close(1.0 - fit.coverage, share) && close(fit.overlap, share), "{fit:?}");
        // Its two neighbours in its row are off by a quarter, those beside it as well.
        let tile = 6 * CELLS + 5;
        assert!((fit.of_tiles[tile] - 0.5).abs() < 1e-4, "{}", fit.of_tiles[tile]);
        assert!((fit.of_tiles[tile + 1] - (1.0 - 2.0 * 0.25 / 4.0)).abs() < 1e-4);
    }

    #[test]
    fn rows_that_are_sheared_are_not_straight() {
        // Each row a fifth of a tile further than the one below: of the pairs of neighbours half are off by arctan 0.2.
        let (surface, mosaic) = lattice(|_, j| [0.2 * j as f32, 0.0], 0.0);
        let fit = TileQuality::of(&surface, &mosaic);
        let angle = 0.2_f64.atan().to_degrees();
        assert!((fit.straightness - angle / 2.0).abs() < 1e-3, "{}", fit.straightness);
        let turned = TileQuality::of(&surface, &lattice(|_, _| [0.0; 2], 0.1).1);
        assert!((turned.straightness - 0.1_f64.to_degrees()).abs() < 1e-3);
    }

    #[test]
    fn halves_and_quarters_of_tiles_cover_their_part() {
        for (quarters, share) in [(1, 0.25), (2, 0.5), (3, 0.75), (4, 1.0), (5, 1.0), (0, 1.0)] {
            let (surface, mut mosaic) = lattice(|_, _| [0.0; 2], 0.0);
            mosaic.tiles.iter_mut().for_each(|tile| tile.quarters = quarters);
            let fit = TileQuality::of(&surface, &mosaic);
            assert!((fit.coverage - share).abs() < 0.005, "{quarters} quarters: {}", fit.coverage);
            assert_eq!(fit.overlap, 0.0);
        }
    }

    #[test]
    fn the_other_side_of_a_thin_part_is_not_covered() {
        let (surface, mosaic) = lattice(|_, _| [0.0; 2], 0.0);
        let turned = Mosaic {
            tiles: mosaic.tiles.iter().map(|tile| Tile { normal: [0.0, 0.0, -1.0], ..*tile }).collect(),
            ..mosaic
        };
        assert_eq!(TileQuality::of(&surface, &turned).coverage, 0.0);
        let soup = Example::Sphere.generate(500);
        let sphere = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let none = TileQuality::of(&sphere, &Mosaic::default());
        assert_eq!((none.coverage, none.overlap, none.straightness), (0.0, 0.0, 0.0));
    }
}
