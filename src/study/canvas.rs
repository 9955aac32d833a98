//! Where charts are drawn in pixels: with smooth lines, and letters that need no font of the system.

use crate::picture::text::Letters;
use crate::picture::{Colour, Image};
use glam::DVec2;
use plotters::prelude::DrawingBackend;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind};
use std::convert::Infallible;

/// A picture as plotters draws into it.
pub(super) struct Canvas<'a>(pub &'a mut Image);

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl Canvas<'_> {
    /// A line with round ends.
    fn stroke(&mut self, ends: [BackendCoord; 2], colour: BackendColor, width: f64) {
        let [a, b] = ends.map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
        let reach = DVec2::splat(width / 2.0 + 1.0);
        let (low, high) = ((a.min(b) - reach).as_ivec2(), (a.max(b) + reach).as_ivec2());
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let p = DVec2::new(f64::from(x), f64::from(y));
                let way = b - a;
                let share = ((p - a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let cover = (width / 2.0 + 0.5 - p.distance(a.lerp(b, share))).clamp(0.0, 1.0);
                self.put((x, y), colour, cover);
            }
        }
    }

    fn put(&mut self, (x, y): BackendCoord, colour: BackendColor, cover: f64) {
        let (red, green, blue) = colour.rgb;
        self.0.blend([x, y], Colour([red, green, blue]), (colour.alpha * cover) as f32);
    }
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.0.width, self.0.height)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Drawn {
        self.put(point, colour, 1.0);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.stroke([from, to], style.color(), f64::from(style.stroke_width()));
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        let places: Vec<BackendCoord> = path.into_iter().collect();
        for ends in places.windows(2) {
            self.stroke([ends[0], ends[1]], style.color(), f64::from(style.stroke_width()));
        }
        Ok(())
    }

    /// Filled, as all circles of these charts are.
    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, _fill: bool) -> Drawn {
        self.stroke([centre; 2], style.color(), 2.0 * f64::from(radius));
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let letters = Letters::of_height(style.size());
        let (width, height) = (letters.width(text) as i32, letters.height() as i32);
        let anchor = style.anchor();
        let left = match anchor.h_pos {
            HPos::Left => 0,
            HPos::Center => width / 2,
            HPos::Right => width,
        };
        let top = match anchor.v_pos {
            VPos::Top => 0,
            VPos::Center => height / 2,
            VPos::Bottom => height,
        };
        let (red, green, blue) = style.color().rgb;
        letters.write(self.0, text, [x - left, y - top], Colour([red, green, blue]));
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let letters = Letters::of_height(style.size());
        Ok((letters.width(text), letters.height()))
    }
}
