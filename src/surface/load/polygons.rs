//! What files hold: polygons on numbered vertices, before they are split into triangles.

use super::super::{Attributes, Regions, Soup, polygon};
use super::Fault;
use glam::DVec3;

/// More corners of a face than are plausible: splitting the most intricate polygons takes their square in time.
const MOST_CORNERS: usize = 20_000;

/// Whether a face may have so many corners.
pub(super) fn check_corners(count: usize) -> Result<(), Fault> {
    match count {
        0..3 => Err(Fault::TooFewIndices { count }),
        3..=MOST_CORNERS => Ok(()),
        _ => Err(Fault::TooManyIndices { count, most: MOST_CORNERS }),
    }
}

/// Vertices in the order of the file, and faces of three or more of them.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    /// Vertex positions. Those that no face uses may be anything.
    pub points: Vec<[f64; 3]>,
    /// Vertex indices of all faces, one face after the other.
    pub corners: Vec<u32>,
    /// Where each face ends in `corners`.
    pub ends: Vec<u32>,
    /// Which named part each face belongs to.
    pub regions: Regions,
    /// Numbers of vertices or of `corners`.
    pub attributes: Attributes,
}

impl Polygons {
    /// The vertices of each face.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let starts = [0].iter().chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.corners[start as usize..end as usize])
    }

    /// Makes a face of the corners that were pushed since the last.
    pub fn end_face(&mut self) -> Result<(), Fault> {
        let end = self.corners.len() as u32;
        check_corners((end - self.ends.last().copied().unwrap_or(0)) as usize)?;
        self.ends.push(end);
        Ok(())
    }

    /// Adds the triangles of a strip: every vertex after the second makes one with the two before it, every other turned over.
    /// Triangles that use a vertex twice, which join strips, are left out.
    pub fn push_strip(&mut self, strip: &[u32]) -> Result<(), Fault> {
        self.check_room(3 * strip.len())?;
        for (place, corners) in strip.windows(3).enumerate() {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            if a != b && b != c && c != a {
                self.corners.extend(if place % 2 == 0 { [a, b, c] } else { [b, a, c] });
                self.ends.push(self.corners.len() as u32);
            }
        }
        Ok(())
    }

    /// Whether so many more corners can be counted in 32 bits. Faces that a file writes corner by corner always can.
    pub fn check_room(&self, more: usize) -> Result<(), Fault> {
        match u32::try_from(self.corners.len() + more) {
            Ok(_) => Ok(()),
            Err(_) => Err(Fault::TooManyCorners),
        }
    }

    /// The first vertex that a face uses and that has no place in space.
    pub fn nowhere(&self) -> Option<usize> {
        let finite = |point: &[f64; 3]| point.iter().all(|coordinate| coordinate.is_finite());
        if self.points.iter().all(finite) {
            return None;
        }
        self.corners.iter().map(|&vertex| vertex as usize).filter(|&vertex| !finite(&self.points[vertex])).min()
    }

    /// The triangles, polygons split by ear clipping.
    pub fn into_soup(mut self) -> Soup {
        if self.ends.iter().zip(1..).all(|(&end, face)| end == 3 * face) {
            let triangles = self.corners.as_chunks().0.to_vec();
            return Soup { points: self.points, triangles, regions: self.regions, attributes: self.attributes };
        }
        let mut triangles = Vec::with_capacity(self.corners.len());
        // The face of each triangle.
        let mut sources = Vec::with_capacity(self.corners.len());
        // The place of each triangle's corners in `corners`.
        let mut places = Vec::new();
        let has_places = self.attributes.list.iter().any(|attribute| !attribute.of_corners.is_empty());
        let mut start = 0;
        for (face, number) in self.faces().zip(0..) {
            if let &[a, b, c] = face {
                triangles.push([a, b, c]);
                if has_places {
                    places.push([start, start + 1, start + 2]);
                }
            } else {
                let corners: Vec<_> =
                    face.iter().map(|&index| DVec3::from_array(self.points[index as usize])).collect();
                let ears = polygon::triangulate(&corners);
                triangles.extend(ears.iter().map(|ear| ear.map(|place| face[place])));
                if has_places {
                    places.extend(ears.iter().map(|ear| ear.map(|place| start + place)));
                }
            }
            start += face.len();
            sources.resize(triangles.len(), number);
        }
        for attribute in self.attributes.list.iter_mut().filter(|attribute| !attribute.of_corners.is_empty()) {
            attribute.of_corners = places.as_flattened().iter().map(|&place| attribute.of_corners[place]).collect();
        }
        let regions = self.regions.of(&sources);
        Soup { points: self.points, triangles, regions, attributes: self.attributes }
    }
}
