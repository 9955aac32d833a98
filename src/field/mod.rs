//! The cross field: four directions 90 degrees apart at each point of the surface, following features and guides.
//!
//! # Theory
//! A cross is the complex number `z = (cos 4t, sin 4t)`, `t` its angle from a fixed axis, so that its four directions are one
//! number. The smoothest field minimises the energy of the connection Laplacian of Knöppel et al. 2013 (*Globally optimal
//! direction fields*), diffused and normalised as by Viertel and Osting 2019 (*An approach to quad meshing based on harmonic
//! cross-valued maps and the Ginzburg-Landau theory*).
//!
//! # Changes versus the paper
//! The paper (section 1) interpolates a vector field from control vectors. Here it is a cross field, and features and
//! open boundaries guide it too.
//!
//! # Practice
//! The unknowns are not vertices but *sectors*: a vertex on a feature has one on each side, so that each side of a crease follows
//! it. A sector's angles are scaled to sum to 2 pi inside, to pi along a feature and to a multiple of 90 degrees at a corner, so
//! that rows meet a feature at right angles whatever its angle in space.

mod absorb;
mod align;
mod connection;
mod constraints;
mod guide_file;
mod guides;
pub(crate) mod matching;
mod sectors;
mod singularities;
mod stretch;

pub use align::Align;
pub use guide_file::{GuideFault, GuideFileError, parse_guides, read_guides};
pub use guides::{Guide, GuideReport, GuideTrouble, Trace};
pub use sectors::Sectors;
pub use singularities::{Singularity, SingularityLocation};
pub use stretch::{ASPECTS, Stretch, StretchError, StretchReport};

use crate::compute::{Backend, Complex, ComputeError, RelaxationSurface};
use crate::geometry::{axis_at, barycentric};
use crate::sizes::Sizes;
use crate::solver::{Hierarchy, NORMALISED_SWEEPS};
use crate::surface::Surface;
use glam::Vec3;

/// The constraints of the field beside features.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldOptions {
    /// The user's guides.
    pub guides: Vec<Guide>,
    /// How the field is aligned with principal directions of curvature where no guide and no feature is. Default `None`: not.
    pub align: Option<Align>,
    /// Normalised sweeps at the end: a heat flow of the angle, in which opposite singularities that are near each other meet and
    /// vanish. Default 10.
    pub sweeps: u32,
    /// Singularities nearer to a feature than this, in model units, move onto it, as rows that pass over the whole surface need
    /// it. Default 0.
    pub absorb: f64,
}

impl Default for FieldOptions {
    fn default() -> Self {
        Self { guides: Vec::new(), align: None, sweeps: NORMALISED_SWEEPS, absorb: 0.0 }
    }
}

impl FieldOptions {
    /// These guides and nothing else.
    pub fn guided(guides: impl Into<Vec<Guide>>) -> Self {
        Self { guides: guides.into(), ..Self::default() }
    }
}

/// The most rounds in which singularities are moved onto features: those that are near afterwards follow.
const ABSORBING_ROUNDS: usize = 3;

/// A cross field over a surface.
#[derive(Clone, Debug)]
pub struct Field {
    sectors: Sectors,
    crosses: Vec<Complex>,
    in_triangles: Vec<[Complex; 3]>,
    guides: Vec<GuideReport>,
    sizes: Sizes,
    stretch: Option<Stretch>,
}

impl Field {
    /// The smoothest field that follows the surface's features, the guides and, if asked, its curvature.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn new(surface: &Surface, options: &FieldOptions, backend: &dyn Backend) -> Result<Self, ComputeError> {
        let mut sectors = Sectors::new(surface);
        let (mut directions, guides) = guides::constraints(surface, &sectors, &options.guides);
        if let Some(align) = options.align {
            directions.extend(align::constraints(surface, &sectors, &align, &directions));
        }
        let solve = |sectors: &Sectors| {
            let constraints = constraints::combined(surface, sectors, &directions);
            Hierarchy::directions(connection::problem(surface, sectors, &constraints), options.sweeps)?.solve(backend)
        };
        let mut crosses = solve(&sectors)?;
        let reach = options.absorb / surface.frame().diagonal;
        for _ in 0..if reach > 0.0 { ABSORBING_ROUNDS } else { 0 } {
            let near = singularities::find(surface, &sectors, &crosses);
            if !sectors.absorb(surface, &near, reach) {
                break;
            }
            crosses = solve(&sectors)?;
        }
        let in_triangles = sectors.in_triangles(&crosses, 4.0);
        Ok(Self { sectors, crosses, in_triangles, guides, sizes: Sizes::equal(), stretch: None })
    }

    /// The same field for tiles of these sizes.
    pub fn with_sizes(self, sizes: Sizes) -> Self {
        Self { sizes, ..self }
    }

    /// The same field for tiles stretched like this.
    pub fn with_stretch(self, stretch: Stretch) -> Self {
        Self { stretch: Some(stretch), ..self }
    }

    /// How tiles are stretched; `None`, as it is made: they are squares.
    pub fn stretch(&self) -> Option<&Stretch> {
        self.stretch.as_ref()
    }

    /// How large tiles are to be; as it is made, equal.
    pub fn sizes(&self) -> &Sizes {
        &self.sizes
    }

    /// What became of each guide, in order.
    pub fn guides(&self) -> &[GuideReport] {
        &self.guides
    }

    /// Where the field turns about a point: triangles in which it has no direction, and corners of features that are no
    /// right or straight angles. On a closed surface their quarters add up to four times its Euler characteristic.
    pub fn singularities(&self, surface: &Surface) -> Vec<Singularity> {
        singularities::find(surface, &self.sectors, &self.crosses)
    }

    /// The sectors of vertices that the field lives on.
    pub fn sectors(&self) -> &Sectors {
        &self.sectors
    }

    /// The cross of each sector, against the sector's first direction.
    pub fn crosses(&self) -> &[Complex] {
        &self.crosses
    }

    /// The crosses at the corners of each triangle, against the triangle's first edge.
    pub fn in_triangles(&self) -> &[[Complex; 3]] {
        &self.in_triangles
    }

    /// One direction of the cross at a point of a triangle: a unit vector in the triangle's plane.
    pub(crate) fn axis(&self, surface: &Surface, triangle: u32, position: Vec3) -> Vec3 {
        let corners = surface.corners(triangle as usize);
        axis_at(corners, self.in_triangles[triangle as usize], barycentric(corners, position))
    }

    /// The surface with the field's sizes and crosses, for the relaxation of tiles.
    pub fn relaxation_surface(&self, surface: &Surface) -> RelaxationSurface {
        RelaxationSurface::new(surface, &self.sizes, &self.in_triangles)
    }
}
