//! Between arrays of numpy and plain records.

use crate::error::of_text;
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use numpy::{PyUntypedArrayMethods, ndarray::ArrayView2};
use pyo3::prelude::*;
use quadmosaic::surface;

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
