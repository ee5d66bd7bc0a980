// Lit runs of a ray, integrated one by one as they are found from the eye outward.

struct Span {
    // Where there is air, up to the surface.
    air: vec2f,
    // The part of it that anything can shade.
    shaded: vec2f,
}

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

fn shaded_span(origin: vec3f, direction: vec3f, surface: f32) -> Span {
    let air = air_span(origin, direction);
    let end = min(min(surface, air_end(origin, direction)), air.y);
    var span: Span;
    span.air = vec2f(air.x, max(end, air.x));
    let between = shadow_span(origin, direction);
    span.shaded.x = clamp(between.x, span.air.x, span.air.y);
    span.shaded.y = clamp(between.y, span.shaded.x, span.air.y);
    return span;
}

var<private> run_origin: vec3f;
var<private> run_direction: vec3f;
var<private> run_one_minus_mu: f32;
var<private> run_lit: bool;
var<private> run_since: f32;
var<private> run_end: f32;
var<private> run_sum: vec3f;
// The piece without bends in which the last run ended.
var<private> run_piece: Piece;
var<private> run_piece_span: vec2f;

// A ray that is lit from the beginning of its air on, until it turns.
fn begin_runs(origin: vec3f, direction: vec3f, air: vec2f) {
    let apart = direction - light.toward;
    run_origin = origin;
    run_direction = direction;
    run_one_minus_mu = 0.5 * dot(apart, apart);
    run_lit = true;
    run_since = air.x;
    run_end = air.y;
    run_sum = vec3f(0.0);
    run_piece_span = vec2f(-1.0);
}

// From the distance t on the ray is lit, or not: the run that ends there adds to run_sum [1/sr, per unit of illuminance]. It
// is split at the faces of boxes and where their depth toward the sun bends. Large: call it in one place of a shader.
fn turn(lit: bool, t: f32) {
    if lit == run_lit {
        return;
    }
    var at = select(t, run_since, run_lit);
    // Each box gives at most fourteen bends.
    for (var guard = 0u; guard <= 14u * frame.media && at < t; guard++) {
        if at >= run_piece_span.y || at < run_piece_span.x {
            run_piece_span = vec2f(at, min(run_end, next_bend(run_origin, run_direction, light.toward, at)));
            run_piece = homogeneous(run_origin, run_direction, at, run_piece_span.y, light.toward, run_one_minus_mu);
        }
        let next = min(t, run_piece_span.y);
        run_sum += scattered_part(run_piece, run_piece_span.x, run_origin, run_direction, at, next, light.toward,
                                  run_one_minus_mu);
        at = next;
    }
    run_lit = lit;
    run_since = t;
}
