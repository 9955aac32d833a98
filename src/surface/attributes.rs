//! Numbers that a file gives to its vertices or corners beside their places: colours, texture coordinates, results.

/// What an attribute is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeKind {
    /// Red, green and blue, from 0 to 1.
    Colour,
    /// Two coordinates in a picture.
    Texture,
    /// Any other numbers.
    Numbers,
}

impl AttributeKind {
    /// The name that an attribute of this kind gets where its file gives none.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Colour => "RGB",
            Self::Texture => "TCoords",
            Self::Numbers => "numbers",
        }
    }

    /// The kind of an attribute of this name: three components called `RGB` are a colour, two called `TCoords` texture coordinates.
    pub fn of(name: &str, components: usize) -> Self {
        let is = |kind: &Self| kind.name() == name && components == if *kind == Self::Colour { 3 } else { 2 };
        [Self::Colour, Self::Texture].into_iter().find(is).unwrap_or(Self::Numbers)
    }
}

/// Tuples of numbers, one a vertex, or shared by corners of faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Its name in the file, but for colours (`RGB`) and texture coordinates (`TCoords`).
    pub name: String,
    /// What it is.
    pub kind: AttributeKind,
    /// The length of a tuple.
    pub components: usize,
    /// The tuples, one after the other.
    pub values: Vec<f64>,
    /// The tuple of each corner of each face; empty: the tuple of a corner is that of its vertex.
    pub of_corners: Vec<u32>,
}

impl Attribute {
    /// Numbers of vertices.
    pub(crate) fn of_vertices(name: &str, kind: AttributeKind, components: usize, values: Vec<f64>) -> Self {
        let name = if kind == AttributeKind::Numbers { name } else { kind.name() };
        Self { name: name.to_owned(), kind, components, values, of_corners: Vec::new() }
    }

    /// A tuple.
    pub fn tuple(&self, number: u32) -> &[f64] {
        &self.values[number as usize * self.components..][..self.components]
    }

    /// The tuple of a corner, which is a vertex, by its place among all corners.
    pub fn at_corner(&self, place: usize, vertex: u32) -> &[f64] {
        self.tuple(self.of_corners.get(place).copied().unwrap_or(vertex))
    }
}

/// What a file has beside its shape and regions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// What was read.
    pub list: Vec<Attribute>,
    /// The names of what was not, such as numbers of faces. Normals are not among them.
    pub left_out: Vec<String>,
}

impl Attributes {
    /// Notes that something of this name was not read.
    pub(crate) fn leave_out(&mut self, name: String) {
        if !self.left_out.contains(&name) {
            self.left_out.push(name);
        }
    }
}
