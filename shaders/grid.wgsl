// Sorts points into the buckets of a hashed uniform grid by counting: count, scan (three kernels), scatter, order.
// The twin of `Grid::build` in src/compute/cpu/grid.rs.

@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(1) var<storage, read> tiles: array<vec4<f32>>;
// First the number of points in each bucket, then the next free slot of each.
@group(0) @binding(2) var<storage, read_write> cursors: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> block_sums: array<u32>;
@group(0) @binding(4) var<storage, read_write> starts: array<u32>;
@group(0) @binding(5) var<storage, read_write> ids: array<u32>;

fn bucket_of_point(id: u32) -> u32 {
    let cell = cell_of(tiles[id * grid.stride].xyz, grid.per_unit);
    // Nobody looks for a point without a cell: many of them are spread, not piled into one long bucket.
    if cell.x == OUTSIDE {
        return id & grid.mask;
    }
    return bucket_of(cell, grid.mask);
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < grid.count {
        atomicAdd(&cursors[bucket_of_point(id)], 1u);
    }
}

var<workgroup> sums: array<u32, WORKGROUP>;

// The sum of the values of this and all lower invocations of the workgroup: in runs of 16, then over the runs. That is
// two barriers; a tree of pairs has sixteen, and barriers are what costs on a software adapter.
fn inclusive_sum(local: u32, value: u32) -> u32 {
    sums[local] = value;
    workgroupBarrier();
    if local < 16u {
        var sum = 0u;
        for (var place = 16u * local; place < 16u * local + 16u; place++) {
            sum += sums[place];
            sums[place] = sum;
        }
    }
    workgroupBarrier();
    var sum = sums[local];
    for (var last = 15u; last < local - local % 16u; last += 16u) {
        sum += sums[last];
    }
    return sum;
}

// The number of buckets is a multiple of WORKGROUP: each block is full, and only whole workgroups are past the end.
@compute @workgroup_size(WORKGROUP)
fn scan_blocks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let bucket = invocation_of(group, groups, local);
    var size = 0u;
    if bucket <= grid.mask {
        size = atomicLoad(&cursors[bucket]);
    }
    let sum = inclusive_sum(local, size);
    if bucket <= grid.mask {
        starts[bucket] = sum - size;
        if local == WORKGROUP - 1u {
            block_sums[bucket / WORKGROUP] = sum;
        }
    }
}

var<workgroup> turn_sum: u32;

// One workgroup turns the blocks' sums into the sums of all blocks before, 256 at a time.
@compute @workgroup_size(WORKGROUP)
fn scan_sums(@builtin(local_invocation_index) local: u32) {
    let blocks = (grid.mask + 1u) / WORKGROUP;
    var before = 0u;
    for (var first = 0u; first < blocks; first += WORKGROUP) {
        let block = first + local;
        var value = 0u;
        if block < blocks {
            value = block_sums[block];
        }
        let sum = inclusive_sum(local, value);
        if block < blocks {
            block_sums[block] = before + sum - value;
        }
        if local == WORKGROUP - 1u {
            turn_sum = sum;
        }
        workgroupBarrier();
        before += turn_sum;
    }
}

@compute @workgroup_size(WORKGROUP)
fn add_sums(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let bucket = invocation_of(group, groups, local);
    if bucket <= grid.mask {
        let start = starts[bucket] + block_sums[bucket / WORKGROUP];
        starts[bucket] = start;
        atomicStore(&cursors[bucket], start);
    }
    if bucket == grid.mask {
        starts[bucket + 1u] = grid.count;
    }
}

@compute @workgroup_size(WORKGROUP)
fn scatter(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < grid.count {
        ids[atomicAdd(&cursors[bucket_of_point(id)], 1u)] = id;
    }
}

// Sorts the ids of each bucket, so that nothing is left of the order in which the atomics came. Shell's sort: plain
// insertion for the few ids of a bucket, and within the driver's 65,535 turns (see common.wgsl) for some thousands.
@compute @workgroup_size(WORKGROUP)
fn order(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let bucket = invocation_of(group, groups, local);
    if bucket > grid.mask {
        return;
    }
    let start = starts[bucket];
    let end = starts[bucket + 1u];
    var gap = 1u;
    while gap < (end - start) / 3u {
        gap = 3u * gap + 1u;
    }
    for (; gap > 0u; gap /= 3u) {
        for (var next = start + gap; next < end; next++) {
            let id = ids[next];
            var slot = next;
            while slot >= start + gap && ids[slot - gap] > id {
                ids[slot] = ids[slot - gap];
                slot -= gap;
            }
            ids[slot] = id;
        }
    }
}
