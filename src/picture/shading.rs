//! Faces in the light.

use super::Colour;
use super::raster::Sight;
use super::scene::Face;
use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};

/// The colour of a face in the light, at a place of it or as a whole.
pub(super) fn shaded(sight: &Sight, face: &Face, place: Option<DVec2>) -> Colour {
    let corners = sight.scene.corners_of(face);
    let outline = sight.outline(face).map(|corner| corner.xy());
    let front = sight.is_front(face);
    let even = corners.iter().all(|corner| corner.normal == corners[0].normal);
    let normal = match place {
        _ if even => corners[0].normal,
        None => corners.iter().map(|corner| corner.normal).sum::<Vec3>(),
        Some(place) => {
            let places: Vec<DVec2> = outline.collect();
            // Of the triangles of the fan the one that the place is in, or least outside of.
            let shares = (1..places.len() - 1).map(|k| (k, shares([places[0], places[k], places[k + 1]], place)));
            let best = shares.max_by(|a, b| a.1.min_element().total_cmp(&b.1.min_element()));
            best.map_or(Vec3::ZERO, |(k, share)| {
                let share = share.as_vec3();
                corners[0].normal * share.x + corners[k].normal * share.y + corners[k + 1].normal * share.z
            })
        }
    };
    let seen = sight.camera.seen(normal.as_dvec3()).normalize_or_zero() * if front { 1.0 } else { -1.0 };
    // Where colours mean something, they are not to be changed much.
    let contrast = if sight.scene.legend.is_some() { 0.5 } else { 1.0 };
    let light = 1.0 - contrast * (1.0 - light(seen));
    if front { face.colour.lit(light) } else { Colour::BACK.lit(0.9 * light) }
}

/// The light on a surface with this normal as seen: a lamp above the left shoulder, and the sky.
fn light(normal: DVec3) -> f32 {
    let lamp = DVec3::new(-0.35, 0.5, 1.0).normalize();
    let direct = normal.dot(lamp).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    (0.4 + 0.6 * direct + 0.1 * sky).min(1.0) as f32
}

/// The shares of a triangle's corners in a place.
fn shares([a, b, c]: [DVec2; 3], p: DVec2) -> DVec3 {
    let whole = (b - a).perp_dot(c - a);
    if whole == 0.0 {
        return DVec3::new(f64::NEG_INFINITY, 0.0, 0.0);
    }
    DVec3::new((c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)) / whole
}
