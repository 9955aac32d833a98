//! Faults are cut anew, go or are split; features stay, and all quads stay quads.

use super::plate::{Grid, SIDE, at};
use super::{area_of, with};
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::connectivity::{EditCounts, Quads, untangle};
use quadmosaic::mesh::quality::quad_shape;
use quadmosaic::mesh::{Context, Mesh, SurfaceMesh};
use quadmosaic::surface::Surface;

/// What becomes of the faults of a mesh.
struct Untangled {
    /// Whether anything was done.
    is_changed: bool,
    /// The number of faults before and after.
    faults: [usize; 2],
    after: Mesh,
    /// The vertex before that each one was; `u32::MAX` for one that is new.
    origins: Vec<u32>,
    counts: EditCounts,
}

impl Untangled {
    /// Whether the mesh has an edge between two vertices as they were before.
    fn has_edge(&self, ends: [u32; 2]) -> bool {
        let now = |v: u32| (0..).zip(&self.origins).find(|(_, origin)| **origin == v).map(|(now, _)| now);
        let [Some(a), Some(b)] = ends.map(now) else { return false };
        self.after.edges().iter().any(|edge| edge.ends == [a.min(b), a.max(b)])
    }
}

impl Grid {
    fn untangled(&self, quads: Quads) -> Untangled {
        self.untangled_on(&self.surface(), quads)
    }

    fn untangled_on(&self, surface: &Surface, quads: Quads) -> Untangled {
        let context = Context::new(surface);
        let mut mesh = SurfaceMesh::of(&context, &self.mesh());
        let before = mesh.faults(&context).len();
        let mut counts = EditCounts::default();
        let is_changed = untangle(&context, &mut mesh, &with(quads), &mut counts);
        Untangled {
            is_changed,
            faults: [before, mesh.faults(&context).len()],
            after: mesh.in_model_units(&context),
            origins: mesh.compacted().vertices().iter().map(|vertex| vertex.origin).collect(),
            counts,
        }
    }
}

/// The faces of a mesh of the plate whose normal points down.
fn turned_over(mesh: &Mesh) -> usize {
    mesh.faces().filter(|face| area_of(mesh, face) < 0.0).count()
}

/// Nothing but faults has changed, and there are none.
#[track_caller]
fn assert_mended(mended: &Untangled, faults: usize) {
    assert_eq!((mended.faults, mended.is_changed), ([faults, 0], true));
    let left = check(&mended.after);
    assert!(left.is_clean(), "{left}");
    assert_eq!((left.euler, left.boundary_loops), (1, 1));
}

#[track_caller]
fn assert_stays(grid: &Grid) {
    for quads in [Quads::Most, Quads::All] {
        let Untangled { is_changed, faults, counts, .. } = grid.untangled(quads);
        assert_eq!((is_changed, faults, counts), (false, [0, 0], EditCounts::default()));
    }
}

/// The sides of a face.
fn sides(face: &[u32]) -> Vec<[u32; 2]> {
    (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]).collect()
}

#[test]
fn two_triangles_are_cut_anew_unless_the_edge_between_them_is_a_feature() {
    let [a, b, c, d] = [at(2, 2), at(3, 2), at(3, 3), at(2, 3)];
    // One corner lies beyond the diagonal that the triangles share.
    let wrong = Grid::new().recut(&[[2, 2]], &[&[a, b, c], &[a, c, d]]).moved(d, [2.7, 2.3]);
    assert_eq!(turned_over(&wrong.mesh()), 1);
    let mended = wrong.untangled(Quads::Most);
    assert_mended(&mended, 1);
    assert!(!mended.has_edge([a, c]));
    assert_eq!(turned_over(&mended.after), 0);
    // A vertex beyond a feature cannot come back.
    let stays = wrong.with_features(&[[a, c]]).untangled(Quads::Most);
    assert_eq!((stays.faults, stays.has_edge([a, c])), ([1, 1], true));
}

#[test]
fn the_edge_between_two_quads_is_flipped_unless_it_is_a_feature() {
    let [a, b, c, d, e, f] = [at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(3, 3), at(2, 3)];
    // The edge between two squares leads elsewhere, so that each has a straight corner.
    let wrong = Grid::new().recut(&[[2, 2], [3, 2]], &[&[f, a, b, c], &[c, d, e, f]]);
    for quads in [Quads::Most, Quads::All] {
        let mended = wrong.untangled(quads);
        assert_mended(&mended, 2);
        assert!(mended.has_edge([b, e]) && !mended.has_edge([c, f]));
        assert!(mended.after.faces().all(|face| face.len() == 4));
        let otherwise = wrong.clone().with_features(&[[c, f]]).untangled(quads);
        assert_mended(&otherwise, 2);
        assert!(otherwise.has_edge([c, f]), "a feature stays");
    }
}

#[test]
fn a_face_whose_corners_all_lie_on_features_is_judged_like_any_other() {
    let [a, b, c, d] = [at(2, 2), at(3, 2), at(3, 3), at(2, 3)];
    // A quad with a reflex corner, all of its sides features.
    let mut grid = Grid::new().with_features(&sides(&[a, b, c, d]));
    grid.points[d as usize] = [2.8, 2.2];
    let square = [[2, 2]];
    let right = grid.clone().recut(&square, &[&[a, b, d], &[b, c, d]]);
    assert_stays(&right);
    let wrong = grid.recut(&square, &[&[a, b, c], &[a, c, d]]);
    assert_eq!(turned_over(&wrong.mesh()), 1);
    let mended = wrong.untangled_on(&right.surface(), Quads::Most);
    assert_mended(&mended, 1);
    assert!(mended.has_edge([b, d]) && sides(&[a, b, c, d]).into_iter().all(|side| mended.has_edge(side)));
}

#[test]
fn a_triangle_whose_corners_all_lie_on_one_straight_crease_is_taken_away() {
    let crease: Vec<[u32; 2]> = (0..SIDE).map(|i| [at(i, 5), at(i + 1, 5)]).collect();
    let flat = [at(4, 5), at(5, 5), at(6, 5)];
    let above: [&[u32]; 2] = [&[at(4, 5), at(6, 5), at(6, 6), at(5, 6)], &[at(4, 5), at(5, 6), at(4, 6)]];
    let come = [&flat[..], above[0], above[1]];
    let wrong = Grid::new().recut(&[[4, 5], [5, 5]], &come).with_features(&crease);
    let mended = wrong.untangled(Quads::Most);
    assert_mended(&mended, 1);
    // The crease is a chain of edges still.
    let on_crease = |v: u32| (mended.after.points[v as usize][1] - 5.0).abs() < 1e-5;
    let length = |[a, b]: [u32; 2]| mended.after.points[b as usize][0] - mended.after.points[a as usize][0];
    let chain =
        mended.after.edges().into_iter().map(|edge| edge.ends).filter(|ends| ends.iter().all(|&v| on_crease(v)));
    let total: f64 = chain.map(|ends| length(ends).abs()).sum();
    assert!((total - f64::from(SIDE)).abs() < 1e-5, "{total}");
    // Off the crease its middle corner gives it an area.
    let thin = Grid::new().recut(&[[4, 5], [5, 5]], &come).moved(flat[1], [5.0, 4.6]);
    assert_stays(&thin.with_features(&crease[..4]));
}

#[test]
fn a_quad_with_a_reflex_corner_becomes_two_triangles_from_there() {
    let square = [at(2, 2), at(3, 2), at(3, 3), at(2, 3)];
    let places = square.map(|v| Grid::new().points[v as usize]);
    // Each corner in turn is pushed over the diagonal of its neighbours; all sides are features.
    for k in 0..4 {
        let mut wrong = Grid::new().with_features(&sides(&square));
        let ([x, y], [u, v]) = (places[k], places[(k + 2) % 4]);
        wrong.points[square[k] as usize] = [x + 0.8 * (u - x), y + 0.8 * (v - y)];
        let mended = wrong.untangled(Quads::Most);
        assert_mended(&mended, 1);
        assert_eq!((mended.counts.split, mended.after.face_count()), (1, wrong.faces.len() + 1));
        assert!(mended.has_edge([square[k], square[(k + 2) % 4]]), "corner {k}");
        assert_stays(&Grid::new().with_features(&sides(&square)));
    }
}

#[test]
fn a_ring_about_the_opposite_corner_takes_a_straight_one_away() {
    let [low, high] = [2, 3].map(|j| move |i: u32| at(i, j));
    let straight = [low(2), low(3), low(4), high(2)];
    let others = [[high(2), low(4), high(4), high(3)], [low(4), low(5), high(5), high(4)]];
    let come: Vec<&[u32]> = std::iter::once(&straight[..]).chain(others.iter().map(|face| &face[..])).collect();
    let mut wrong = Grid::new().recut(&[[2, 2], [3, 2], [4, 2]], &come);
    wrong.points[high(3) as usize] = [3.0, 3.4];
    // Where nothing about it is a feature, an edge is flipped.
    assert_mended(&wrong.untangled(Quads::All), 1);
    assert_eq!(wrong.untangled(Quads::All).counts.strips_in, 0);
    // Where all sides are, nothing can be cut anew, and two triangles may not be.
    let wrong = wrong.with_features(&sides(&straight));
    let mended = wrong.untangled(Quads::All);
    assert_mended(&mended, 1);
    assert_eq!(mended.counts.strips_in, 1);
    let quads = mended.after.faces().map(|face| [0, 1, 2, 3].map(|k| mended.after.points[face[k] as usize]));
    assert!(quads.map(quad_shape).fold(1.0, f64::min) > 0.1);
    // Five edges meet at the corner, and five faces: each gets a vertex.
    assert_eq!(mended.origins.iter().filter(|&&origin| origin == u32::MAX).count(), 10);
    assert_eq!(mended.after.points.len(), wrong.points.len() + 10);
    assert!(mended.after.faces().all(|face| face.len() == 4));
    let split = wrong.untangled(Quads::Most);
    assert_eq!((split.counts.split, split.counts.triangles_after), (1, 2));
}

#[test]
fn a_mesh_without_faults_stays() {
    assert_stays(&Grid::new());
    assert_stays(&Grid::new().moved(at(3, 3), [3.3, 3.2]));
    assert_ne!(Grid::new().moved(at(3, 3), [4.3, 3.2]).untangled(Quads::Most).faults[0], 0);
}

#[test]
fn a_quad_whose_corners_lie_on_one_straight_feature_is_recut_with_the_faces_beside_it() {
    let [low, high]: [[u32; 4]; 2] = [2, 3].map(|y| [2, 3, 4, 5].map(|x| at(x, y)));
    let [b0, b1, b2, b3] = low;
    let [d0, d1, d2, d3] = high;
    let faces: [&[u32]; 5] = [&[d0, b0, b1], &[d0, b1, d3], &[d3, b1, b2], &[d3, b2, b3], &[d0, d3, d2, d1]];
    let wrong = Grid::new().recut(&[[2, 2], [3, 2], [4, 2]], &faces).with_features(&[[d0, d1], [d1, d2], [d2, d3]]);
    let mended = wrong.untangled(Quads::Most);
    assert_mended(&mended, 1);
    assert!(!mended.has_edge([d0, d3]), "the edge beside the feature is gone");
    assert!([[d0, d1], [d1, d2], [d2, d3]].into_iter().all(|ends| mended.has_edge(ends)), "the feature stays");
}
