//! Surfaces and meshes out of bytes, so that each change of a byte is a small change of one.

use quadmosaic::Soup;
use quadmosaic::mesh::Mesh;

/// Bytes that are taken from the front; after the end they are 0.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// A number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count.max(1)
    }

    /// A coordinate. Few values are common, so that points coincide and triangles lie in one plane; rare ones are extreme.
    fn coordinate(&mut self) -> f64 {
        match self.byte() {
            0xF0 => f64::NAN,
            0xF1 => f64::INFINITY,
            0xF2 => 1e300,
            0xF3 => -1e300,
            0xF4 => 1e-300,
            0xF5 => 1e-9,
            0xF6 => 1.0 + f64::EPSILON,
            0xF7 => f64::MAX,
            0xF8 => 1e12,
            byte => f64::from(byte.cast_signed()) / 16.0,
        }
    }

    fn points(&mut self, most: usize) -> Vec<[f64; 3]> {
        let count = 3 + self.below(most - 2);
        (0..count).map(|_| [self.coordinate(), self.coordinate(), self.coordinate()]).collect()
    }

    /// A soup of up to 40 points; its triangles are the rest of the bytes, which may name one point more than there are.
    pub fn soup(&mut self) -> Soup {
        let points = self.points(40);
        let mut triangles = Vec::new();
        while !self.0.is_empty() && triangles.len() < 100 {
            triangles.push([0; 3].map(|_| self.below(points.len() + 1) as u32));
        }
        Soup::new(points, triangles)
    }

    /// A mesh of up to 60 points, with faces of up to six corners.
    pub fn mesh(&mut self) -> Mesh {
        let mut mesh = Mesh::new(self.points(60));
        while !self.0.is_empty() && mesh.face_count() < 200 {
            let corners: Vec<u32> = (0..self.below(7)).map(|_| self.below(mesh.points.len() + 1) as u32).collect();
            mesh.push_face(&corners);
        }
        mesh
    }
}

/// The bytes that [`Bytes::soup`] makes this soup of, but for the rounding of coordinates to sixteenths.
pub fn of_soup(soup: &Soup) -> Vec<u8> {
    let count = u8::try_from(soup.points.len() - 3).expect("a few points");
    let coordinate = |x: &f64| ((x * 16.0).round().clamp(-15.0, 127.0) as i8).cast_unsigned();
    let corner = |&v: &u32| v as u8;
    let points = soup.points.as_flattened().iter().map(coordinate);
    let corners = soup.triangles.as_flattened().iter().map(corner);
    [count].into_iter().chain(points).chain(corners).collect()
}
