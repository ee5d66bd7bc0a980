// The air: optical depths and single scattering in closed form. Lengths in metres, coefficients per metre.

struct Medium {
    scattering: vec3f,
    shape: u32,
    extinction: vec3f,
    phase: u32,
    // Box: its corners. Haze: lower and upper height (y). Relative to the eye.
    least: vec3f,
    g: f32,
    greatest: vec3f,
    // Height: that of the eye over the base in scale heights; the scale height; where rays that meet nothing end.
    start: f32,
    // Clear air: depth from the site to the sun.
    overhead: vec3f,
    scale_height: f32,
    far: f32,
    // Whether it is of the clear air, whose light the models of sun and sky hold already: 1, of shape height.
    clear: u32,
    // Draine's part of the phase function and its share; `g` is that of Henyey-Greenstein's.
    g_draine: f32,
    a: f32,
    weight: f32,
}

// Which media send the light that is integrated along a ray; the others take from it all the same.
const ALL_MEDIA = 0u;
const ALL_BUT_CLEAR = 1u;
const ONLY_CLEAR = 2u;

// On a ray that meets nothing, sky and sun hold the clear air already: it sends no light then but takes from what other media send.
fn sources_of(surface: Surface) -> u32 {
    return select(ALL_MEDIA, ALL_BUT_CLEAR, surface.number == NOTHING);
}

fn is_source(medium: Medium, sources: u32) -> bool {
    return sources == ALL_MEDIA || (sources == ONLY_CLEAR) == (medium.clear != 0u);
}

// (1 - e^-x) / x.
fn phi1(x: f32) -> f32 {
    if abs(x) < 0.5 {
        return 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0 * (1.0 - x / 8.0))))));
    }
    return (1.0 - exp(-x)) / x;
}

// (1 - e^-x) / x for x not below 0.
fn phi1_3(x: vec3f) -> vec3f {
    let series = 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0 * (1.0 - x / 8.0))))));
    return select((1.0 - exp(-x)) / max(x, vec3f(0.25)), series, x < vec3f(0.5));
}

// The integral of exp(-(start + slope t)) over t from 0 to `length`, from the end where less is lost.
fn exponential_integral3(start: vec3f, slope: vec3f, length: vec3f) -> vec3f {
    let change = slope * length;
    return exp(-min(start, start + change)) * length * phi1_3(abs(change));
}

fn henyey_greenstein(g: f32, one_minus_mu: f32) -> f32 {
    const PI = 3.14159265358979;
    let below = 1.0 - g;
    let square = below * below + 2.0 * g * one_minus_mu;
    return below * (1.0 + g) / (4.0 * PI * square * sqrt(square));
}

// Phase function [1/sr] from 1 - mu; +1 looks at the sun.
fn phase_value(medium: Medium, one_minus_mu: f32) -> f32 {
    const PI = 3.14159265358979;
    let mu = 1.0 - one_minus_mu;
    let half = 0.5 * (1.0 + mu);
    let half2 = half * half;
    let half8 = half2 * half2 * half2 * half2;
    let half16 = half8 * half8;
    switch medium.phase {
        case ISOTROPIC: { return 1.0 / (4.0 * PI); }
        case RAYLEIGH: { return 3.0 / (16.0 * PI) * (1.0 + mu * mu); }
        case HENYEY_GREENSTEIN: { return henyey_greenstein(medium.g, one_minus_mu); }
        // Cornette-Shanks, Draine, and the mixture for fog.
        case DRAINE: {
            let g = medium.g_draine;
            let draine = henyey_greenstein(g, one_minus_mu) * (1.0 + medium.a * mu * mu) / (1.0 + medium.a * (1.0 + 2.0 * g * g) / 3.0);
            // Written out: some drivers take x + w (y - x) for a mix, which loses what is small beside what has no weight.
            return (1.0 - medium.weight) * henyey_greenstein(medium.g, one_minus_mu) + medium.weight * draine;
        }
        case NISHITA_HAZY: { return (1.0 + 9.0 * half8) / (8.0 * PI); }
        default: { return 33.0 / (332.0 * PI) * (1.0 + 50.0 * half16 * half16); }
    }
}

// What a medium scatters of the sun's light toward the eye where it is as dense as at its base [1/(m sr)].
fn source_of(medium: Medium, one_minus_mu: f32, sources: u32) -> vec3f {
    return select(vec3f(0.0), medium.scattering * phase_value(medium, one_minus_mu), is_source(medium, sources));
}

// The part of a half-line inside a box or a haze; an empty one has its end before its start.
fn chord(medium: Medium, origin: vec3f, direction: vec3f) -> vec2f {
    var span = vec2f(0.0, FARTHEST);
    for (var axis = 0u; axis < 3u; axis++) {
        if medium.shape == HAZE && axis != 1u {
            continue;
        }
        let o = origin[axis];
        let d = direction[axis];
        if abs(d) < 1e-30 {
            if o < medium.least[axis] || o > medium.greatest[axis] {
                return vec2f(0.0, -1.0);
            }
            continue;
        }
        let a = (medium.least[axis] - o) / d;
        let b = (medium.greatest[axis] - o) / d;
        span = vec2f(max(span.x, min(a, b)), min(span.y, max(a, b)));
    }
    return span;
}

fn inside(medium: Medium, p: vec3f) -> bool {
    if medium.shape == HAZE {
        return p.y >= medium.least.y && p.y <= medium.greatest.y;
    }
    return all(p >= medium.least) && all(p <= medium.greatest);
}

fn length_inside(medium: Medium, origin: vec3f, direction: vec3f, distance: f32) -> f32 {
    let span = chord(medium, origin, direction);
    return clamp(min(span.y, distance) - span.x, 0.0, FARTHEST);
}

// Density of a height medium along a ray, relative to its base.
fn density(medium: Medium, origin: vec3f, direction: vec3f, t: f32) -> f32 {
    return exp(min(-(medium.start + (origin.y + direction.y * t) / medium.scale_height), 50.0));
}

// Length of base air between two distances, from the denser end.
fn base_length(medium: Medium, origin: vec3f, direction: vec3f, a: f32, b: f32) -> f32 {
    let dense = max(density(medium, origin, direction, a), density(medium, origin, direction, b));
    return dense * (b - a) * phi1(abs(direction.y / medium.scale_height * (b - a)));
}

// A coefficient times a length: nothing stays nothing however long the way.
fn depth_of(extinction: vec3f, length: f32) -> vec3f {
    return min(extinction * length, vec3f(1e30));
}

// Depth of a height medium toward the sun from where it has a density: of the clear air relative to the site, so that it is
// negative above that but never below -overhead.
fn depth_above(medium: Medium, density: f32, toward: vec3f) -> vec3f {
    if medium.clear != 0u {
        return medium.overhead * (density - 1.0);
    }
    let length = select(1e30, min(density * medium.scale_height / toward.y, 1e30), toward.y > 0.0);
    return depth_of(medium.extinction, length);
}

// The change of that depth over a length of base air, with the sign turned: both are linear in each other.
fn depth_passed(medium: Medium, direction: vec3f, toward: vec3f) -> vec3f {
    if medium.clear != 0u {
        return medium.overhead * (direction.y / medium.scale_height);
    }
    return medium.extinction * (direction.y / toward.y);
}

// Distance beyond which a ray that meets nothing sees no more air; what sends no light into the sky is not looked for.
fn air_end(origin: vec3f, direction: vec3f, sources: u32) -> f32 {
    var end = 0.0;
    for (var i = 0u; i < tile.media; i++) {
        if sources == ALL_BUT_CLEAR && media[i].clear != 0u {
            continue;
        }
        if media[i].shape == HEIGHT {
            end = max(end, media[i].far);
        } else {
            let span = chord(media[i], origin, direction);
            end = max(end, select(0.0, span.y, span.y > span.x));
        }
    }
    return min(end, FARTHEST);
}

// Where a ray ends: at its surface or with the air.
fn ray_end(surface: Surface, origin: vec3f, direction: vec3f) -> f32 {
    return min(surface.distance, air_end(origin, direction, sources_of(surface)));
}

// Of the first `distance` metres of a ray: of all media, or with ALL_BUT_CLEAR without the clear air.
fn optical_depth(origin: vec3f, direction: vec3f, distance: f32, sources: u32) -> vec3f {
    var depth = vec3f(0.0);
    for (var i = 0u; i < tile.media; i++) {
        if sources == ALL_BUT_CLEAR && media[i].clear != 0u {
            continue;
        }
        if media[i].shape == HEIGHT {
            depth += depth_of(media[i].extinction, base_length(media[i], origin, direction, 0.0, distance));
        } else {
            depth += depth_of(media[i].extinction, length_inside(media[i], origin, direction, distance));
        }
    }
    return depth;
}

fn sun_optical_depth(p: vec3f, toward: vec3f) -> vec3f {
    var depth = vec3f(0.0);
    for (var i = 0u; i < tile.media; i++) {
        if media[i].shape == HEIGHT {
            depth += depth_above(media[i], density(media[i], p, vec3f(0.0), 0.0), toward);
        } else {
            depth += depth_of(media[i].extinction, length_inside(media[i], p, toward, FARTHEST));
        }
    }
    return depth;
}

// The first distance beyond `t` at which a box's or haze's depth toward the sun bends.
fn next_bend(origin: vec3f, direction: vec3f, toward: vec3f, t: f32) -> f32 {
    var next = FARTHEST;
    let after = t + 2e-7 * abs(t);
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        if medium.shape == HEIGHT {
            continue;
        }
        let span = chord(medium, origin, direction);
        if span.y > span.x {
            next = select(next, span.x, span.x > after && span.x < next);
            next = select(next, span.y, span.y > after && span.y < next);
        }
        if medium.shape == HAZE {
            continue;
        }
        for (var c = 0u; c < 3u; c++) {
            // Where the plane of ray and sun meets the edges along axis c.
            let a = (c + 1u) % 3u;
            let b = (c + 2u) % 3u;
            let determinant = direction[a] * toward[b] - direction[b] * toward[a];
            if abs(determinant) < 1e-12 {
                continue;
            }
            for (var corner = 0u; corner < 4u; corner++) {
                let p = select(medium.least[a], medium.greatest[a], (corner & 1u) != 0u) - origin[a];
                let q = select(medium.least[b], medium.greatest[b], (corner & 2u) != 0u) - origin[b];
                let at = (p * toward[b] - q * toward[a]) / determinant;
                next = select(next, at, at > after && at < next);
            }
        }
    }
    return next;
}

// What homogeneous media do on a piece of a ray without bends: depth eye to point to sun at its start, its slope, and
// the source.
struct Piece {
    depth: vec3f,
    slope: vec3f,
    source: vec3f,
}

fn homogeneous(origin: vec3f, direction: vec3f, a: f32, b: f32, toward: vec3f, one_minus_mu: f32, sources: u32) -> Piece {
    var piece = Piece(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    let length = b - a;
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        if medium.shape == HEIGHT {
            continue;
        }
        // Both samples lie inside the piece: at its ends the depth may jump (a face parallel to the sun's rays).
        let first = length_inside(medium, origin + (a + 0.25 * length) * direction, toward, FARTHEST);
        let last = length_inside(medium, origin + (a + 0.75 * length) * direction, toward, FARTHEST);
        let slope = (last - first) / (0.5 * length);
        let eye = length_inside(medium, origin, direction, a);
        // What is left of a difference below its rounding is nothing: dense media would make much of it. Divisions may be off by some
        // digits, and not alike in two places.
        let start = first - 0.25 * length * slope;
        piece.depth += medium.extinction * (select(eye, 0.0, eye < 5e-7 * a) + select(start, 0.0, start < 5e-7 * max(first, last)));
        piece.slope += medium.extinction * slope;
        if inside(medium, origin + (a + 0.5 * length) * direction) {
            piece.slope += medium.extinction;
            piece.source += source_of(medium, one_minus_mu, sources);
        }
    }
    return piece;
}

fn all_depth(piece: Piece, origin: vec3f, direction: vec3f, a: f32, t: f32, toward: vec3f) -> vec3f {
    var depth = piece.depth + piece.slope * (t - a);
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        if medium.shape == HEIGHT {
            depth += depth_of(medium.extinction, base_length(medium, origin, direction, 0.0, t));
            depth += depth_above(medium, density(medium, origin, direction, t), toward);
        }
    }
    return depth;
}

// Sunlight that the part [a, b] of a piece beginning at `start` scatters to the eye [1/sr], per unit of illuminance.
fn scattered_part(whole: Piece, start: f32, origin: vec3f, direction: vec3f, a: f32, b: f32, toward: vec3f,
                  one_minus_mu: f32, sources: u32) -> vec3f {
    var piece = whole;
    piece.depth += whole.slope * (a - start);
    var heights = 0u;
    var only = 0u;
    var sends = any(piece.source > vec3f(0.0));
    for (var i = 0u; i < tile.media; i++) {
        if media[i].shape == HEIGHT {
            heights += 1u;
            only = i;
            sends = sends || is_source(media[i], sources);
        }
    }
    if !sends {
        return vec3f(0.0);
    }
    if heights == 0u {
        return piece.source * exponential_integral3(piece.depth, piece.slope, vec3f(b - a));
    }
    if heights == 1u && all(piece.depth == vec3f(0.0)) && all(piece.slope == vec3f(0.0)) {
        // The exponent is linear in the medium's own optical depth.
        let medium = media[only];
        if medium.clear == 0u && toward.y <= 0.0 {
            return vec3f(0.0);
        }
        let run = base_length(medium, origin, direction, a, b);
        let ahead = depth_of(medium.extinction, base_length(medium, origin, direction, 0.0, a))
            + depth_above(medium, density(medium, origin, direction, a), toward);
        let slope = medium.extinction - depth_passed(medium, direction, toward);
        return source_of(medium, one_minus_mu, sources) * exponential_integral3(ahead, slope, vec3f(run));
    }
    // A mixture: three-point Gauss-Legendre on parts that change little.
    let change = abs(all_depth(piece, origin, direction, a, b, toward) - all_depth(piece, origin, direction, a, a, toward));
    var uneven = min(max(change.x, max(change.y, change.z)), 100.0);
    for (var i = 0u; i < tile.media; i++) {
        if media[i].shape == HEIGHT {
            uneven = max(uneven, abs(direction.y * (b - a) / media[i].scale_height));
        }
    }
    let parts = u32(clamp(ceil(2.0 * uneven), 1.0, 128.0));
    var sum = vec3f(0.0);
    for (var k = 0u; k < parts; k++) {
        let half = 0.5 * (b - a) / f32(parts);
        let middle = a + (2.0 * f32(k) + 1.0) * half;
        for (var node = 0u; node < 3u; node++) {
            let t = middle + (f32(node) - 1.0) * 0.774596669 * half;
            let weight = half * select(5.0 / 9.0, 8.0 / 9.0, node == 1u);
            var source = piece.source;
            for (var i = 0u; i < tile.media; i++) {
                let medium = media[i];
                if medium.shape == HEIGHT {
                    source += source_of(medium, one_minus_mu, sources) * density(medium, origin, direction, t);
                }
            }
            sum += weight * source * exp(-all_depth(piece, origin, direction, a, t, toward));
        }
    }
    return sum;
}

// What the air sends to the eye from a place of a ray for a beam of either kind that reaches it [cd/m2 a metre]. Runs of parallel
// light have closed forms, see common/runs.wgsl; this is for light from near by, and for steps.
fn beam_scattered(origin: vec3f, direction: vec3f, t: f32, sources: u32) -> vec3f {
    let p = origin + t * direction;
    let toward = beam_toward(p);
    let apart = direction - toward;
    var source = vec3f(0.0);
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        let own = source_of(medium, 0.5 * dot(apart, apart), sources);
        if medium.shape == HEIGHT {
            source += own * density(medium, origin, direction, t);
        } else if inside(medium, p) {
            source += own;
        }
    }
    var beyond = sun_optical_depth(p, toward);
    if beam.kind == LOCAL {
        beyond = optical_depth(p, toward, length(beam.position - p), ALL_MEDIA);
    }
    return source * exp(-optical_depth(origin, direction, t, sources) - beyond) * beam_illuminance(p);
}
