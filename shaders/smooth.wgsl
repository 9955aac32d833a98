// The equations of the cross field on one level of the hierarchy; the twin of src/field/smooth.rs.

struct Sweep {
    // The number of unknowns on this level.
    count: u32,
    // The share of the residual, over the diagonal, that a value is moved by.
    step: f32,
}

struct Row {
    // Where its links start; the next row's start is their end.
    start: u32,
    // What its own value is multiplied by; 0: its value is fixed.
    diagonal: f32,
    // The part of the diagonal that draws it to itself.
    anchor: f32,
}

struct Link {
    // The unknown, and MIRRORED where its value is taken conjugate.
    neighbour: u32,
    weight_x: f32,
    weight_y: f32,
}

@group(0) @binding(0) var<uniform> sweep: Sweep;
@group(0) @binding(1) var<storage, read> rows: array<Row>;
@group(0) @binding(2) var<storage, read> links: array<Link>;
@group(0) @binding(3) var<storage, read> pulls: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read> wanted: array<vec2<f32>>;
@group(0) @binding(5) var<storage, read> values: array<vec2<f32>>;
@group(0) @binding(6) var<storage, read_write> made: array<vec2<f32>>;

// The same numbers stand in src/field/smooth.rs.
const HEARD: f32 = 0.45;
const LEAST_LENGTH: f32 = 1e-18;
const MIRRORED: u32 = 0x80000000u;

// What is left of `asked` once a row of the values has got its part; nothing on a fixed one.
fn left_of(asked: vec2<f32>, id: u32) -> vec2<f32> {
    let diagonal = rows[id].diagonal;
    if diagonal == 0.0 {
        return vec2<f32>(0.0, 0.0);
    }
    var sum = asked - diagonal * values[id];
    let end = rows[id + 1u].start;
    for (var e = rows[id].start; e < end; e++) {
        let link = links[e];
        var z = values[link.neighbour & ~MIRRORED];
        z.y = select(z.y, -z.y, (link.neighbour & MIRRORED) != 0u);
        sum.x = sum.x + link.weight_x * z.x - link.weight_y * z.y;
        sum.y = sum.y + link.weight_x * z.y + link.weight_y * z.x;
    }
    return sum;
}

// A value moved by a step of its residual.
fn stepped(z: vec2<f32>, residual: vec2<f32>, id: u32) -> vec2<f32> {
    let diagonal = rows[id].diagonal;
    if diagonal == 0.0 {
        return z;
    }
    let factor = sweep.step / diagonal;
    return z + factor * residual;
}

// The residual of crosses whose anchors draw them to what they are.
fn unsettled(id: u32) -> vec2<f32> {
    var z = values[id];
    let length = sqrt(z.x * z.x + z.y * z.y);
    if length > LEAST_LENGTH && length < HEARD {
        z = z / length * HEARD;
    }
    return left_of(pulls[id] + rows[id].anchor * z, id);
}

@compute @workgroup_size(WORKGROUP)
fn begin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        made[id] = unsettled(id);
    }
}

// A sweep from zero.
@compute @workgroup_size(WORKGROUP)
fn sweep_first(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        made[id] = stepped(vec2<f32>(0.0, 0.0), wanted[id], id);
    }
}

@compute @workgroup_size(WORKGROUP)
fn sweep_again(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        made[id] = stepped(values[id], left_of(wanted[id], id), id);
    }
}

@compute @workgroup_size(WORKGROUP)
fn leave(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        made[id] = left_of(wanted[id], id);
    }
}

@compute @workgroup_size(WORKGROUP)
fn apply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        made[id] = -left_of(vec2<f32>(0.0, 0.0), id);
    }
}

// A sweep of the crosses themselves, normalised.
@compute @workgroup_size(WORKGROUP)
fn flow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= sweep.count {
        return;
    }
    var z = stepped(values[id], unsettled(id), id);
    let length = sqrt(z.x * z.x + z.y * z.y);
    if length > LEAST_LENGTH {
        z = z / length;
    }
    made[id] = z;
}
