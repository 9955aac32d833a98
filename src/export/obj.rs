//! Wavefront OBJ.

use std::io::{self, Write};
use std::path::Path;

use super::{WriteError, atomic};
use crate::mesh::Mesh;
use crate::surface::{Regions, Soup};
use rayon::prelude::*;

/// Writes a mesh as Wavefront OBJ: quads as quads, larger faces as polygons, named regions as groups. Coordinates have nine significant digits,
/// and more where the model is far from the origin, so that its size always has about nine. The same mesh gives the same bytes.
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_obj(path: &Path, mesh: &Mesh) -> Result<(), WriteError> {
    atomic(path, |writer| records(writer, &mesh.points, mesh.faces(), &mesh.regions))
}

/// Writes triangles as Wavefront OBJ, as [`write_obj`] does.
///
/// # Errors
/// As [`write_obj`].
pub fn write_soup(path: &Path, soup: &Soup) -> Result<(), WriteError> {
    atomic(path, |writer| {
        records(writer, &soup.points, soup.triangles.iter().map(|triangle| &triangle[..]), &soup.regions)
    })
}

/// The number of points whose lines are in memory at the same time.
const LINES_AT_ONCE: usize = 1 << 16;

fn records<'a>(
    writer: &mut dyn Write,
    points: &[[f64; 3]],
    faces: impl Iterator<Item = &'a [u32]>,
    regions: &Regions,
) -> io::Result<()> {
    writeln!(writer, "# quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    let digits = significant_digits(points);
    let line = |point: &[f64; 3]| {
        let [x, y, z] = point.map(|coordinate| rounded(coordinate, digits));
        format!("v {x:?} {y:?} {z:?}\n")
    };
    // Digits take most of the time.
    for some in points.chunks(LINES_AT_ONCE) {
        let lines: Vec<String> = some.par_iter().with_min_len(512).map(line).collect();
        lines.iter().try_for_each(|line| writer.write_all(line.as_bytes()))?;
    }
    let mut last = None;
    for (index, face) in faces.enumerate() {
        let region = regions.of_face.get(index);
        if let Some(name) = region.filter(|_| region != last).map(|&region| &regions.names[region as usize]) {
            writeln!(writer, "{}", format!("g {name}").trim_end())?;
        }
        last = region;
        write!(writer, "f")?;
        for index in face {
            write!(writer, " {}", index + 1)?;
        }
        writeln!(writer)?;
    }
    Ok(())
}

/// Nine, and as many more as the model's distance from the origin has before its size; never more than tell two doubles apart.
fn significant_digits(points: &[[f64; 3]]) -> usize {
    let reach = |axis: usize| {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point[axis]), high.max(point[axis]))
        })
    };
    let axes = [reach(0), reach(1), reach(2)];
    let size = axes.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let farthest = axes.iter().map(|(low, high)| low.abs().max(high.abs())).fold(0.0, f64::max);
    let before = (farthest / size).log10().ceil();
    if before.is_finite() { 9 + before.clamp(0.0, 8.0) as usize } else { 9 }
}

/// The nearest double with so many significant decimal digits; no negative zero.
fn rounded(coordinate: f64, digits: usize) -> f64 {
    format!("{coordinate:.*e}", digits - 1).parse().unwrap_or(coordinate) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(mesh: &Mesh) -> String {
        let mut bytes = Vec::new();
        records(&mut bytes, &mesh.points, mesh.faces(), &mesh.regions).expect("a vector takes all");
        String::from_utf8(bytes).expect("OBJ is text")
    }

    #[test]
    fn faces_keep_their_corners() {
        let mut mesh = Mesh::new(vec![[0.0; 3], [1.0 / 3.0, 0.0, -0.0], [1e-7, 2e20, -1.5], [0.0, 1.0, 0.0], [3.0; 3]]);
        mesh.push_face(&[0, 1, 2, 3]);
        mesh.push_face(&[4, 3, 2]);
        mesh.push_face(&[0, 1, 2, 3, 4]);
        let expected = "v 0.0 0.0 0.0\nv 0.333333333 0.0 0.0\nv 1e-7 2e20 -1.5\nv 0.0 1.0 0.0\nv 3.0 3.0 3.0\n\
                        f 1 2 3 4\nf 5 4 3\nf 1 2 3 4 5\n";
        assert_eq!(text(&mesh).split_once('\n').map(|(_, body)| body), Some(expected));
    }

    #[test]
    fn a_far_model_keeps_its_shape() {
        let far = Mesh::new(vec![[1e6 + 1.0 / 3.0, 0.0, 0.0], [1e6 + 1.0, 0.0, 0.0]]);
        assert!(text(&far).contains("v 1000000.333333333 "), "{}", text(&far));
        let single = Mesh::new(vec![[1e6, 1.0 / 3.0, 0.0]]);
        assert!(text(&single).contains("v 1000000.0 0.333333333 0.0"), "{}", text(&single));
    }
}
