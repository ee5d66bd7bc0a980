// Sunlight scattered by the air, on virtual planes across the view. See src/effect/shafts_planes.rs.

@compute @workgroup_size(1)
fn begin() {
    atomicStore(&depths[0], 0xffffffffu);
    atomicStore(&depths[1], 0u);
}

// Depth that a ray gains in a metre. Planes of a panorama are spheres.
fn depth_rate(direction: vec3f) -> f32 {
    return select(1.0, dot(direction, tile.forward), tile.projection == PERSPECTIVE);
}

// Light from behind such an optical depth is not seen: e^-9 of it comes through.
const DEEPEST = 9.0;

fn is_seen(origin: vec3f, direction: vec3f, t: f32, sources: u32) -> bool {
    return any(optical_depth(origin, direction, t, sources) < vec3f(DEEPEST));
}

// How far into the air a ray sees: a level one may have a million kilometres of it.
fn seen_end(origin: vec3f, direction: vec3f, air: vec2f, sources: u32) -> f32 {
    if is_seen(origin, direction, air.y, sources) {
        return air.y;
    }
    var ends = air;
    for (var k = 0u; k < 32u; k++) {
        let middle = 0.5 * (ends.x + ends.y);
        ends = select(vec2f(ends.x, middle), vec2f(middle, ends.y), is_seen(origin, direction, middle, sources));
    }
    return ends.y;
}

@compute @workgroup_size(8, 8)
fn measure(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let span = shaded_span(origin, direction, surfaces[pixel_index(id)]);
    let air = span.air;
    if air.y <= air.x {
        return;
    }
    let depth = vec2f(air.x, seen_end(origin, direction, air, span.sources)) * depth_rate(direction);
    atomicMin(&depths[0], bitcast<u32>(depth.x));
    atomicMax(&depths[1], bitcast<u32>(depth.y));
}

struct Planes {
    count: u32,
    // Where the first slab begins, and the slabs' thickness. A plane stands in the middle of its slab.
    first: f32,
    spacing: f32,
}

fn all_planes() -> Planes {
    let first = bitcast<f32>(atomicLoad(&depths[0]));
    let last = bitcast<f32>(atomicLoad(&depths[1]));
    return Planes(knobs.planes, first, (last - first) / f32(knobs.planes));
}

// Lattice points of a plane, as far as there are pixels between them.
fn lattice_size() -> vec2u {
    return min(vec2u(knobs.lattice), tile.extent);
}

// A lattice point's place in pixels; the first and the last stand at the tile's outermost pixels.
fn lattice_place(point: vec2u) -> vec2f {
    return vec2f(point) * vec2f(tile.extent - 1u) / max(vec2f(lattice_size() - 1u), vec2f(1.0));
}

fn lattice_origin(point: vec2u) -> vec3f {
    if tile.projection != ORTHOGRAPHIC {
        return vec3f(0.0);
    }
    let place = lattice_place(point);
    return tile.origin + place.x * tile.origin_right + place.y * tile.origin_down;
}

// Between pixels that stand side by side a ray is between theirs.
fn lattice_direction(point: vec2u) -> vec3f {
    let place = lattice_place(point);
    let least = min(vec2u(place), tile.extent - 1u);
    let greatest = min(least + 1u, tile.extent - 1u);
    let share = place - vec2f(least);
    let above = mix(rays[least.y * tile.extent.x + least.x].xyz, rays[least.y * tile.extent.x + greatest.x].xyz, share.x);
    let below = mix(rays[greatest.y * tile.extent.x + least.x].xyz, rays[greatest.y * tile.extent.x + greatest.x].xyz, share.x);
    return normalize(mix(above, below, share.y));
}

fn lattice_index(plane: u32, point: vec2u) -> u32 {
    let size = lattice_size();
    return (plane * size.y + point.y) * size.x + point.x;
}

// What comes through to each lattice point and from there to the eye.
@compute @workgroup_size(64)
fn weigh(@builtin(global_invocation_id) id: vec3u) {
    let size = lattice_size();
    if id.x >= size.x * size.y {
        return;
    }
    let point = vec2u(id.x % size.x, id.x / size.x);
    let planes = all_planes();
    let origin = lattice_origin(point);
    let direction = lattice_direction(point);
    let t = (planes.first + (f32(id.y) + 0.5) * planes.spacing) / depth_rate(direction);
    let depth = optical_depth(origin, direction, t, ALL_MEDIA) + sun_optical_depth(origin + t * direction, beam.toward);
    lattice[lattice_index(id.y, point)] = vec4f(exp(-depth), 0.0);
}

// The lattice points around a pixel, and its place between them.
struct Cell {
    least: vec2u,
    greatest: vec2u,
    share: vec2f,
}

fn cell_of(pixel: vec2u) -> Cell {
    let last = lattice_size() - 1u;
    let place = vec2f(pixel) * vec2f(last) / max(vec2f(tile.extent - 1u), vec2f(1.0));
    let least = min(vec2u(place), last);
    return Cell(least, min(least + 1u, last), place - vec2f(least));
}

fn between(cell: Cell, corners: mat4x3f) -> vec3f {
    return mix(mix(corners[0], corners[1], cell.share.x), mix(corners[2], corners[3], cell.share.x), cell.share.y);
}

fn corner(cell: Cell, k: u32) -> vec2u {
    return select(cell.least, cell.greatest, vec2<bool>((k & 1u) != 0u, (k & 2u) != 0u));
}

fn transmittance_of(cell: Cell, plane: u32) -> vec3f {
    count_reads(4u);
    var corners: mat4x3f;
    for (var k = 0u; k < 4u; k++) {
        corners[k] = lattice[lattice_index(plane, corner(cell, k))].xyz;
    }
    return between(cell, corners);
}

// Media that a ray goes through at once; of more the planes are gone through again.
const TOGETHER = 4u;

@compute @workgroup_size(8, 8)
fn integrate(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let span = shaded_span(origin, direction, surfaces[i]);
    if span.air.y <= span.air.x {
        return;
    }
    let planes = all_planes();
    let rate = depth_rate(direction);
    // What lies behind the last slab is not seen.
    let end = min(span.air.y, (planes.first + f32(planes.count) * planes.spacing) / rate);
    let first = u32(clamp((span.air.x * rate - planes.first) / planes.spacing, 0.0, f32(planes.count - 1u)));
    let last = u32(clamp((end * rate - planes.first) / planes.spacing, f32(first), f32(planes.count - 1u)));
    let cell = cell_of(id.xy);
    var one_minus_mu: vec4f;
    for (var k = 0u; k < 4u; k++) {
        let apart = lattice_direction(corner(cell, k)) - beam.toward;
        one_minus_mu[k] = 0.5 * dot(apart, apart);
    }
    var sum = vec3f(0.0);
    for (var group = 0u; group < tile.media; group += TOGETHER) {
        let count = min(tile.media - group, TOGETHER);
        var source: array<vec3f, TOGETHER>;
        var within: array<vec2f, TOGETHER>;
        for (var m = 0u; m < count; m++) {
            let medium = media[group + m];
            var corners: mat4x3f;
            for (var k = 0u; k < 4u; k++) {
                corners[k] = source_of(medium, one_minus_mu[k], span.sources);
            }
            source[m] = between(cell, corners);
            within[m] = span.air;
            if medium.shape != HEIGHT {
                let own = chord(medium, origin, direction);
                within[m] = vec2f(max(own.x, span.air.x), min(own.y, span.air.y));
            }
        }
        var from_t = span.air.x;
        for (var k = first; k <= last; k++) {
            let slab_end = (planes.first + f32(k + 1u) * planes.spacing) / rate;
            let to = max(select(min(slab_end, end), end, k == last), from_t);
            let middle = 0.5 * (from_t + to);
            let open = middle <= span.shaded.x || middle >= span.shaded.y;
            count_reads(select(1u, 0u, open));
            if open || beam_reaches(origin + middle * direction) {
                var sent = vec3f(0.0);
                for (var m = 0u; m < count; m++) {
                    var length = clamp(min(to, within[m].y) - max(from_t, within[m].x), 0.0, FARTHEST);
                    if media[group + m].shape == HEIGHT {
                        length = base_length(media[group + m], origin, direction, from_t, to);
                    }
                    sent += source[m] * length;
                }
                sum += sent * transmittance_of(cell, k);
            }
            from_t = to;
        }
    }
    inscatter_sun[i] += vec4f(beam.strength * sum, 0.0);
    report_counts();
}
