//! Measures of faces as colours, and of the mesh as histograms.

use super::array::Floats;
use crate::mesh::quality::{measures_of, valences};
use crate::mesh::{Edge, Mesh};
use crate::picture::Colour;
use glam::DVec3;
use serde::Serialize;

/// Steps of a ramp of colours.
const STEPS: u32 = 32;
/// The bars of a histogram, but for those of valences. They are odd in number: right angles, and the mean length, are in the middle of
/// one.
const BARS: usize = 41;
/// The least and the largest valence that have a bar.
const VALENCES: [u32; 2] = [2, 8];
/// A share of a width, and the name of that place.
type Mark = (f64, &'static str);

/// A measure of faces, and its colours.
#[derive(Serialize)]
pub(super) struct Scale {
    title: &'static str,
    /// Colours from 0 to 1.
    ramp: Vec<String>,
    /// Names of shares of the ramp.
    marks: Vec<Mark>,
    /// The share of each face; NaN where it has none.
    shares: Floats,
}

/// How often values occur.
#[derive(Serialize)]
pub(super) struct Histogram {
    title: &'static str,
    /// What is counted.
    of: &'static str,
    /// Names of shares of the width.
    marks: Vec<Mark>,
    /// Values below the first bar are in the first, those above the last in the last.
    counts: Vec<usize>,
}

/// The measures that faces can be coloured by.
pub(super) fn scales(mesh: &Mesh, edges: &[Edge]) -> Vec<Scale> {
    let mean = mean(mesh.lengths(edges));
    let measures: Vec<(f64, f64)> = mesh.faces().map(|face| measures_of(mesh, face)).collect();
    let quality = |title, of: fn(&(f64, f64)) -> f64| Scale {
        title,
        ramp: ramp(Colour::of_quality),
        marks: vec![(0.0, "0"), (0.5, "0.5"), (1.0, "1")],
        shares: Floats(measures.iter().map(|measures| of(measures) as f32).collect()),
    };
    let length = |face: &[u32]| {
        let perimeter: f64 = sides(mesh, face).map(|(a, b)| a.distance(b)).sum();
        (0.5 + (perimeter / face.len() as f64 / mean).log2() / 2.0) as f32
    };
    vec![
        quality("shape: Qg of quads, Tg of triangles", |measures| measures.0),
        quality("scaled Jacobian of quads", |measures| measures.1),
        Scale {
            title: "edge length, over the mean",
            ramp: ramp(Colour::of_length),
            marks: vec![(0.0, "1/2"), (0.5, "1"), (1.0, "2")],
            shares: Floats(mesh.faces().map(length).collect()),
        },
    ]
}

/// The scale of wanted sizes, from a quarter of the mean edge length to four times as much.
pub(super) fn scale_of_sizes() -> Scale {
    Scale {
        title: "wanted edge length, over the mean",
        ramp: ramp(Colour::of_length),
        marks: vec![(0.0, "1/4"), (0.25, "1/2"), (0.5, "1"), (0.75, "2"), (1.0, "4")],
        shares: Floats::default(),
    }
}

/// The distributions of shapes, scaled Jacobians, angles, edge lengths and valences.
pub(super) fn histograms(mesh: &Mesh, edges: &[Edge]) -> Vec<Histogram> {
    let measures: Vec<(f64, f64)> = mesh.faces().map(|face| measures_of(mesh, face)).collect();
    let quality = || vec![(0.0, "0"), (0.5, "0.5"), (1.0, "1")];
    let lengths = mesh.lengths(edges);
    let mean = mean(lengths.clone());
    let angles = mesh.faces().flat_map(|face| {
        let ways: Vec<DVec3> = sides(mesh, face).map(|(a, b)| b - a).collect();
        (0..ways.len()).map(|k| (-ways[k]).angle_between(ways[(k + 1) % ways.len()]).to_degrees()).collect::<Vec<_>>()
    });
    let (valence, boundary) = valences(mesh, edges);
    let inside = valence.iter().zip(&boundary).filter(|(valence, boundary)| **valence > 0 && !**boundary);
    let [least, largest] = VALENCES;
    let bars = (largest - least + 1) as usize;
    let of_valence = |&valence: &u32| (f64::from(valence - valence.min(least)) + 0.5) / bars as f64;
    let names = ["2", "3", "4", "5", "6", "7", "8"];
    let valence_marks = names.into_iter().enumerate().map(|(k, name)| ((k as f64 + 0.5) / bars as f64, name));
    vec![
        Histogram {
            title: "Shape: Qg of quads, Tg of triangles",
            of: "faces",
            marks: quality(),
            counts: counted(BARS, measures.iter().map(|measures| measures.0)),
        },
        Histogram {
            title: "Scaled Jacobian",
            of: "quads",
            marks: quality(),
            counts: counted(BARS, measures.iter().map(|measures| measures.1)),
        },
        Histogram {
            title: "Angle, in degrees",
            of: "corners of faces",
            marks: vec![(0.0, "0"), (0.5, "90"), (1.0, "180")],
            counts: counted(BARS, angles.map(|angle| angle / 180.0)),
        },
        Histogram {
            title: "Edge length, over the mean",
            of: "edges",
            marks: vec![(0.0, "0"), (0.5, "1"), (1.0, "2 and more")],
            counts: counted(BARS, lengths.iter().map(|length| length / mean / 2.0)),
        },
        Histogram {
            title: "Valence",
            of: "interior vertices",
            marks: valence_marks.collect(),
            counts: counted(bars, inside.map(|(valence, _)| of_valence(valence))),
        },
    ]
}

/// How many shares, from 0 to 1, are in each bar; those that are NaN are in none.
fn counted(bars: usize, shares: impl Iterator<Item = f64>) -> Vec<usize> {
    let mut counts = vec![0; bars];
    for share in shares.filter(|share| !share.is_nan()) {
        counts[((share.max(0.0) * bars as f64) as usize).min(bars - 1)] += 1;
    }
    counts
}

fn ramp(colour: fn(f64) -> Colour) -> Vec<String> {
    (0..=STEPS).map(|step| colour(f64::from(step) / f64::from(STEPS)).hex()).collect()
}

/// The ends of the sides of a face.
fn sides(mesh: &Mesh, face: &[u32]) -> impl Iterator<Item = (DVec3, DVec3)> {
    let next = face.iter().cycle().skip(1);
    face.iter().zip(next).map(|(&a, &b)| (mesh.place(a), mesh.place(b)))
}

fn mean(values: Vec<f64>) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_outside_are_in_the_outer_bars_and_no_number_in_none() {
        assert_eq!(counted(4, [-1.0, 0.0, 0.3, 0.5, 1.0, 7.0, f64::NAN].into_iter()), [2, 1, 1, 2]);
    }

    #[test]
    fn a_rectangle_has_four_right_angles_and_two_lengths() {
        let mut mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        mesh.push_face(&[0, 1, 2, 3]);
        let [shape, jacobian, angle, length, valence] =
            <[Histogram; 5]>::try_from(histograms(&mesh, &mesh.edges())).unwrap_or_else(|_| panic!("five"));
        assert_eq!(jacobian.counts.last(), Some(&1));
        assert_eq!(shape.counts.last(), Some(&0), "it is no square");
        assert_eq!(angle.counts[angle.counts.len() / 2], 4);
        // The mean is 2: the lengths are a half and one and a half of it.
        assert_eq!([length.counts[BARS / 4], length.counts[3 * BARS / 4]], [2, 2]);
        assert_eq!(valence.counts.iter().sum::<usize>(), 0, "all vertices are on the boundary");
        let scales = scales(&mesh, &mesh.edges());
        assert!((scales[2].shares.0[0] - 0.5).abs() < 1e-6, "its mean side is the mean edge");
    }
}
