//! Figures for people: a name and its values on each line.

use quadmosaic::mesh::compare::{Comparison, Difference, Farthest, FeatureDistance};
use quadmosaic::mesh::connectivity::EditCounts;
use quadmosaic::mesh::quality::{Quality, Range, Spread};
use quadmosaic::report::{
    Against, Asked, CheckReport, DroppedCreases, FieldFigures, FieldReport, Input, MosaicReport, Report,
    SymmetryFigures,
};
use quadmosaic::surface::{Denoised, Repairs, shown};
use quadmosaic::warnings::counted;

/// The figures of a run.
pub fn of_run(report: &Report) -> String {
    lines(&figures_of_run(report))
}

/// The figures of a run, each with its name.
pub fn figures_of_run(report: &Report) -> Vec<(&'static str, String)> {
    let Report { surface: input, mesh, before, mosaic, backend, .. } = report;
    let holes = format!("{} in the connected mosaic, {} left", mosaic.holes, mesh.polygons);
    let times: Vec<_> = report.times.iter().map(|time| format!("{} {:.0}", time.stage, time.milliseconds)).collect();
    let mut entries = vec![
        ("surface", surface(input)),
        ("repairs", repaired(input)),
        ("features", features(input)),
        ("field", field(&report.field)),
        ("vertices", format!("{} ({})", mesh.vertices, asked(report.asked))),
        ("faces", faces(mesh)),
        ("edges", edges(mesh)),
        ("Qr", format!("{:.3} ({:.3} before clean-up)", mesh.qr, before.qr)),
        ("Qg", spread(mesh.qg)),
        ("Tg", spread(mesh.tg)),
        ("Jacobian", jacobian(mesh)),
        ("irregular", format!("{}, {} demanded by the field", irregular(mesh), report.regularity.demanded)),
        ("holes", holes),
        ("edits", report.edits.map_or("none".to_owned(), edits)),
        ("check", checked(report)),
        ("backend", format!("{}, {}", backend.name, backend.adapter)),
        ("time", format!("{:.0} ms: {}", report.total_milliseconds, times.join(", "))),
    ];
    if let Some(figures) = &report.symmetry {
        entries.insert(3, ("symmetry", symmetry(figures)));
    }
    if let Some(boundary) = &report.boundary {
        entries.insert(3, ("boundary", format!("{} kept", counted(boundary.edges, "edge"))));
    }
    entries
}

/// The figures of a field.
pub fn of_field(report: &FieldReport) -> String {
    let FieldReport { surface: input, field: figures, backend, .. } = report;
    lines(&[
        ("surface", surface(input)),
        ("repairs", repaired(input)),
        ("features", features(input)),
        ("field", field(figures)),
        ("backend", format!("{}, {}", backend.name, backend.adapter)),
    ])
}

/// The figures of a mosaic.
pub fn of_mosaic(report: &MosaicReport) -> String {
    let MosaicReport { surface: input, field: figures, backend, fit, .. } = report;
    lines(&[
        ("surface", surface(input)),
        ("repairs", repaired(input)),
        ("features", features(input)),
        ("field", field(figures)),
        ("tiles", format!("{} ({}), {} on features", report.tiles, asked(report.asked), report.on_features)),
        ("coverage", format!("{:.4} of the area", fit.coverage)),
        ("overlap", format!("{:.4} of the area", fit.overlap)),
        ("straight", format!("rows turn by {:.2} degrees between neighbours", fit.straightness)),
        ("backend", format!("{}, {}", backend.name, backend.adapter)),
    ])
}

/// The figures of a mesh, alone or against a surface.
pub fn of_check(report: &CheckReport) -> String {
    lines(&figures_of_check(report))
}

/// The figures of a mesh, each with its name.
pub fn figures_of_check(report: &CheckReport) -> Vec<(&'static str, String)> {
    let mut entries = report.mesh.as_ref().map(measures).unwrap_or_default();
    if report.joints > 0 {
        entries.push(("joints", format!("sheets meet along {}", counted(report.joints, "edge"))));
    }
    entries.push(("check", report.faults.to_string()));
    if let Some(Against { surface: input, comparison }) = &report.against {
        entries.extend([("surface", surface(input)), ("repairs", repaired(input)), ("features", features(input))]);
        match comparison {
            Some(comparison) => entries.extend(compared(comparison)),
            None => entries.push(("Hausdorff", "none: the mesh has no extent".to_owned())),
        }
    }
    entries
}

fn measures(mesh: &Quality) -> Vec<(&'static str, String)> {
    vec![
        ("vertices", mesh.vertices.to_string()),
        ("faces", faces(mesh)),
        ("edges", edges(mesh)),
        ("Qr", format!("{:.3}", mesh.qr)),
        ("Qg", spread(mesh.qg)),
        ("Tg", spread(mesh.tg)),
        ("Jacobian", jacobian(mesh)),
        ("irregular", irregular(mesh)),
    ]
}

fn compared(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let Comparison { to_surface, to_mesh, hausdorff, features, differences, .. } = comparison;
    let farthest = |of: &Farthest| format!("{:.3} at {}", of.distance, shown(&of.at));
    let mut entries = vec![
        ("Hausdorff", format!("{hausdorff:.3} mean edge lengths")),
        ("  of mesh", farthest(to_surface)),
        ("  of surface", farthest(to_mesh)),
    ];
    if let Some(FeatureDistance { edges, p99, max, .. }) = features {
        let edges = counted(*edges, "edge");
        entries.push(("  of features", format!("{}, {p99:.3} for 99 % of {edges}", farthest(max))));
    }
    let differences: Vec<String> = differences.iter().map(ToString::to_string).collect();
    entries.push(("differences", if differences.is_empty() { "none".to_owned() } else { differences.join("; ") }));
    entries
}

/// The faults and differences of a checked mesh, in a sentence.
pub fn faults_of(report: &CheckReport) -> Option<String> {
    let differences = report.differences();
    if let Some(size @ Difference::Size { .. }) = differences.first() {
        // The other differences follow from it.
        return Some(size.to_string());
    }
    let faults = Some(report.faults.list.len()).filter(|count| *count > 0).map(|count| counted(count, "fault"));
    let said: Vec<String> = faults.into_iter().chain(differences.iter().map(ToString::to_string)).collect();
    (!said.is_empty()).then(|| said.join("; "))
}

fn lines(entries: &[(&str, String)]) -> String {
    let width = entries.iter().map(|(name, _)| name.len()).max().unwrap_or_default();
    entries.iter().map(|(name, text)| format!("{name:width$}  {text}\n")).collect()
}

fn asked(asked: Asked) -> String {
    match asked {
        Asked::Points(count) => format!("{count} asked for"),
        Asked::Size(size) => format!("tiles of side {size} asked for"),
        Asked::Sampled => "tiles of the given sizes asked for".to_owned(),
    }
}

fn surface(input: &Input) -> String {
    let Input { name, triangles, vertices, diagonal, .. } = input;
    format!("{name}: {}, {}, diagonal {diagonal:.4}", counted(*triangles, "triangle"), counted(*vertices, "vertex"))
}

/// The repairs, and the smoothing of noise.
fn repaired(input: &Input) -> String {
    let noise = input
        .denoised
        .map(|Denoised { mean, largest }| format!("noise smoothed: points moved by {mean:.3e}, at most {largest:.3e}"));
    let repairs = Some(repairs(&input.repairs, input.diagonal)).filter(|text| noise.is_none() || text != "none");
    repairs.into_iter().chain(noise).collect::<Vec<_>>().join("; ")
}

fn features(input: &Input) -> String {
    let DroppedCreases { short, weak, double } = input.dropped;
    let of = [(short, "short"), (weak, "weak"), (double, "double")];
    let some = of.into_iter().filter(|(creases, _)| creases.count > 0);
    let texts: Vec<String> =
        some.map(|(creases, name)| format!("{} {name} ({:.4} long)", creases.count, creases.length)).collect();
    let dropped = match short.count + weak.count + double.count {
        0 => String::new(),
        count => format!("; {} dropped: {}", counted(count, "crease"), texts.join(", ")),
    };
    format!("{}, {}{dropped}", counted(input.curves, "curve"), counted(input.corners, "corner"))
}

fn symmetry(figures: &SymmetryFigures) -> String {
    let SymmetryFigures { plane, is_found, asymmetry, on_plane, .. } = figures;
    let found = if *is_found { ", found" } else { "" };
    let on_plane = counted(*on_plane, "vertex");
    format!(
        "about {plane}{found}; {on_plane} on it; the surface's mirror image is up to {:.3e} away",
        asymmetry.distance
    )
}

fn field(figures: &FieldFigures) -> String {
    let corners = figures.singularities.iter().filter(|singularity| singularity.on_feature).count();
    let free = counted(figures.singularities.len() - corners, "singularity");
    let corners = match corners {
        0 => String::new(),
        count => format!(" and {} of features", counted(count, "corner")),
    };
    let guides = match figures.guides.len() {
        0 => String::new(),
        count => format!("; {}", counted(count, "guide")),
    };
    let stretch = figures.stretch.map_or_else(String::new, |stretch| {
        let squares = 100.0 * (stretch.nearly_square + stretch.unguided);
        format!("; tiles {} to 1, squares on {squares:.1} % of the area", stretch.aspect)
    });
    format!("{free}{corners}, the sum of indices is {}{guides}{stretch}", figures.index_sum)
}

/// Gaps below this, in diagonals, are none at the precision of computation.
const ROUNDING: f64 = 1e-7;

fn repairs(repairs: &Repairs, diagonal: f64) -> String {
    let said: Vec<_> = [
        (&repairs.welded_points, "point", "welded"),
        (&repairs.sewn_vertices, "vertex", "inserted in rims"),
        (&repairs.imprinted_edges, "edge", "of rims joined to sheets"),
        (&repairs.degenerate_triangles, "triangle", "without area dropped"),
        (&repairs.duplicate_triangles, "repeated triangle", "dropped"),
        (&repairs.dropped_specks, "part", "too small to have a shape dropped"),
        (&repairs.dropped_parts, "small part", "dropped"),
        (&repairs.filled_holes, "hole", "filled"),
        (&repairs.flipped_triangles, "triangle", "turned over"),
        (&repairs.flipped_caps, "triangle", "without height flipped"),
        (&repairs.joined_edges, "edge", "of more than two triangles kept"),
        (&repairs.joined_vertices, "vertex", "added where sheets meet"),
    ]
    .into_iter()
    .map(|(repair, what, done)| (repair.count, what, done))
    .filter(|(count, ..)| *count > 0)
    .map(|(count, what, done)| format!("{} {done}", counted(count, what)))
    .collect();
    // What is rounding is not told.
    let gap = Some(repairs.largest_gap).filter(|gap| *gap > ROUNDING * diagonal);
    let gap = gap.map(|gap| format!("over gaps of at most {gap:.3e}"));
    let said: Vec<String> = said.into_iter().chain(gap).collect();
    if said.is_empty() { "none".to_owned() } else { said.join(", ") }
}

fn faces(mesh: &Quality) -> String {
    let larger = match mesh.polygons {
        0 => String::new(),
        count => format!(", {count} of more sides"),
    };
    format!("{}, {}{larger}", counted(mesh.quads, "quad"), counted(mesh.triangles, "triangle"))
}

fn edges(mesh: &Quality) -> String {
    let ends = mesh.edge.map_or(String::new(), |Range { min, max, .. }| format!(", {min:.4e} to {max:.4e}"));
    format!("{:.4e} in the mean, deviation {:.1} %{ends}", mesh.mean_edge, 100.0 * mesh.edge_cv)
}

fn edits(counts: EditCounts) -> String {
    let EditCounts { triangles_before, triangles_after, .. } = counts;
    let made = [
        (counts.merged, "pair merged"),
        (counts.recut_rows, "row recut"),
        (counts.recut_fans, "fan recut"),
        (counts.removed, "vertex removed"),
        (counts.met, "pair met"),
        (counts.rows_out, "row taken out"),
        (counts.rows_in, "row put in"),
        (counts.strips_out, "strip taken out"),
        (counts.strips_in, "strip put in"),
        (counts.flipped, "edge flipped"),
        (counts.collapsed, "face collapsed"),
        (counts.quadrangulated, "disc quadrangulated"),
        (counts.dissolved, "vertex dissolved"),
        (counts.split, "quad split"),
        (counts.on_boundaries, "vertex added on boundaries"),
        (counts.on_features, "vertex added on features"),
    ];
    let made = made.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| {
        let (noun, done) = what.split_once(' ').unwrap_or((what, ""));
        format!("{} {done}", counted(count, noun))
    });
    let said: Vec<String> =
        std::iter::once(format!("triangles {triangles_before} -> {triangles_after}")).chain(made).collect();
    said.join(", ")
}

/// The result of a run's check.
fn checked(report: &Report) -> String {
    let found: String = report.faults.to_string().lines().take(1).collect();
    let same = if report.differences.is_empty() { "as the surface" } else { "other than the surface" };
    let other = if report.surface.denoised.is_some() { format!("{same} without noise") } else { same.to_owned() };
    format!("{found}; {other}")
}

fn spread(measure: Option<Spread>) -> String {
    measure.map_or("none".to_owned(), |of| format!("{:.3} (worst {:.3})", of.mean, of.min))
}

fn jacobian(mesh: &Quality) -> String {
    mesh.scaled_jacobian.map_or("none".to_owned(), |of| format!("{:.3} scaled, at least", of.min))
}

fn irregular(mesh: &Quality) -> String {
    let of = counted(mesh.interior_vertices, "interior vertex");
    format!("{} of {of} ({:.2} %)", mesh.irregular_vertices, 100.0 * mesh.irregular())
}
