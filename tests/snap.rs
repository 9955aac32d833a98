//! Snapping: free vertices beside a crease that is no feature move to it.

use glam::DVec3;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::snap::snap;
use quadmosaic::mesh::{Context, Mesh, SurfaceMesh};
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

/// The half width and the length of the folded sheet.
const SIZE: usize = 12;

/// The point of the sheet at a signed distance from the fold, which turns it by `angle` degrees.
fn on_sheet(s: f64, y: f64, angle: f64) -> [f64; 3] {
    let (sine, cosine) = angle.to_radians().sin_cos();
    if s < 0.0 { [s, y, 0.0] } else { [s * cosine, y, -s * sine] }
}

/// The faces of a grid of so many points across and along.
fn cells(across: u32, along: u32) -> impl Iterator<Item = [u32; 4]> {
    let at = move |i: u32, j: u32| j * across + i;
    (0..along - 1)
        .flat_map(move |j| (0..across - 1).map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
}

/// The folded sheet in triangles of unit legs, for tiles of a side.
fn sheet(angle: f64, side: f64) -> Surface {
    let n = 2 * SIZE + 1;
    let points = (0..=SIZE).flat_map(|j| (0..n).map(move |i| on_sheet(i as f64 - SIZE as f64, j as f64, angle)));
    let triangles = cells(n as u32, SIZE as u32 + 1).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let soup = Soup { points: points.collect(), triangles: triangles.collect(), ..Soup::default() };
    let options = FeatureOptions { ridge: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&soup, &options).unwrap_or_else(|error| panic!("{error}"));
    let side = side / surface.frame().diagonal;
    surface.fitted(&options, side as f32)
}

/// A grid of unit squares on the sheet whose columns pass the fold at distances `offset` and `1 - offset`.
fn grid(angle: f64, offset: f64) -> Mesh {
    let across = 2 * SIZE - 3;
    let column = |i: usize| i as f64 - (SIZE as f64 - 2.0) + offset;
    let points = (0..SIZE).flat_map(|j| (0..across).map(move |i| on_sheet(column(i), j as f64 + 0.5, angle)));
    let mut mesh = Mesh::new(points.collect());
    cells(across as u32, SIZE as u32).for_each(|cell| mesh.push_face(&cell));
    mesh
}

fn snapped(surface: &Surface, mesh: &Mesh) -> Mesh {
    let context = Context::new(surface);
    let mut mesh = SurfaceMesh::of(&context, mesh);
    snap(&context, &mut mesh);
    mesh.in_model_units(&context)
}

/// The number of vertices on the fold.
fn on_fold(mesh: &Mesh) -> usize {
    mesh.points.iter().filter(|p| p[0].abs() < 1e-5 && p[2].abs() < 1e-5).count()
}

#[test]
fn vertices_move_to_a_dropped_crease_and_faces_keep_their_shapes() {
    // A fold of 45 degrees, 12 long, persists for tiles of side 2, and for tiles of side 3 no more.
    let surface = sheet(45.0, 3.0);
    assert_eq!(surface.dropped_edges().len(), SIZE);
    for offset in [0.2, 0.35, -0.3] {
        let before = grid(45.0, offset);
        let after = snapped(&surface, &before);
        assert_eq!((on_fold(&before), on_fold(&after)), (0, SIZE), "offset {offset}");
        assert!(after.faces().eq(before.faces()), "faces stay");
        let least = Quality::of(&after).qg.expect("quads").min;
        assert!(least >= 0.5, "offset {offset}: {least}");
        let off = |p: &[f64; 3]| {
            let s = if p[2] < -1e-9 { DVec3::new(p[0], 0.0, p[2]).length() } else { p[0] };
            DVec3::from(*p).distance(DVec3::from(on_sheet(s, p[1], 45.0)))
        };
        assert!(after.points.iter().all(|p| off(p) < 1e-5), "vertices stay on the surface");
    }
}

#[test]
fn without_a_dropped_crease_nothing_moves() {
    let surface = sheet(45.0, 2.0);
    assert_eq!(surface.dropped_edges().len(), 0);
    let context = Context::new(&surface);
    let before = SurfaceMesh::of(&context, &grid(45.0, 0.3)).in_model_units(&context);
    assert_eq!(snapped(&surface, &grid(45.0, 0.3)), before);
}
