//! Colours of pictures, chosen to be told apart on paper too, in grey as well.

/// Red, green and blue in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// The page.
    pub const PAPER: Self = Self([255, 255, 255]);
    /// Lines of a mesh, text.
    pub const INK: Self = Self([44, 48, 56]);
    /// Sides of the triangles of a surface.
    pub const PENCIL: Self = Self([150, 156, 165]);
    /// A surface.
    pub const CLAY: Self = Self([216, 222, 230]);
    /// Quads.
    pub const PALE: Self = Self([243, 240, 230]);
    /// Triangles of a mesh of quads.
    pub const ORANGE: Self = Self([232, 119, 34]);
    /// Faces of more than four sides.
    pub const VIOLET: Self = Self([126, 64, 152]);
    /// What is seen of faces from behind.
    pub const BACK: Self = Self([150, 160, 150]);
    /// Between tiles.
    pub const GROUT: Self = Self([112, 106, 98]);
    /// Streamlines.
    pub const BLUE: Self = Self([36, 92, 158]);
    /// Singularities that rows bend round.
    pub const RED: Self = Self([200, 30, 40]);

    /// This colour in this light: 1 leaves it, 0 is black.
    pub(super) fn lit(self, light: f32) -> Self {
        Self(self.0.map(|part| (f32::from(part) * light).round().clamp(0.0, 255.0) as u8))
    }

    /// Some of the other colour in this one: 0 none, 1 all.
    pub(super) fn mixed(self, other: Self, share: f32) -> Self {
        let mix = |k: usize| f32::from(self.0[k]) * (1.0 - share) + f32::from(other.0[k]) * share;
        Self([0, 1, 2].map(|k| mix(k).round() as u8))
    }

    /// The colour of a measure that is 1 for the best and 0 for the worst: pale where all is well, darker and redder where not.
    pub fn of_quality(quality: f64) -> Self {
        const STEPS: [(f32, [u8; 3]); 6] = [
            (0.0, [103, 0, 13]),
            (0.3, [203, 24, 29]),
            (0.55, [244, 109, 67]),
            (0.75, [253, 190, 112]),
            (0.9, [254, 236, 190]),
            (1.0, [232, 241, 244]),
        ];
        Self::between(&STEPS, quality)
    }

    /// The colour of a length: 0 for the shortest and 1 for the longest, palest between them.
    pub fn of_length(share: f64) -> Self {
        const STEPS: [(f32, [u8; 3]); 5] = [
            (0.0, [16, 66, 120]),
            (0.25, [93, 158, 198]),
            (0.5, [240, 240, 234]),
            (0.75, [222, 165, 96]),
            (1.0, [128, 66, 14]),
        ];
        Self::between(&STEPS, share)
    }

    /// A colour for the region of this number; those of regions that follow each other differ most.
    pub fn of_region(number: usize) -> Self {
        // The golden angle never comes back to a hue.
        let hue = (number as f64 * 0.381_966 + 0.58).fract() * 6.0;
        let part = |offset: f64| {
            let wave = (((hue + offset) % 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
            (255.0 * (0.5 + 0.4 * wave)).round() as u8
        };
        Self([part(0.0), part(4.0), part(2.0)])
    }

    /// The colour at a share of the way through steps, each a share and a colour.
    fn between(steps: &[(f32, [u8; 3])], share: f64) -> Self {
        let at = share.clamp(0.0, 1.0) as f32;
        let above = steps.iter().position(|step| at <= step.0).unwrap_or(steps.len() - 1).max(1);
        let (low, high) = (steps[above - 1], steps[above]);
        Self(low.1).mixed(Self(high.1), (at - low.0) / (high.0 - low.0))
    }

    /// As SVG and HTML write it.
    pub(crate) fn hex(self) -> String {
        let [red, green, blue] = self.0;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worse_is_darker_all_the_way() {
        let light = |quality: f64| {
            let [red, green, blue] = Colour::of_quality(quality).0.map(f64::from);
            0.299 * red + 0.587 * green + 0.114 * blue
        };
        assert!((1..=20).all(|step| light(f64::from(step) / 20.0) > light(f64::from(step - 1) / 20.0)));
        assert_eq!(Colour::of_quality(-3.0), Colour::of_quality(0.0));
        assert_eq!(Colour::of_quality(2.0), Colour([232, 241, 244]));
        assert_ne!(Colour::of_quality(0.9), Colour::of_quality(0.8));
    }

    #[test]
    fn regions_that_follow_each_other_are_told_apart() {
        let far = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|number| Colour::of_region(number).0.map(i32::from));
            a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<i32>()
        };
        assert!((0..50).all(|number| far(number, number + 1) > 60), "no two neighbours are alike");
        assert!((0..50).any(|number| far(number, number + 8) < 60), "after many, hues come near to each other");
    }
}
