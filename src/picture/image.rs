//! A picture in pixels.

use super::raster::{Band, EMPTY, FINE, Sight, nearest};
use super::scene::{Face, NO_PEN};
use super::view::Camera;
use super::{Colour, PictureError, Scene, View, legend};
use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};
use std::io;

/// A picture in pixels, in sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue of all pixels, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

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

    /// Mixes some of a colour into a pixel, 0 none, 1 all; outside of the picture nothing happens.
    pub(super) fn blend(&mut self, [x, y]: [i32; 2], colour: Colour, share: f32) {
        if (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y) {
            let pixel = &mut self.pixels[y as usize * self.width as usize + x as usize];
            *pixel = Colour(*pixel).mixed(colour, share).0;
        }
    }

    /// Writes it as PNG.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_png(&self, writer: impl io::Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(writer, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        Ok(writer.finish()?)
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

/// The colour of a face in the light, at a place of it or as a whole.
pub(super) fn shaded(sight: &Sight, face: &Face, place: Option<DVec2>) -> Colour {
    let corners = sight.scene.corners_of(face);
    let outline = sight.outline(face).map(|corner| corner.xy());
    let front = sight.is_front(face);
    let even = corners.iter().all(|corner| corner.normal == corners[0].normal);
    let normal = match place {
        _ if even => corners[0].normal,
        None => corners.iter().map(|corner| corner.normal).sum::<Vec3>(),
        Some(place) => {
            let places: Vec<DVec2> = outline.collect();
            // Of the triangles of the fan the one that the place is in, or least outside of.
            let shares = (1..places.len() - 1).map(|k| (k, shares([places[0], places[k], places[k + 1]], place)));
            let best = shares.max_by(|a, b| a.1.min_element().total_cmp(&b.1.min_element()));
            best.map_or(Vec3::ZERO, |(k, share)| {
                let share = share.as_vec3();
                corners[0].normal * share.x + corners[k].normal * share.y + corners[k + 1].normal * share.z
            })
        }
    };
    let seen = sight.camera.seen(normal.as_dvec3()).normalize_or_zero() * if front { 1.0 } else { -1.0 };
    // Where colours mean something, they are not to be changed much.
    let contrast = if sight.scene.legend.is_some() { 0.5 } else { 1.0 };
    let light = 1.0 - contrast * (1.0 - light(seen));
    if front { face.colour.lit(light) } else { Colour::BACK.lit(0.9 * light) }
}

/// The light on a surface with this normal as seen: a lamp above the left shoulder, and the sky.
fn light(normal: DVec3) -> f32 {
    let lamp = DVec3::new(-0.35, 0.5, 1.0).normalize();
    let direct = normal.dot(lamp).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    (0.4 + 0.6 * direct + 0.1 * sky).min(1.0) as f32
}

/// The shares of a triangle's corners in a place.
fn shares([a, b, c]: [DVec2; 3], p: DVec2) -> DVec3 {
    let whole = (b - a).perp_dot(c - a);
    if whole == 0.0 {
        return DVec3::new(f64::NEG_INFINITY, 0.0, 0.0);
    }
    DVec3::new((c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)) / whole
}
