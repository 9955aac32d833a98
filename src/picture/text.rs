//! Text in pixels, without the fonts of the system: letters of Noto Sans Mono, in ASCII, in four heights.

use super::{Colour, Image};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Letters of one height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Letters(RasterHeight);

impl Letters {
    /// The letters whose height in pixels, from line to line, is nearest to this one.
    pub fn of_height(height: f64) -> Self {
        Self(match height {
            ..18.0 => RasterHeight::Size16,
            ..22.0 => RasterHeight::Size20,
            ..28.0 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        })
    }

    /// Their height in pixels.
    pub fn height(self) -> u32 {
        self.0.val() as u32
    }

    /// The width of a text in pixels.
    pub fn width(self, text: &str) -> u32 {
        (text.chars().count() * get_raster_width(FontWeight::Regular, self.0)) as u32
    }

    /// Writes a line, its upper left corner there; what is no ASCII leaves a gap.
    pub fn write(self, image: &mut Image, text: &str, [left, top]: [i32; 2], colour: Colour) {
        let step = get_raster_width(FontWeight::Regular, self.0) as i32;
        for (number, letter) in (0..).zip(text.chars()) {
            let raster = get_raster(letter, FontWeight::Regular, self.0);
            for (y, row) in (0..).zip(raster.iter().flat_map(|raster| raster.rows())) {
                for (x, &share) in (0..).zip(row) {
                    image.blend([left + number * step + x, top + y], colour, f32::from(share) / 255.0);
                }
            }
        }
    }
}
