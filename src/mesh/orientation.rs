//! The test for inverted faces.
//!
//! # Theory
//! A face is inverted where its normal points against the sheet that it lies on: the triangle of the surface nearest to its
//! middle. Several triangles can be equally near, beside an edge: none of them may oppose the face. A wall perpendicular to the
//! face does not count as one that does, nor do two sheets that lie on each other, at one place; a face that has such a wall nearest
//! to it is mended all the same, as roundings decide how it is judged. No search is needed where the sheets at all corners are known and agree, which is the usual case. A
//! surface that was smoothed or coarsened differs from the given one, whose triangles decide in the end.
//!
//! # Practice
//! Give the triangles at the corners where they are known: this is faster, and it decides on parts thinner than a face, where
//! the nearest sheet can be the opposite one.

use super::sheet_tree::{NearestSheets, SheetTree, Standing};
use super::vertex::walked;
use crate::geometry::cells_around;
use crate::surface::nearest::Triangles;
use crate::surface::{NONE, Surface};
use glam::{DVec3, IVec3};
use rustc_hash::FxHashSet;
use std::iter::zip;

/// The cosine of the largest angle between a face and the sheets at its corners that needs no search: 60 degrees.
const AGREEMENT: f64 = 0.5;

/// The orientation of a surface, with a tree of its triangles.
pub(crate) struct Orientation<'a> {
    surface: &'a Surface,
    sheets: SheetTree<'a>,
    /// The triangles as they were given, and how far the surface may be from them, from [`Self::regard_given`] on; `None` too where
    /// they are those of the surface.
    given: Option<(SheetTree<'a>, f64)>,
    /// Where the nearest triangles decide, whatever sheets are known at the corners of a face: cubes of a grid.
    nearest_decide: FxHashSet<IVec3>,
    /// The side of the cubes.
    side: f64,
}

impl<'a> Orientation<'a> {
    pub(crate) fn new(surface: &'a Surface) -> Self {
        let sheets = SheetTree::new(&surface.points, &surface.triangles);
        Self { surface, sheets, given: None, nearest_decide: FxHashSet::default(), side: 1.0 }
    }

    /// From now on the given triangles count where the nearest ones decide.
    pub(crate) fn regard_given(&mut self) {
        if self.given.is_none() {
            let given = self.surface.as_given();
            self.given = given.map(|given| (SheetTree::new(&given.points, &given.triangles), given.off));
        }
    }

    /// From now on, for faces whose middles are within `distance` of one of these points, and some that are farther, the nearest
    /// triangles decide, whatever sheets are known at their corners; for no others.
    pub(crate) fn let_nearest_decide(&mut self, about: impl Iterator<Item = DVec3>, distance: f64) {
        self.side = distance.max(f64::MIN_POSITIVE);
        self.nearest_decide = about.flat_map(|point| cells_around(self.cube(point))).collect();
    }

    fn cube(&self, point: DVec3) -> IVec3 {
        (point / self.side).floor().as_ivec3()
    }

    /// Whether the nearest triangles decide for faces with this middle.
    pub(crate) fn nearest_decide_at(&self, point: DVec3) -> bool {
        !self.nearest_decide.is_empty() && self.nearest_decide.contains(&self.cube(point))
    }

    /// The tree of the surface's triangles.
    pub(crate) fn triangles(&self) -> &Triangles {
        self.sheets.triangles()
    }

    /// Whether a face with these corners, counter-clockwise and unit-sized, is inverted. `sheets` names the triangles of the
    /// surface on the two sides of each corner, [`NONE`] where they are unknown.
    pub(crate) fn is_inverted(&self, corners: &[DVec3], sheets: impl Iterator<Item = [u32; 2]> + Clone) -> bool {
        let (normal, middle) = (normal(corners), middle(corners));
        // A face that is removed or has no area opposes nothing; a search from the centre of a ball would look at all of its triangles.
        if normal == DVec3::ZERO {
            return false;
        }
        if self.nearest_decide_at(middle) {
            return self.standing(corners, sheets) != Standing::Along;
        }
        !self.agrees(normal, sheets.clone())
            && self.sheets.standing(normal, middle, self.distance_from(corners, middle, sheets)) == Standing::Against
    }

    /// How a face stands on the triangles nearest to its middle: of the given ones, once they are regarded, or of the surface.
    pub(crate) fn standing(&self, corners: &[DVec3], sheets: impl Iterator<Item = [u32; 2]>) -> Standing {
        let (normal, middle) = (normal(corners), middle(corners));
        let distance = self.distance_from(corners, middle, sheets);
        match &self.given {
            Some((given, off)) => given.standing(normal, middle, distance + off),
            None => self.sheets.standing(normal, middle, distance),
        }
    }

    /// An upper bound of the distance of the surface from the middle of a face: that of the end of a walk from a corner whose sheet
    /// is known.
    fn distance_from(&self, corners: &[DVec3], middle: DVec3, sheets: impl Iterator<Item = [u32; 2]>) -> f64 {
        let inside = zip(corners, sheets).find(|(_, [a, b])| *a != NONE && a == b);
        match inside {
            Some((&corner, [triangle, _])) => walked(self.surface, triangle, corner, middle).point.distance(middle),
            None => self.triangles().nearest(middle).1,
        }
    }

    /// Whether a sheet is known at a corner of a face, and all known sheets agree with its normal.
    fn agrees(&self, normal: DVec3, sheets: impl Iterator<Item = [u32; 2]>) -> bool {
        let least = AGREEMENT * normal.length();
        let of = |triangle: u32| self.surface.normal(triangle as usize).as_dvec3();
        // The two sides of an edge sharper than a right angle decide nothing.
        let is_known = |[a, b]: &[u32; 2]| *a != NONE && (a == b || of(*a).dot(of(*b)) > 0.0);
        let mut known = sheets.filter(is_known).peekable();
        known.peek().is_some() && known.all(|sides| sides.iter().any(|&side| of(side).dot(normal) > least))
    }

    /// Compares the normal of a face, of any length, with the triangles nearest to its middle.
    pub(crate) fn nearest_sheets(&self, normal: DVec3, middle: DVec3) -> NearestSheets {
        self.sheets.nearest_to(normal, middle)
    }
}

/// Twice the vector area of a polygon.
pub(crate) fn normal(corners: &[DVec3]) -> DVec3 {
    let first = corners.first().copied().unwrap_or_default();
    corners.windows(2).skip(1).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// The mean of the corners of a polygon.
pub(crate) fn middle(corners: &[DVec3]) -> DVec3 {
    corners.iter().sum::<DVec3>() / corners.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};
    use glam::{DQuat, EulerRot, Vec3};

    fn surface(points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Surface {
        Surface::new(&Soup { points, triangles, ..Soup::default() }, &FeatureOptions::default()).unwrap()
    }

    /// Two squares of side 1, the lower one looking down, the upper one up, so far apart.
    fn sheets(apart: f64) -> Surface {
        let square = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        surface([square(0.0), square(apart)].concat(), vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]])
    }

    fn unknown() -> impl Iterator<Item = [u32; 2]> + Clone {
        [[NONE; 2]; 3].into_iter()
    }

    #[test]
    fn the_nearest_sheet_decides_unless_all_corners_agree() {
        let surface = sheets(0.1);
        let orientation = Orientation::new(&surface);
        let at = |[x, y, z]: [f64; 3]| DVec3::from(surface.frame().to_unit([x, y, z]));
        // Counter-clockwise from above, two corners on the upper sheet and one on the lower.
        let up = [at([0.4, 0.4, 0.1]), at([0.6, 0.4, 0.1]), at([0.5, 0.6, 0.0])];
        let down = [up[0], up[2], up[1]];
        assert!(!orientation.is_inverted(&up, unknown()));
        assert!(orientation.is_inverted(&down, unknown()));
        let low = down.map(|corner| corner - DVec3::Z * (at([0.0, 0.0, 0.1]) - at([0.0; 3])).z * 0.5);
        assert!(!orientation.is_inverted(&low, unknown()), "the lower sheet is nearer");
        assert!(!orientation.is_inverted(&down, [[0; 2]; 3].into_iter()), "all corners lie on the lower sheet");
        assert!(orientation.is_inverted(&down, [[0; 2], [0; 2], [2; 2]].into_iter()));
        let double = sheets(1e-6);
        let orientation = Orientation::new(&double);
        let flat = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]].map(|[x, y]| DVec3::from(double.frame().to_unit([x, y, 0.0])));
        assert!(!orientation.is_inverted(&flat, unknown()), "both sheets are equally near");
        assert!(!orientation.is_inverted(&[flat[0], flat[2], flat[1]], unknown()));
        // In the middle of a wall both of its sides are equally near, at two places.
        let between = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]];
        let between = between.map(|[x, y]| DVec3::from(surface.frame().to_unit([x, y, 0.05])));
        let orientation = Orientation::new(&surface);
        assert!(orientation.is_inverted(&between, unknown()));
        assert!(orientation.is_inverted(&[between[0], between[2], between[1]], unknown()));
    }

    #[test]
    fn the_given_triangles_decide_once_they_are_regarded() {
        let surface = sheets(0.1);
        let at = |[x, y]: [f64; 2]| DVec3::from(surface.frame().to_unit([x, y, 0.1]));
        let face = [at([0.4, 0.4]), at([0.6, 0.4]), at([0.5, 0.6])];
        let turned: Vec<[u32; 3]> = surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let mut regarded = Orientation::new(&surface);
        regarded.regard_given();
        assert!(regarded.standing(&face, unknown()) == Standing::Along, "the surface is as it was given");
        let off = 1e-3;
        // Also farther than the surface may be from them.
        for apart in [0.0, 0.5 * off, 2.0 * off] {
            let points: Vec<Vec3> = surface.points.iter().map(|&p| p + Vec3::Z * apart as f32).collect();
            let given = Some((SheetTree::new(&points, &turned), off));
            let orientation = Orientation { given, ..Orientation::new(&surface) };
            assert!(orientation.standing(&face, unknown()) == Standing::Against, "{apart}");
        }
    }

    /// A floor that looks up, and a wall below its edge at x = 1 that looks along x.
    fn floor_and_wall() -> Surface {
        let points =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0]];
        surface(points.to_vec(), vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    }

    #[test]
    fn a_face_across_a_step_stands_perpendicular_on_its_wall_and_is_to_be_mended() {
        // The wall at x = 0 looks against x; the floor before it is lower than the one behind. Turned, its normal has roundings.
        for (height, turn) in [(0.1, DQuat::IDENTITY), (0.01, DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1))] {
            let low = [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
            let high = [[0.0, 0.0, height], [1.0, 0.0, height], [1.0, 1.0, height], [0.0, 1.0, height]];
            let points = [low, high].concat().into_iter().map(|p| (turn * DVec3::from(p)).to_array()).collect();
            let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 4, 7], [1, 7, 2], [4, 5, 6], [4, 6, 7]];
            let surface = surface(points, triangles);
            let mut orientation = Orientation::new(&surface);
            let at = |p: DVec3| DVec3::from(surface.frame().to_unit((turn * p).to_array()));
            let face = |shift: f64, rise: f64| {
                let corner = |x: f64, y: f64| at(DVec3::new(x + shift, y, height / 2.0 + rise * x));
                [corner(-0.2, 0.4), corner(0.2, 0.4), corner(0.2, 0.6), corner(-0.2, 0.6)]
            };
            let standing = |face: [DVec3; 4]| orientation.standing(&face, unknown());
            assert_eq!(standing(face(0.0, 0.0)), Standing::Perpendicular, "{height}");
            assert_eq!(standing(face(0.0, 0.1)), Standing::Along, "{height}");
            assert_eq!(standing(face(0.0, -0.1)), Standing::Against, "{height}");
            assert_eq!(standing(face(0.1, 0.0)), Standing::Along, "{height}: the upper floor is nearer");
            assert_eq!(standing([at(DVec3::Z * height / 2.0); 4]), Standing::Along, "a face without area");
            assert!(!orientation.is_inverted(&face(0.0, 0.0), unknown()));
            orientation.let_nearest_decide([at(DVec3::Y / 2.0)].into_iter(), 0.1);
            assert!(orientation.is_inverted(&face(0.0, 0.0), unknown()));
            assert!(!orientation.is_inverted(&face(0.1, 0.0), unknown()));
        }
    }

    #[test]
    fn beside_an_edge_no_nearest_triangle_may_oppose_a_face() {
        // The wall below the floor's edge leans outwards, stands perpendicular, or leans inwards under the floor.
        let wall = |x: f64| {
            let points =
                [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [x, 0.0, -1.0], [x, 1.0, -1.0]];
            surface(points.to_vec(), vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
        };
        for (foot, standing) in [(1.3, Standing::Along), (1.0, Standing::Perpendicular), (0.7, Standing::Against)] {
            let surface = wall(foot);
            let mut orientation = Orientation::new(&surface);
            let at = |x: f64, y: f64| DVec3::from(surface.frame().to_unit([x, y, 0.0]));
            // Its middle lies beyond the edge, which is nearest.
            let face = [at(0.9, 0.3), at(1.3, 0.3), at(1.3, 0.6), at(0.9, 0.6)];
            assert!(!orientation.is_inverted(&face, [[0; 2]; 4].into_iter()), "its corners are on the floor");
            orientation.let_nearest_decide([at(0.1, 0.3)].into_iter(), 0.1);
            assert!(!orientation.is_inverted(&face, [[0; 2]; 4].into_iter()), "its middle is far from there");
            orientation.let_nearest_decide([middle(&face)].into_iter(), 0.1);
            assert_eq!(orientation.standing(&face, [[0; 2]; 4].into_iter()), standing, "the foot at {foot}");
            let is_inverted = standing != Standing::Along;
            assert_eq!(orientation.is_inverted(&face, [[0; 2]; 4].into_iter()), is_inverted, "the foot at {foot}");
        }
    }

    #[test]
    fn a_face_whose_corners_all_lie_on_a_rim_is_judged_by_its_own_sheet_and_not_by_the_wall() {
        let surface = floor_and_wall();
        let orientation = Orientation::new(&surface);
        let at = |x: f64, y: f64| DVec3::from(surface.frame().to_unit([x, y, 0.0]));
        // A triangle beyond the rim: floor and wall are equally near to it.
        let down = [at(1.0, 0.2), at(1.1, 0.5), at(1.0, 0.8)].map(|p| p);
        let up = [down[0], down[2], down[1]];
        let rim = [[0, 2], [0, 2], [1, 3]];
        assert_ne!(orientation.is_inverted(&down, rim.into_iter()), orientation.is_inverted(&up, rim.into_iter()));
        assert!(!orientation.is_inverted(&down, rim.into_iter()), "counter-clockwise from above");
    }
}
