//! A mesh for the page: the page's data and the bytes of the file.

use crate::cli::page;
use anyhow::Context;
use quadmosaic::Mesher;
use quadmosaic::export::{Format, MeshFile, atomic, write_mesh_to};
use quadmosaic::pipeline::{Options, Watch};
use quadmosaic::surface::Soup;
use std::path::PathBuf;
use std::sync::Arc;

/// What all meshes of a server share.
pub struct Meshing {
    pub name: String,
    pub soup: Soup,
    pub mesher: Mesher,
    pub format: Format,
    /// The file that each mesh is written to.
    pub output: Option<PathBuf>,
}

/// A mesh.
#[derive(Clone)]
pub struct Product {
    /// The data of its page, as JSON.
    pub page: Arc<String>,
    /// The bytes of its file.
    pub file: Arc<Vec<u8>>,
}

impl Meshing {
    /// Meshes the surface, and writes the file where there is to be one.
    ///
    /// # Errors
    /// Where the surface cannot be meshed with these options, the mesh not be written, or `watch` cancels the run.
    pub fn make(&self, options: &Options, watch: &Watch) -> anyhow::Result<Product> {
        let Self { name, soup, mesher, format, output } = self;
        let outcome = mesher.mesh_watched(soup, options, watch).context(name.clone())?;
        let report = mesher.report(name, options, &outcome);
        let meshed = &outcome.meshed;
        let mut file = Vec::new();
        write_mesh_to(&mut file, *format, &MeshFile::new(&meshed.mesh, &meshed.vertices).with_input(soup, false))?;
        if let Some(path) = output {
            atomic(path, |writer| writer.write_all(&file))?;
        }
        let page = page::of_run(soup, options, &outcome, &report)?.json();
        Ok(Product { page: Arc::new(page), file: Arc::new(file) })
    }
}
