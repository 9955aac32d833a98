//! Discs of several irregular vertices are quadrangulated anew, with fewer.
//!
//! # Theory
//! A [disc](super::disc) about an irregular vertex whose outline has convex corners alone is filled by a [template](super::templates):
//! the faces outside do not change, nor does a valence there. A disc of three or five corners needs one irregular vertex, however
//! many it has: the other ones, which are ends of rows, are absorbed by it, and it moves.
//!
//! The new vertices have the places that they have in the old faces, where both are embedded in one circle by barycentric
//! coordinates (W. T. Tutte: How to draw a graph, 1963), and are relaxed on the surface.

use super::super::edit::Edit;
use super::super::{Engine, Kind};
use super::caps::are_near;
use super::disc::{Disc, Growing, is_irregular};
use super::templates::{SIDES, Template, least_irregular, templates};
use super::untangle::replaced;
use crate::mesh::metric::{from_metric, to_metric};
use crate::mesh::objective::Measure;
use crate::mesh::relocate::regular;
use crate::mesh::vertex::{Place, Position, REGULAR, Vertex, walked};
use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

/// The number of faces of a disc may change by one, and by one for each of so many.
const FACES_PER_CHANGE: usize = 8;
/// The farthest that a removed vertex may lie from the new faces, in mean edges of the outline.
const FARTHEST: f64 = 0.2;
/// The most discs about a vertex that are filled.
const MOST_DISCS: usize = 2;
/// The most templates of a disc that are tried.
const MOST_TEMPLATES: usize = 2;
/// The sweeps that embed a disc, and their over-relaxation.
const EMBEDDING_SWEEPS: usize = 40;
const OVER_RELAXATION: f64 = 1.6;
/// The sweeps of shape matching in tangent planes after each walk over the surface, and the number of walks.
const SWEEPS: usize = 4;
const WALKS: usize = 3;

/// Whether a face is the first one, by its id, at an irregular vertex off features: each such vertex has one.
pub(super) fn has_irregular(engine: &Engine, face: u32) -> bool {
    irregular_of(&Edit::new(engine.mesh), face).next().is_some()
}

fn irregular_of<'a>(edit: &'a Edit, face: u32) -> impl Iterator<Item = u32> + 'a {
    let is_first = move |v: u32| edit.around(v).all(|other| other >= face);
    edit.face(face).iter().copied().filter(move |&v| is_irregular(edit, v) && is_first(v))
}

/// For each irregular vertex of a face, quadrangulations with fewer irregular vertices of the smallest discs about it that seem to
/// gain by that.
pub(super) fn quadrangulations<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let of_smallest = |v: u32| {
        let mut growing = Growing::at(&edit, v);
        let discs = std::iter::from_fn(|| growing.grow().then(|| growing.disc()));
        let fillings = discs.flatten().filter_map(|disc| Filling::new(engine, &edit, disc)).take(MOST_DISCS);
        let found = fillings.filter_map(|filling| filling.best());
        found.map(|edit| (Kind::Quadrangulate, edit)).collect::<Vec<_>>()
    };
    irregular_of(&edit, face).flat_map(of_smallest).collect()
}

/// A disc that is filled anew.
struct Filling<'a, 'e> {
    engine: &'a Engine<'a>,
    edit: &'a Edit<'e>,
    disc: Disc,
    /// Its templates that have fewer irregular vertices.
    templates: Vec<Template>,
    /// The outline embedded in a circle.
    circle: Vec<DVec2>,
    /// The vertices of the outline, and those inside.
    ids: Vec<u32>,
    /// Their places in the circle.
    places: Vec<DVec2>,
    /// The disc's faces in triangles, by the indices of these vertices.
    triangles: Vec<[usize; 3]>,
}

/// A template in a disc.
struct Placed {
    /// For each vertex inside, its place and the old vertex whose metric it takes.
    vertices: Vec<(Position, u32)>,
    quads: Vec<[usize; 4]>,
}

impl<'a, 'e> Filling<'a, 'e> {
    /// A filling; `None` where no template has fewer irregular vertices.
    fn new(engine: &'a Engine<'a>, edit: &'a Edit<'e>, disc: Disc) -> Option<Self> {
        let Disc { faces, outline, lengths, inner, irregular } = &disc;
        if !SIDES.contains(&lengths.len()) || *irregular <= least_irregular(lengths.len()) {
            return None;
        }
        let most_change = 1 + faces.len() / FACES_PER_CHANGE;
        let mut templates = templates(lengths, faces.len(), MOST_TEMPLATES);
        templates.retain(|template| {
            template.irregular < *irregular && template.quads.len().abs_diff(faces.len()) <= most_change
        });
        if templates.is_empty() {
            return None;
        }
        let circle = circle(edit, outline);
        let ids: Vec<u32> = outline.iter().chain(inner).copied().collect();
        let numbers: FxHashMap<u32, usize> = (0..).zip(&ids).map(|(k, &v)| (v, k)).collect();
        let faces = faces.iter().map(|&face| edit.face(face).iter().map(|v| numbers[v]).collect());
        let faces: Vec<Vec<usize>> = faces.collect();
        let places = embedded(&circle, faces.iter().map(Vec::as_slice), ids.len());
        let triangles = faces.iter().flat_map(|face| (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
        let triangles = triangles.collect();
        Some(Self { engine, edit, templates, circle, ids, places, triangles, disc })
    }

    /// The edit of the template that seems to gain most.
    fn best(&self) -> Option<Edit<'e>> {
        let irregularity: f64 = self.disc.inner.iter().map(|&v| self.edit.irregularity(v, 0)).sum();
        let gains = self.templates.iter().filter_map(|template| {
            // Each irregular vertex of a template has one face too few or too many.
            let removed = irregularity - template.irregular as f64;
            let placed = self.placed(template)?;
            let gain = self.gain(&placed) + self.engine.options.regularity * removed;
            (gain > 0.0 && self.covers(&placed)).then_some((gain, placed))
        });
        let (_, placed) = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.filled(&placed)).filter(Edit::is_sound)
    }

    /// The old vertex whose metric a vertex of a template takes.
    fn like(&self, placed: &[(Position, u32)], v: usize) -> u32 {
        let outline = &self.disc.outline;
        outline.get(v).copied().unwrap_or_else(|| placed[v - outline.len()].1)
    }

    fn point(&self, placed: &[(Position, u32)], v: usize) -> DVec3 {
        let outline = &self.disc.outline;
        outline.get(v).map_or_else(|| placed[v - outline.len()].0.point, |&v| self.edit.point(v))
    }

    /// The loss that the disc's faces have more than those of a template.
    fn gain(&self, placed: &Placed) -> f64 {
        let price = self.engine.options.triangle_price;
        let before = self.disc.faces.iter().map(|&face| self.engine.measures[face as usize].score(price).loss);
        let Placed { vertices, quads } = placed;
        let metric = self.edit.mesh.metric();
        let after = quads.iter().map(|quad| {
            let map = metric.map_of(&quad.map(|v| self.like(vertices, v)));
            Measure::of(&quad.map(|v| self.point(vertices, v)), map.as_ref(), None, || false).score(price).loss
        });
        before.sum::<f64>() - after.sum::<f64>()
    }

    /// Whether all vertices that are removed lie near the faces of a template, so that no pin is cut off.
    fn covers(&self, placed: &Placed) -> bool {
        let Disc { outline, inner, .. } = &self.disc;
        let removed: Vec<DVec3> = inner.iter().map(|&v| self.edit.point(v)).collect();
        let faces: Vec<[DVec3; 4]> =
            placed.quads.iter().map(|quad| quad.map(|v| self.point(&placed.vertices, v))).collect();
        let around: f64 = edge_lengths(self.edit, outline).iter().sum();
        are_near(&removed, &faces, FARTHEST * around / outline.len() as f64)
    }

    /// The edit that puts a template in the place of the disc.
    fn filled(&self, placed: &Placed) -> Edit<'e> {
        let mut result = self.edit.clone();
        let mut ids = self.disc.outline.clone();
        for &(Position { point, place, triangles }, like) in &placed.vertices {
            let normal = self.engine.surface().normal(triangles[0] as usize).as_dvec3();
            let axis = self.edit.vertex(like).axis;
            let vertex =
                Vertex { point, place, triangles, normal, axis, valence: REGULAR, is_kept: false, origin: u32::MAX };
            ids.push(result.add_vertex(vertex, like));
        }
        let faces: Vec<Vec<u32>> = placed.quads.iter().map(|quad| quad.map(|v| ids[v]).to_vec()).collect();
        replaced(&result, &self.disc.faces, &faces)
    }

    /// A template whose vertices have their places on the surface; `None` where they cannot be found.
    fn placed(&self, template: &Template) -> Option<Placed> {
        let places = embedded(&self.circle, template.quads.iter().map(<[usize; 4]>::as_slice), template.vertices);
        let place = |&place: &DVec2| {
            let (shares, corners) = located(&self.places, &self.triangles, place)?;
            let target = (0..3).map(|k| self.edit.point(self.ids[corners[k]]) * shares[k]).sum::<DVec3>();
            let free = (0..3).filter(|&k| self.edit.is_free(self.ids[corners[k]]));
            let like = self.ids[corners[free.max_by(|&a, &b| shares[a].total_cmp(&shares[b]))?]];
            let from = self.edit.vertex(like);
            Some((walked(self.engine.surface(), from.triangles[0], from.point, target), like))
        };
        let vertices = places[self.circle.len()..].iter().map(place).collect::<Option<Vec<_>>>()?;
        Some(self.relaxed(Placed { vertices, quads: template.quads.clone() }))
    }

    /// Moves the vertices inside by shape matching.
    fn relaxed(&self, placed: Placed) -> Placed {
        let Placed { mut vertices, quads } = placed;
        let count = self.disc.outline.len();
        let mut uses: Vec<Vec<(usize, usize)>> = vec![Vec::new(); vertices.len()];
        for (f, quad) in quads.iter().enumerate() {
            for (k, &v) in quad.iter().enumerate().filter(|(_, v)| **v >= count) {
                uses[v - count].push((f, k));
            }
        }
        let maps = self.edit.mesh.metric().maps_of(quads.iter().map(|quad| quad.map(|v| self.like(&vertices, v))));
        let mut points: Vec<DVec3> = (0..count + vertices.len()).map(|v| self.point(&vertices, v)).collect();
        let surface = self.engine.surface();
        for _ in 0..WALKS {
            for _ in 0..SWEEPS {
                for (k, (vertex, _)) in vertices.iter().enumerate() {
                    let here = points[count + k];
                    let mut way = DVec3::ZERO;
                    for &(f, at) in &uses[k] {
                        let map = maps.get(f);
                        let corner = |k: usize| to_metric(map, points[quads[f][(at + k) % 4]]);
                        way += from_metric(map, regular(4, corner)) - here;
                    }
                    let normal = surface.normal(vertex.triangles[0] as usize).as_dvec3();
                    let way = way / uses[k].len() as f64;
                    points[count + k] = here + way - normal * normal.dot(way);
                }
            }
            for ((vertex, _), point) in vertices.iter_mut().zip(&mut points[count..]) {
                *vertex = Position { place: Place::Free, ..walked(surface, vertex.triangles[0], vertex.point, *point) };
                *point = vertex.point;
            }
        }
        Placed { vertices, quads }
    }
}

fn edge_lengths(edit: &Edit, outline: &[u32]) -> Vec<f64> {
    let point = |k: usize| edit.point(outline[k % outline.len()]);
    (0..outline.len()).map(|k| point(k).distance(point(k + 1))).collect()
}

/// Points of a circle for an outline, by its edges' lengths.
fn circle(edit: &Edit, outline: &[u32]) -> Vec<DVec2> {
    let lengths = edge_lengths(edit, outline);
    let turn = std::f64::consts::TAU / lengths.iter().sum::<f64>();
    let starts = lengths.iter().scan(0.0, |sum, length| Some(std::mem::replace(sum, *sum + length)));
    starts.map(|start| DVec2::from_angle(turn * start)).collect()
}

/// The embedding of a disc in a circle: each vertex inside is the mean of its neighbours.
fn embedded<'a>(circle: &[DVec2], faces: impl Iterator<Item = &'a [usize]>, vertices: usize) -> Vec<DVec2> {
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); vertices];
    for face in faces {
        // An edge inside has two faces, which run through it in both directions.
        (0..face.len()).for_each(|k| neighbours[face[k]].push(face[(k + 1) % face.len()]));
    }
    let mut places = circle.to_vec();
    places.resize(vertices, DVec2::ZERO);
    for _ in 0..EMBEDDING_SWEEPS {
        for v in circle.len()..vertices {
            let sum: DVec2 = neighbours[v].iter().map(|&w| places[w]).sum();
            let mean = sum / neighbours[v].len() as f64;
            places[v] = places[v].lerp(mean, OVER_RELAXATION);
        }
    }
    places
}

/// The triangle that holds a place, or is nearest to do so, and the barycentric coordinates there.
fn located(places: &[DVec2], triangles: &[[usize; 3]], place: DVec2) -> Option<([f64; 3], [usize; 3])> {
    let shares = |corners: &[usize; 3]| {
        let [a, b, c] = corners.map(|v| places[v] - place);
        let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        let area: f64 = parts.iter().sum();
        (area > 0.0).then(|| parts.map(|part| part / area))
    };
    let least = |shares: &[f64; 3]| shares.iter().copied().fold(f64::INFINITY, f64::min);
    let mut all = triangles.iter().filter_map(|corners| Some((shares(corners)?, *corners)));
    let mut nearest = all.next()?;
    // The others need not be looked at once one holds the place.
    while let Some(next) = (least(&nearest.0) < 0.0).then(|| all.next()).flatten() {
        if least(&next.0) > least(&nearest.0) {
            nearest = next;
        }
    }
    Some(nearest)
}

#[cfg(test)]
mod tests {
    use super::super::{QUADRANGULATE, recut::flipped};
    use super::*;
    use crate::mesh::connectivity::ConnectivityOptions;
    use crate::mesh::objective::Context;
    use crate::mesh::surface_mesh::SurfaceMesh;
    use crate::mesh::{Mesh, check::check};
    use crate::surface::{FeatureOptions, Soup, Surface};

    /// The mesh of a template in a regular polygon.
    fn mesh(sides: &[usize]) -> Mesh {
        let [template] = &templates(sides, 1, 1)[..] else { panic!("{sides:?} are filled") };
        let corner = |k: usize| DVec2::from_angle(std::f64::consts::TAU * k as f64 / sides.len() as f64);
        let side = |(k, &side): (usize, &usize)| {
            (0..side).map(move |at| corner(k).lerp(corner(k + 1), at as f64 / side as f64)).collect::<Vec<DVec2>>()
        };
        let rim: Vec<DVec2> = sides.iter().enumerate().flat_map(side).collect();
        let places = embedded(&rim, template.quads.iter().map(<[usize; 4]>::as_slice), template.vertices);
        let mut mesh = Mesh::new(places.iter().map(|place| [place.x, place.y, 0.0]).collect());
        template.quads.iter().for_each(|quad| mesh.push_face(&quad.map(|v| v as u32)));
        mesh
    }

    /// The numbers of irregular vertices of a mesh inside before and after edges of its faces are flipped, and after discs are
    /// quadrangulated.
    fn irregular(mesh: &Mesh, flips: &[u32]) -> [usize; 3] {
        let triangles = mesh.faces().flat_map(|face| [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]);
        let soup = Soup { points: mesh.points.clone(), triangles: triangles.collect(), ..Soup::default() };
        let surface = Surface::new(&soup, &FeatureOptions::default()).expect("a disc");
        let context = Context::new(&surface);
        let mut on_surface = SurfaceMesh::of(&context, mesh);
        let count = |mesh: &SurfaceMesh| {
            let edit = Edit::new(mesh);
            (0..mesh.vertices().len() as u32).filter(|&v| edit.valence(v) > 0 && is_irregular(&edit, v)).count()
        };
        let mut counts = vec![count(&on_surface)];
        for &face in flips {
            let flip = flipped(&Edit::new(&on_surface), face, 0).remove(0).into_change();
            flip.make(&mut on_surface, &surface, &[]);
        }
        counts.push(count(&on_surface));
        let options = ConnectivityOptions { regularity: 1.0, ..ConnectivityOptions::default() };
        Engine::new(&context, &mut on_surface, &options).run(&[QUADRANGULATE]);
        counts.push(count(&on_surface));
        let faults = check(&on_surface.compacted().in_model_units(&context));
        assert!(faults.is_clean() && faults.euler == 1, "{faults}");
        counts.try_into().expect("three counts")
    }

    #[test]
    fn a_disc_keeps_the_irregular_vertices_that_it_needs_alone() {
        // The face in the middle of a grid, and one beside the middle of three, four and five sides.
        for (sides, flips, counts) in [
            (vec![8, 8, 8, 8], vec![], [0, 0, 0]),
            (vec![8, 8, 8, 8], vec![27], [0, 4, 0]),
            (vec![8, 8, 8], vec![], [1, 1, 1]),
            (vec![8, 8, 8], vec![10], [1, 5, 1]),
            (vec![6, 6, 6, 6, 6], vec![7], [1, 5, 1]),
        ] {
            assert_eq!(irregular(&mesh(&sides), &flips), counts, "{sides:?}, {flips:?}");
        }
    }
}
