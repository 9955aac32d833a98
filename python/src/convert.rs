//! Between arrays of numpy and plain records.

use crate::error::of_text;
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use numpy::{PyUntypedArrayMethods, ndarray::ArrayView2};
use pyo3::prelude::*;
use quadmosaic::mesh::Mesh;
use quadmosaic::surface::{self, Attribute, AttributeKind};

/// An array of so many columns.
pub fn flat<T: Element>(py: Python<'_>, numbers: Vec<T>, columns: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = numbers.len() / columns;
    numbers.into_pyarray(py).reshape([rows, columns])
}

/// An array of integers.
pub fn integers(py: Python<'_>, numbers: impl Iterator<Item = i64>) -> Bound<'_, PyArray1<i64>> {
    numbers.collect::<Vec<i64>>().into_pyarray(py)
}

fn expect_columns<T>(array: &ArrayView2<'_, T>, columns: usize, name: &str) -> PyResult<()> {
    let shape = array.shape();
    if shape[1] == columns {
        return Ok(());
    }
    Err(of_text(format!("{name} has the shape ({}, {}); give {columns} columns", shape[0], shape[1])))
}

/// The rows of an array of so many columns.
pub fn points<const N: usize>(array: &PyReadonlyArray2<'_, f64>, name: &str) -> PyResult<Vec<[f64; N]>> {
    let array = array.as_array();
    expect_columns(&array, N, name)?;
    Ok(array.outer_iter().map(|row| std::array::from_fn(|k| row[k])).collect())
}

/// The rows of an array of indices below `count`.
pub fn rows<const N: usize>(array: &PyReadonlyArray2<'_, i64>, count: usize, name: &str) -> PyResult<Vec<[u32; N]>> {
    let array = array.as_array();
    expect_columns(&array, N, name)?;
    let index = |row: usize, value: i64| {
        let found = u32::try_from(value).ok().filter(|index| (*index as usize) < count);
        found.ok_or_else(|| crate::error::of_index(name, row, value, count))
    };
    let mut rows = Vec::with_capacity(array.nrows());
    for (number, row) in array.outer_iter().enumerate() {
        let mut indices = [0; N];
        for (place, &value) in indices.iter_mut().zip(row) {
            *place = index(number, value)?;
        }
        rows.push(indices);
    }
    Ok(rows)
}

/// Arrays of attributes by name.
pub type Named<'py> = Vec<(String, Bound<'py, PyArray2<f64>>)>;

/// The arrays of attributes of vertices, and of those of the corners of triangles.
pub fn named<'py>(
    py: Python<'py>,
    attributes: Vec<Attribute>,
    triangles: &[[u32; 3]],
) -> PyResult<(Named<'py>, Named<'py>)> {
    let (mut of_vertices, mut of_corners) = (Vec::new(), Vec::new());
    for attribute in attributes {
        if attribute.of_corners.is_empty() {
            of_vertices.push((attribute.name, flat(py, attribute.values, attribute.components)?));
            continue;
        }
        let corners = triangles.as_flattened().iter().enumerate();
        let values = corners.flat_map(|(place, &vertex)| attribute.at_corner(place, vertex)).copied().collect();
        of_corners.push((attribute.name, flat(py, values, attribute.components)?));
    }
    Ok((of_vertices, of_corners))
}

/// The array of an attribute of the vertices of a mesh.
pub fn at_vertices<'py>(py: Python<'py>, attribute: &Attribute, mesh: &Mesh) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let components = attribute.components;
    flat(py, attribute.values[..components * mesh.points.len()].to_vec(), components)
}

/// The array of an attribute of the corners of a mesh: of its quads, triangles, larger faces.
pub fn at_corners<'py>(py: Python<'py>, attribute: &Attribute, mesh: &Mesh) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut of_kinds = [Vec::new(), Vec::new(), Vec::new()];
    let mut start = 0;
    for face in mesh.faces() {
        let values = &mut of_kinds[match face.len() {
            4 => 0,
            3 => 1,
            _ => 2,
        }];
        face.iter().enumerate().for_each(|(k, &vertex)| values.extend(attribute.at_corner(start + k, vertex)));
        start += face.len();
    }
    flat(py, of_kinds.concat(), attribute.components)
}

/// An attribute of vertices, or of the corners of triangles.
#[derive(FromPyObject)]
pub struct Given<'py>(String, bool, PyReadonlyArray2<'py, f64>);

impl Given<'_> {
    /// The attribute of so many vertices and triangles.
    pub fn of(self, vertices: usize, triangles: usize) -> PyResult<Attribute> {
        let Self(name, is_of_corners, array) = self;
        let array = array.as_array();
        let [rows, components] = [array.nrows(), array.ncols()];
        let (wanted, what) = if is_of_corners { (3 * triangles, "corners") } else { (vertices, "vertices") };
        if rows != wanted {
            return Err(of_text(format!(
                "the attribute {name} has {rows} rows for {wanted} {what}; give one for each"
            )));
        }
        if components == 0 {
            return Err(of_text(format!("the attribute {name} has no columns; give one or more")));
        }
        let kind = AttributeKind::of(&name, components);
        if kind == AttributeKind::Colour && array.iter().any(|value| !(0.0..=1.0).contains(value)) {
            return Err(of_text(format!("the colours {name} are not from 0 to 1; divide bytes by 255")));
        }
        let of_corners = if is_of_corners { (0..rows as u32).collect() } else { Vec::new() };
        Ok(Attribute { name, kind, components, values: array.iter().copied().collect(), of_corners })
    }
}

/// The names of regions, and the region of each face.
#[derive(FromPyObject)]
pub struct Regions<'py>(Vec<String>, PyReadonlyArray1<'py, i64>);

impl Regions<'_> {
    /// The regions of so many faces.
    pub fn of(self, faces: usize) -> PyResult<surface::Regions> {
        let Self(names, numbers) = self;
        if numbers.len() != faces {
            return Err(of_text(format!("there are {} regions for {faces} faces; give one for each", numbers.len())));
        }
        let region = |&number: &i64| {
            let known = u32::try_from(number).ok().filter(|region| (*region as usize) < names.len());
            known.ok_or_else(|| of_text(format!("region {number} has no name; there are {} names", names.len())))
        };
        let of_face = numbers.as_array().iter().map(region).collect::<PyResult<Vec<u32>>>()?;
        Ok(if of_face.is_empty() { surface::Regions::default() } else { surface::Regions { names, of_face } })
    }
}
