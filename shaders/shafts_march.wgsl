// Sunlight scattered by the air, marched: in even steps over the part of the ray that anything can shade, the middle of a
// step says whether it is lit; runs of lit steps are integrated in closed form.

// Interleaved gradient noise, 0 to 1 (Jimenez 2014).
fn noise(pixel: vec2u) -> f32 {
    return fract(52.9829189 * fract(dot(vec2f(pixel % 4096u), vec2f(0.06711056, 0.00583715))));
}

// Where the ray turns between the middles of two steps.
fn refined_border(origin: vec3f, direction: vec3f, t: f32, step: f32, lit_behind: bool, shaded: vec2f) -> f32 {
    let halvings = knobs.halvings;
    count_reads(halvings);
    var ends = clamp(vec2f(t - 0.5 * step, t + 0.5 * step), vec2f(shaded.x), vec2f(shaded.y));
    for (var k = 0u; k < halvings; k++) {
        let middle = 0.5 * (ends.x + ends.y);
        let lit = beam_reaches(origin + middle * direction);
        ends = select(vec2f(middle, ends.y), vec2f(ends.x, middle), lit == lit_behind);
    }
    return 0.5 * (ends.x + ends.y);
}

@compute @workgroup_size(8, 8)
fn march(@builtin(global_invocation_id) id: vec3u) {
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
    if knobs.soft == 1u {
        run_gap_count = u32(penumbrae[PENUMBRA_SIZE * i].x);
        for (var k = 0u; k < run_gap_count; k++) {
            run_gaps[k] = penumbrae[PENUMBRA_SIZE * i + 1u + k].xy;
        }
    }
    begin_runs(origin, direction, span.air, span.sources);
    let steps = knobs.steps;
    let step = (span.shaded.y - span.shaded.x) / f32(steps);
    // A shifted march has one step more, the first and the last in part.
    let shift = select(0.0, noise(tile.corner + id.xy), knobs.jitter > 0.5);
    let count = select(0u, steps + u32(shift > 0.0), step > 0.0);
    count_reads(count);
    // Behind the last step all is lit, and the air ends.
    var k = 0u;
    while k < count + 2u {
        while k < count + 2u && !is_full() {
            var t = span.shaded.y;
            var lit = k == count;
            if k < count {
                t = max(span.shaded.x + (f32(k) - shift) * step, span.shaded.x);
                let next = min(span.shaded.x + (f32(k) + 1.0 - shift) * step, span.shaded.y);
                lit = beam_reaches(origin + 0.5 * (t + next) * direction);
            } else if k > count {
                t = span.air.y;
            }
            // A border between two steps is told from the others by its sign until it is refined.
            turn(lit, select(t, -1.0 - t, k > 0u && k < count));
            k++;
        }
        for (var border = 0u; border < run_count; border++) {
            let t = -1.0 - run_borders[border];
            if t >= 0.0 {
                run_borders[border] = refined_border(origin, direction, t, step, (border & 1u) == 0u, span.shaded);
            }
        }
        integrate_runs();
    }
    inscatter_sun[i] += vec4f(beam.strength * run_sum, 0.0);
    report_counts();
}
