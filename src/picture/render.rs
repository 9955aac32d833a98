//! Scenes drawn in pixels.

use super::raster::{Band, EMPTY, FINE, Sight, nearest};
use super::scene::NO_PEN;
use super::shading::shaded;
use super::view::Camera;
use super::{Colour, Image, PictureError, Scene, View, legend};
use glam::{DVec2, Vec3Swizzles};

/// The thinnest side that samples show evenly, in samples; thinner ones are drawn so wide, but paler.
const THINNEST: f64 = 1.25;

impl Image {
    /// Draws a scene.
    ///
    /// # Errors
    /// Where the size or the view makes no sense, or there is nothing to draw.
    pub fn of(scene: &Scene, view: &View, size: [u32; 2]) -> Result<Self, PictureError> {
        let camera = Camera::new(scene, view, size)?;
        let sight = Sight::new(scene, &camera);
        let pixels = sight.each_band(|band| resolve(&sight, band)).concat();
        let mut image = Self { width: size[0], height: size[1], pixels };
        if let Some(legend) = &scene.legend {
            legend::draw(legend, &mut image);
        }
        Ok(image)
    }
}

/// The colours of a band's pixels.
fn resolve(sight: &Sight, band: &Band) -> Vec<[u8; 3]> {
    let columns = sight.columns();
    let width = columns / FINE;
    let rows = band.seen.len() / columns / FINE;
    let mut pixels = Vec::with_capacity(rows * width);
    for row in 0..rows {
        for column in 0..width {
            let mut sum = [0_u32; 3];
            for k in 0..FINE * FINE {
                let (y, x) = (FINE * row + k / FINE, FINE * column + k % FINE);
                let place = DVec2::new(x as f64 + 0.5, (band.top + y) as f64 + 0.5);
                let colour = colour(sight, band.seen[y * columns + x], place);
                sum.iter_mut().zip(colour.0).for_each(|(sum, part)| *sum += u32::from(part));
            }
            const ALL: u32 = (FINE * FINE) as u32;
            pixels.push(sum.map(|sum| ((sum + ALL / 2) / ALL) as u8));
        }
    }
    pixels
}

/// The colour of a sample where this is seen.
fn colour(sight: &Sight, seen: u32, place: DVec2) -> Colour {
    if seen == EMPTY {
        return Colour::PAPER;
    }
    if let Some((_, line)) = sight.line(seen) {
        return sight.scene.pens[line.pen as usize].colour;
    }
    let face = &sight.scene.faces[seen as usize];
    let filled = shaded(sight, face, Some(place));
    let corners = sight.scene.corners_of(face);
    let mut ends = sight.outline(face).map(|corner| corner.xy());
    let first = ends.next().unwrap_or_default();
    let mut start = first;
    let mut drawn: Option<(u8, f64)> = None;
    for (corner, end) in corners.iter().zip(ends.chain([first])) {
        if corner.pen != NO_PEN {
            let width = sight.widths[corner.pen as usize];
            let away = start.lerp(end, nearest(start, end, place)).distance(place);
            // Where two meet, the wider is above.
            if away <= width.max(THINNEST) / 2.0 && drawn.is_none_or(|drawn| drawn.1 < width) {
                drawn = Some((corner.pen, width));
            }
        }
        start = end;
    }
    match drawn {
        None => filled,
        Some((pen, width)) => filled.mixed(sight.scene.pens[pen as usize].colour, (width / THINNEST).min(1.0) as f32),
    }
}
