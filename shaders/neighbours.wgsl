// The tiles that each free tile may see during some steps.
// The twin of src/compute/cpu/neighbours.rs: the same ids in the same order.

@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(1) var<storage, read> tiles: array<Tile>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> ids: array<u32>;
// The first ids of all lists, then the second ones, and so on; each list ends with NONE where it is not full.
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn list(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let id = invocation_of(group, groups, local);
    if id >= grid.count {
        return;
    }
    var length = 0u;
    let tile = tiles[id];
    if tile.quarters == 0u {
        let here = cell_of(tile.position, grid.per_unit);
        for (var number = 0u; number < 9u; number++) {
            let row = row_of(here, number);
            for (var part = 0u; part < 2u; part++) {
                let run = run_of(row, part, grid.mask);
                let end = starts[run.y];
                for (var slot = starts[run.x]; slot < end && length < LIST_LENGTH; slot++) {
                    let other = ids[slot];
                    let near = tiles[other];
                    if other != id && is_near(tile, near) && in_row(cell_of(near.position, grid.per_unit), row) {
                        lists[length * grid.count + id] = other;
                        length += 1u;
                    }
                }
            }
        }
    }
    if length < LIST_LENGTH {
        lists[length * grid.count + id] = NONE;
    }
}

fn is_near(a: Tile, b: Tile) -> bool {
    let reach = (REACH + SKIN) * ((a.h + b.h) * 0.5);
    let e = b.position - a.position;
    return dot3(e, e) <= reach * reach && dot3(a.normal, b.normal) > 0.0;
}
