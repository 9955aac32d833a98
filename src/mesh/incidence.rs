//! Incidence tables: rows of ids that can grow (the corners of faces, the faces at vertices).

/// Rows of ids in one buffer (compressed rows with spare room). A row that outgrows its room moves to the end of the buffer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    ids: Vec<u32>,
    spans: Vec<Span>,
}

#[derive(Clone, Copy, Debug)]
struct Span {
    start: usize,
    len: u32,
    room: u32,
}

impl Rows {
    /// Rows of these lengths; `ids` are the rows one after the other.
    pub(crate) fn new(lengths: impl Iterator<Item = usize>, ids: Vec<u32>) -> Self {
        let mut start = 0;
        let spans = lengths
            .map(|len| {
                start += len;
                Span { start: start - len, len: len as u32, room: len as u32 }
            })
            .collect();
        Self { ids, spans }
    }

    /// The transpose: for each of `count` ids, the rows that hold it in ascending order.
    pub(crate) fn transposed<'a>(rows: impl Iterator<Item = &'a [u32]> + Clone, count: usize) -> Self {
        let mut lengths = vec![0; count];
        rows.clone().flatten().for_each(|&id| lengths[id as usize] += 1);
        let total = lengths.iter().sum();
        let mut result = Self::new(lengths.into_iter(), vec![0; total]);
        result.spans.iter_mut().for_each(|span| span.len = 0);
        for (row, ids) in (0..).zip(rows) {
            for &id in ids {
                let span = &mut result.spans[id as usize];
                result.ids[span.start + span.len as usize] = row;
                span.len += 1;
            }
        }
        result
    }

    /// The number of rows.
    pub(crate) fn count(&self) -> usize {
        self.spans.len()
    }

    /// The ids of a row.
    pub(crate) fn get(&self, row: u32) -> &[u32] {
        let span = self.spans[row as usize];
        &self.ids[span.start..span.start + span.len as usize]
    }

    /// All rows, in order.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        self.spans.iter().map(|span| &self.ids[span.start..span.start + span.len as usize])
    }

    /// Adds a row without ids.
    pub(crate) fn add(&mut self) {
        self.spans.push(Span { start: self.ids.len(), len: 0, room: 0 });
    }

    /// Replaces the ids of a row.
    pub(crate) fn set(&mut self, row: u32, ids: &[u32]) {
        let span = &mut self.spans[row as usize];
        if ids.len() > span.room as usize {
            span.start = self.ids.len();
            span.room = ids.len() as u32;
            self.ids.extend_from_slice(ids);
        } else {
            self.ids[span.start..span.start + ids.len()].copy_from_slice(ids);
        }
        span.len = ids.len() as u32;
    }

    /// Adds an id to a row.
    pub(crate) fn push(&mut self, row: u32, id: u32) {
        let span = &mut self.spans[row as usize];
        if span.len == span.room {
            let old = span.start..span.start + span.len as usize;
            span.start = self.ids.len();
            span.room = 2 * span.room.max(2);
            self.ids.extend_from_within(old);
            self.ids.resize(span.start + span.room as usize, u32::MAX);
        }
        self.ids[span.start + span.len as usize] = id;
        span.len += 1;
    }

    /// Removes an id from a row; the order of the others stays.
    pub(crate) fn remove(&mut self, row: u32, id: u32) {
        let span = &mut self.spans[row as usize];
        let ids = &mut self.ids[span.start..span.start + span.len as usize];
        if let Some(at) = ids.iter().position(|other| *other == id) {
            ids.copy_within(at + 1.., at);
            span.len -= 1;
        }
    }
}

/// The corners before and after `vertex` in a face that has it.
pub(crate) fn neighbours_in(face: &[u32], vertex: u32) -> [u32; 2] {
    let at = face.iter().position(|corner| *corner == vertex).expect("the face has the vertex");
    [face[(at + face.len() - 1) % face.len()], face[(at + 1) % face.len()]]
}

/// The sides of a face, each from one corner to the next.
pub(crate) fn sides(face: &[u32]) -> impl Iterator<Item = [u32; 2]> + Clone {
    face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// An edge by its ends, the smaller first.
pub(crate) fn undirected([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_grow_shrink_and_keep_their_order() {
        let mut rows = Rows::new([2, 0, 3].into_iter(), vec![7, 8, 1, 2, 3]);
        rows.push(0, 9);
        rows.push(1, 4);
        rows.remove(2, 2);
        rows.add();
        rows.set(3, &[5, 6]);
        assert_eq!(rows.iter().collect::<Vec<_>>(), [&[7, 8, 9][..], &[4], &[1, 3], &[5, 6]]);
        rows.set(0, &[1]);
        rows.remove(0, 5);
        assert_eq!((rows.get(0), rows.count()), (&[1][..], 4));
    }

    #[test]
    fn transposed_rows_are_those_that_hold_an_id() {
        let faces = [&[0u32, 1, 2][..], &[2, 1, 4]];
        let around = Rows::transposed(faces.iter().copied(), 5);
        assert_eq!(around.iter().collect::<Vec<_>>(), [&[0][..], &[0, 1], &[0, 1], &[], &[1]]);
    }
}
