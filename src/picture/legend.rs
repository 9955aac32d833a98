//! The legend of a picture: a bar of colours with its ends named.

use super::{Colour, Image};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// What the colours of faces mean: those of [`Colour::of_quality`] from 0 to 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Legend {
    /// What is measured, in ASCII.
    pub title: String,
}

/// The numbers below the bar, each at its share of it.
pub(super) const MARKS: [(f64, &str); 3] = [(0.0, "0"), (0.5, "0.5"), (1.0, "1")];

/// Where things are, in pixels, for a picture of this size.
pub(super) struct Layout {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    /// The height of letters.
    pub text: f64,
}

impl Layout {
    pub fn of(size: [u32; 2]) -> Self {
        let page = f64::from(size[0].min(size[1])) / 1000.0;
        let text = f64::from(raster_height(page).val() as u32);
        let (width, height) = (260.0 * page, 14.0 * page);
        Self { left: 30.0 * page, top: f64::from(size[1]) - 30.0 * page - height - 1.4 * text, width, height, text }
    }
}

fn raster_height(page: f64) -> RasterHeight {
    match 22.0 * page {
        ..18.0 => RasterHeight::Size16,
        ..22.0 => RasterHeight::Size20,
        ..28.0 => RasterHeight::Size24,
        _ => RasterHeight::Size32,
    }
}

/// Draws a legend into the lower left corner.
pub(super) fn draw(legend: &Legend, image: &mut Image) {
    let size = [image.width, image.height];
    let layout = Layout::of(size);
    let height = raster_height(f64::from(size[0].min(size[1])) / 1000.0);
    for y in layout.top as u32..(layout.top + layout.height) as u32 {
        for x in layout.left as u32..(layout.left + layout.width) as u32 {
            let share = (f64::from(x) + 0.5 - layout.left) / layout.width;
            blend(image, [i64::from(x), i64::from(y)], Colour::of_quality(share), 1.0);
        }
    }
    write(image, &legend.title, layout.left, layout.top - 1.3 * layout.text, height);
    for (share, mark) in MARKS {
        let width = (mark.len() * get_raster_width(FontWeight::Regular, height)) as f64;
        let x = layout.left + share * (layout.width - width);
        write(image, mark, x, layout.top + layout.height + 0.2 * layout.text, height);
    }
}

/// Writes a line of text, its upper left corner there.
fn write(image: &mut Image, text: &str, left: f64, top: f64, height: RasterHeight) {
    let step = get_raster_width(FontWeight::Regular, height) as i64;
    for (number, letter) in (0..).zip(text.chars()) {
        let raster = get_raster(letter, FontWeight::Regular, height);
        for (y, row) in (0..).zip(raster.iter().flat_map(|raster| raster.rows())) {
            for (x, &share) in (0..).zip(row) {
                let place = [left.round() as i64 + number * step + x, top.round() as i64 + y];
                blend(image, place, Colour::INK, f32::from(share) / 255.0);
            }
        }
    }
}

fn blend(image: &mut Image, [x, y]: [i64; 2], colour: Colour, share: f32) {
    if (0..i64::from(image.width)).contains(&x) && (0..i64::from(image.height)).contains(&y) {
        let pixel = &mut image.pixels[y as usize * image.width as usize + x as usize];
        *pixel = Colour(*pixel).mixed(colour, share).0;
    }
}
