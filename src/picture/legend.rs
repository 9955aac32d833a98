//! The legend of a picture: a bar of colours with its ends named.

use super::text::Letters;
use super::{Colour, Image};

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
        let text = f64::from(letters(size).height());
        let (width, height) = (260.0 * page, 14.0 * page);
        Self { left: 30.0 * page, top: f64::from(size[1]) - 30.0 * page - height - 1.4 * text, width, height, text }
    }
}

/// The letters of a picture of this size.
fn letters(size: [u32; 2]) -> Letters {
    Letters::of_height(0.022 * f64::from(size[0].min(size[1])))
}

/// Draws a legend into the lower left corner.
pub(super) fn draw(legend: &Legend, image: &mut Image) {
    let size = [image.width, image.height];
    let layout = Layout::of(size);
    let letters = letters(size);
    for y in layout.top as u32..(layout.top + layout.height) as u32 {
        for x in layout.left as u32..(layout.left + layout.width) as u32 {
            let share = (f64::from(x) + 0.5 - layout.left) / layout.width;
            image.blend([x as i32, y as i32], Colour::of_quality(share), 1.0);
        }
    }
    let at = |x: f64, y: f64| [x.round() as i32, y.round() as i32];
    letters.write(image, &legend.title, at(layout.left, layout.top - 1.3 * layout.text), Colour::INK);
    for (share, mark) in MARKS {
        let x = layout.left + share * (layout.width - f64::from(letters.width(mark)));
        letters.write(image, mark, at(x, layout.top + layout.height + 0.2 * layout.text), Colour::INK);
    }
}
