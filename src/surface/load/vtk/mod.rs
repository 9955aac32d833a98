//! VTK, legacy and XML (VTU, VTP): cells that are faces, with an integer array of cells as regions, and arrays of points.
//!
//! Triangles, quads, pixels, polygons and strips are faces; of those of higher order the corners are taken. Points, lines and
//! volumes are passed over. Field data that is two integers, a number and 2, is the name of the region of that number, as `meshio`
//! has it: 2 is the dimension.
//!
//! The crate `vtkio` was looked at: its last release (0.6.3) is of 2021, followed by release candidates, and its errors have no
//! places. XML is read by `quick-xml`.
//!
//! Source: the VTK file formats, sections "Simple legacy formats" and "XML file formats".

pub(super) mod legacy;
mod payload;
pub(super) mod xml;

use super::cursor::{Encoding, Type};
use super::{Fault, LoadError, Place, Polygons, Regions};
use crate::surface::attributes::{Attribute, AttributeKind, Attributes};
use crate::surface::regions::{Numbers, attribute_rank};
use rustc_hash::FxHashMap;

/// VTK's types of cells that all cells of a section have.
const VERTEX: u8 = 2;
const LINE: u8 = 4;
const STRIP: u8 = 6;
const POLYGON: u8 = 7;

/// Cells in the order of the file: vertices, and where each cell ends in them.
#[derive(Default)]
struct Cells {
    corners: Vec<u32>,
    ends: Vec<usize>,
}

impl Cells {
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = [0].iter().chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.corners[start..end])
    }

    /// Cells of these vertices that end where these numbers say: as many as cells, or one more at the beginning, which is 0.
    fn new(corners: Vec<u32>, ends: &[f64]) -> Result<Self, Fault> {
        let mut last = 0;
        let ends = ends.iter().map(|&end| {
            if !(last as f64..=corners.len() as f64).contains(&end) || end.fract() != 0.0 {
                return Err(Fault::NoCellEnd { end, last, numbers: corners.len() });
            }
            last = end as usize;
            Ok(last)
        });
        let ends = ends.collect::<Result<_, _>>()?;
        Ok(Self { corners, ends })
    }
}

/// An array of integers of cells that tells regions.
struct RegionArray {
    rank: usize,
    name: String,
    /// NaN for cells without a number.
    numbers: Vec<f64>,
}

impl RegionArray {
    /// The rank of an array by its name, type and number of components, if it may tell regions.
    fn rank(name: &str, kind: Type, components: usize) -> Option<usize> {
        attribute_rank(name).filter(|_| kind.is_integer() && components == 1)
    }
}

/// What an array of points is, by its name, type and number of components; `None` for integers that are no colours.
fn attribute_kind(name: &str, kind: Type, components: usize) -> Option<AttributeKind> {
    /// Letters of the names of texture coordinates.
    const TEXTURES: [&str; 5] = ["tcoords", "textcoords", "texturecoordinates", "uv", "st"];
    let letters: String = name.chars().filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_lowercase()).collect();
    match (kind, components) {
        (Type::U8, 3 | 4) => Some(AttributeKind::Colour),
        (Type::F32 | Type::F64, 3) if ["rgb", "color", "colour"].contains(&&*letters) => Some(AttributeKind::Colour),
        (Type::F32 | Type::F64, 2) if TEXTURES.contains(&&*letters) => Some(AttributeKind::Texture),
        (Type::F32 | Type::F64, _) => Some(AttributeKind::Numbers),
        _ => None,
    }
}

/// An array of points, normals and integers excepted.
struct PointArray {
    name: String,
    kind: AttributeKind,
    components: usize,
    numbers: Vec<f64>,
}

/// The attributes of so many points that arrays hold. An array may end early, where later pieces of a file lack it.
fn attributes(arrays: Vec<PointArray>, left_out: Vec<String>, points: usize) -> Attributes {
    let mut attributes = Attributes::default();
    left_out.into_iter().for_each(|name| attributes.leave_out(name));
    for PointArray { name, kind, components, mut numbers } in arrays {
        numbers.resize(components * points, 0.0);
        let kept = match kind {
            AttributeKind::Colour => components.min(3),
            AttributeKind::Texture => components.min(2),
            AttributeKind::Numbers => components,
        };
        if kept < components {
            numbers = numbers.chunks(components).flat_map(|tuple| &tuple[..kept]).copied().collect();
        }
        let again = attributes.list.iter().any(|other| other.kind == kind && kind != AttributeKind::Numbers);
        if again {
            attributes.leave_out(name);
        } else {
            attributes.list.push(Attribute::of_vertices(&name, kind, kept, numbers));
        }
    }
    attributes
}

fn is_normals(name: &str) -> bool {
    name.eq_ignore_ascii_case("normals")
}

/// The number of the region that an array of field data names, if it names one.
fn named_region(numbers: &[f64]) -> Option<i64> {
    match *numbers {
        [number, 2.0] => Some(number as i64),
        _ => None,
    }
}

/// What a file holds of a surface.
#[derive(Default)]
struct Faces {
    polygons: Polygons,
    /// The number of cells so far, of every type.
    cells: usize,
    /// The number of faces that come before each cell's.
    before: Vec<usize>,
}

impl Faces {
    /// Adds cells, each with its type.
    fn add(&mut self, file: &str, cells: &Cells, kinds: impl Iterator<Item = u8>) -> Result<(), LoadError> {
        for (corners, kind) in cells.iter().zip(kinds) {
            self.before.push(self.polygons.ends.len());
            add_cell(&mut self.polygons, kind, corners).map_err(|fault| {
                let place = Place::Item { kind: "cell", number: self.cells };
                LoadError::At { file: file.to_owned(), place, fault, unended: false }
            })?;
            self.cells += 1;
        }
        Ok(())
    }

    /// The polygons with their regions.
    fn finish(
        self,
        file: &str,
        region: Option<RegionArray>,
        names: FxHashMap<i64, String>,
    ) -> Result<Polygons, LoadError> {
        let mut polygons = self.polygons;
        let file = file.to_owned();
        if polygons.points.is_empty() {
            return Err(LoadError::NoVertices { file });
        }
        if polygons.ends.is_empty() {
            return Err(LoadError::NoFaces { file, vertices: polygons.points.len() });
        }
        if let Some(RegionArray { name, numbers, .. }) = region {
            let ends = self.before.iter().skip(1).copied().chain([polygons.ends.len()]);
            let faces = self.before.iter().zip(ends).zip(numbers);
            let numbered = faces.filter(|(_, number)| !number.is_nan());
            let marks =
                numbered.flat_map(|((&start, end), number)| (start..end).map(move |face| (face, number as i64)));
            let numbers = Numbers { marks: marks.collect(), names };
            polygons.regions = Regions::from_numbers(&numbers, &name, polygons.ends.len());
        }
        Ok(polygons)
    }
}

fn encoding(is_big_endian: bool) -> Encoding {
    if is_big_endian { Encoding::BigEndian } else { Encoding::LittleEndian }
}

fn add_cell(polygons: &mut Polygons, kind: u8, corners: &[u32]) -> Result<(), Fault> {
    polygons.check_room(corners.len())?;
    let first = |count: usize| corners.get(..count).ok_or(Fault::TooFewIndices { count: corners.len() });
    match kind {
        // Triangles: plain, quadratic, biquadratic, Lagrange, Bezier.
        5 | 22 | 34 | 69 | 76 => polygons.corners.extend(first(3)?),
        9 | 23 | 28 | 70 | 77 => polygons.corners.extend(first(4)?),
        8 => polygons.corners.extend(
            [0, 1, 3, 2].map(|place| first(4).map(|pixel| pixel[place])).into_iter().collect::<Result<Vec<_>, _>>()?,
        ),
        POLYGON => polygons.corners.extend(corners),
        // A quadratic polygon has its corners first.
        36 => polygons.corners.extend(first(corners.len() / 2)?),
        STRIP => return polygons.push_strip(corners),
        _ => return Ok(()),
    }
    polygons.end_face()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_end_where_they_may() {
        let cells = Cells::new(vec![4, 5, 6, 7], &[0.0, 3.0, 3.0, 4.0]).expect("they are in order");
        assert_eq!(cells.iter().collect::<Vec<_>>(), [&[][..], &[4, 5, 6], &[], &[7]]);
        for ends in [[3.0, 2.0], [3.0, 5.0], [1.5, 4.0], [-1.0, 4.0], [f64::NAN, 4.0]] {
            assert!(matches!(Cells::new(vec![0; 4], &ends), Err(Fault::NoCellEnd { numbers: 4, .. })), "{ends:?}");
        }
    }

    #[test]
    fn cells_become_faces_by_their_type() {
        let faces = |kind, corners: &[u32]| {
            let mut polygons = Polygons::default();
            add_cell(&mut polygons, kind, corners).map(|()| polygons.faces().map(<[u32]>::to_vec).collect::<Vec<_>>())
        };
        let all = [1, 2, 3, 4, 5, 6];
        assert_eq!(faces(5, &all[..3]), Ok(vec![vec![1, 2, 3]]));
        assert_eq!(faces(22, &all), Ok(vec![vec![1, 2, 3]]));
        assert_eq!(faces(8, &all[..4]), Ok(vec![vec![1, 2, 4, 3]]));
        assert_eq!(faces(7, &all), Ok(vec![all.to_vec()]));
        assert_eq!(faces(36, &all), Ok(vec![vec![1, 2, 3]]));
        assert_eq!(faces(6, &all[..4]), Ok(vec![vec![1, 2, 3], vec![3, 2, 4]]));
        for kind in [0, 1, 2, 3, 4, 10, 12, 255] {
            assert_eq!(faces(kind, &all), Ok(vec![]), "{kind}");
        }
        for kind in [5, 7, 8, 9, 36] {
            assert!(faces(kind, &all[..2]).is_err(), "{kind}");
        }
    }
}
