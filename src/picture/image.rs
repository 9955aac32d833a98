//! A picture in pixels.

use super::Colour;
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

impl Image {
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
