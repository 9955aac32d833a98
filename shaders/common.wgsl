// What all kernels share; it is joined before each of them.

// Numbers that stand in Rust too are compared by tests/shaders.rs.
const WORKGROUP: u32 = 256u;

// The number of an invocation; dispatches of more than 65,535 workgroups are two-dimensional.
fn invocation_of(group: vec3<u32>, groups: vec3<u32>, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * WORKGROUP + local;
}

// No id, and no half-edge.
const NONE: u32 = 0xffffffffu;

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// ---- Tiles: the same record and numbers as in src/compute/tiles.rs ----

struct Tile {
    position: vec3<f32>,
    h: f32,
    normal: vec3<f32>,
    triangle: u32,
    axis: vec3<f32>,
    quarters: u32,
}

// How far a tile sees, how much further its neighbour list goes, in tile sides, and the longest list.
const REACH: f32 = 1.75;
const SKIN: f32 = 0.2;
const LIST_LENGTH: u32 = 16u;

// ---- The neighbour grid: the twin of src/compute/cpu/grid.rs ----

struct Grid {
    // The number of points.
    count: u32,
    // The length of a point's record, in 16 bytes; its first 12 bytes are the position.
    stride: u32,
    // The number of buckets, a power of two, less one.
    mask: u32,
    // Cells per unit of length. Multiplied, not divided by: a product is rounded alike on every device.
    per_unit: f32,
}

// Cells lie within +-2^23; past it an f32 has no fraction left. OUTSIDE on all axes marks a point that has no cell, and
// is nobody's neighbour.
const CELL_LIMIT_BITS: u32 = 0x4b000000u; // the bits of 2^23
const OUTSIDE: i32 = 16777216;

fn cell_of(position: vec3<f32>, per_unit: f32) -> vec3<i32> {
    let place = floor(position * per_unit);
    // Judged by its bits: a device may assume that no number is NaN or infinite.
    let magnitude = bitcast<vec3<u32>>(place) & vec3<u32>(0x7fffffffu);
    if any(magnitude >= vec3<u32>(CELL_LIMIT_BITS)) {
        return vec3<i32>(OUTSIDE);
    }
    return vec3<i32>(place);
}

// Cells adjacent in x are adjacent buckets, so that three cells in a row are read as one run.
fn bucket_of(cell: vec3<i32>, mask: u32) -> u32 {
    var hash = bitcast<u32>(cell.y) * 0x9e3779b1u + bitcast<u32>(cell.z);
    hash = (hash ^ (hash >> 15u)) * 0x85ebca6bu;
    hash = hash ^ (hash >> 13u);
    return (bitcast<u32>(cell.x) + hash) & mask;
}

// How to visit the 27 cells round a position, each point once, in the order of `Grid::around`:
//
//     let here = cell_of(position, grid.per_unit);
//     for (var number = 0u; number < 9u; number++) {
//         let row = row_of(here, number);
//         for (var part = 0u; part < 2u; part++) {
//             let run = run_of(row, part, grid.mask);
//             let end = starts[run.y];
//             for (var slot = starts[run.x]; slot < end; slot++) {
//                 let id = ids[slot];
//                 if in_row(cell_of(tiles[id].position, grid.per_unit), row) { ... }
//             }
//         }
//     }
//
// Two rows may share buckets, hence `in_row`. The three buckets of a row may wrap round the mask, hence the two parts,
// of which the second is almost always empty.
//
// Mesa's software driver silently ends an invocation's loops after 65,535 turns, all its loops together. A search is far
// below that as long as cells are sized to hold some tiles each.

// The middle cell of a row of three in x: y fastest, then z.
fn row_of(here: vec3<i32>, number: u32) -> vec3<i32> {
    return here + vec3<i32>(0, i32(number % 3u) - 1, i32(number / 3u) - 1);
}

// The buckets (first, one past the last) of a row.
fn run_of(row: vec3<i32>, part: u32, mask: u32) -> vec2<u32> {
    let first = bucket_of(row - vec3<i32>(1, 0, 0), mask);
    let end = first + 3u;
    let buckets = mask + 1u;
    if part == 0u {
        return vec2<u32>(first, min(end, buckets));
    }
    return vec2<u32>(0u, max(end, buckets) - buckets);
}

fn in_row(cell: vec3<i32>, row: vec3<i32>) -> bool {
    return all(cell.yz == row.yz) && abs(cell.x - row.x) <= 1 && cell.x != OUTSIDE;
}
