// The scalar products and the vectors of conjugate gradients; the twin of src/compute/cpu/conjugate.rs and of `descend` in
// src/compute/cpu/multigrid.rs.

struct Sum {
    // The number of values, or of sums that are summed up.
    count: u32,
    // Where the sums that are read begin, or the place of a ratio's numerator.
    numerator: u32,
    // The place of a ratio's denominator.
    denominator: u32,
    // Where sums are written to.
    to: u32,
}

@group(0) @binding(0) var<uniform> settings: Sum;
@group(0) @binding(1) var<storage, read> first: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> second: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read_write> changed: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read_write> sums: array<f32>;

var<workgroup> terms: array<f32, WORKGROUP>;

// The sum of the workgroup's terms: the second half is added to the first, and so on.
fn tree(local: u32) -> f32 {
    for (var half = WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            terms[local] = terms[local] + terms[local + half];
        }
    }
    return terms[0];
}

// The scalar products of the blocks of `first` and `second`.
@compute @workgroup_size(WORKGROUP)
fn multiply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    var term = 0.0;
    if id < settings.count {
        term = first[id].x * second[id].x + first[id].y * second[id].y;
    }
    terms[local] = term;
    let sum = tree(local);
    // The last row of workgroups may reach past the values.
    if local == 0u && id < settings.count {
        sums[settings.to + id / WORKGROUP] = sum;
    }
}

// The sums of blocks of sums.
@compute @workgroup_size(WORKGROUP)
fn total(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    var term = 0.0;
    if id < settings.count {
        term = sums[settings.numerator + id];
    }
    terms[local] = term;
    let sum = tree(local);
    if local == 0u && id < settings.count {
        sums[settings.to + id / WORKGROUP] = sum;
    }
}

fn ratio() -> f32 {
    let denominator = sums[settings.denominator];
    if denominator > 0.0 {
        return sums[settings.numerator] / denominator;
    }
    return 0.0;
}

// changed <- first + ratio changed
@compute @workgroup_size(WORKGROUP)
fn direction(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < settings.count {
        changed[id] = first[id] + ratio() * changed[id];
    }
}

// changed <- changed + ratio first
@compute @workgroup_size(WORKGROUP)
fn advance(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < settings.count {
        changed[id] = changed[id] + ratio() * first[id];
    }
}

// changed <- changed - ratio first
@compute @workgroup_size(WORKGROUP)
fn retreat(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id < settings.count {
        changed[id] = changed[id] - ratio() * first[id];
    }
}
