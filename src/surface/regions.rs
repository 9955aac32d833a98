//! Named parts of a surface: groups and materials, solids, physical groups, or numbers of faces.

use rustc_hash::FxHashMap;

/// Integer attributes of faces that tell their regions, in PLY, VTK, VTU and VTP. Programs that convert MSH write `gmsh:physical` or
/// `CellEntityIds`.
const ATTRIBUTES: [&str; 9] =
    ["region", "patch", "label", "material", "part", "group", "gmshphysical", "physical", "cellentity"];

/// The rank of an attribute among those that tell regions; none for others. Case, whatever is neither letter nor digit, and `id`,
/// `index` or a plural at the end do not matter.
pub(crate) fn attribute_rank(name: &str) -> Option<usize> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    let stem = ["ids", "id", "index", "s"].iter().find_map(|ending| plain.strip_suffix(ending));
    ATTRIBUTES.iter().position(|known| *known == stem.unwrap_or(&plain))
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

    /// The regions of so many faces from numbers, each with the number of faces that came before it. A number without a name gets
    /// that of the attribute and itself, as `region_3`; a face without a number has the empty name. One number for all faces
    /// is no region unless it has a name.
    pub(crate) fn from_numbers(numbers: &Numbers, attribute: &str, faces: usize) -> Self {
        let mut regions = Self { names: Vec::new(), of_face: Vec::with_capacity(faces) };
        let (mut by_number, mut by_name) = (FxHashMap::default(), FxHashMap::default());
        let mut fill = |end: usize, number: Option<i64>| {
            if end > regions.of_face.len() {
                let region = *by_number.entry(number).or_insert_with(|| {
                    let name = number.map_or(String::new(), |number| match numbers.names.get(&number) {
                        Some(name) => name.clone(),
                        None => format!("{attribute}_{number}"),
                    });
                    *by_name.entry(name).or_insert_with_key(|name| {
                        regions.names.push(name.clone());
                        regions.names.len() as u32 - 1
                    })
                });
                regions.of_face.resize(end, region);
            }
        };
        for &(place, number) in &numbers.marks {
            fill(place.min(faces), None);
            fill((place + 1).min(faces), Some(number));
        }
        fill(faces, None);
        let named = |number: &Option<i64>| number.is_some_and(|number| numbers.names.contains_key(&number));
        let one_unnamed = by_number.len() < 2 && !by_number.keys().all(named);
        if numbers.marks.is_empty() || one_unnamed || regions.names == [""] { Self::default() } else { regions }
    }
}

/// Regions as files have them that number them.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    /// Numbers, each with the number of faces that came before the face that it is for.
    pub marks: Vec<(usize, i64)>,
    /// The names of numbers.
    pub names: FxHashMap<i64, String>,
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
    fn numbers_are_named_by_the_file_or_their_attribute() {
        let regions = |marks: &[(usize, i64)], names: &[(i64, &str)], faces| {
            let names = names.iter().map(|&(number, name)| (number, name.to_owned())).collect();
            let Regions { names, of_face } =
                Regions::from_numbers(&Numbers { marks: marks.to_vec(), names }, "Patch", faces);
            (names.join(","), of_face)
        };
        let marks = [(0, 7), (1, -1), (3, 7)];
        assert_eq!(regions(&marks, &[], 5), ("Patch_7,Patch_-1,".into(), vec![0, 1, 2, 0, 2]));
        assert_eq!(regions(&marks, &[(-1, "wing")], 4), ("Patch_7,wing,".into(), vec![0, 1, 2, 0]));
        assert_eq!(regions(&marks, &[(-1, "wing"), (7, "wing"), (9, "tail")], 2), ("wing".into(), vec![0, 0]));
        let nothing = (String::new(), vec![]);
        assert_eq!([regions(&[], &[], 5), regions(&[(0, 3), (1, 3)], &[], 2)], [nothing.clone(), nothing]);
        assert_eq!(regions(&[(0, 3), (1, 3)], &[(3, "all")], 2), ("all".into(), vec![0, 0]));
        assert_eq!(regions(&[(9, 1)], &[], 2).1.len(), 0, "a face that is not there has no region");
    }

    #[test]
    fn attributes_are_known_by_letters_and_digits() {
        assert!(attribute_rank("Region ID") == attribute_rank("region_id") && attribute_rank("region_id").is_some());
        assert!(attribute_rank("region") < attribute_rank("gmsh:physical"));
        assert_eq!(attribute_rank("Labels"), attribute_rank("label"));
        assert_eq!(attribute_rank("material_index"), attribute_rank("MaterialIds"));
        assert_eq!(["red", "", "id", "subregion"].map(attribute_rank), [None; 4]);
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
