//! Named parts of a surface: the groups and materials of an OBJ file, the solids of an STL file.

use rustc_hash::FxHashMap;

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
    fn one_region_is_told_only_if_it_has_a_name() {
        let nothing = (vec![], vec![]);
        assert_eq!(regions(&[], 3), nothing);
        assert_eq!(regions(&[(0, ""), (2, "")], 3), nothing);
        assert_eq!(regions(&[(3, "late")], 3), nothing);
        assert_eq!(regions(&[(0, "all")], 3), (vec!["all".to_owned()], vec![0; 3]));
    }
}
