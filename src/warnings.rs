//! Warnings: what a user should know of a result.

use crate::export::Format;
use crate::field::{GuideReport, StretchReport};
use crate::pipeline::Options;
use crate::report::{Asked, Input, Report, SymmetryFigures, Time};
use crate::surface::{AttributeKind, Attributes, NearRims, Places, Soup, shown};
use crate::symmetry::find::NEARLY;

/// A number of vertices that misses the wanted one by a larger share is a warning.
const COUNT_TOLERANCE: f64 = 0.05;

impl Report {
    /// What a user should know of the run, a sentence each: guides without full effect, tiles without the wanted aspect, repairs that
    /// show in the mesh, sheets that touch or cross, a number of vertices that misses the wanted one, a kept boundary that leaves
    /// triangles, a time limit that ended the run, and options without effect. What is wrong with the mesh itself is in [`Report::wrong`].
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = of_guides(&self.field.guides);
        warnings.extend(of_stretch(self.field.stretch.as_ref()));
        warnings.extend(of_surface(&self.surface));
        warnings.extend(self.symmetry.iter().flat_map(of_symmetry));
        warnings.extend(self.count_warning());
        warnings.extend(self.odd_boundary_warning());
        warnings.extend(self.late_warning());
        warnings.extend(self.ineffective.iter().map(ToString::to_string));
        warnings
    }

    /// The differences and faults of the mesh, with places, in a sentence; `None` where there are none.
    pub fn wrong(&self) -> Option<String> {
        let faults = (!self.faults.is_clean()).then(|| self.faults.to_string());
        let said: Vec<String> = self.differences.iter().map(ToString::to_string).chain(faults).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }

    /// Triangles that are left only because the kept boundary has an odd number of edges.
    fn odd_boundary_warning(&self) -> Option<String> {
        let odd = self.boundary.as_ref()?.odd_parts;
        (odd > 0 && self.mesh.triangles == odd).then(|| {
            let left = counted(odd, "triangle");
            format!(
                "{left} left, as a kept boundary of an odd number of edges goes round no mesh of quads alone; add a vertex to it or \
                 remove one"
            )
        })
    }

    /// That the mesh is not as good as it could be, as the time was over.
    pub fn late_warning(&self) -> Option<String> {
        let Time { stage, .. } = self.late.as_ref()?;
        Some(format!(
            "the time limit ended the run in the stage {stage}: this is the best mesh so far; allow more time"
        ))
    }

    fn count_warning(&self) -> Option<String> {
        let Asked::Points(asked) = self.asked else { return None };
        let found = self.mesh.vertices;
        (found.abs_diff(asked) as f64 > COUNT_TOLERANCE * asked as f64).then(|| {
            let (on_features, wanted) = (self.mosaic.on_features, self.mosaic.wanted);
            let advice = if self.boundary.is_some() {
                ", as the edges of the boundary are kept; ask for another number, or for another size there".to_owned()
            } else if wanted > asked && found > asked {
                ", as thin parts, or a mesh without faults, need them; ask for as many, or for --around 0".to_owned()
            } else if found > asked && 2 * on_features > asked {
                format!(
                    ", as {on_features} tiles lie on features; ask for another number, or for fewer features by --crease"
                )
            } else {
                "; ask for another number".to_owned()
            };
            format!("{found} vertices instead of {asked}{advice}")
        })
    }
}

/// Guides without full effect.
pub fn of_guides(guides: &[GuideReport]) -> Vec<String> {
    let told = |guide: &GuideReport| Some(format!("{}: {}", guide.name, guide.trouble.as_ref()?));
    guides.iter().filter_map(told).collect()
}

/// Tiles without the wanted aspect.
pub fn of_stretch(stretch: Option<&StretchReport>) -> Vec<String> {
    let Some(&StretchReport { aspect, odd_singularities, nearly_square, unguided }) = stretch else {
        return Vec::new();
    };
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let square = (nearly_square > 0.0).then(|| {
        let reason = match odd_singularities {
            0 => "guides contradict each other there".to_owned(),
            count => format!(
                "the field is only a cross about {}, which have no longer side; guides may move or remove them",
                counted(count, "point")
            ),
        };
        let share = percent(nearly_square);
        format!("on {share} of the area tiles are squares or nearly so instead of {aspect} to 1: {reason}")
    });
    let unguided = (unguided > 0.0).then(|| {
        format!(
            "no guide reaches {} of the area, whose tiles are squares; give each part of the surface a guide",
            percent(unguided)
        )
    });
    square.into_iter().chain(unguided).collect()
}

/// Repairs that show in the mesh, and sheets that touch or cross without being joined.
pub fn of_surface(surface: &Input) -> Vec<String> {
    let told = |places: &Places, noun: &str, what: &str, advice: &str| {
        let place = places.at.first()?;
        Some(format!("{} {what}, the first at {}; {advice}", counted(places.count, noun), shown(place)))
    };
    let (repairs, contacts) = (&surface.repairs, &surface.contacts);
    let places = [
        told(&repairs.joined_edges, "edge", "of more than two triangles", "sheets meet there, in the mesh too"),
        told(&repairs.dropped_specks, "part", "too small to have a shape left out", "mesh small parts apart"),
        told(
            &contacts.crossing,
            "pair",
            "of triangles that cross each other",
            "sheets pass through each other there, in the mesh too; unite or trim them",
        ),
        told(
            &contacts.coincident,
            "pair",
            "of triangles that lie on each other",
            "two walls stand at one place there, in the mesh too; they are not joined: remove one of them",
        ),
        told(
            &contacts.touching,
            "edge",
            "of open boundaries that lie inside other triangles",
            "sheets touch there but are not joined; ask for --imprint",
        ),
    ];
    let rims = contacts.near_rims.as_ref().map(|NearRims { at, gap, length, tolerance }| {
        format!(
            "open boundaries run side by side over a length of {length:.4}, with a gap of {gap:.3e} at {}; if they are one, \
             ask for --weld {tolerance}",
            shown(at)
        )
    });
    places.into_iter().flatten().chain(rims).collect()
}

/// A surface that is not symmetric about the plane of its mesh.
pub fn of_symmetry(symmetry: &SymmetryFigures) -> Vec<String> {
    let SymmetryFigures { plane, asymmetry, lost_regions, .. } = symmetry;
    let apart = (asymmetry.tiles > NEARLY).then(|| {
        format!(
            "the surface is not symmetric about {plane}: its mirror image is up to {:.3e} away from it, {:.2} sides of a tile, at {}; \
             the mesh has the shape of the half above the plane on both sides",
            asymmetry.distance,
            asymmetry.tiles,
            shown(&asymmetry.at)
        )
    });
    let lost = (!lost_regions.is_empty()).then(|| {
        format!(
            "regions that lie below {plane} alone are not in the mesh, where faces have the regions of their mirror images: {}",
            lost_regions.join(", ")
        )
    });
    apart.into_iter().chain(lost).collect()
}

/// The attributes of a surface that a file of the mesh, called `name`, does not have.
pub fn of_attributes(attributes: &Attributes, format: Format, name: &str) -> Option<String> {
    let refused = attributes.list.iter().filter(|attribute| !format.takes(attribute.kind));
    let refused: Vec<&str> = refused
        .map(|attribute| match attribute.kind {
            AttributeKind::Colour => "colours",
            AttributeKind::Texture => "texture coordinates",
            AttributeKind::Numbers => attribute.name.as_str(),
        })
        .collect();
    let advice = if refused.is_empty() { "" } else { "; ply, vtk and vtu hold numbers of vertices" };
    let all: Vec<&str> = refused.into_iter().chain(attributes.left_out.iter().map(String::as_str)).collect();
    (!all.is_empty()).then(|| format!("not carried to {name}: {}{advice}", all.join(", ")))
}

/// Seams of texture coordinates that are to be kept, where the surface has no such coordinates.
pub fn of_seams(soup: &Soup, options: &Options) -> Option<String> {
    let has_texture = soup.attributes.list.iter().any(|attribute| attribute.kind == AttributeKind::Texture);
    let is_idle = options.features.texture_seams && !has_texture;
    is_idle.then(|| "keeping seams had no effect, as the surface has no texture coordinates".to_owned())
}

/// Steps of coordinates above this share of a tile's side show in the mesh.
const COARSE: f64 = 1e-3;

/// Coordinates in f32 that are too coarse for tiles of which so many cover the surface.
pub fn of_precision(soup: &Soup, tiles: usize) -> Option<String> {
    let side = (soup.area() / tiles as f64).sqrt();
    let step = soup.f32_step().filter(|&step| step > COARSE * side)?;
    Some(format!(
        "the coordinates are multiples of {step:.1e}, as f32 has them so far from the origin, and a tile has a side of \
         {side:.3e}: steps show in the mesh; move the model to the origin before it is exported, or export it in f64 or text"
    ))
}

/// `1 corner`, `2 corners`, `0 vertices`.
pub fn counted(count: usize, what: &str) -> String {
    match (count, what.strip_suffix("ex"), what.strip_suffix('y')) {
        (1, ..) => format!("1 {what}"),
        (_, Some(stem), _) => format!("{count} {stem}ices"),
        (_, _, Some(stem)) => format!("{count} {stem}ies"),
        _ => format!("{count} {what}s"),
    }
}
