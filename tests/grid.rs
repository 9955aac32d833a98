//! The neighbour grid: against a search of all pairs, and the GPU against the CPU.

mod common;

use bytemuck::{Pod, Zeroable};
use quadmosaic::compute::cpu::grid::Grid;
use quadmosaic::gpu::grid::{GridBuffers, GridKernels};
use quadmosaic::gpu::{Access, Gpu, GpuError, Program};

const CELL: f32 = 0.1;

/// The stem of each case in messages, and its points.
fn cases() -> Vec<(&'static str, Vec<[f32; 3]>)> {
    let mut random = Random(1);
    let mut cases = vec![("none", vec![]), ("one", vec![[0.3, -0.2, 0.1]])];
    for (name, count) in [("255 random", 255), ("256 random", 256), ("257 random", 257), ("60,000 random", 60_000)] {
        cases.push((name, (0..count).map(|_| random.point(4.0)).collect()));
    }
    let centres: Vec<_> = (0..20).map(|_| random.point(4.0)).collect();
    let near = |random: &mut Random, centre: [f32; 3]| {
        let offset = random.point(0.3);
        [0, 1, 2].map(|axis| centre[axis] + offset[axis])
    };
    cases.push(("clustered", (0..4000).map(|id| near(&mut random, centres[id % 20])).collect()));
    cases.push(("all in one cell", (0..500).map(|_| random.point(0.04).map(|x| 0.55 + x)).collect()));
    let steps = |id: i32| [id % 16 - 8, id / 16 % 16 - 8, id / 256 - 8].map(|step| step as f32 * CELL);
    cases.push(("on cell borders", (0..4096).map(steps).collect()));
    let border = |id: i32| steps(id).map(|x| if id % 2 == 0 { x.next_down() } else { x.next_up() });
    cases.push(("beside cell borders", (0..4096).map(border).collect()));
    let poison =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -0.0, f32::MIN_POSITIVE, 1e-45, 838_860.8, 0.25];
    let mixed = (0..729).map(|id| [poison[id % 9], poison[id / 9 % 9], poison[id / 81]]);
    cases.push(("poison", mixed.chain((0..300).map(|_| random.point(1.0))).collect()));
    cases.push(("60,000 that have no cell", vec![[f32::NAN; 3]; 60_000]));
    cases
}

/// Numbers that need no luck to be reproduced (Vigna's splitmix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    /// In a cube round the origin, `side` wide.
    fn point(&mut self, side: f32) -> [f32; 3] {
        [0; 3].map(|_| (self.unit() - 0.5) * side)
    }
}

fn build(points: &[[f32; 3]]) -> Grid {
    Grid::build(|id| points[id], points.len(), CELL)
}

/// What is wrong with what `grid` finds round every 37th of `points`, if anything.
fn complaint(grid: &Grid, points: &[[f32; 3]]) -> Option<String> {
    let cell = |point: [f32; 3]| point.map(|x| (f64::from(x * (1.0 / CELL))).floor());
    for (number, &here) in points.iter().enumerate().step_by(37) {
        let mut found = vec![];
        grid.around(here, |id| found.push(id));
        found.sort_unstable();
        if found.windows(2).any(|pair| pair[0] == pair[1]) {
            return Some(format!("a point is found twice round point {number}"));
        }
        // Past 2^23 cells from the origin, a tenth of it in units, there are no cells.
        if !here.iter().all(|x| x.abs() < 838_860.0) {
            if !found.is_empty() {
                return Some(format!("point {number} has no cell, and {} neighbours", found.len()));
            }
            continue;
        }
        let home = cell(here);
        let beside = |other: [f32; 3]| (0..3).all(|axis| (cell(other)[axis] - home[axis]).abs() <= 1.0);
        let wanted: Vec<u32> = (0..points.len() as u32).filter(|&id| beside(points[id as usize])).collect();
        if found != wanted {
            return Some(format!("round point {number}: {} points found, {} there", found.len(), wanted.len()));
        }
        // Rounding may move a point by two units in the last place of its place in cells, at most 2 * 40 * 2^-24 here.
        let radius = CELL * (1.0 - 1e-5);
        let distance = |other: [f32; 3]| (0..3).map(|axis| (other[axis] - here[axis]).powi(2)).sum::<f32>().sqrt();
        let near = |&id: &u32| distance(points[id as usize]) < radius;
        if let Some(missed) = (0..points.len() as u32).filter(near).find(|id| found.binary_search(id).is_err()) {
            return Some(format!("point {missed} is near point {number} and not found"));
        }
    }
    None
}

#[test]
fn finds_what_a_search_of_all_pairs_finds() {
    for (name, points) in cases() {
        let grid = build(&points);
        assert_eq!(grid.ids.len(), points.len(), "{name}");
        assert_eq!(grid.starts.last(), Some(&(points.len() as u32)), "{name}");
        assert_eq!(complaint(&grid, &points), None, "{name}");
    }
}

#[test]
fn a_search_of_all_pairs_notices_one_point_elsewhere() {
    let (_, points) = cases().swap_remove(2);
    let mut moved = points.clone();
    moved[37][0] += 2.0 * CELL;
    assert!(complaint(&build(&moved), &points).is_some());
}

#[test]
fn poison_is_nobodys_neighbour() {
    let grid = Grid::build(|id| if id == 0 { [f32::NAN; 3] } else { [0.0; 3] }, 2, CELL);
    let mut found = vec![];
    grid.around([0.0; 3], |id| found.push(id));
    assert_eq!(found, [1]);
}

/// A record longer than its position, as the mosaic's tiles are.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Record {
    position: [f32; 3],
    rest: [u32; 5],
}

fn record(&position: &[f32; 3]) -> Record {
    // The bits of a NaN: the kernels must not look at them.
    Record { position, rest: [0x7fc0_0001; 5] }
}

fn build_on_gpu<T: Pod>(gpu: &Gpu, kernels: &GridKernels, points: &[T]) -> Result<[Vec<u32>; 2], GpuError> {
    let grid = GridBuffers::new::<T>(gpu, points.len(), CELL)?;
    let points = gpu.upload("test points", points)?;
    let mut recording = gpu.record();
    // Twice in one batch: nothing of a first grid may be left in the second.
    grid.record(gpu, kernels, &mut recording, &points)?;
    grid.record(gpu, kernels, &mut recording, &points)?;
    recording.submit()?;
    Ok([gpu.read(&grid.starts)?, gpu.read(&grid.ids)?])
}

#[test]
fn gpu_and_cpu_build_the_same_grid() {
    let Some(gpu) = common::gpu() else { return };
    let kernels = GridKernels::new(gpu).unwrap();
    for (name, points) in cases() {
        let cpu = build(&points);
        let padded: Vec<[f32; 4]> = points.iter().map(|&[x, y, z]| [x, y, z, f32::NAN]).collect();
        let records: Vec<Record> = points.iter().map(record).collect();
        for (layout, [starts, ids]) in [
            ("16-byte records", build_on_gpu(gpu, &kernels, &padded).unwrap()),
            ("32-byte records", build_on_gpu(gpu, &kernels, &records).unwrap()),
        ] {
            assert_eq!(first_difference(&starts, &cpu.starts), None, "starts of {name}, {layout}");
            assert_eq!(first_difference(&ids, &cpu.ids), None, "ids of {name}, {layout}");
        }
    }
}

#[test]
fn one_point_elsewhere_makes_another_grid() {
    let Some(gpu) = common::gpu() else { return };
    let (_, points) = cases().swap_remove(4);
    let mut padded: Vec<[f32; 4]> = points.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
    padded[100] = padded[200];
    let [starts, ids] = build_on_gpu(gpu, &GridKernels::new(gpu).unwrap(), &padded).unwrap();
    let cpu = build(&points);
    assert!(first_difference(&starts, &cpu.starts).is_some());
    assert!(first_difference(&ids, &cpu.ids).is_some());
}

/// Where two lists differ first, and how; without printing 60,000 numbers.
fn first_difference(left: &[u32], right: &[u32]) -> Option<String> {
    if left.len() != right.len() {
        return Some(format!("{} and {} entries", left.len(), right.len()));
    }
    let place = (0..left.len()).find(|&place| left[place] != right[place])?;
    Some(format!("{} and {} at {place}", left[place], right[place]))
}

#[test]
fn the_scan_goes_beyond_one_row_of_workgroups() {
    // 4,194,304 buckets: 16,384 blocks, whose sums the one workgroup of `scan_sums` takes in 64 turns.
    let Some(gpu) = common::gpu() else { return };
    let points: Vec<[f32; 4]> = (0..1_100_000).map(|id| [(id % 1024) as f32, (id / 1024) as f32, 0.5, 0.0]).collect();
    let cpu = Grid::build(|id| [points[id][0], points[id][1], points[id][2]], points.len(), CELL);
    assert_eq!(cpu.starts.len(), (4 << 20) + 1);
    let [starts, ids] = build_on_gpu(gpu, &GridKernels::new(gpu).unwrap(), &points).unwrap();
    assert_eq!(first_difference(&starts, &cpu.starts), None);
    assert_eq!(first_difference(&ids, &cpu.ids), None);
}

/// The loop that `shaders/common.wgsl` prescribes to kernels, here adding up what depends on the order of the visits.
const PROBE: &str = "
@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(1) var<storage, read> tiles: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> ids: array<u32>;
@group(0) @binding(4) var<storage, read_write> digests: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn probe(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let me = invocation_of(group, groups, local);
    if me >= grid.count {
        return;
    }
    var digest = 0u;
    let here = cell_of(tiles[me * grid.stride].xyz, grid.per_unit);
    for (var number = 0u; number < 9u; number++) {
        let row = row_of(here, number);
        for (var part = 0u; part < 2u; part++) {
            let run = run_of(row, part, grid.mask);
            let end = starts[run.y];
            for (var slot = starts[run.x]; slot < end; slot++) {
                let id = ids[slot];
                if in_row(cell_of(tiles[id * grid.stride].xyz, grid.per_unit), row) {
                    digest = digest * 31u + id + 1u;
                }
            }
        }
    }
    digests[me] = digest;
}
";

#[test]
fn gpu_and_cpu_visit_the_same_neighbours_in_the_same_order() {
    use Access::{Read, Uniform, Write};
    let Some(gpu) = common::gpu() else { return };
    let kernels = GridKernels::new(gpu).unwrap();
    let program = Program::new(gpu, "probe", PROBE, &[Uniform, Read, Read, Read, Write]).unwrap();
    let probe = program.kernel(gpu, "probe").unwrap();
    for (name, points) in cases() {
        let cpu = build(&points);
        let digest = |&point: &[f32; 3]| {
            let mut digest = 0_u32;
            cpu.around(point, |id| digest = digest.wrapping_mul(31).wrapping_add(id + 1));
            digest
        };
        let wanted: Vec<u32> = points.iter().map(digest).collect();

        let records: Vec<Record> = points.iter().map(record).collect();
        let grid = GridBuffers::new::<Record>(gpu, points.len(), CELL).unwrap();
        let tiles = gpu.upload("test points", &records).unwrap();
        let digests = gpu.zeros("digests", points.len()).unwrap();
        let bindings = program.bind(gpu, &[&grid.settings, &tiles, &grid.starts, &grid.ids, &digests]).unwrap();
        let mut recording = gpu.record();
        grid.record(gpu, &kernels, &mut recording, &tiles).unwrap();
        recording.dispatch(&probe, &bindings, points.len());
        recording.submit().unwrap();
        assert_eq!(first_difference(&gpu.read(&digests).unwrap(), &wanted), None, "{name}");
    }
}
