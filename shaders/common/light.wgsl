// One point of the sun's disc and its shadow maps.

struct PartitionMap {
    // Least light coordinates of the window, and texel sizes [m].
    least: vec2f,
    texel: vec2f,
    // How many texels it has; they lie in the corner of its layer.
    @size(16) size: vec2f,
}

struct Light {
    toward: vec3f,
    partitions: u32,
    // Its share of the illuminance on a plane that faces it [lx].
    illuminance: vec3f,
    // Side of the layers in which its maps lie [texels].
    side: f32,
    // Light coordinates of p are dot(axis.xyz, p) + axis.w; the third is the height toward the sun.
    across: vec4f,
    along: vec4f,
    height: vec4f,
    // Least and greatest light coordinates of all casters, and their heights.
    casters: vec4f,
    heights: vec4f,
    maps: array<PartitionMap, 16>,
}

@group(2) @binding(0) var<uniform> light: Light;
@group(2) @binding(1) var sun_maps: texture_depth_2d_array;
// One more than the number of the caster in each texel, 0 for none; CUT_OUT is added for one with holes.
@group(2) @binding(2) var sun_casters: texture_2d_array<u32>;
// Corners of all casters, row by row.
@group(2) @binding(3) var caster_corners: texture_2d<f32>;

const CUT_OUT = 0x80000000u;
const NO_CASTER = 0xffffffffu;

fn light_coordinates(p: vec3f) -> vec3f {
    return vec3f(dot(light.across.xyz, p) + light.across.w, dot(light.along.xyz, p) + light.along.w,
                 dot(light.height.xyz, p) + light.height.w);
}

// Of a direction.
fn axis_parts(direction: vec3f) -> vec3f {
    return vec3f(dot(light.across.xyz, direction), dot(light.along.xyz, direction), dot(light.height.xyz, direction));
}

// The finest partition whose map covers a place, by at least `border` texels; `partitions` when none does.
fn covering(at: vec2f, border: f32) -> u32 {
    for (var k = 0u; k < light.partitions; k++) {
        let q = (at - light.maps[k].least) / light.maps[k].texel;
        if all(q >= vec2f(border)) && all(q < light.maps[k].size - border) {
            return k;
        }
    }
    return light.partitions;
}

// Height of the sun-nearest caster in a texel; far below everything where there is none.
fn caster_height(part: u32, texel: vec2i) -> f32 {
    let depth = textureLoad(sun_maps, texel, part, 0);
    return select(light.heights.y - depth * (light.heights.y - light.heights.x), -1e30, depth >= 1.0);
}

// Number of the sun-nearest caster at a place; NO_CASTER where there is none, CUT_OUT where it has holes.
fn caster_at(at: vec2f) -> u32 {
    let k = covering(at, 0.0);
    if k == light.partitions {
        return NO_CASTER;
    }
    let found = textureLoad(sun_casters, vec2i((at - light.maps[k].least) / light.maps[k].texel), k, 0).x;
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
    let p0 = axis_parts(c0.xyz - origin);
    let p1 = axis_parts(c1.xyz - origin);
    let p2 = axis_parts(c2.xyz - origin);
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

// Whether the sun reaches a point of the air: the nearest texel, never an interpolated height, no bias.
fn sun_reaches(p: vec3f) -> bool {
    let at = light_coordinates(p);
    if at.z >= light.heights.y || any(at.xy < light.casters.xy) || any(at.xy > light.casters.zw) {
        return true;
    }
    let k = covering(at.xy, 0.0);
    if k == light.partitions {
        return true;
    }
    let q = (at.xy - light.maps[k].least) / light.maps[k].texel;
    return at.z >= caster_height(k, vec2i(q));
}

// The part of a ray outside which nothing stands between it and the sun.
fn shadow_span(origin: vec3f, direction: vec3f) -> vec2f {
    let o = light_coordinates(origin);
    let d = axis_parts(direction);
    let least = vec3f(light.casters.xy, -1e30);
    let greatest = vec3f(light.casters.zw, light.heights.y);
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
