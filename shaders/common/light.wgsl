// One point of the sun's disc and its shadow maps.

struct PartitionMap {
    // Least light coordinates of the window, and texel sizes [m].
    least: vec2f,
    texel: vec2f,
}

struct Light {
    toward: vec3f,
    partitions: u32,
    // Its share of the illuminance on a plane that faces it [lx].
    illuminance: vec3f,
    resolution: f32,
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

fn light_coordinates(p: vec3f) -> vec3f {
    return vec3f(dot(light.across.xyz, p) + light.across.w, dot(light.along.xyz, p) + light.along.w,
                 dot(light.height.xyz, p) + light.height.w);
}

// The finest partition whose map covers a place, by at least `border` texels; `partitions` when none does.
fn covering(at: vec2f, border: f32) -> u32 {
    for (var k = 0u; k < light.partitions; k++) {
        let q = (at - light.maps[k].least) / light.maps[k].texel;
        if all(q >= vec2f(border)) && all(q < vec2f(light.resolution - border)) {
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
    let d = vec3f(dot(light.across.xyz, direction), dot(light.along.xyz, direction), dot(light.height.xyz, direction));
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
