// One step of relaxation: tiles push and pull each other into rows and walk on the surface.
// The twin of src/compute/cpu/relax.rs, src/surface/walk.rs and src/geometry.rs: the same operations in the same order, so that
// both give the same bits where the device rounds as IEEE 754 does.

// A triangle of the surface. `beyond`: the opposite half-edge of each half-edge; NONE where it may not be crossed.
struct Triangle {
    corners: array<u32, 3>,
    beyond: array<u32, 3>,
}

@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(1) var<storage, read> tiles: array<Tile>;
// As shaders/neighbours.wgsl makes them.
@group(0) @binding(2) var<storage, read> lists: array<u32>;
// The vertices of the surface, each with the relative size of tiles there.
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> triangles: array<Triangle>;
// The crosses at the corners of each triangle, against its first edge.
@group(0) @binding(5) var<storage, read> crosses: array<array<vec2<f32>, 3>>;
@group(0) @binding(6) var<storage, read_write> moved: array<Tile>;
// The scale of the tiles' sizes.
@group(0) @binding(7) var<uniform> scale: f32;

// The same numbers stand in src/compute; tests/shaders.rs compares them.
const LEAST_COSINE: f32 = 0.2;
const SHEET: f32 = 0.6;
const STEP: f32 = 0.7;
const DIAGONAL: f32 = 0.5;
const MOST_EDGES: u32 = 256u;
const ARC: vec3<f32> = vec3<f32>(0.16666667, 0.075, 0.04464286);

fn cross3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

fn unit(a: vec3<f32>) -> vec3<f32> {
    let length = sqrt(dot3(a, a));
    if length > 0.0 {
        return a / length;
    }
    return a;
}

// ---- Crosses ----

fn half_angle(c: f32, s: f32) -> vec2<f32> {
    if c >= 0.0 {
        let x = sqrt((1.0 + c) * 0.5);
        return vec2<f32>(x, s / (2.0 * x));
    }
    let y = sqrt((1.0 - c) * 0.5);
    let x = abs(s) / (2.0 * y);
    return vec2<f32>(x, select(y, -y, s < 0.0));
}

fn fourth_root(z: vec2<f32>) -> vec2<f32> {
    let length = sqrt(z.x * z.x + z.y * z.y);
    if length > 0.0 {
        let half = half_angle(z.x / length, z.y / length);
        return half_angle(half.x, half.y);
    }
    return vec2<f32>(1.0, 0.0);
}

fn corner(triangle: u32, k: u32) -> vec3<f32> {
    return points[triangles[triangle].corners[k]].xyz;
}

// How far a point of a triangle is towards its second and third corner, in shares of the way from the first.
fn barycentric(triangle: u32, position: vec3<f32>) -> vec2<f32> {
    let a = corner(triangle, 0u);
    let b = corner(triangle, 1u);
    let c = corner(triangle, 2u);
    let double_area = cross3(b - a, c - a);
    let normal = unit(double_area);
    let total = dot3(double_area, normal);
    return vec2<f32>(
        clamp(-dot3(cross3(c - a, position - a), normal) / total, 0.0, 1.0),
        clamp(dot3(cross3(b - a, position - a), normal) / total, 0.0, 1.0),
    );
}

fn size_at(triangle: u32, share: vec2<f32>) -> f32 {
    let corners = triangles[triangle].corners;
    let a = points[corners[0]].w;
    return a + (points[corners[1]].w - a) * share.x + (points[corners[2]].w - a) * share.y;
}

fn axis_at(triangle: u32, share: vec2<f32>) -> vec3<f32> {
    let a = corner(triangle, 0u);
    let b = corner(triangle, 1u);
    let normal = unit(cross3(b - a, corner(triangle, 2u) - a));
    let wb = share.x;
    let wc = share.y;
    let wa = max(1.0 - wb - wc, 0.0);
    let z = crosses[triangle];
    let root = fourth_root(vec2<f32>(
        z[0].x * wa + z[1].x * wb + z[2].x * wc,
        z[0].y * wa + z[1].y * wb + z[2].y * wc,
    ));
    let first = unit(b - a);
    return first * root.x + cross3(normal, first) * root.y;
}

// ---- Walking ----

struct SurfacePoint {
    triangle: u32,
    position: vec3<f32>,
}

fn walk(from_triangle: u32, from_position: vec3<f32>, displacement: vec3<f32>) -> SurfacePoint {
    var t = from_triangle;
    var p = from_position;
    var heading = displacement;
    var left = 1.0;
    var entered = NONE;
    for (var edge = 0u; edge < MOST_EDGES; edge++) {
        var corners = array<vec3<f32>, 3>(corner(t, 0u), corner(t, 1u), corner(t, 2u));
        let normal = unit(cross3(corners[1] - corners[0], corners[2] - corners[0]));
        let way = heading * left;
        var exit = NONE;
        var share = 1.0;
        for (var k = 0u; k < 3u; k++) {
            let h = 3u * t + k;
            if h == entered {
                continue;
            }
            let a = corners[k];
            let inward = cross3(normal, corners[(k + 1u) % 3u] - a);
            let speed = dot3(inward, way);
            if speed < 0.0 {
                let reach = max(dot3(inward, p - a), 0.0) / (-speed);
                if reach < share {
                    share = reach;
                    exit = h;
                }
            }
        }
        p += way * share;
        if exit == NONE {
            return SurfacePoint(t, p - normal * dot3(normal, p - corners[0]));
        }
        left *= 1.0 - share;
        let k = exit % 3u;
        let along = unit(corners[(k + 1u) % 3u] - corners[k]);
        let forward = dot3(heading, along);
        let twin = triangles[t].beyond[k];
        if twin == NONE {
            heading = along * forward;
            entered = exit;
            continue;
        }
        let across = -dot3(heading, cross3(normal, along));
        t = twin / 3u;
        entered = twin;
        let a = corner(t, 0u);
        let beyond_normal = unit(cross3(corner(t, 1u) - a, corner(t, 2u) - a));
        heading = along * forward + cross3(along, beyond_normal) * across;
    }
    let a = corner(t, 0u);
    let normal = unit(cross3(corner(t, 1u) - a, corner(t, 2u) - a));
    return SurfacePoint(t, p - normal * dot3(normal, p - a));
}

// ---- The force ----

// One tile as another sees it: mean axes, place in these axes in tile sides, mean side; `seen` false where it does not.
struct Sight {
    seen: bool,
    x: vec3<f32>,
    y: vec3<f32>,
    u: vec2<f32>,
    h: f32,
}

fn see(a: Tile, b: Tile) -> Sight {
    var sight: Sight;
    let h = (a.h + b.h) * 0.5;
    let e = b.position - a.position;
    if dot3(e, e) > (REACH * h) * (REACH * h) {
        return sight;
    }
    let cosine = dot3(a.normal, b.normal);
    if cosine < LEAST_COSINE {
        return sight;
    }
    let n = a.normal + b.normal;
    let nn = dot3(n, n);
    let height = dot3(e, n);
    if height * height > (SHEET * h) * (SHEET * h) * nn {
        return sight;
    }
    let bx = b.axis;
    let by = cross3(b.normal, b.axis);
    let behind = h * 1e-3;
    if ((b.quarters == 1u || b.quarters == 2u) && dot3(e, by) > behind)
        || (b.quarters == 1u && dot3(e, bx) > behind) {
        return sight;
    }
    let dx = dot3(a.axis, bx);
    let dy = dot3(a.axis, by);
    let turned = select(0.0, 1.0, abs(dx) < abs(dy));
    let sum = a.axis + bx * ((1.0 - turned) * sign_of(dx)) + by * (turned * sign_of(dy));
    let x = sum - n * (dot3(n, sum) / nn);
    let xx = dot3(x, x);
    var scale = 0.0;
    if xx > 0.0 {
        scale = 1.0 / sqrt(xx);
    }
    sight.x = x * scale;
    sight.y = cross3(n, sight.x) * (1.0 / sqrt(nn));
    let s2 = (1.0 - cosine) * 0.5;
    let stretch = (1.0 + s2 * (ARC.x + s2 * (ARC.y + s2 * ARC.z))) / h;
    sight.u = vec2<f32>(dot3(e, sight.x) * stretch, dot3(e, sight.y) * stretch);
    sight.h = h;
    sight.seen = true;
    return sight;
}

fn sign_of(t: f32) -> f32 {
    return select(1.0, -1.0, t < 0.0);
}

fn away(t: f32, first: bool) -> f32 {
    return select(-1.0, 1.0, t > 0.0 || (t == 0.0 && first));
}

// The place in the lattice, next to the tile, that is nearest to where the other lies; `u` within 1.5.
fn place(u: vec2<f32>, first: bool) -> vec2<f32> {
    let k = select(vec2<f32>(0.0), vec2<f32>(sign_of(u.x), sign_of(u.y)), abs(u) > vec2<f32>(0.5));
    if k.x != 0.0 || k.y != 0.0 {
        return k;
    }
    if abs(u.x) >= abs(u.y) {
        return vec2<f32>(away(u.x, first), 0.0);
    }
    return vec2<f32>(0.0, away(u.y, first));
}

@compute @workgroup_size(WORKGROUP)
fn relax(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= grid.count {
        return;
    }
    let tile = tiles[id];
    if tile.quarters > 0u {
        moved[id] = tile;
        return;
    }
    var force = vec3<f32>(0.0);
    var weight = 0.0;
    for (var slot = 0u; slot < LIST_LENGTH; slot++) {
        let other = lists[slot * grid.count + id];
        if other == NONE {
            break;
        }
        let sight = see(tile, tiles[other]);
        if !sight.seen || abs(sight.u.x) >= 1.5 || abs(sight.u.y) >= 1.5 {
            continue;
        }
        let k = place(sight.u, id < other);
        let w = select(1.0, DIAGONAL, k.x != 0.0 && k.y != 0.0);
        force += (sight.x * (sight.u.x - k.x) + sight.y * (sight.u.y - k.y)) * (w * sight.h);
        weight += w;
    }
    let step = force * (STEP / max(weight, 2.0));
    let foot = walk(tile.triangle, tile.position, step - tile.normal * dot3(tile.normal, step));
    let a = corner(foot.triangle, 0u);
    var result = tile;
    result.position = foot.position;
    result.triangle = foot.triangle;
    result.normal = unit(cross3(corner(foot.triangle, 1u) - a, corner(foot.triangle, 2u) - a));
    let share = barycentric(foot.triangle, foot.position);
    result.h = scale * size_at(foot.triangle, share);
    result.axis = axis_at(foot.triangle, share);
    moved[id] = result;
}
