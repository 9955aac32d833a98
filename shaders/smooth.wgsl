// The equations of one level: residuals and Jacobi sweeps; the twin of src/compute/cpu/smooth.rs.

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
    // The part of the diagonal that draws it to itself: a mass over a time step.
    mass: f32,
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
@group(0) @binding(3) var<storage, read> right_hand_side: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read> wanted: array<vec2<f32>>;
@group(0) @binding(5) var<storage, read> values: array<vec2<f32>>;
@group(0) @binding(6) var<storage, read_write> result: array<vec2<f32>>;

// The same numbers stand in src/compute; tests/shaders.rs compares them.
const TARGET_LENGTH: f32 = 0.45;
const NEGLIGIBLE: f32 = 1e-18;
const MIRRORED: u32 = 0x80000000u;

// What is left of `asked` once a row's part of the values is taken off; nothing on a fixed one.
fn remainder_of(asked: vec2<f32>, id: u32) -> vec2<f32> {
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

// A value moved by `step` times its residual over the diagonal.
fn stepped(z: vec2<f32>, residual: vec2<f32>, id: u32) -> vec2<f32> {
    let diagonal = rows[id].diagonal;
    if diagonal == 0.0 {
        return z;
    }
    let factor = sweep.step / diagonal;
    return z + factor * residual;
}

// The residual of values that mass terms draw to themselves.
fn residual_of(id: u32) -> vec2<f32> {
    var z = values[id];
    let length = sqrt(z.x * z.x + z.y * z.y);
    if length > NEGLIGIBLE && length < TARGET_LENGTH {
        z = z / length * TARGET_LENGTH;
    }
    return remainder_of(right_hand_side[id] + rows[id].mass * z, id);
}

@compute @workgroup_size(WORKGROUP)
fn residual(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        result[id] = residual_of(id);
    }
}

// A sweep from zero.
@compute @workgroup_size(WORKGROUP)
fn first_sweep(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        result[id] = stepped(vec2<f32>(0.0, 0.0), wanted[id], id);
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
        result[id] = stepped(values[id], remainder_of(wanted[id], id), id);
    }
}

@compute @workgroup_size(WORKGROUP)
fn remainder(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < sweep.count {
        result[id] = remainder_of(wanted[id], id);
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
        result[id] = -remainder_of(vec2<f32>(0.0, 0.0), id);
    }
}

// A sweep of the values themselves; then they are divided by their moduli.
@compute @workgroup_size(WORKGROUP)
fn normalised_sweep(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= sweep.count {
        return;
    }
    var z = stepped(values[id], residual_of(id), id);
    let length = sqrt(z.x * z.x + z.y * z.y);
    if length > NEGLIGIBLE {
        z = z / length;
    }
    result[id] = z;
}
