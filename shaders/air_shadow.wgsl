// Light that the sky lacks where geometry shadows the clear air: gathered for each point of the sun by marching, then taken.

@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;
// What the shadowed parts of the clear air would scatter to the eye, and what the whole of it would.
@group(1) @binding(1) var<storage, read_write> shadow: array<vec4f>;
@group(1) @binding(2) var<storage, read_write> whole: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> background: array<vec4f>;
// The number of steps; distance up to which shadows are seen.
@group(1) @binding(4) var<storage, read> knobs: array<f32>;

fn is_open(i: u32) -> bool {
    return surfaces[i].number == 0u && any(background[i].xyz > vec3f(0.0));
}

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let i = pixel_index(id);
    if !inside_tile(id) || !is_open(i) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    sources = ONLY_CLEAR;
    let far = knobs[1];
    let span = shadow_span(origin, direction);
    let begin = clamp(span.x, 0.0, far);
    let finish = clamp(span.y, begin, far);
    let steps = u32(knobs[0]);
    let step = (finish - begin) / f32(steps);
    let count = select(0u, steps + 1u, step > 0.0);
    // The whole ray is one run; then those of shadow take the place of light.
    begin_runs(origin, direction, vec2f(0.0, far));
    turn(false, far);
    var k = 0u;
    var all = vec3f(-1.0);
    loop {
        integrate_runs();
        if all.x < 0.0 {
            all = run_sum;
            run_sum = vec3f(0.0);
        }
        if k == count {
            break;
        }
        while k < count && !is_full() {
            let dark = k < steps && !sun_reaches(origin + (begin + (f32(k) + 0.5) * step) * direction);
            turn(dark, begin + f32(k) * step);
            k++;
        }
    }
    whole[i] += vec4f(light.illuminance * all, 0.0);
    shadow[i] += vec4f(light.illuminance * run_sum, 0.0);
}

// B becomes B (1 - S / max(T B, W)): never below zero.
@compute @workgroup_size(8, 8)
fn take(@builtin(global_invocation_id) id: vec3u) {
    let i = pixel_index(id);
    if !inside_tile(id) || !is_open(i) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let end = ray_end(surfaces[i], origin, direction);
    let seen = exp(-optical_depth(origin, direction, end)) * background[i].xyz;
    let most = max(max(seen, whole[i].xyz), vec3f(1e-30));
    background[i] *= vec4f(1.0 - min(shadow[i].xyz, whole[i].xyz) / most, 1.0);
}
