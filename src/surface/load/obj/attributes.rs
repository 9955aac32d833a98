//! Colours and texture coordinates of an OBJ text.

use super::super::text::{parsed, words};
use crate::surface::attributes::{Attribute, AttributeKind, Attributes};

/// A corner without texture coordinates.
const NO_TEXTURE: u32 = 0;

/// What was read so far.
#[derive(Default)]
pub struct Collected {
    /// Of the vertices up to the last that has one; NaN for those without, which become white.
    colours: Vec<[f64; 3]>,
    textures: Vec<[f64; 2]>,
    /// The number of the texture coordinates of each corner, counted from 1.
    of_corners: Vec<u32>,
    /// The number of corners; `of_corners` ends with the last that has slashes.
    corners: usize,
}

impl Collected {
    /// Takes the words behind the place of a vertex: red, green and blue, perhaps more.
    pub fn push_colour(&mut self, vertex: usize, colour: &[u8]) {
        if colour.is_empty() {
            return;
        }
        let numbers: Vec<f64> = words(colour).map_while(parsed).collect();
        if let [r, g, b, ..] = numbers[..] {
            self.colours.resize(vertex, [f64::NAN; 3]);
            self.colours.push([r, g, b]);
        }
    }

    /// Takes texture coordinates, of which there may be one to three.
    pub fn push_texture(&mut self, coordinates: &[u8]) {
        let mut numbers = words(coordinates).map(|word| parsed(word).unwrap_or(0.0));
        self.textures.push([numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)]);
    }

    /// Takes the corners of a face: `vertex/texture/normal`. Negative numbers are counted back from the last coordinates so far.
    pub fn push_face(&mut self, corners: &[u8]) {
        let count = self.textures.len() as i64;
        let texture = |corner: &[u8]| {
            let number: i64 = parsed(corner.split(|&byte| byte == b'/').nth(1)?)?;
            let number = if number < 0 { count + 1 + number } else { number };
            u32::try_from(number).ok()
        };
        if corners.contains(&b'/') {
            self.of_corners.resize(self.corners, NO_TEXTURE);
            self.of_corners.extend(words(corners).map(|corner| texture(corner).unwrap_or(NO_TEXTURE)));
            self.corners = self.of_corners.len();
        } else {
            self.corners += words(corners).count();
        }
    }

    /// The attributes of so many vertices and corners.
    pub fn finish(self, vertices: usize, corners: usize) -> Attributes {
        let Self { mut colours, textures, mut of_corners, corners: counted } = self;
        let mut attributes = Attributes::default();
        if !colours.is_empty() {
            colours.resize(vertices, [f64::NAN; 3]);
            // Some programs write 0 to 255.
            let most = colours.as_flattened().iter().copied().fold(0.0, f64::max);
            let scale = if most > 1.0 { 255.0 } else { 1.0 };
            let values = colours.as_flattened().iter().map(|x| if x.is_nan() { 1.0 } else { x / scale }).collect();
            attributes.list.push(Attribute::of_vertices("", AttributeKind::Colour, 3, values));
        }
        let is_used = of_corners.iter().any(|&number| number != NO_TEXTURE);
        of_corners.resize(counted, NO_TEXTURE);
        let is_whole = counted == corners && of_corners.iter().all(|&n| n as usize <= textures.len());
        if is_used && is_whole {
            // Corners without texture coordinates have zeros.
            let values = [0.0; 2].into_iter().chain(textures.into_flattened()).collect();
            let texture = Attribute::of_vertices("", AttributeKind::Texture, 2, values);
            attributes.list.push(Attribute { of_corners, ..texture });
        } else if is_used {
            attributes.leave_out("texture coordinates, some of whose numbers are wrong".to_owned());
        }
        attributes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collected(statements: &[(&str, &[u8])]) -> Attributes {
        let mut collected = Collected::default();
        let (mut vertices, mut corners) = (0, 0);
        for &(keyword, rest) in statements {
            match keyword {
                "v" => {
                    collected.push_colour(vertices, rest);
                    vertices += 1;
                }
                "vt" => collected.push_texture(rest),
                _ => {
                    collected.push_face(rest);
                    corners += words(rest).count();
                }
            }
        }
        collected.finish(vertices, corners)
    }

    #[test]
    fn colours_are_from_0_to_1_and_white_where_there_is_none() {
        let colours = collected(&[("v", b""), ("v", b"255 0 51"), ("v", b"0 0 255 7"), ("v", b"")]);
        assert_eq!(colours.list[0].values, [1.0, 1.0, 1.0, 1.0, 0.0, 0.2, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        let colours = collected(&[("v", b""), ("v", b"1 0 0.2")]);
        assert_eq!(colours.list[0].values, [1.0, 1.0, 1.0, 1.0, 0.0, 0.2]);
        assert!(collected(&[("v", b""), ("v", b"red")]).list.is_empty());
    }

    #[test]
    fn corners_number_texture_coordinates_from_either_end() {
        let read = collected(&[
            ("vt", b"0.5"),
            ("vt", b"1 2 3"),
            ("f", b"1/1 2/-1/7 3"),
            ("vt", b"4 5"),
            ("f", b"3/-1 2//1 1/2"),
        ]);
        assert_eq!(read.list[0].of_corners, [1, 2, 0, 3, 0, 2]);
        assert_eq!(read.list[0].values, [0.0, 0.0, 0.5, 0.0, 1.0, 2.0, 4.0, 5.0]);
        let wrong = collected(&[("vt", b"0 0"), ("f", b"1/1 2/2 3/1")]);
        assert!(wrong.list.is_empty() && wrong.left_out.len() == 1);
        assert_eq!(collected(&[("f", b"1//1 2//2 3//3")]), Attributes::default());
    }
}
