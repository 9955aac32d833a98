//! Seams of texture coordinates: edges whose two triangles have different coordinates at the same vertex.

use super::attributes::{Attribute, AttributeKind};
use super::given::SAME;
use super::{Frame, NONE, Soup};
use glam::{DVec3, Vec3};

/// The half-edges on seams of welded triangles, of which `sources` gives the triangles of the soup.
pub(super) fn seams(
    soup: &Soup,
    sources: &[u32],
    triangles: &[[u32; 3]],
    twins: &[u32],
    points: &[Vec3],
    frame: &Frame,
) -> Vec<u32> {
    let textures: Vec<&Attribute> =
        soup.attributes.list.iter().filter(|attribute| attribute.kind == AttributeKind::Texture).collect();
    if textures.is_empty() {
        return Vec::new();
    }
    // The corner of the triangle's source that lies at a vertex. Orientation may have exchanged corners.
    let corner_at = |triangle: u32, vertex: u32| {
        let source = sources[triangle as usize] as usize;
        let place = points[vertex as usize].as_dvec3();
        let distance = |&k: &usize| {
            let given = soup.points[soup.triangles[source][k] as usize];
            DVec3::from(frame.to_unit(given)).distance(place)
        };
        let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(&nearest) <= SAME).then(|| (3 * source + nearest, soup.triangles[source][nearest]))
    };
    let differs = |&h: &u32| {
        let twin = twins[h as usize];
        let [t, k] = [h / 3, h % 3];
        twin != NONE
            && [k, (k + 1) % 3].into_iter().any(|k| {
                let vertex = triangles[t as usize][k as usize];
                let [here, there] = [t, twin / 3].map(|t| corner_at(t, vertex));
                here.zip(there).is_some_and(|((a, v), (b, w))| {
                    textures.iter().any(|texture| texture.at_corner(a, v) != texture.at_corner(b, w))
                })
            })
    };
    (0..3 * triangles.len() as u32).filter(differs).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Surface};

    /// A flat square of two triangles; the texture coordinates of the second one's corners are those of the vertices, shifted.
    fn square(shift: f64) -> Soup {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let pairs = [[0, 1, 2], [0, 2, 3]];
        let values = pairs.iter().flatten().enumerate().flat_map(|(corner, &v): (usize, &u32)| {
            let [x, y, _] = points[v as usize];
            [x + if corner < 3 { 0.0 } else { shift }, y]
        });
        let values: Vec<f64> = values.collect();
        let texture =
            Attribute { of_corners: (0..6).collect(), ..Attribute::of_vertices("", AttributeKind::Texture, 2, values) };
        let mut soup = Soup { points, triangles: pairs.to_vec(), ..Soup::default() };
        soup.attributes.list.push(texture);
        soup
    }

    #[test]
    fn an_edge_with_two_values_is_a_feature_where_that_is_asked_for() {
        for (shift, is_asked_for, curves) in [(2.0, true, 5), (0.0, true, 4), (2.0, false, 4)] {
            let options = FeatureOptions { texture_seams: is_asked_for, ..FeatureOptions::default() };
            let surface = Surface::new(&square(shift), &options).expect("a surface");
            assert_eq!(surface.features().curves().len(), curves, "{shift} {is_asked_for}");
        }
    }
}
