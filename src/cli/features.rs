//! Features: arguments of all commands that need the features of a surface.

use clap::Args;
use quadmosaic::options::degrees;
use quadmosaic::surface::{FeatureOptions, NamedEdge, read_edges};
use std::path::PathBuf;

#[derive(Args)]
pub struct FeatureArguments {
    /// The dihedral angle over which an edge is kept as a crease
    ///
    /// In degrees (1 to 180); 180: none is. Without this option the angle is 40, and a crease is kept only where the surface turns sharply
    /// at the scale of a tile too
    #[arg(long, value_name = "ANGLE", value_parser = degrees::<180>, help_heading = "Features")]
    crease: Option<f64>,
    /// Ignore the borders of regions (groups, materials, solids)
    ///
    /// The faces of the mesh still have the names of their regions
    #[arg(long, help_heading = "Features")]
    ignore_regions: bool,
    /// Keep the seams of texture coordinates like creases
    ///
    /// No face of the mesh lies across one
    #[arg(long, help_heading = "Features")]
    keep_uv: bool,
    /// Edges to keep at any angle, from a file
    ///
    /// On each line two vertex numbers of the surface, counted from 1, or two points (X,Y,Z,X,Y,Z); a straight line of edges may be named
    /// by its ends
    #[arg(long, value_name = "FILE", help_heading = "Features")]
    feature_edges: Vec<PathBuf>,
}

impl FeatureArguments {
    /// The options of features.
    pub fn options(&self) -> FeatureOptions {
        let default = FeatureOptions::default();
        FeatureOptions {
            crease: self.crease.unwrap_or(default.crease),
            every_crease: self.crease.is_some(),
            region_borders: !self.ignore_regions,
            texture_seams: self.keep_uv,
            ..default
        }
    }

    /// The edges that are features at any angle.
    ///
    /// # Errors
    /// Where a file of edges cannot be read.
    pub fn edges(&self) -> anyhow::Result<Vec<NamedEdge>> {
        let mut edges = Vec::new();
        for file in &self.feature_edges {
            edges.extend(read_edges(file)?);
        }
        Ok(edges)
    }
}
