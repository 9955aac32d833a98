// Values carried between a level and the next coarser one; the twin of src/compute/cpu/transfer.rs.

struct Transfer {
    // The number of unknowns on the finer level.
    fine: u32,
    // On the coarser one.
    coarse: u32,
}

struct Row {
    start: u32,
    // 0: the value is fixed.
    diagonal: f32,
    mass: f32,
}

// The same number stands in src/compute; tests/shaders.rs compares them.
const MIRRORED: u32 = 0x80000000u;

struct Parent {
    // The coarse unknown, and MIRRORED where its value is taken conjugate.
    index: u32,
    turn_x: f32,
    turn_y: f32,
}

@group(0) @binding(0) var<uniform> transfer: Transfer;
@group(0) @binding(1) var<storage, read> rows: array<Row>;
@group(0) @binding(2) var<storage, read> parents: array<Parent>;
// Where the members of each coarse unknown, an aggregate, start, and after the last one their number.
@group(0) @binding(3) var<storage, read> aggregate_starts: array<u32>;
@group(0) @binding(4) var<storage, read> members: array<u32>;
@group(0) @binding(5) var<storage, read> values: array<vec2<f32>>;
@group(0) @binding(6) var<storage, read_write> result: array<vec2<f32>>;

fn interpolated(z: vec2<f32>, id: u32) -> vec2<f32> {
    let parent = parents[id];
    var c = values[parent.index & ~MIRRORED];
    c.y = select(c.y, -c.y, (parent.index & MIRRORED) != 0u);
    return vec2<f32>(
        z.x + parent.turn_x * c.x - parent.turn_y * c.y,
        z.y + parent.turn_x * c.y + parent.turn_y * c.x,
    );
}

// The coarser level's values, in the frames of the finer one.
@compute @workgroup_size(WORKGROUP)
fn prolong(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < transfer.fine && rows[id].diagonal != 0.0 {
        result[id] = interpolated(vec2<f32>(0.0, 0.0), id);
    }
}

// They are added.
@compute @workgroup_size(WORKGROUP)
fn correct(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < transfer.fine && rows[id].diagonal != 0.0 {
        result[id] = interpolated(result[id], id);
    }
}

// The sum of the finer level's values over each aggregate, in its frame.
@compute @workgroup_size(WORKGROUP)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= transfer.coarse {
        return;
    }
    var sum = vec2<f32>(0.0, 0.0);
    let end = aggregate_starts[id + 1u];
    for (var m = aggregate_starts[id]; m < end; m++) {
        let member = members[m];
        let parent = parents[member];
        var z = values[member];
        sum.x = sum.x + parent.turn_x * z.x + parent.turn_y * z.y;
        z = select(z, -z, (parent.index & MIRRORED) != 0u);
        sum.y = sum.y + parent.turn_x * z.y - parent.turn_y * z.x;
    }
    result[id] = sum;
}
