//! The method with a plane of symmetry: one half of the surface is meshed, and its mirror image is joined to it.
//!
//! # Practice
//! The half of larger coordinates on the plane's axis is meshed, its regions and feature edges with it. Guides and samples of sizes on
//! the other side are mirrored to it.

use super::prepare::{Prepared, prepared, repaired};
use super::{Fineness, Meshed, Options, Outcome, PipelineError, run_watched};
use crate::compute::Backend;
use crate::field::{Guide, Trace};
use crate::mesh::check::{Fault, Faults, Kind, check_joined, sort};
use crate::mesh::compare::{Difference, differences_from, uncovered};
use crate::mesh::{VertexAttributes, VertexKind};
use crate::mosaic;
use crate::progress::{Progress, Stage};
use crate::sizes::Place;
use crate::surface::nearest::Simplices;
use crate::surface::{RepairOptions, Soup, Surface};
use crate::symmetry::chords::without_chords;
use crate::symmetry::find::Comparison;
use crate::symmetry::{Asymmetry, Half, Joined, ON_PLANE, Plane, Symmetry, cut, join};
use glam::DVec3;
use rustc_hash::FxHashSet;
use std::time::{Duration, Instant};

/// What is known of a run with a plane of symmetry, beside the results of the half.
pub struct Symmetric {
    /// The whole surface.
    pub surface: Surface,
    /// The plane.
    pub plane: Plane,
    /// Whether the plane was looked for.
    pub is_found: bool,
    /// How far the mirror image of the surface is from it.
    pub asymmetry: Asymmetry,
    /// The number of vertices of the mesh on the plane.
    pub on_plane: usize,
    /// The number of vertices that were wanted of the whole mesh, as [`Mosaic::wanted`](crate::mosaic::Mosaic::wanted).
    pub wanted: usize,
    /// The named regions of the surface that lie on the other side of the plane alone: the mesh does not have them.
    pub lost_regions: Vec<String>,
}

impl Symmetric {
    /// A vertex of the half's surface no farther from the plane than this, in model units, lies on it.
    pub fn tolerance(&self) -> f64 {
        tolerance(&self.surface)
    }
}

fn tolerance(surface: &Surface) -> f64 {
    ON_PLANE * surface.frame().diagonal
}

/// As [`run`](super::run), with a plane of symmetry.
pub(super) fn run_symmetric(
    soup: &Soup,
    symmetry: Symmetry,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<Outcome, PipelineError> {
    let started = Instant::now();
    progress.report(Stage::Surface, 0.0)?;
    let whole = repaired(soup, options, progress)?;
    progress.check()?;
    let uncut = whole.clone();
    let Prepared { surface: whole, count, .. } = prepared(whole, options, progress)?;
    let side = f64::from(mosaic::side_for_count(&whole, count));
    let comparison = Comparison::new(&uncut, side);
    let (plane, asymmetry) = match symmetry {
        Symmetry::About(plane) => (plane, comparison.about(plane)),
        Symmetry::Auto => comparison.find()?,
    };
    let half = cut(&uncut, plane)?;
    progress.check()?;
    let asked = of_half(options, &half, plane, &whole);
    let before = started.elapsed();

    let mut outcome = run_watched(&half.soup, &asked, backend, progress)?;

    let started = Instant::now();
    progress.report(Stage::Finish, 0.0)?;
    let tolerance = tolerance(&whole);
    let joined = join(&without_chords(&outcome.meshed.mesh, plane, tolerance), plane, tolerance);
    let on_plane = (0..joined.images.len() as u32).filter(|&v| joined.is_on_plane(v)).count();
    let wanted = match (options.fineness, asked.fineness) {
        (Fineness::Points(whole), Fineness::Points(half)) if outcome.mosaic.wanted == half => whole,
        _ => (2 * outcome.mosaic.wanted).saturating_sub(on_plane),
    };
    outcome.meshed = doubled(&outcome.meshed, joined, plane, &whole);
    let lost_regions = lost_regions(&uncut, &half);
    outcome.symmetry = Some(Symmetric {
        surface: whole,
        plane,
        is_found: symmetry == Symmetry::Auto,
        asymmetry,
        on_plane,
        wanted,
        lost_regions,
    });
    progress.report(Stage::Finish, 1.0)?;
    add(&mut outcome.times, Stage::Surface, before);
    add(&mut outcome.times, Stage::Finish, started.elapsed());
    Ok(outcome)
}

fn add(times: &mut [(Stage, Duration)], stage: Stage, time: Duration) {
    times.iter_mut().filter(|known| known.0 == stage).take(1).for_each(|known| known.1 += time);
}

/// The options for a half of the whole surface.
fn of_half(options: &Options, half: &Half, plane: Plane, whole: &Surface) -> Options {
    let mut asked = options.clone();
    if let Fineness::Points(count) = options.fineness {
        // Half of the vertices, and half of those on the plane, which the halves share.
        let side = whole.frame().diagonal * f64::from(mosaic::side_for_count(whole, count));
        let count = (count as f64 + half.rim / side) / 2.0;
        asked.fineness = Fineness::Points((count.round() as usize).max(*super::POINTS.start()));
    }
    asked.symmetry = None;
    // The surface was repaired before it was cut; its rim is no hole.
    asked.repairs = RepairOptions::default();
    asked.edges.clone_from(&half.edges);
    asked.field.guides.iter_mut().for_each(|guide| fold(guide, plane));
    asked.sizes.samples.iter_mut().for_each(|sample| sample.point = plane.folded(sample.point));
    for local in &mut asked.sizes.local {
        if let Place::Box { low, high } = &mut local.place {
            (*low, *high) = plane.folded_box(*low, *high);
        }
    }
    asked
}

/// Mirrors what a guide has on the other side of the plane.
fn fold(guide: &mut Guide, plane: Plane) {
    match &mut guide.trace {
        Trace::Vector { point, direction } => {
            if plane.height(*point) < 0.0 {
                (*point, *direction) = (plane.image(*point), plane.image_of_direction(*direction));
            }
        }
        Trace::Stroke { points } => points.iter_mut().for_each(|point| *point = plane.folded(*point)),
    }
}

/// The results for the whole surface from those of a half, whose mesh was joined with its mirror image.
fn doubled(half: &Meshed, joined: Joined, plane: Plane, surface: &Surface) -> Meshed {
    let tolerance = tolerance(surface);
    let kinds = Kinds::new(surface);
    let known = |v: u32| {
        let VertexAttributes { kind, direction } = half.vertices[joined.sources[v as usize] as usize];
        match () {
            () if joined.is_on_plane(v) => {
                VertexAttributes { kind: kinds.at(joined.mesh.points[v as usize], tolerance), direction }
            }
            () if joined.sources[v as usize] == v => VertexAttributes { kind, direction },
            () => VertexAttributes { kind, direction: plane.image_of_direction(direction) },
        }
    };
    let vertices = (0..joined.images.len() as u32).map(known).collect();
    let branches: Vec<bool> = joined.sources.iter().map(|&source| half.branches[source as usize]).collect();
    let (faults, differences) = compared(half, &joined, &branches, surface);
    let before = join(&half.before, plane, tolerance).mesh;
    Meshed {
        before,
        holes: 2 * half.holes,
        edits: half.edits,
        vertices,
        branches,
        faults,
        differences,
        mesh: joined.mesh,
    }
}

/// The faults of a joined mesh, and its differences from the whole surface. A face is inverted where it, or its image, is in the half.
fn compared(half: &Meshed, joined: &Joined, branches: &[bool], surface: &Surface) -> (Faults, Vec<Difference>) {
    let mesh = &joined.mesh;
    let sorted = |mut corners: Vec<u32>| {
        corners.sort_unstable();
        corners
    };
    let inverted: FxHashSet<Vec<u32>> = (half.faults.list.iter())
        .filter_map(|fault| match fault.kind {
            Kind::FlippedFace { face } => Some(sorted(half.mesh.face(face as usize).to_vec())),
            _ => None,
        })
        .collect();
    let source = |v: &u32| joined.sources[*v as usize];
    let is_inverted = |face: &[u32]| inverted.contains(&sorted(face.iter().map(source).collect()));
    let faces = (0..).zip(mesh.faces()).filter(|(_, face)| !inverted.is_empty() && is_inverted(face));
    let faces = faces.map(|(face, corners)| (face, mesh.middle(corners).to_array()));
    let mut faults = check_joined(mesh, branches);
    faults.list.extend(faces.map(|(face, at)| Fault { kind: Kind::FlippedFace { face }, at }));
    sort(&mut faults.list);
    let mut unit_sized = mesh.clone();
    unit_sized.points.iter_mut().for_each(|point| *point = surface.frame().to_unit(*point));
    let uncovered = uncovered(&unit_sized, surface);
    let differences = differences_from(faults.topology(), surface).into_iter().chain(uncovered).collect();
    (faults, differences)
}

/// What points of the whole surface lie on.
struct Kinds<'a> {
    surface: &'a Surface,
    half_edges: Vec<u32>,
    features: Simplices<2>,
    corners: Simplices<2>,
}

impl<'a> Kinds<'a> {
    fn new(surface: &'a Surface) -> Self {
        let all = 0..3 * surface.triangle_count() as u32;
        let half_edges: Vec<u32> = all.filter(|&h| surface.features().is_feature(h)).collect();
        let place = |v: u32| DVec3::from(surface.model_point(v));
        let features = Simplices::new(half_edges.iter().map(|&h| [surface.origin(h), surface.target(h)].map(place)));
        let corners = Simplices::new(surface.features().corners().map(|v| [place(v); 2]));
        Self { surface, half_edges, features, corners }
    }

    fn at(&self, point: [f64; 3], tolerance: f64) -> VertexKind {
        let point = DVec3::from(point);
        if self.corners.distance(point) <= tolerance {
            return VertexKind::Corner;
        }
        match self.features.nearest(point).filter(|(distance, _)| *distance <= tolerance) {
            None => VertexKind::Free,
            Some((_, edge)) if self.surface.twin(self.half_edges[edge.id as usize]).is_none() => VertexKind::Boundary,
            Some(_) => VertexKind::Feature,
        }
    }
}

/// The named regions of the surface that its half does not have.
fn lost_regions(surface: &Surface, half: &Half) -> Vec<String> {
    let used = |regions: &[u32]| regions.iter().copied().collect::<FxHashSet<u32>>();
    let (all, kept) = (used(&surface.regions().of_face), used(&half.soup.regions.of_face));
    let names = (0..).zip(&surface.regions().names);
    names.filter(|(region, _)| all.contains(region) && !kept.contains(region)).map(|(_, name)| name.clone()).collect()
}
