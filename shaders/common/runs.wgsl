// Lit runs of a ray, integrated one by one as they are found from the eye outward.

struct Span {
    // Where there is air, up to the surface.
    air: vec2f,
    // The part of it that anything can shade.
    shaded: vec2f,
    // Which media send light.
    sources: u32,
}

// The part of a ray on which there is any air that can be seen.
fn air_span(origin: vec3f, direction: vec3f) -> vec2f {
    var span = vec2f(FARTHEST, 0.0);
    for (var i = 0u; i < tile.media; i++) {
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

fn shaded_span(origin: vec3f, direction: vec3f, surface: Surface) -> Span {
    let air = air_span(origin, direction);
    let end = min(ray_end(surface, origin, direction), air.y);
    var span: Span;
    span.sources = sources_of(surface);
    span.air = vec2f(air.x, max(end, air.x));
    let between = shadow_span(origin, direction);
    span.shaded.x = clamp(between.x, span.air.x, span.air.y);
    span.shaded.y = clamp(between.y, span.shaded.x, span.air.y);
    return span;
}

var<private> run_origin: vec3f;
var<private> run_direction: vec3f;
var<private> run_one_minus_mu: f32;
var<private> run_end: f32;
var<private> run_sources: u32;
var<private> run_sum: vec3f;
// Borders of light and shadow that are not integrated yet: light from the first on, shadow from the second on, and so on.
var<private> run_borders: array<f32, 16>;
var<private> run_count: u32;
// The piece without bends in which the last run ended.
var<private> run_piece: Piece;
var<private> run_piece_span: vec2f;
// Parts of the ray, in order, that are left out; and the first of them that may still come.
var<private> run_gaps: array<vec2f, MOST_RAMPS>;
var<private> run_gap_count: u32;
var<private> run_gap: u32;

// A ray that is lit from the beginning of its air on, until it turns.
fn begin_runs(origin: vec3f, direction: vec3f, air: vec2f, sources: u32) {
    let apart = direction - beam.toward;
    run_origin = origin;
    run_direction = direction;
    run_one_minus_mu = 0.5 * dot(apart, apart);
    run_end = air.y;
    run_sources = sources;
    run_sum = vec3f(0.0);
    run_borders[0] = air.x;
    run_count = 1u;
    run_piece_span = vec2f(-1.0);
    run_gap = 0u;
}

fn is_lit() -> bool {
    return (run_count & 1u) != 0u;
}

// From the distance t on the ray is lit, or not.
fn turn(lit: bool, t: f32) {
    if lit != is_lit() {
        run_borders[run_count] = t;
        run_count += 1u;
    }
}

// Whether the borders must be integrated before the next turn. They are kept for a while since neighbouring rays turn at
// different times, and integrate faster together.
fn is_full() -> bool {
    return run_count >= 15u;
}

// Adds what the finished runs scatter to the eye to run_sum [1/sr, per unit of illuminance]. They are split at the faces of
// boxes and where their depth toward the sun bends. Large: call it in one place of a shader.
fn integrate_runs() {
    for (var k = 0u; k + 1u < run_count; k += 2u) {
        var at = run_borders[k];
        let end = run_borders[k + 1u];
        // Each box gives at most fourteen bends.
        for (var guard = 0u; guard <= 14u * tile.media + 3u * run_gap_count && at < end; guard++) {
            if run_gap < run_gap_count && run_gaps[run_gap].x <= at {
                at = max(at, min(end, run_gaps[run_gap].y));
                run_gap += u32(at >= run_gaps[run_gap].y);
                continue;
            }
            if at >= run_piece_span.y || at < run_piece_span.x {
                run_piece_span = vec2f(at, min(run_end, next_bend(run_origin, run_direction, beam.toward, at)));
                run_piece = homogeneous(run_origin, run_direction, at, run_piece_span.y, beam.toward, run_one_minus_mu, run_sources);
            }
            var next = min(end, run_piece_span.y);
            if run_gap < run_gap_count {
                next = min(next, run_gaps[run_gap].x);
            }
            run_sum += scattered_part(run_piece, run_piece_span.x, run_origin, run_direction, at, next, beam.toward,
                                      run_one_minus_mu, run_sources);
            at = next;
        }
    }
    if is_lit() {
        run_borders[0] = run_borders[run_count - 1u];
        run_count = 1u;
    } else {
        run_count = 0u;
    }
}
