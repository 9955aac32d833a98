//! From where a scene is seen.

use super::{PictureError, SIDE, Scene};
use glam::{DMat3, DVec2, DVec3};
use std::str::FromStr;
use thiserror::Error;

/// Where the eye is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Eye {
    /// Before the broad side of the model, a little above and to the right.
    #[default]
    ThreeQuarter,
    /// In this direction from the model, far away.
    At([f64; 3]),
}

/// A name that is no view's.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{name:?} is no view; write a direction from the model to the eye, X,Y,Z, or one of {}", Eye::NAMES.map(|name| name.0).join(", "))]
pub struct UnknownEye {
    /// The name that was given.
    pub name: String,
}

impl Eye {
    /// The views with a name: z is up, and x is to the right seen from the front.
    const NAMES: [(&str, Self); 7] = [
        ("three-quarter", Self::ThreeQuarter),
        ("front", Self::At([0.0, -1.0, 0.0])),
        ("back", Self::At([0.0, 1.0, 0.0])),
        ("left", Self::At([-1.0, 0.0, 0.0])),
        ("right", Self::At([1.0, 0.0, 0.0])),
        ("top", Self::At([0.0, 0.0, 1.0])),
        ("bottom", Self::At([0.0, 0.0, -1.0])),
    ];
}

/// The views with a name, for a bounding box of this extent: right, up and the direction to the eye.
#[cfg(feature = "page")]
pub(crate) fn named_turns(extent: [f64; 3]) -> Vec<(&'static str, [[f64; 3]; 3])> {
    let rows = |eye: Eye| {
        let turn = turn(&View { eye, ..View::default() }, extent.into()).ok()?.transpose();
        Some([turn.x_axis, turn.y_axis, turn.z_axis].map(Into::into))
    };
    Eye::NAMES.iter().filter_map(|&(name, eye)| Some((name, rows(eye)?))).collect()
}

impl FromStr for Eye {
    type Err = UnknownEye;

    /// A name, or a direction: `X,Y,Z`.
    fn from_str(text: &str) -> Result<Self, UnknownEye> {
        if let Some(known) = Self::NAMES.iter().find(|known| known.0 == text) {
            return Ok(known.1);
        }
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        let direction = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
        direction.map(Self::At).ok_or_else(|| UnknownEye { name: text.to_owned() })
    }
}

/// From where a scene is seen, and how much of it. Parallel lines stay parallel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// Where the eye is.
    pub eye: Eye,
    /// What is up in the picture. Default `None`: z, or y where the eye looks along z; of the three-quarter view, the shorter
    /// side of the model's bounding box as seen from there.
    pub up: Option<[f64; 3]>,
    /// Centre and radius of the ball that is to fill the picture, in model units. Default `None`: all that there is.
    pub zoom: Option<([f64; 3], f64)>,
}

/// The share of the picture that is left free at each side.
const MARGIN: f64 = 0.04;

/// A view of a scene, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    /// From model units to right, up and towards the eye.
    turn: DMat3,
    centre: DVec3,
    /// Pixels a model unit.
    scale: f64,
    pub size: [u32; 2],
}

impl Camera {
    pub fn new(scene: &Scene, view: &View, size: [u32; 2]) -> Result<Self, PictureError> {
        let [width, height] = size;
        if !size.iter().all(|side| SIDE.contains(side)) {
            return Err(PictureError::Size { width, height });
        }
        let places = || scene.points.iter().copied().chain(scene.lines.iter().flat_map(|line| line.ends));
        let low = places().fold(DVec3::INFINITY, DVec3::min);
        let high = places().fold(DVec3::NEG_INFINITY, DVec3::max);
        if !low.is_finite() || !high.is_finite() {
            return Err(PictureError::Empty);
        }
        let turn = turn(view, high - low)?;
        let half = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
        let (centre, scale) = match view.zoom {
            Some((_, radius)) if !(radius > 0.0 && radius.is_finite()) => return Err(PictureError::Radius { radius }),
            Some((centre, radius)) => (DVec3::from(centre), half.min_element() / radius),
            None => {
                let seen = || places().map(|place| turn * (place - low));
                let least = seen().fold(DVec3::INFINITY, DVec3::min);
                let most = seen().fold(DVec3::NEG_INFINITY, DVec3::max);
                let scale = (half * (1.0 - 2.0 * MARGIN) / ((most - least).truncate() / 2.0)).min_element();
                let whole = if scale.is_finite() { scale } else { 1.0 };
                (low + turn.transpose() * ((least + most) / 2.0), whole)
            }
        };
        Ok(Self { turn, centre, scale, size })
    }

    /// Where a point is in the picture: pixels from the left, pixels from the top, pixels towards the eye.
    pub fn project(&self, point: DVec3) -> DVec3 {
        let seen = self.turn * (point - self.centre) * self.scale;
        DVec3::new(f64::from(self.size[0]) / 2.0 + seen.x, f64::from(self.size[1]) / 2.0 - seen.y, seen.z)
    }

    /// A direction as it is seen: to the right, up, and towards the eye.
    pub fn seen(&self, direction: DVec3) -> DVec3 {
        self.turn * direction
    }
}

/// The turn that brings right, up and the direction to the eye to the axes.
fn turn(view: &View, extent: DVec3) -> Result<DMat3, PictureError> {
    let (eye, up) = match view.eye {
        Eye::At(direction) => {
            let along_z = direction[0].abs() + direction[1].abs() < 1e-6 * direction[2].abs();
            (DVec3::from(direction), if along_z { DVec3::Y } else { DVec3::Z })
        }
        Eye::ThreeQuarter => three_quarter(extent),
    };
    let up = view.up.map_or(up, DVec3::from);
    let unit = |way: DVec3| {
        let unit = way.try_normalize().filter(|unit| unit.is_finite());
        unit.ok_or(PictureError::Direction { direction: way.into() })
    };
    let (eye, up) = (unit(eye)?, unit(up)?);
    let right = up.cross(eye);
    if right.length() < 1e-6 {
        return Err(PictureError::Up { up: up.into() });
    }
    let right = right.normalize();
    Ok(DMat3::from_cols(right, eye.cross(right), eye).transpose())
}

/// The direction to the eye, and up, for a bounding box: mostly along its shortest side, the longest one running across.
fn three_quarter(extent: DVec3) -> (DVec3, DVec3) {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut order = [0, 1, 2];
    // Of equal sides z is up and x runs across.
    order.sort_by(|&a, &b| extent[a].total_cmp(&extent[b]).then([2, 0, 1][a].cmp(&[2, 0, 1][b])));
    let (depth, up, across) = match order {
        [thin, middle, long] if extent[thin] < 0.7 * extent[long] => (axes[thin], axes[middle], axes[long]),
        _ => (-DVec3::Y, DVec3::Z, DVec3::X),
    };
    // Seen in a mirror the picture would be as good, but left and right are to be kept.
    let right = up.cross(depth);
    // A flat model shows its face; seen aslant, it would lie aslant in the picture.
    let tilt = 0.25 + 0.5 * extent.min_element() / extent.max_element();
    (depth + tilt * (0.9 * right.dot(across).signum() * across + 0.8 * up), up)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(view: View) -> Result<Camera, PictureError> {
        let mut scene = Scene::default();
        scene.place([[0.0; 3], [4.0, 2.0, 1.0]]);
        Camera::new(&scene, &view, [400, 200])
    }

    #[test]
    fn named_views_show_the_axes_where_drawings_have_them() {
        for (name, right, up) in
            [("front", DVec3::X, DVec3::Z), ("right", DVec3::Y, DVec3::Z), ("top", DVec3::X, DVec3::Y)]
        {
            let view = View { eye: name.parse().expect("a name"), ..View::default() };
            let camera = camera(view).unwrap_or_else(|error| panic!("{error}"));
            assert!(camera.seen(right).abs_diff_eq(DVec3::X, 1e-12), "{name}");
            assert!(camera.seen(up).abs_diff_eq(DVec3::Y, 1e-12), "{name}");
        }
    }

    #[test]
    fn a_scene_fills_the_picture_up_to_its_margin() {
        let camera =
            camera(View { eye: Eye::At([0.0, 0.0, 1.0]), ..View::default() }).unwrap_or_else(|e| panic!("{e}"));
        let [low, high] = [[0.0; 3], [4.0, 2.0, 1.0]].map(|p| camera.project(p.into()));
        assert!(low.abs_diff_eq(DVec3::new(16.0, 192.0, low.z), 1e-9), "{low}");
        assert!(high.abs_diff_eq(DVec3::new(384.0, 8.0, high.z), 1e-9), "{high}");
        assert!(high.z > low.z, "nearer to the eye");
    }

    #[test]
    fn a_ball_that_is_zoomed_to_touches_the_nearer_sides() {
        let zoom = Some(([1.0, 1.0, 0.5], 0.25));
        let camera = camera(View { eye: Eye::At([0.0, 0.0, 2.0]), zoom, up: None }).unwrap_or_else(|e| panic!("{e}"));
        assert!(camera.project(DVec3::new(1.0, 1.25, 0.5)).abs_diff_eq(DVec3::new(200.0, 0.0, 0.0), 1e-9));
    }

    #[test]
    fn what_shows_nothing_is_refused() {
        let at = |eye, up| camera(View { eye: Eye::At(eye), up, zoom: None });
        assert!(matches!(at([0.0; 3], None), Err(PictureError::Direction { .. })));
        assert!(matches!(at([1.0, 0.0, 0.0], Some([-2.0, 0.0, 0.0])), Err(PictureError::Up { .. })));
        assert!(matches!(at([1.0, f64::NAN, 0.0], None), Err(PictureError::Direction { .. })));
        let zoom = |radius| camera(View { zoom: Some(([0.0; 3], radius)), ..View::default() });
        assert!(matches!(zoom(0.0), Err(PictureError::Radius { .. })));
        assert!(matches!(Camera::new(&Scene::default(), &View::default(), [99; 2]), Err(PictureError::Empty)));
        assert!("sideways".parse::<Eye>().is_err());
        assert_eq!("1, 2,-3".parse(), Ok(Eye::At([1.0, 2.0, -3.0])));
    }
}
