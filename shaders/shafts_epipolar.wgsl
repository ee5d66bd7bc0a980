// Sunlight scattered by the air at sparse places of slices, refined where it bends or depth breaks, and blended for pixels.

fn is_known(sample: vec4f) -> bool {
    return sample.x >= 0.0;
}

fn sample_index(slice: u32, number: u32) -> u32 {
    return slice * (knobs.samples + 1u) + number;
}

// How deep the air of a ray is, with the sign that samples have. Ground that the air lies on ends it too, whichever of the two
// rounding puts first.
fn end_of(span: Span, surface: Surface) -> f32 {
    let depth = span.air.y - span.air.x;
    return select(-depth, depth, surface.distance <= 1.0001 * span.air.y);
}

// How much a sample whose air ends elsewhere says of a ray: 1 at the same depth, 0 a tenth off or of another kind.
fn likeness(end: f32, other: f32) -> f32 {
    let apart = abs(other - end) / max(min(abs(end), abs(other)), 1e-30);
    return select(0.0, clamp(1.0 - 10.0 * apart, 0.0, 1.0), end * other > 0.0);
}

// c of a sample; the outermost lie on the borders of what is asked for.
fn sample_c(rows: Rows, number: u32) -> f32 {
    return rows.low + 65533.0 / rows.scale * f32(number) / f32(knobs.samples);
}

fn sample_row(rows: Rows, slice: u32) -> f32 {
    return rows.first + (f32(slice) + 0.5) * rows.step * f32(rows.count) / f32(knobs.slices);
}

// A sample's ray, in its slice at its own c.
struct Sample {
    slice: Slice,
    origin: vec3f,
    direction: vec3f,
}

fn from_axis_parts(p: vec3f) -> vec3f {
    return p.x * beam.across.xyz + p.y * beam.along.xyz + p.z * beam.height.xyz;
}

fn sample_of(rows: Rows, slice_number: u32, number: u32) -> Sample {
    var found: Sample;
    let c = sample_c(rows, number);
    let row = sample_row(rows, slice_number);
    let e = reference_across();
    if tile.projection == ORTHOGRAPHIC {
        // Row and c are coordinates on the camera's plane, along axes at right angles, wherever the sun stands.
        found.direction = rays[0].xyz;
        let d = axis_parts(found.direction);
        found.origin = from_axis_parts(vec3f(row * vec2f(-e.y, e.x) - c * d.z * e, c * length(d.xy)));
        found.slice = slice_of(found.origin, found.direction);
        return found;
    }
    let size = length(vec2f(1.0 - abs(c), c));
    found.slice.row = row;
    found.slice.sine = (1.0 - abs(c)) / size;
    found.slice.cosine = c / size;
    found.slice.c = c;
    let turn = vec2f(cos(row), sin(row));
    let across = found.slice.sine * vec2f(turn.x * e.x - turn.y * e.y, turn.x * e.y + turn.y * e.x);
    found.direction = from_axis_parts(vec3f(across, found.slice.cosine));
    return found;
}

// The pixel in which a sample's ray lies; far beyond the tile where there is none.
fn pixel_of(sample: Sample) -> vec2i {
    let d = vec3f(dot(sample.direction, tile.right), dot(sample.direction, tile.up), dot(sample.direction, tile.forward));
    var place = d.xy / d.z;
    if tile.projection == ORTHOGRAPHIC {
        place = vec2f(dot(sample.origin, tile.right), dot(sample.origin, tile.up));
    } else if tile.projection == PANORAMA {
        const PI = 3.14159265358979;
        place = vec2f(atan2(d.x, d.z), 2.0 * atan2(d.y, length(d.xz))) / PI;
    } else if d.z <= 1e-6 {
        return vec2i(-1000000);
    }
    // The projection is that of a whole tile.
    let clip = tile.project.xz * place + tile.project.yw;
    var at = (0.5 + vec2f(0.5, -0.5) * clip) * tile.whole;
    if tile.projection == PANORAMA {
        // Once around is the width of the picture.
        let width = tile.project.x * tile.whole.x;
        at.x -= width * floor((at.x + f32(tile.corner.x)) / width);
    }
    return vec2i(floor(clamp(at, vec2f(-1e6), vec2f(1e6))));
}

// Every sample's pixel tells where its air ends.
@compute @workgroup_size(16, 16)
fn place(@builtin(global_invocation_id) id: vec3u) {
    let slices = knobs.slices;
    if id.y >= slices || !is_asked() {
        return;
    }
    let rows = rows_of(knobs.rows, knobs.columns);
    let sample = sample_of(rows, id.y, id.x);
    var pixel = pixel_of(sample);
    // A pixel beyond the border stands for what its border's pixel shows.
    let inside = vec2i(tile.extent) - 1;
    if all(pixel >= vec2i(-2)) && all(pixel <= inside + 2) {
        pixel = clamp(pixel, vec2i(0), inside);
    }
    var end = 0.0;
    if all(pixel >= vec2i(0)) && all(pixel <= inside) {
        let at = vec3u(vec2u(pixel), 0u);
        var surface = surfaces[pixel_index(at)];
        // The sample's ray meets the pixel's surface in its plane, else its distance would go in steps.
        let met = ray_origin(at) + surface.distance * ray_direction(at) - sample.origin;
        let distance = dot(surface.facet, met) / dot(surface.facet, sample.direction);
        if surface.number != NOTHING && distance > 0.5 * surface.distance && distance < 2.0 * surface.distance {
            surface.distance = distance;
        }
        let span = shaded_span(sample.origin, sample.direction, surface);
        end = select(0.0, end_of(span, surface), span.shaded.y > span.shaded.x);
    }
    samples[sample_index(id.y, id.x)] = vec4f(vec3f(-1.0), end);
    if id.x == 0u {
        samples[sample_index(id.y, knobs.samples)] = vec4f(0.0);
    }
    report_counts();
}

// A sample's light, exactly.
fn sample_light(rows: Rows, slice_number: u32, number: u32) -> vec3f {
    let end = samples[sample_index(slice_number, number)].w;
    if end == 0.0 {
        return vec3f(0.0);
    }
    let sample = sample_of(rows, slice_number, number);
    var surface: Surface;
    surface.number = select(NOTHING, GROUND, end > 0.0);
    surface.distance = select(NO_HIT, air_span(sample.origin, sample.direction).x + end, end > 0.0);
    let span = shaded_span(sample.origin, sample.direction, surface);
    let row = min(u32((f32(slice_number) + 0.5) * f32(rows.count) / f32(knobs.slices)), rows.count - 1u);
    return scattered_in_row(sample.origin, sample.direction, sample.slice, span, rows, row, knobs.halvings);
}

// Every sixteenth sample. Neighbouring invocations are neighbours across slices, here and below: at the same angle they do much
// the same.
@compute @workgroup_size(8, 8)
fn seed(@builtin(global_invocation_id) id: vec3u) {
    let number = 16u * id.y;
    if id.x >= knobs.slices || number >= knobs.samples || !is_asked() {
        return;
    }
    let rows = rows_of(knobs.rows, knobs.columns);
    let at = sample_index(id.x, number);
    samples[at] = vec4f(sample_light(rows, id.x, number), samples[at].w);
    report_counts();
}

// Whether the air goes on without a break at a sample: one over its depth lies straight between its neighbours', of the same
// kind.
fn goes_on(at: u32) -> bool {
    let ends = vec3f(samples[at - 1u].w, samples[at].w, samples[at + 1u].w);
    let q = 1.0 / ends;
    count_reads(1u);
    return ends.x * ends.y > 0.0 && ends.y * ends.z > 0.0 && abs(q.x - 2.0 * q.y + q.z) <= 0.02 * abs(q.y);
}

// Between two samples, `size` apart, whose light is known: integrates the middle one, and interpolates all others if they lie
// straight. One sample an invocation, since some drivers count the turns of all loops of a shader and end them at 65 535.
fn refine(slice: u32, interval: u32, size: u32) {
    let number = interval * size;
    if slice >= knobs.slices || number >= knobs.samples || !is_asked() {
        return;
    }
    let first = sample_index(slice, number);
    let last = first + size;
    let half = size / 2u;
    count_reads(1u);
    if is_known(samples[first + half]) {
        report_counts();
        return;
    }
    let rows = rows_of(knobs.rows, knobs.columns);
    let middle = sample_light(rows, slice, number + half);
    samples[first + half] = vec4f(middle, samples[first + half].w);
    if size > 2u {
        let a = samples[first];
        let b = samples[last];
        count_reads(2u);
        let off = abs(middle - 0.5 * (a.xyz + b.xyz));
        let most = knobs.tolerance * max(middle, max(a.xyz, b.xyz));
        var straight = a.w != 0.0 && b.w != 0.0 && all(off <= most);
        for (var at = first + 1u; at < last && straight; at++) {
            straight = goes_on(at);
        }
        for (var k = 1u; k < size && straight; k++) {
            if k != half {
                let share = f32(k % half) / f32(half);
                let between = select(mix(middle, b.xyz, share), mix(a.xyz, middle, share), k < half);
                samples[first + k] = vec4f(between, samples[first + k].w);
            }
        }
    }
    report_counts();
}

@compute @workgroup_size(8, 8)
fn refine_16(@builtin(global_invocation_id) id: vec3u) {
    refine(id.x, id.y, 16u);
}

@compute @workgroup_size(8, 8)
fn refine_8(@builtin(global_invocation_id) id: vec3u) {
    refine(id.x, id.y, 8u);
}

@compute @workgroup_size(8, 8)
fn refine_4(@builtin(global_invocation_id) id: vec3u) {
    refine(id.x, id.y, 4u);
}

@compute @workgroup_size(8, 8)
fn refine_2(@builtin(global_invocation_id) id: vec3u) {
    refine(id.x, id.y, 2u);
}

@compute @workgroup_size(8, 8)
fn unwarp(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let surface = surfaces[i];
    let span = shaded_span(origin, direction, surface);
    if span.air.y <= span.air.x {
        return;
    }
    let slice = slice_of(origin, direction);
    let rows = rows_of(knobs.rows, knobs.columns);
    let shaded = span.shaded.y > span.shaded.x && !along_light(slice, span.shaded);
    var sum = vec4f(0.0);
    if shaded {
        let end = end_of(span, surface);
        let line = clamp((slice.row - rows.first) / rows.step * f32(knobs.slices) / f32(rows.count) - 0.5, 0.0, f32(knobs.slices) - 1.0);
        let place = clamp((slice.c - rows.low) * rows.scale / 65533.0 * f32(knobs.samples), 0.0, f32(knobs.samples) - 1.0);
        for (var k = 0u; k < 4u; k++) {
            let corner = vec2f(f32(k & 1u), f32(k >> 1u));
            let at = vec2f(min(floor(line) + corner.x, f32(knobs.slices) - 1.0), min(floor(place) + corner.y, f32(knobs.samples) - 1.0));
            let near = 1.0 - abs(vec2f(floor(line), floor(place)) + corner - vec2f(line, place));
            let found = samples[sample_index(u32(at.x), u32(at.y))];
            sum += max(near.x, 0.0) * max(near.y, 0.0) * likeness(end, found.w) * vec4f(found.xyz, 1.0);
        }
        count_reads(4u);
    }
    var scattered = sum.xyz / max(sum.w, 1e-3);
    // What weighs so little lies to one side of the ray, or is hardly like it.
    if sum.w < 0.5 {
        let row = u32(clamp((slice.row - rows.first) / rows.step, 0.0, f32(rows.count - 1u)));
        scattered = scattered_in_row(origin, direction, slice, span, rows, row, knobs.halvings);
    }
    inscatter_sun[i] += vec4f(beam.strength * scattered, 0.0);
    report_counts();
}
