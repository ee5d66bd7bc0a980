// A beam of light and its shadow maps: parallel from a point of the sun's disc, or local from a point of a lamp.

struct PartitionMap {
    // Least light coordinates of the window, and texel sizes [m].
    least: vec2f,
    texel: vec2f,
    // How many texels it has; they lie in the corner of its layer.
    size: vec2f,
    // Heights of depth 0 and 1: least and greatest of what lies over or under the window.
    heights: vec2f,
}

struct Beam {
    // Of parallel light: unit vector toward where it comes from.
    toward: vec3f,
    // How many maps there are.
    partitions: u32,
    // Illuminance of parallel light on a plane that faces it [lx]; luminous intensity of a local beam [cd].
    strength: vec3f,
    // Side of the layers in which its maps lie [texels].
    side: f32,
    // Of parallel light: light coordinates of p are dot(axis.xyz, p) + axis.w; the third is the height toward the light.
    across: vec4f,
    along: vec4f,
    height: vec4f,
    // Least and greatest light coordinates of all casters.
    casters: vec4f,
    maps: array<PartitionMap, PARTITIONS>,
    // Of a local beam: its place relative to the eye [m].
    position: vec3f,
    // PARALLEL or LOCAL.
    kind: u32,
    // Of the cell that it stands for: angular radius [rad] of parallel light, radius [m] of a local beam.
    extent: f32,
    // Of a local beam: where its maps begin [m].
    near: f32,
    // Of parallel light: the greatest height of all casters.
    highest: f32,
}

@group(2) @binding(0) var<uniform> beam: Beam;
@group(2) @binding(1) var beam_maps: texture_depth_2d_array;
// One more than the number of the caster in each texel, 0 for none; CUT_OUT is added for one with holes.
@group(2) @binding(2) var beam_casters: texture_2d_array<u32>;
// Its binding 3 are the corners of all casters, `caster_corners`: other passes have them without a beam.

const NO_CASTER = 0xffffffffu;

// Unit vector from a place toward where the light comes from.
fn beam_toward(p: vec3f) -> vec3f {
    if beam.kind == PARALLEL {
        return beam.toward;
    }
    let way = beam.position - p;
    return way / max(length(way), 1e-30);
}

// Illuminance on a plane that faces the light, without shadow and media.
fn beam_illuminance(p: vec3f) -> vec3f {
    if beam.kind == PARALLEL {
        return beam.strength;
    }
    let way = beam.position - p;
    return beam.strength / max(max(dot(way, way), beam.extent * beam.extent), 1e-30);
}

fn light_coordinates(p: vec3f) -> vec3f {
    return vec3f(dot(beam.across.xyz, p) + beam.across.w, dot(beam.along.xyz, p) + beam.along.w,
                 dot(beam.height.xyz, p) + beam.height.w);
}

// Of a direction.
fn axis_parts(direction: vec3f) -> vec3f {
    return vec3f(dot(beam.across.xyz, direction), dot(beam.along.xyz, direction), dot(beam.height.xyz, direction));
}

// The finest partition whose map covers a place; `partitions` when none does.
fn covering(at: vec2f) -> u32 {
    for (var k = 0u; k < beam.partitions; k++) {
        let q = (at - beam.maps[k].least) / beam.maps[k].texel;
        if all(q >= vec2f(0.0)) && all(q < beam.maps[k].size) {
            return k;
        }
    }
    return beam.partitions;
}

// Height of the light-nearest caster in a texel; far below everything where there is none.
fn caster_height(part: u32, texel: vec2i) -> f32 {
    let depth = textureLoad(beam_maps, texel, part, 0);
    return select(mix(beam.maps[part].heights.x, beam.maps[part].heights.y, depth), -1e30, depth <= 0.0);
}

// Number of the light-nearest caster at a place; NO_CASTER where there is none, CUT_OUT where it has holes.
fn caster_at(at: vec2f) -> u32 {
    let k = covering(at);
    if k == beam.partitions {
        return NO_CASTER;
    }
    let found = textureLoad(beam_casters, vec2i((at - beam.maps[k].least) / beam.maps[k].texel), k, 0).x;
    return select(found - 1u, CUT_OUT, found >= CUT_OUT);
}

// The part of a ray that lies in a triangle's shadow, of the ray as a line; empty when it begins behind its end.
struct Shadow {
    span: vec2f,
    // The triangles over whose edges it begins and ends; NO_CASTER where there is none, and where the ray crosses the plane.
    beyond: vec2u,
}

// The part of a shadow where bound.x + t bound.y >= 0. The number of what is beyond is one more, 0 for none.
fn bounded(shadow: Shadow, bound: vec2f, beyond: f32) -> Shadow {
    let found = u32(beyond) - 1u;
    var less = shadow;
    let t = -bound.x / bound.y;
    if bound.y == 0.0 {
        less.span = select(shadow.span, vec2f(0.0, -1.0), bound.x < 0.0);
    } else if bound.y > 0.0 && t > shadow.span.x {
        less.span.x = t;
        less.beyond.x = found;
    } else if bound.y < 0.0 && t < shadow.span.y {
        less.span.y = t;
        less.beyond.y = found;
    }
    return less;
}

// Inside of the edge from a to b of a triangle that runs to the left, seen along the light.
fn beside(a: vec3f, b: vec3f, d: vec3f) -> vec2f {
    let edge = b.xy - a.xy;
    return vec2f(edge.y * a.x - edge.x * a.y, edge.x * d.y - edge.y * d.x);
}

// Written out: some drivers count the turns of all loops of a shader and end them at 65 535.
fn shadow_of(triangle: u32, origin: vec3f, direction: vec3f) -> Shadow {
    let size = textureDimensions(caster_corners);
    let at = vec2u(3u * triangle % size.x, 3u * triangle / size.x);
    var shadow = Shadow(vec2f(-FARTHEST, FARTHEST), vec2u(NO_CASTER));
    if at.y >= size.y {
        shadow.span = vec2f(0.0, -1.0);
        return shadow;
    }
    count_reads(3u);
    let c0 = textureLoad(caster_corners, at, 0);
    let c1 = textureLoad(caster_corners, at + vec2u(1u, 0u), 0);
    let c2 = textureLoad(caster_corners, at + vec2u(2u, 0u), 0);
    let d = axis_parts(direction);
    let p0 = axis_parts(eye_relative(c0.xyz) - origin);
    let p1 = axis_parts(eye_relative(c1.xyz) - origin);
    let p2 = axis_parts(eye_relative(c2.xyz) - origin);
    let normal = cross(p1 - p0, p2 - p0);
    let side = sign(normal.z);
    if side == 0.0 {
        // The light runs along its plane: it has no shadow.
        shadow.span = vec2f(0.0, -1.0);
        return shadow;
    }
    // Not over the plane, and inside of each edge.
    shadow = bounded(shadow, side * vec2f(dot(normal, p0), -dot(normal, d)), 0.0);
    shadow = bounded(shadow, side * beside(p0, p1, d), c0.w);
    shadow = bounded(shadow, side * beside(p1, p2, d), c1.w);
    return bounded(shadow, side * beside(p2, p0, d), c2.w);
}

// Whether the light reaches a point of the air: the nearest texel, never an interpolated height, no bias.
fn beam_reaches(p: vec3f) -> bool {
    if beam.kind == LOCAL {
        return local_beam_reaches(p);
    }
    let at = light_coordinates(p);
    if at.z >= beam.highest || any(at.xy < beam.casters.xy) || any(at.xy > beam.casters.zw) {
        return true;
    }
    let k = covering(at.xy);
    if k == beam.partitions {
        return true;
    }
    let q = (at.xy - beam.maps[k].least) / beam.maps[k].texel;
    return at.z >= caster_height(k, vec2i(q));
}

// The six faces of the cube around a local beam: p relative to it in a face's axes, the third outward from the beam.
fn in_face(p: vec3f, face: u32) -> vec3f {
    switch face {
        case 0u: { return vec3f(-p.z, p.y, p.x); }
        case 1u: { return vec3f(p.z, p.y, -p.x); }
        case 2u: { return vec3f(p.x, -p.z, p.y); }
        case 3u: { return vec3f(p.x, p.z, -p.y); }
        case 4u: { return vec3f(p.x, p.y, p.z); }
        default: { return vec3f(-p.x, p.y, -p.z); }
    }
}

fn face_of(p: vec3f) -> u32 {
    let a = abs(p);
    if a.x >= a.y && a.x >= a.z {
        return select(1u, 0u, p.x > 0.0);
    }
    if a.y >= a.z {
        return select(3u, 2u, p.y > 0.0);
    }
    return select(5u, 4u, p.z > 0.0);
}

// The nearest caster in the texel that a point lies in shades it if the way from the light meets the caster's plane before: the
// plane has digits that a depth behind a near plane has not.
fn local_beam_reaches(p: vec3f) -> bool {
    let way = p - beam.position;
    let face = face_of(way);
    let at = in_face(way, face);
    if at.z <= beam.near {
        return true;
    }
    let share = vec2f(0.5 + 0.5 * at.x / at.z, 0.5 - 0.5 * at.y / at.z);
    let texel = clamp(vec2i(share * beam.side), vec2i(0), vec2i(i32(beam.side) - 1));
    let found = textureLoad(beam_casters, texel, face, 0).x;
    if found == 0u {
        return true;
    }
    let triangle = (found & ~CUT_OUT) - 1u;
    let size = textureDimensions(caster_corners);
    let first = vec2u(3u * triangle % size.x, 3u * triangle / size.x);
    if first.y >= size.y {
        return true;
    }
    let a = eye_relative(textureLoad(caster_corners, first, 0).xyz) - beam.position;
    let b = eye_relative(textureLoad(caster_corners, first + vec2u(1u, 0u), 0).xyz) - beam.position;
    let c = eye_relative(textureLoad(caster_corners, first + vec2u(2u, 0u), 0).xyz) - beam.position;
    let normal = cross(b - a, c - a);
    return dot(normal, way) * sign(dot(normal, a)) <= abs(dot(normal, a));
}

// The part of a ray outside which nothing stands between it and the sun.
fn shadow_span(origin: vec3f, direction: vec3f) -> vec2f {
    let o = light_coordinates(origin);
    let d = axis_parts(direction);
    let least = vec3f(beam.casters.xy, -1e30);
    let greatest = vec3f(beam.casters.zw, beam.highest);
    var span = vec2f(0.0, FARTHEST);
    for (var axis = 0u; axis < 3u; axis++) {
        if abs(d[axis]) < 1e-12 {
            if o[axis] < least[axis] || o[axis] > greatest[axis] {
                return vec2f(0.0, -1.0);
            }
            continue;
        }
        let a = (least[axis] - o[axis]) / d[axis];
        let b = (greatest[axis] - o[axis]) / d[axis];
        span = vec2f(max(span.x, min(a, b)), min(span.y, max(a, b)));
    }
    return span;
}
