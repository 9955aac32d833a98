//! The statements of an OBJ text that a surface is read from: vertices, texture coordinates, faces and names.

use super::super::text::{content, words};
use std::borrow::Cow;

/// A statement with what follows its keyword.
pub enum Statement<'a> {
    /// `v`: coordinates, then a weight or a colour.
    Vertex(&'a [u8]),
    /// `vt`: texture coordinates.
    Texture(&'a [u8]),
    /// `f`: corners.
    Face(&'a [u8]),
    /// `g`, `o` or `usemtl`: a name of the faces that follow.
    Name(Kind, &'a [u8]),
}

/// What a name is given to. Groups are the finer division where a file has objects too; materials divide either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// `g`.
    Group,
    /// `o`.
    Object,
    /// `usemtl`.
    Material,
}

impl<'a> Statement<'a> {
    /// The statement of a line; `None` where it says nothing about the surface.
    pub fn of(line: &'a [u8]) -> Option<Self> {
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(end);
        match keyword {
            b"v" => Some(Self::Vertex(rest)),
            b"vt" => Some(Self::Texture(rest)),
            b"f" => Some(Self::Face(rest)),
            b"g" => Some(Self::Name(Kind::Group, rest)),
            b"o" => Some(Self::Name(Kind::Object, rest)),
            b"usemtl" => Some(Self::Name(Kind::Material, rest)),
            _ => None,
        }
    }
}

/// The lines without comments and outer blanks, each with its number, counted from 1; continued lines are joined.
pub fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut physical = (1..).zip(text.split(|&byte| byte == b'\n').map(content));
    std::iter::from_fn(move || {
        let (number, line) = physical.next()?;
        let mut line = Cow::Borrowed(line);
        while line.ends_with(b"\\") {
            let (_, continued) = physical.next().unwrap_or_default();
            let begun = line.to_mut();
            begun.pop();
            begun.push(b' ');
            begun.extend_from_slice(continued);
        }
        Some((number, line))
    })
}

/// The numbers of all vertices' lines and what follows their keyword.
pub fn vertices(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    lines(text).filter(|(_, line)| matches!(Statement::of(line), Some(Statement::Vertex(_))))
}

/// The fourth coordinate of a vertex, by which the others are divided. More than four numbers are a colour, no weight.
pub fn weight(vertex: &[u8]) -> Option<&[u8]> {
    let mut words = words(vertex).skip(3);
    words.next().filter(|_| words.next().is_none())
}
