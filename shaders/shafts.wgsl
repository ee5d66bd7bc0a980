// Sunlight scattered by the air, marched: in even steps over the part of the ray that anything can shade, the middle of a
// step says whether it is lit; runs of lit steps are integrated in closed form.

@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;
@group(1) @binding(1) var<storage, read_write> inscatter: array<vec4f>;
// The number of steps.
@group(1) @binding(2) var<storage, read> knobs: array<f32>;

// The part of a ray on which there is any air that can be seen.
fn air_span(origin: vec3f, direction: vec3f) -> vec2f {
    var span = vec2f(FARTHEST, 0.0);
    for (var i = 0u; i < frame.media; i++) {
        if media[i].shape == HEIGHT {
            return vec2f(0.0, FARTHEST);
        }
        let own = chord(media[i], origin, direction);
        if own.y > own.x {
            span = vec2f(min(span.x, own.x), max(span.y, own.y));
        }
    }
    return span;
}

@compute @workgroup_size(8, 8)
fn march(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let air = air_span(origin, direction);
    let end = min(ray_end(surfaces[i], origin, direction), air.y);
    let start = air.x;
    if end <= start {
        return;
    }
    let span = shadow_span(origin, direction);
    let begin = clamp(span.x, start, end);
    let finish = clamp(span.y, begin, end);
    let steps = u32(knobs[0]);
    let step = (finish - begin) / f32(steps);
    var lit = true;
    var since = start;
    var sum = vec3f(0.0);
    if step > 0.0 {
        for (var k = 0u; k < steps; k++) {
            let reaches = sun_reaches(origin + (begin + (f32(k) + 0.5) * step) * direction);
            if reaches == lit {
                continue;
            }
            let border = begin + f32(k) * step;
            if lit {
                sum += scattered(origin, direction, since, border, light.toward);
            }
            lit = reaches;
            since = border;
        }
    }
    if !lit && finish < end {
        since = finish;
        lit = true;
    }
    if lit {
        sum += scattered(origin, direction, since, end, light.toward);
    }
    inscatter[i] += vec4f(light.illuminance * sum, 0.0);
}
