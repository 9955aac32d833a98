//! Options that one name sets: layouts and presets.

use super::Options;
use crate::pipeline::Layout;

/// A name of an option, and the text of its value.
pub type Setting = (&'static str, &'static str);

/// Options for a purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A surface mesh for a flow solver, as round a wing.
    Cfd,
    /// A shell mesh of a machine part for a solver of solids.
    Fem,
    /// A noisy scan.
    Scan,
    /// A light mesh for artists.
    Retopo,
    /// The paper's method.
    Paper,
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 5] = [Self::Cfd, Self::Fem, Self::Scan, Self::Retopo, Self::Paper];

    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cfd => "cfd",
            Self::Fem => "fem",
            Self::Scan => "scan",
            Self::Retopo => "retopo",
            Self::Paper => "paper",
        }
    }

    /// What it is for.
    pub const fn purpose(self) -> &'static str {
        match self {
            Self::Cfd => "a wing or a body in a flow: fine where it is curved, rows along its sharp noses",
            Self::Fem => "a machine part: quads alone",
            Self::Scan => "a noisy scan: no creases, cracks are sewn, small holes filled, specks dropped",
            Self::Retopo => "a light mesh for artists: quads alone, few of them",
            Self::Paper => "the paper's method: equal tiles, its clean-up alone, no relocation",
        }
    }

    /// The options that it sets, in this order.
    pub const fn settings(self) -> &'static [Setting] {
        match self {
            Self::Cfd => &[("layout", "mosaic"), ("refine-curvature", "15"), ("ridge", "60")],
            Self::Fem => &[("layout", "even"), ("quads", "all")],
            Self::Scan => &[
                ("layout", "mosaic"),
                ("crease", "180"),
                ("ridge", "180"),
                ("weld", "0.01%"),
                ("fill-holes", "3x"),
                ("drop-parts", "3x"),
            ],
            Self::Retopo => &[("layout", "quads"), ("points", "1500")],
            Self::Paper => &[
                ("layout", "mosaic"),
                ("quads", "paper"),
                ("smoothing", "0"),
                ("around", "0"),
                ("max-distance", "1.6"),
                ("max-angle", "30"),
            ],
        }
    }
}

impl Layout {
    /// What it is.
    pub const fn purpose(self) -> &'static str {
        match self {
            Self::Mosaic => "the paper's equal tiles",
            Self::Even => "sides that fit the field, few triangles",
            Self::Quads => "quads alone, rows that never end, sides that fit the field",
        }
    }

    /// The options that it sets.
    pub const fn settings(self) -> &'static [Setting] {
        match self {
            Self::Mosaic => &[("fit", "0"), ("rows", "paper"), ("quads", "most")],
            Self::Even => &[("fit", "1"), ("rows", "paper"), ("quads", "most")],
            Self::Quads => &[("fit", "1"), ("rows", "continuous"), ("quads", "all")],
        }
    }
}

impl Options {
    /// The same options in a layout. Those that are set afterwards override what it sets.
    pub fn with_layout(mut self, layout: Layout) -> Self {
        self.lay_out(layout);
        self
    }

    /// The same options with those of a preset. Those that are set afterwards override what it sets.
    pub fn with_preset(mut self, preset: Preset) -> Self {
        self.prepare_for(preset);
        self
    }

    pub(super) fn lay_out(&mut self, layout: Layout) {
        self.layout = layout;
        self.apply(layout.settings());
    }

    pub(super) fn prepare_for(&mut self, preset: Preset) {
        self.apply(preset.settings());
    }

    fn apply(&mut self, settings: &[Setting]) {
        for &(name, value) in settings {
            let set = self.set(&name.replace('-', "_"), value);
            debug_assert_eq!(set, Ok(()), "the settings are valid");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Contradiction, Fineness};

    #[test]
    fn each_setting_is_valid_and_contradicts_no_other() {
        let plain = || Options::new(Fineness::Points(100));
        let all = Layout::ALL.map(Layout::settings).into_iter().chain(Preset::ALL.map(Preset::settings));
        for (name, value) in all.flatten() {
            assert_eq!(plain().set(&name.replace('-', "_"), value), Ok(()), "{name} {value}");
        }
        assert!(plain().set("layout", "odd").is_err());
        for layout in Layout::ALL {
            assert_eq!(Contradiction::expect_none(&plain().with_layout(layout)), Ok(()));
        }
        for preset in Preset::ALL {
            assert_eq!(Contradiction::expect_none(&plain().with_preset(preset)), Ok(()));
        }
        assert!(Contradiction::expect_none(&plain().with_layout(Layout::Quads).with_paper_clean_up()).is_err());
    }
}
