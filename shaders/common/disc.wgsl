// How much of the sun's disc a place sees: src/scene/disc.rs in 32 bits a chord. A pass that sees it sees the tree of casters,
// facets and materials.
//
// A chord of the disc is 32 places that share its light; what a triangle covers of it are some of the bits in a row. Places of
// neighbouring chords are shifted against each other, so that an edge passes them one by one whichever way it lies.

const CHORDS = 16u;
const TURNS = 8u;

struct Disc {
    // Axes across the direction toward its middle; that direction; tangent of its angular radius.
    x: vec3f,
    y: vec3f,
    z: vec3f,
    tangent: f32,
    // Luminance falls as (1 - rho^2)^(limb / 2) toward the limb: 0 for a uniform disc.
    limb: vec3f,
}

fn disc_of(toward: vec3f, radius: f32, limb: vec3f) -> Disc {
    let axes = axes_along(toward);
    return Disc(axes.x, axes.y, toward, tan(radius), limb);
}

// Lines through two corners each, positive inside; all zero where a triangle is no obstacle.
struct Outline {
    a: vec3f,
    b: vec3f,
    c: vec3f,
}

const NO_OUTLINE = Outline(vec3f(0.0), vec3f(0.0), vec3f(0.0));

fn disc_outline(disc: Disc, triangle: u32, start: vec3f, blur: f32) -> Outline {
    let facet = facets[triangle];
    // In the plane, by as much as places are rounded, is no obstacle.
    if abs(facet.plane.w - dot(facet.plane.xyz, start)) <= blur {
        return NO_OUTLINE;
    }
    let size = textureDimensions(caster_corners);
    let at = vec2u(3u * triangle % size.x, 3u * triangle / size.x);
    let c0 = textureLoad(caster_corners, at, 0).xyz - start;
    let c1 = textureLoad(caster_corners, at + vec2u(1u, 0u), 0).xyz - start;
    let c2 = textureLoad(caster_corners, at + vec2u(2u, 0u), 0).xyz - start;
    let wide = 1.0 / disc.tangent;
    let a = vec3f(wide * dot(c0, disc.x), wide * dot(c0, disc.y), dot(c0, disc.z));
    let b = vec3f(wide * dot(c1, disc.x), wide * dot(c1, disc.y), dot(c1, disc.z));
    let c = vec3f(wide * dot(c2, disc.x), wide * dot(c2, disc.y), dot(c2, disc.z));
    // The plane, made in f64, says on which side of it the place lies.
    let side = sign(facet.plane.w - dot(facet.plane.xyz, start));
    return Outline(side * cross(b, c), side * cross(c, a), side * cross(a, b));
}

fn has_holes(triangle: u32) -> bool {
    return materials[facets[triangle].material].least_alpha >= 0.0;
}

// By how much of a bit those of a chord are shifted.
fn disc_shift(chord: u32) -> f32 {
    return fract(0.5 + 0.61803399 * f32(chord));
}

// The least of a triangle's three lines counts.
const MEETS_NOTHING = 0u;
const MEETS_PART = 1u;
const MEETS_ALL = 2u;

fn disc_side(line: vec3f) -> u32 {
    let across = length(line.xy);
    return select(select(MEETS_PART, MEETS_ALL, line.z >= across), MEETS_NOTHING, line.z <= -across);
}

fn disc_meets(outline: Outline) -> u32 {
    return min(disc_side(outline.a), min(disc_side(outline.b), disc_side(outline.c)));
}

// The part of [from, to] where a line, by its value in the middle of a chord and its slope, is not negative.
fn disc_cut(run: vec2f, line: vec3f, across: vec2f, offset: f32) -> vec2f {
    let middle = line.z + offset * dot(line.xy, across);
    let slope = line.y * across.x - line.x * across.y;
    let place = -middle / select(slope, 1.0, slope == 0.0);
    if slope > 0.0 {
        return vec2f(max(run.x, place), run.y);
    }
    if slope < 0.0 {
        return vec2f(run.x, min(run.y, place));
    }
    return select(run, vec2f(0.0, -1.0), middle < 0.0);
}

// The share of a chord's light before a place of it, -1 to 1: that of the middle channel, whose luminance falls as the fourth
// root of 1 - u^2 (by its series, the last term adjusted to the sum), or of an even one.
fn disc_before(disc: Disc, u: f32) -> f32 {
    let v = clamp(u, -1.0, 1.0);
    if disc.limb.y == 0.0 {
        return 0.5 + 0.5 * v;
    }
    let s = v * v;
    return 0.5 + 0.57207 * v * (1.0 - s * (0.083333 + s * (0.01875 + s * 0.023897)));
}

// The bits of a chord between two places of it, -1 to 1. The middle of bit k is at (k + shift) / 32 of its light.
fn disc_bits(disc: Disc, run: vec2f, shift: f32) -> u32 {
    let first = u32(clamp(ceil(32.0 * disc_before(disc, run.x) - shift), 0.0, 32.0));
    let last = u32(clamp(ceil(32.0 * disc_before(disc, run.y) - shift), 0.0, 32.0));
    if last <= first {
        return 0u;
    }
    let below = select((1u << last) - 1u, 0xffffffffu, last == 32u);
    return below & ~((1u << first) - 1u);
}

struct Walk {
    at: u32,
    end: u32,
    // Steps so far.
    steps: u32,
}

// The next caster whose box a cone from `start` meets; NO_CASTER behind the last.
fn disc_next(disc: Disc, walk: ptr<function, Walk>, start: vec3f, own: u32) -> u32 {
    let tiny = select(vec3f(-1e-18), vec3f(1e-18), disc.z >= vec3f(0.0));
    let per_metre = 1.0 / select(disc.z, tiny, abs(disc.z) < vec3f(1e-18));
    while (*walk).at < (*walk).end {
        let i = (*walk).at;
        (*walk).steps += 1u;
        let low = tree_texel(2u * i);
        let high = tree_texel(2u * i + 1u);
        let least = bitcast<vec3f>(low.xyz) - start;
        let most = bitcast<vec3f>(high.xyz) - start;
        let far = dot(max(least * disc.z, most * disc.z), vec3f(1.0));
        let wide = vec3f(max(far, 0.0) * disc.tangent);
        let a = (least - wide) * per_metre;
        let b = (most + wide) * per_metre;
        let first = min(a, b);
        let last = max(a, b);
        let enter = max(max(first.x, first.y), max(first.z, 0.0));
        let leave = min(last.x, min(last.y, last.z));
        let met = far >= 0.0 && enter <= leave * 1.000001;
        (*walk).at = select(low.w, i + 1u, met);
        if met && high.w != 0u && high.w - 1u != own {
            return high.w - 1u;
        }
    }
    return NO_CASTER;
}

fn disc_turn(k: u32) -> vec2f {
    let angle = 3.14159265358979 * f32(k) / f32(TURNS);
    return vec2f(cos(angle), sin(angle));
}

fn disc_line(disc: Disc, normal: vec3f) -> vec3f {
    return vec3f(disc.tangent * dot(normal, disc.x), disc.tangent * dot(normal, disc.y), dot(normal, disc.z));
}
