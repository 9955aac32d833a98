//! Scenes of mosaics: tiles with grout between them, as in the paper's figure 1.

use super::mesh::surface_scene;
use super::scene::{Corner, NO_PEN};
use super::{Colour, Legend, Scene};
use crate::mosaic::{Mosaic, Tile};
use crate::surface::Surface;
use glam::{DVec3, Vec3};

/// Five shades of stone, so that tiles are told apart.
pub(crate) const STONES: [Colour; 5] = [
    Colour([233, 221, 196]),
    Colour([226, 209, 178]),
    Colour([238, 229, 210]),
    Colour([219, 198, 164]),
    Colour([230, 214, 190]),
];

/// The tiles of a mosaic on their surface. `grout` is the share of a tile's side between it and the next. `fit` tells how
/// well each tile sits, from 0 to 1, by colour; without it tiles are of stone.
pub fn mosaic_scene(surface: &Surface, mosaic: &Mosaic, grout: f32, fit: Option<&[f64]>) -> Scene {
    let mut scene = surface_scene(surface, Colour::GROUT);
    // Tiles lie over the features.
    scene.lines.clear();
    scene.ground = scene.faces.len();
    for (number, (tile, quarters)) in mosaic.tiles.iter().zip(mosaic.quarters(surface, 1.0 - grout)).enumerate() {
        let normal = Vec3::from(tile.normal);
        let colour = fit.map_or_else(|| stone(tile), |fit| Colour::of_quality(fit[number]));
        for quarter in quarters {
            let model = |place: [f32; 3]| surface.frame().to_model(place.map(f64::from));
            let first = scene.place(quarter.map(model));
            scene.face(&[0, 1, 2, 3].map(|k| Corner { point: first + k, normal, pen: NO_PEN }), colour);
        }
    }
    scene.legend = fit.map(|_| Legend { title: "fit of tiles".to_owned() });
    scene
}

/// A shade that looks drawn by lot, the same for all sides of a tile.
fn stone(tile: &Tile) -> Colour {
    let place = DVec3::from(tile.position.map(f64::from));
    let lot = (place.dot(DVec3::new(12_989.8, 78_233.0, 37_719.1))).sin() * 43_758.5;
    STONES[((lot - lot.floor()) * STONES.len() as f64) as usize % STONES.len()]
}
