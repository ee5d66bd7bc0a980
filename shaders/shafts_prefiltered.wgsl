// Sunlight scattered by the air from prefix sums of rows: how many columns up to a place are lit, for some values of c.

// The value in 16 bits of a threshold; 65535 is dark for all rays.
fn threshold_at(k: u32) -> f32 {
    return 65534.0 * f32(k) / f32(knobs.thresholds - 1u);
}

// Each invocation sums one threshold over a row.
@compute @workgroup_size(64)
fn sum_rows(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let blocks = knobs.columns / 8u;
    let thresholds = knobs.thresholds;
    if group.x >= rows_of(knobs.rows, knobs.columns).count {
        return;
    }
    for (var k = local; k < thresholds; k += 64u) {
        let own = vec4u(u32(threshold_at(k)));
        let next = vec4u(u32(threshold_at(min(k + 1u, thresholds - 1u))));
        var sum = 0u;
        var at = group.x * (blocks + 1u) * thresholds + k;
        sums[at] = 0u;
        for (var block = 0u; block < blocks; block++) {
            let leaf = tree[tree_row(group.x, blocks) + block];
            let low = leaf & vec4u(0xffffu);
            let high = leaf >> vec4u(16u);
            let lit = vec4u(own >= low) + vec4u(own >= high) + ((vec4u(next >= low) + vec4u(next >= high)) << vec4u(16u));
            sum += lit.x + lit.y + lit.z + lit.w;
            at += thresholds;
            sums[at] = sum;
        }
    }
}

// Lit columns before a place (in leaves) of a row for a value of c (in thresholds).
fn lit_before(row: u32, place: f32, value: f32) -> f32 {
    let blocks = knobs.columns / 8u;
    let thresholds = knobs.thresholds;
    let k = min(u32(value), thresholds - 1u);
    let block = u32(place);
    let at = (row * (blocks + 1u) + block) * thresholds + k;
    let share = clamp(value - f32(k), 0.0, 1.0);
    count_reads(1u);
    let here = sums[at];
    let before = mix(f32(here & 0xffffu), f32(here >> 16u), share);
    let rest = place - f32(block);
    if rest < 1e-4 || block == blocks {
        return before;
    }
    count_reads(1u);
    let there = sums[at + thresholds];
    return mix(before, mix(f32(there & 0xffffu), f32(there >> 16u), share), rest);
}

@compute @workgroup_size(8, 8)
fn look_up(@builtin(global_invocation_id) id: vec3u) {
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
    let slice = slice_of(origin, direction);
    let rows = rows_of(knobs.rows, knobs.columns);
    let row = u32(clamp((slice.row - rows.first) / rows.step, 0.0, f32(rows.count - 1u)));
    let along = span.shaded.y <= span.shaded.x || along_light(slice, span.shaded);
    let value = clamp(1.0 + (slice.c - rows.low) * rows.scale, 0.0, 65534.0) * f32(knobs.thresholds - 1u) / 65534.0;
    let places = f32(rows.columns) / 8.0;
    let from_place = clamp(place_of(rows, slice.start + span.shaded.x * slice.sine) * places, 0.0, places);
    let to_place = clamp(place_of(rows, slice.start + span.shaded.y * slice.sine) * places, from_place, places);
    var turn_distance = span.shaded.x;
    if along && span.shaded.y > span.shaded.x {
        count_reads(1u);
        turn_distance = turn_along_light(slice, span.shaded);
    }
    // A ray along the light has two parts, a dark one and a lit one.
    let parts = select(knobs.blocks, 2u, along);
    begin_runs(origin, direction, span.air, span.sources);
    var sum = vec3f(0.0);
    var place = from_place;
    var before = 0.0;
    if !along {
        before = lit_before(row, place, value);
    }
    var t = span.air.x;
    // Before the first part and behind the last one all is lit.
    for (var part = 0u; part < parts + 2u; part++) {
        var end = span.shaded.x;
        var share = 1.0;
        if part == parts + 1u {
            end = span.air.y;
        } else if part > 0u && along {
            end = select(span.shaded.y, turn_distance, part == 1u);
            share = f32((slice.cosine < 0.0) == (part == 1u));
        } else if part > 0u {
            // Between whole leaves, but for the ray's own end.
            var next = to_place;
            if part < parts {
                next = clamp(round(mix(from_place, to_place, f32(part) / f32(parts))), place, to_place);
            }
            end = span.shaded.y;
            if part < parts {
                end = column_distance(rows, slice, span, 8.0 * next);
            }
            let all = 8.0 * (next - place);
            if all > 1e-3 {
                let behind = lit_before(row, next, value);
                share = clamp((behind - before) / all, 0.0, 1.0);
                before = behind;
                place = next;
            } else {
                end = max(t, select(t, end, part == parts));
            }
        }
        if end > t {
            run_borders[0] = t;
            run_borders[1] = end;
            run_count = 2u;
            run_sum = vec3f(0.0);
            integrate_runs();
            sum += share * run_sum;
            t = end;
        }
    }
    inscatter_sun[i] += vec4f(beam.strength * sum, 0.0);
    report_counts();
}
