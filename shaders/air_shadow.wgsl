// Light that the sky lacks where geometry shadows the clear air: gathered for each point of the sun by marching, then taken.

fn is_open(i: u32) -> bool {
    return surfaces[i].number == NOTHING && any(background[i].xyz > vec3f(0.0));
}

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let i = pixel_index(id);
    if !inside_tile(id) || !is_open(i) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let far = knobs.far;
    let span = shadow_span(origin, direction);
    let begin = clamp(span.x, 0.0, far);
    let finish = clamp(span.y, begin, far);
    let steps = knobs.steps;
    let step = (finish - begin) / f32(steps);
    let count = select(0u, steps + 1u, step > 0.0);
    // The whole ray is one run; then those of shadow take the place of light.
    begin_runs(origin, direction, vec2f(0.0, far), ONLY_CLEAR);
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
            let dark = k < steps && !beam_reaches(origin + (begin + (f32(k) + 0.5) * step) * direction);
            turn(dark, begin + f32(k) * step);
            k++;
        }
    }
    whole[i] += vec4f(beam.strength * all, 0.0);
    shadowed[i] += vec4f(beam.strength * run_sum, 0.0);
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
    let seen = exp(-optical_depth(origin, direction, end, ALL_BUT_CLEAR)) * background[i].xyz;
    let most = max(max(seen, whole[i].xyz), vec3f(1e-30));
    background[i] *= vec4f(1.0 - min(shadowed[i].xyz, whole[i].xyz) / most, 1.0);
}
