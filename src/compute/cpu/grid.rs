//! The neighbour grid: which points lie near a position.
//!
//! # Theory
//! A hashed uniform grid, sorted by counting. Space is cut into cubic cells. A cell's bucket is its x plus a hash of its y and
//! z, modulo a power of two. So the cells around a position are nine runs of three adjacent buckets, and one run is read in one
//! piece. Cells far apart may share a bucket; a candidate's own cell tells them apart.
//!
//! # Practice
//! The cell size should be slightly more than the radius searched: two points exactly a cell apart may, by rounding, end up two
//! cells apart.

use crate::compute::bucket_count;
use rayon::prelude::*;

/// Cells lie within this many of the origin on each axis: past it an `f32` has no fraction left.
pub const CELL_LIMIT: f32 = (1 << 23) as f32;

/// On all axes, marks a point that has no cell (not finite, or out of reach) and is nobody's neighbour.
pub const OUTSIDE: i32 = 1 << 24;

/// Points sorted by the bucket of their cell, and by number within a bucket.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Where each bucket begins in `ids`, and after the last one the number of points.
    pub starts: Vec<u32>,
    /// The points' numbers.
    pub ids: Vec<u32>,
    /// The points' cells, in the order of `ids`.
    cells: Vec<[i32; 3]>,
    per_unit: f32,
    mask: u32,
}

impl Grid {
    /// Sorts `count` points into cubic cells of side `cell`, in the units of `positions`.
    pub fn build(positions: impl Fn(usize) -> [f32; 3] + Sync, count: usize, cell: f32) -> Self {
        let mask = bucket_count(count) - 1;
        let per_unit = 1.0 / cell;
        let homes: Vec<([i32; 3], u32)> = (0..count)
            .into_par_iter()
            .with_min_len(1024)
            .map(|id| {
                let cell = cell_of(positions(id), per_unit);
                // Nobody looks for a point without a cell: many of them are spread, not piled into one long bucket.
                (cell, if cell[0] == OUTSIDE { id as u32 & mask } else { bucket_of(cell, mask) })
            })
            .collect();

        let mut starts = vec![0_u32; mask as usize + 2];
        for &(_, bucket) in &homes {
            starts[bucket as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }

        let mut cursors = starts.clone();
        let mut ids = vec![0; count];
        let mut cells = vec![[0; 3]; count];
        for (id, &(cell, bucket)) in homes.iter().enumerate() {
            let cursor = &mut cursors[bucket as usize];
            ids[*cursor as usize] = id as u32;
            cells[*cursor as usize] = cell;
            *cursor += 1;
        }
        Self { starts, ids, cells, per_unit, mask }
    }

    /// Visits every point in the 27 cells round `position` once, always in the same order.
    pub fn around(&self, position: [f32; 3], mut visit: impl FnMut(u32)) {
        let here = cell_of(position, self.per_unit);
        for number in 0..9 {
            let row = row_of(here, number);
            for [first, end] in runs_of(row, self.mask) {
                for slot in self.starts[first as usize]..self.starts[end as usize] {
                    if in_row(self.cells[slot as usize], row) {
                        visit(self.ids[slot as usize]);
                    }
                }
            }
        }
    }
}

fn cell_of(position: [f32; 3], per_unit: f32) -> [i32; 3] {
    let place = position.map(|coordinate| (coordinate * per_unit).floor());
    let within = place.iter().all(|coordinate| coordinate.abs() < CELL_LIMIT);
    if within { place.map(|coordinate| coordinate as i32) } else { [OUTSIDE; 3] }
}

fn bucket_of([x, y, z]: [i32; 3], mask: u32) -> u32 {
    let mut hash = (y as u32).wrapping_mul(0x9e37_79b1).wrapping_add(z as u32);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 13;
    (x as u32).wrapping_add(hash) & mask
}

/// The middle cell of a row of three in x: y fastest, then z.
fn row_of([x, y, z]: [i32; 3], number: i32) -> [i32; 3] {
    [x, y + number % 3 - 1, z + number / 3 - 1]
}

/// The buckets (first, one past the last) of a row: the second run is what wraps round the mask.
fn runs_of([x, y, z]: [i32; 3], mask: u32) -> [[u32; 2]; 2] {
    let first = bucket_of([x - 1, y, z], mask);
    let end = first + 3;
    let buckets = mask + 1;
    [[first, end.min(buckets)], [0, end.max(buckets) - buckets]]
}

fn in_row(cell: [i32; 3], row: [i32; 3]) -> bool {
    cell[1..] == row[1..] && (cell[0] - row[0]).abs() <= 1 && cell[0] != OUTSIDE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_wrap_round_the_mask_are_read_whole() {
        let mask = 255;
        let mut wrapped = 0;
        for x in -256..256 {
            let row = [x, 7, -9];
            let runs = runs_of(row, mask);
            let read: Vec<u32> = runs.iter().flat_map(|&[first, end]| first..end).collect();
            let mut wanted = [-1, 0, 1].map(|dx| bucket_of([x + dx, 7, -9], mask));
            wrapped += (runs[1][1] > 0) as usize;
            wanted.sort_by_key(|bucket| bucket.wrapping_sub(runs[0][0]) & mask);
            assert_eq!(read, wanted, "{x}");
        }
        assert_eq!(wrapped, 4, "two rows in each period of the mask");
    }

    #[test]
    fn cells_at_the_edges_of_what_has_a_cell() {
        let cell = |x| cell_of([x, 0.5, -0.5], 1.0);
        assert_eq!(cell(-0.0), [0, 0, -1]);
        assert_eq!(cell(1.0), [1, 0, -1]);
        assert_eq!(cell(-1.0), [-1, 0, -1]);
        assert_eq!(cell(-f32::MIN_POSITIVE), [-1, 0, -1]);
        assert_eq!(cell(CELL_LIMIT.next_down()), [(1 << 23) - 1, 0, -1]);
        for outside in [CELL_LIMIT, -CELL_LIMIT, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            assert_eq!(cell(outside), [OUTSIDE; 3], "{outside}");
        }
    }
}
