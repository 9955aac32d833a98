//! Python's exceptions for the library's errors.

use pyo3::create_exception;
use pyo3::exceptions::{
    PyException, PyFileNotFoundError, PyMemoryError, PyOSError, PyRuntimeError, PyTimeoutError, PyValueError,
};
use pyo3::prelude::*;
use quadmosaic::PipelineError;
use quadmosaic::export::WriteError;
use quadmosaic::pipeline::LimitError;
use quadmosaic::surface::SurfaceError as Fault;
use quadmosaic::surface::load::{LoadError, Place};
use std::fmt::Display;

create_exception!(quadmosaic, SurfaceError, PyValueError, "The surface is faulty.");
create_exception!(quadmosaic, Cancelled, PyException, "The progress function returned False.");

/// An option, or the content of a file of options, is wrong.
pub fn of_value(error: impl Display) -> PyErr {
    of_text(error.to_string())
}

/// An argument is wrong.
pub fn of_text(text: String) -> PyErr {
    PyValueError::new_err(text)
}

fn surface_error(text: String, line: Option<usize>, triangle: Option<usize>) -> PyErr {
    Python::attach(|py| {
        let error = SurfaceError::new_err(text);
        let value = error.value(py);
        match value.setattr("line", line).and_then(|()| value.setattr("triangle", triangle)) {
            Ok(()) => error,
            Err(other) => other,
        }
    })
}

/// An index is wrong; of a triangle, it is a fault of the surface.
pub fn of_index(name: &str, row: usize, value: i64, count: usize) -> PyErr {
    let text = format!("{name}[{row}] uses vertex {value}, but there are only {count} vertices, counted from 0");
    if name == "triangles" { surface_error(text, None, Some(row)) } else { of_text(text) }
}

/// A file is not read.
pub fn of_load(error: LoadError) -> PyErr {
    let text = error.to_string();
    match error {
        LoadError::Missing { .. } => PyFileNotFoundError::new_err(text),
        LoadError::Unreadable { .. } | LoadError::Directory { .. } => PyOSError::new_err(text),
        LoadError::At { place: Place::Line(line), .. } => surface_error(text, Some(line), None),
        LoadError::At { place: Place::Item { kind: "triangle", number }, .. } => {
            surface_error(text, None, Some(number))
        }
        LoadError::At { place: Place::Record { kind, number, .. }, .. } if kind == "triangle" => {
            surface_error(text, None, Some(number))
        }
        _ => surface_error(text, None, None),
    }
}

/// A file is not written.
pub fn of_write(error: WriteError) -> PyErr {
    let text = error.to_string();
    match error {
        WriteError::Polygons { .. } => of_text(text),
        _ => PyOSError::new_err(text),
    }
}

/// There is no mesh.
pub fn of_pipeline(error: PipelineError) -> PyErr {
    let text = error.to_string();
    match error {
        PipelineError::Surface(Fault::RepairLength { .. } | Fault::NoSuchVertex { .. } | Fault::NoEdges { .. }) => {
            of_text(text)
        }
        PipelineError::Surface(Fault::NotOrientable { triangle, .. } | Fault::IndexOutOfRange { triangle, .. }) => {
            surface_error(text, None, Some(triangle))
        }
        PipelineError::Surface(_) => surface_error(text, None, None),
        PipelineError::Cancelled(_) => Cancelled::new_err(text),
        PipelineError::Limit(LimitError::Memory { .. }) => PyMemoryError::new_err(text),
        PipelineError::Limit(LimitError::Time(_)) => PyTimeoutError::new_err(text),
        PipelineError::Compute(_) => PyRuntimeError::new_err(text),
        _ => of_text(text),
    }
}
