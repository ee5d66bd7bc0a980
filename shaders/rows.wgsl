// Fills the rectified map of a tile for one point of the sun: what its pixels ask for, then rows and their trees.

@compute @workgroup_size(1)
fn begin() {
    for (var i = 0u; i < 8u; i++) {
        atomicStore(&asked[2u * i], 0xffffffffu);
        atomicStore(&asked[2u * i + 1u], 0u);
    }
    atomicStore(&asked[LOG_SUM], 0u);
    atomicStore(&asked[LOG_COUNT], 0u);
}

fn ask(i: u32, least: f32, greatest: f32) {
    atomicMin(&asked[2u * i], ordered(least));
    atomicMax(&asked[2u * i + 1u], ordered(greatest));
}

@compute @workgroup_size(8, 8)
fn measure(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let span = shaded_span(origin, direction, surfaces[pixel_index(id)]);
    let slice = slice_of(origin, direction);
    if span.shaded.y <= span.shaded.x || along_light(slice, span.shaded) {
        return;
    }
    ask(0u, slice.row, slice.row);
    ask(1u, slice.start + span.shaded.x * slice.sine, slice.start + span.shaded.y * slice.sine);
    ask(2u, slice.c, slice.c);
    let last = max(slice.start + span.shaded.y * slice.sine, 1e-9);
    atomicAdd(&asked[LOG_SUM], u32(clamp(round(16.0 * (log2(last) + 32.0)), 0.0, 1023.0)));
    atomicAdd(&asked[LOG_COUNT], 1u);
}

var<workgroup> entries: array<u32, 1024>;
var<workgroup> parents: array<u32, 256>;

fn joined(a: u32, b: u32, c: u32, d: u32) -> u32 {
    let least = min(min(a & 0xffffu, b & 0xffffu), min(c & 0xffffu, d & 0xffffu));
    return least | (max(max(a >> 16u, b >> 16u), max(c >> 16u, d >> 16u)) << 16u);
}

@compute @workgroup_size(64)
fn build(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let rows = rows_of(knobs.rows, knobs.columns);
    let blocks = knobs.columns / 8u;
    let used = select(0u, blocks, group.x < rows.count);
    let first_leaf = tree_row(group.x, blocks);
    let row = row_middle(rows, group.x);
    // In an orthographic view all rays have the angle of any.
    let any_ray = slice_of(vec3f(0.0), rays[0].xyz);
    for (var block = local; block < used; block += 64u) {
        var leaf = vec4u(0u);
        var least = 65535u;
        var greatest = 0u;
        for (var k = 0u; k < 8u; k++) {
            let a = across_of(rows, (f32(8u * block + k) + 0.5) / f32(rows.columns));
            let d = threshold_bits(rows, slice_threshold(any_ray, slice_height(slice_place(row, a)), a));
            leaf[k / 2u] |= d << (16u * (k % 2u));
            least = min(least, d);
            greatest = max(greatest, d);
        }
        count_reads(8u);
        tree[first_leaf + block] = leaf;
        entries[block] = least | (greatest << 16u);
    }
    let first = first_leaf + blocks;
    workgroupBarrier();
    for (var k = local; k < used / 4u; k += 64u) {
        let node = vec4u(entries[4u * k], entries[4u * k + 1u], entries[4u * k + 2u], entries[4u * k + 3u]);
        tree[first + k] = node;
        parents[k] = joined(node.x, node.y, node.z, node.w);
    }
    workgroupBarrier();
    for (var k = local; k < used / 16u; k += 64u) {
        let node = vec4u(parents[4u * k], parents[4u * k + 1u], parents[4u * k + 2u], parents[4u * k + 3u]);
        tree[first + blocks / 4u + k] = node;
        entries[k] = joined(node.x, node.y, node.z, node.w);
    }
    workgroupBarrier();
    for (var k = local; k < used / 64u; k += 64u) {
        tree[first + blocks / 4u + blocks / 16u + k] =
            vec4u(entries[4u * k], entries[4u * k + 1u], entries[4u * k + 2u], entries[4u * k + 3u]);
    }
    report_counts();
}
