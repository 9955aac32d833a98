//! Named parts of a surface: the groups and materials of an OBJ file, the solids of an STL file.

use rustc_hash::FxHashMap;

/// Integer attributes of faces that tell their regions, in PLY, VTK, VTU and VTP. Of several, the first in this order counts; case
/// and whatever is neither letter nor digit do not matter. `gmsh:physical` and `CellEntityIds` are written by programs that
/// convert MSH.
const ATTRIBUTES: [&str; 16] = [
    "region",
    "regionid",
    "patch",
    "patchid",
    "label",
    "labels",
    "materialindex",
    "materialid",
    "material",
    "part",
    "partid",
    "group",
    "groupid",
    "gmshphysical",
    "physical",
    "cellentityids",
];

/// The rank of an attribute among those that tell regions; none for others.
pub(crate) fn attribute_rank(name: &str) -> Option<usize> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    ATTRIBUTES.iter().position(|known| *known == plain)
}

/// Which named part each face belongs to: triangles of a surface, faces of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Regions {
    /// Names in order of first use; faces that no name was given for have the empty one.
    pub names: Vec<String>,
    /// The region of each face, an index into `names`; empty: one unnamed region.
    pub of_face: Vec<u32>,
}

impl Regions {
    /// The regions of these faces, in this order.
    pub(crate) fn of(&self, faces: &[u32]) -> Self {
        if self.of_face.is_empty() {
            return Self::default();
        }
        let of_face = faces.iter().map(|&face| self.of_face[face as usize]).collect();
        Self { names: self.names.clone(), of_face }
    }

    /// The regions of so many faces from places in their order where a name begins to hold.
    pub(crate) fn from_marks(marks: &[(usize, String)], faces: usize) -> Self {
        let mut regions = Self::default();
        let mut known = FxHashMap::default();
        let ends = marks.iter().map(|mark| mark.0).chain([faces]);
        let names = [""].into_iter().chain(marks.iter().map(|mark| mark.1.as_str()));
        for (name, end) in names.zip(ends) {
            if end > regions.of_face.len() {
                let region = *known.entry(name).or_insert_with(|| {
                    regions.names.push(name.to_owned());
                    regions.names.len() as u32 - 1
                });
                regions.of_face.resize(end, region);
            }
        }
        if regions.names == [""] { Self::default() } else { regions }
    }

    /// The regions of so many faces from numbers, each with the number of faces that came before it. A face without a number has
    /// the empty name, others that of the attribute and the number: `region_3`.
    pub(crate) fn from_numbers(numbers: &[(usize, f64)], attribute: &str, faces: usize) -> Self {
        let mut regions = Self { names: Vec::new(), of_face: Vec::with_capacity(faces) };
        let mut known = FxHashMap::default();
        let mut fill = |end: usize, number: Option<f64>| {
            if end > regions.of_face.len() {
                let region = *known.entry(number.map(f64::to_bits)).or_insert_with(|| {
                    regions.names.push(number.map_or(String::new(), |number| format!("{attribute}_{number}")));
                    regions.names.len() as u32 - 1
                });
                regions.of_face.resize(end, region);
            }
        };
        for &(place, number) in numbers {
            fill(place, None);
            fill((place + 1).min(faces), Some(number + 0.0));
        }
        fill(faces, None);
        if numbers.is_empty() { Self::default() } else { regions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regions(marks: &[(usize, &str)], triangles: usize) -> (Vec<String>, Vec<u32>) {
        let marks: Vec<_> = marks.iter().map(|&(place, name)| (place, name.to_owned())).collect();
        let Regions { names, of_face } = Regions::from_marks(&marks, triangles);
        (names, of_face)
    }

    #[test]
    fn names_come_in_order_of_first_use() {
        let (names, of) = regions(&[(1, "b"), (1, "unused"), (1, "a"), (3, "b"), (4, "last")], 4);
        assert_eq!((names.join(","), of), (",a,b".to_owned(), vec![0, 1, 1, 2]));
        let (names, of) = regions(&[(0, "b"), (2, "a"), (3, "b")], 4);
        assert_eq!((names.join(","), of), ("b,a".to_owned(), vec![0, 0, 1, 0]));
    }

    #[test]
    fn numbers_are_named_by_their_attribute() {
        let regions = Regions::from_numbers(&[(0, 7.0), (1, -1.0), (3, 7.0)], "Patch", 5);
        assert_eq!(regions.names, ["Patch_7", "Patch_-1", ""]);
        assert_eq!(regions.of_face, [0, 1, 2, 0, 2]);
        assert_eq!(Regions::from_numbers(&[], "Patch", 5), Regions::default());
        assert_eq!(Regions::from_numbers(&[(9, 1.0)], "Patch", 2).of_face.len(), 2);
    }

    #[test]
    fn attributes_are_known_by_letters_and_digits() {
        assert!(attribute_rank("Region ID") == attribute_rank("region_id") && attribute_rank("region_id").is_some());
        assert!(attribute_rank("region") < attribute_rank("gmsh:physical"));
        assert_eq!([attribute_rank("red"), attribute_rank("")], [None, None]);
    }

    #[test]
    fn one_region_is_told_only_if_it_has_a_name() {
        let nothing = (vec![], vec![]);
        assert_eq!(regions(&[], 3), nothing);
        assert_eq!(regions(&[(0, ""), (2, "")], 3), nothing);
        assert_eq!(regions(&[(3, "late")], 3), nothing);
        assert_eq!(regions(&[(0, "all")], 3), (vec!["all".to_owned()], vec![0; 3]));
    }
}
