// Smoothing of the cross field on one level of the hierarchy; the twin of src/field/smooth.rs.

struct Sweep {
    // The number of unknowns on this level.
    count: u32,
    // 1: each value is normalised.
    unit: u32,
}

struct Link {
    neighbour: u32,
    weight_x: f32,
    weight_y: f32,
}

struct Parent {
    index: u32,
    turn_x: f32,
    turn_y: f32,
}

@group(0) @binding(0) var<uniform> sweep: Sweep;
// Where the links of each unknown start, and after the last one their number.
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read> links: array<Link>;
@group(0) @binding(3) var<storage, read> pulls: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read> parents: array<Parent>;
@group(0) @binding(5) var<storage, read> values: array<vec2<f32>>;
@group(0) @binding(6) var<storage, read_write> smoothed: array<vec2<f32>>;

// The same number stands in src/field/smooth.rs.
const LEAST_LENGTH: f32 = 1e-12;

@compute @workgroup_size(WORKGROUP)
fn smooth_once(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= sweep.count {
        return;
    }
    var sum = pulls[id];
    let end = starts[id + 1u];
    for (var e = starts[id]; e < end; e++) {
        let link = links[e];
        let z = values[link.neighbour];
        sum.x = sum.x + link.weight_x * z.x - link.weight_y * z.y;
        sum.y = sum.y + link.weight_x * z.y + link.weight_y * z.x;
    }
    if sweep.unit == 1u {
        let length = sqrt(sum.x * sum.x + sum.y * sum.y);
        if length > LEAST_LENGTH {
            sum = sum / length;
        }
    }
    smoothed[id] = sum;
}

// A coarser level's values (in `values`), read in the frames of this one.
@compute @workgroup_size(WORKGROUP)
fn prolong(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= sweep.count {
        return;
    }
    let parent = parents[id];
    let z = values[parent.index];
    smoothed[id] = vec2<f32>(
        parent.turn_x * z.x - parent.turn_y * z.y,
        parent.turn_x * z.y + parent.turn_y * z.x,
    );
}
