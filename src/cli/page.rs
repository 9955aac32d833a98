//! Pages of runs and of meshes.

use super::summary;
use anyhow::Context;
use quadmosaic::mesh::Mesh;
use quadmosaic::page::{MOST_TRIANGLES, Page};
use quadmosaic::pipeline::{Options, Outcome};
use quadmosaic::report::{CheckReport, Report};
use quadmosaic::surface::{Soup, Surface};

/// The page of a run.
///
/// # Errors
/// Where the mesh cannot be shown.
pub fn of_run(soup: &Soup, options: &Options, outcome: &Outcome, report: &Report) -> anyhow::Result<Page> {
    let Outcome { surface, field, mosaic, meshed, .. } = outcome;
    let page = Page::new(&report.surface.name, &meshed.mesh).context(report.surface.name.clone())?;
    let page = with_input(page, soup, options, outcome, report)?
        .with_features(surface)
        .with_field(surface, field)
        .with_tiles(surface, mosaic)
        .with_figures(owned(summary::figures_of_run(report)));
    let notes = report.wrong().into_iter().chain(report.warnings());
    Ok(notes.fold(page, |page, note| page.with_note(capital(&note))))
}

/// The page with the surface as it is before triangles are divided for tiles; if that has too many, with the one that it was coarsened
/// to.
fn with_input(page: Page, soup: &Soup, options: &Options, outcome: &Outcome, report: &Report) -> anyhow::Result<Page> {
    let (given, used) = (report.surface.triangles, outcome.surface.triangle_count());
    if given > MOST_TRIANGLES {
        let coarse = (used <= MOST_TRIANGLES).then(|| {
            format!(
                "The surface has {given} triangles. This page shows the {used} that it was coarsened to for the tiles."
            )
        });
        let page = page.with_surface(&outcome.surface);
        return Ok(coarse.into_iter().fold(page, Page::with_note));
    }
    let surface = Surface::repaired(soup, &options.features, &options.repairs, report.mesh.mean_edge);
    Ok(page.with_surface(&surface.context(report.surface.name.clone())?))
}

/// The page of a mesh that was checked.
///
/// # Errors
/// Where the mesh cannot be shown.
pub fn of_check(mesh: &Mesh, report: &CheckReport) -> anyhow::Result<Page> {
    let page = Page::new(&report.name, mesh).context(report.name.clone())?;
    let page = page.with_figures(owned(summary::figures_of_check(report)));
    Ok(summary::faults_of(report).iter().fold(page, |page, faults| page.with_note(capital(faults))))
}

fn owned(figures: Vec<(&str, String)>) -> impl Iterator<Item = (String, String)> {
    figures.into_iter().map(|(name, value)| (name.trim().to_owned(), value))
}

/// A sentence of its own.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}
