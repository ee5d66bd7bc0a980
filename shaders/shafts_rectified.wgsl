// Sunlight scattered by the air between the exact borders of light and shadow that a row of the rectified map holds.

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
    if knobs.soft == 1u {
        run_gap_count = u32(penumbrae[PENUMBRA_SIZE * i].x);
        for (var k = 0u; k < run_gap_count; k++) {
            run_gaps[k] = penumbrae[PENUMBRA_SIZE * i + 1u + k].xy;
        }
    }
    let slice = slice_of(origin, direction);
    let rows = rows_of(knobs.rows, knobs.columns);
    let place = (slice.row - rows.first) / rows.step;
    // Two rows share by the pixel's place between their middles.
    let blended = knobs.blend > 1u;
    let between = clamp(select(floor(place), place - 0.5, blended), 0.0, f32(rows.count - 1u));
    let share = fract(between);
    var sum = vec3f(0.0);
    for (var k = 0u; k < select(1u, 2u, share > 0.0); k++) {
        sum += abs(1.0 - f32(k) - share) * scattered_in_row(origin, direction, slice, span, rows, u32(between) + k,
                                                                knobs.halvings);
    }
    inscatter_sun[i] += vec4f(beam.strength * sum, 0.0);
    report_counts();
}
