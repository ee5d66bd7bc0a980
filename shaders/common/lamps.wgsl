// Lamps: what they send which way. A pass that sees it sees their texels, as src/effect/lamps_on_device.rs writes them. Angles are in
// radians, places relative to the eye.

fn lamp_texel(index: u32) -> vec4f {
    return textureLoad(lamps, vec2u(index % TREE_WIDTH, index / TREE_WIDTH), 0);
}

struct Lamp {
    position: vec3f,
    kind: u32,
    toward: vec3f,
    // Half angle of the cone outside which there is nothing.
    cone: f32,
    around: vec3f,
    // One more than the material that does not shade it; 0: all do.
    ignored: u32,
    third: vec3f,
    // The first texel of its table.
    table: u32,
    intensity: vec3f,
    // The most that it sends any way: luminance.
    greatest: f32,
    numbers: vec4f,
    rings: f32,
    detail: f32,
    form: u32,
    extent: f32,
    // Of a line and a rectangle; the size of a line is its length, of a rectangle the root of its area, of a sphere its radius.
    edge: vec3f,
    size: f32,
    other: vec3f,
    side: vec3f,
}

fn lamp_of(index: u32) -> Lamp {
    let first = 1u + LAMP_TEXELS * index;
    let a = lamp_texel(first);
    let b = lamp_texel(first + 1u);
    let c = lamp_texel(first + 2u);
    let d = lamp_texel(first + 3u);
    let e = lamp_texel(first + 4u);
    let g = lamp_texel(first + 6u);
    let h = lamp_texel(first + 7u);
    return Lamp(a.xyz, u32(a.w), b.xyz, b.w, c.xyz, u32(c.w), d.xyz, u32(d.w), e.xyz, e.w,
                lamp_texel(first + 5u), g.x, g.y, u32(g.z), g.w, h.xyz, h.w,
                lamp_texel(first + 8u).xyz, lamp_texel(first + 9u).xyz);
}

// A place of a lamp that stands for a part of it.
struct Spot {
    position: vec3f,
    // The side on which it shines; 0: all around, 1: on this side, 2: on this side, times the cosine with it.
    side: vec3f,
    one_sided: u32,
    // The part of the lamp's intensity that it has; nearer than the radius it gets no brighter.
    share: f32,
    radius: f32,
}

// Equation 7 of Nishita, Miyawaki & Nakamae 1987.
fn lamp_beam(theta: f32, spread: f32, sharpness: f32) -> f32 {
    if theta > spread {
        return 0.0;
    }
    if spread <= 0.0 {
        return 1.0;
    }
    let half = sin(0.5 * spread);
    let inside = sin(0.5 * (spread + theta)) / half * (sin(0.5 * (spread - theta)) / half);
    return (1.0 - sharpness) * inside + sharpness;
}

// Equation 8.
fn lamp_pattern(periods: f32, ratio: f32) -> f32 {
    let from_middle = abs(2.0 * (periods - floor(periods)) - 1.0);
    return max(1.0 - (1.0 - ratio) * (1.0 - from_middle), 0.0);
}

// cos a - cos b.
fn lamp_cosines(a: f32, b: f32) -> f32 {
    return 2.0 * sin(0.5 * (a + b)) * sin(0.5 * (b - a));
}

fn table_number(first: u32, index: u32) -> f32 {
    return lamp_texel(first + index / 4u)[index % 4u];
}

// The interval of ascending numbers that holds one, and how far along in it that is; below 0 outside of them.
fn table_place(first: u32, begin: u32, count: u32, even: vec2f, x: f32) -> vec2f {
    let last = table_number(first, begin + count - 1u);
    if x < even.x || x > last {
        return vec2f(-1.0);
    }
    if even.y > 0.0 {
        let at = (x - even.x) / even.y;
        let i = clamp(floor(at), 0.0, f32(count - 2u));
        return vec2f(i, clamp(at - i, 0.0, 1.0));
    }
    var low = 0u;
    var high = count - 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        let is_below = table_number(first, begin + middle) <= x;
        low = select(low, middle, is_below);
        high = select(middle, high, is_below);
    }
    let a = table_number(first, begin + low);
    let b = table_number(first, begin + high);
    return vec2f(f32(low), clamp((x - a) / (b - a), 0.0, 1.0));
}

// Bilinear in degrees, nothing outside its angles.
fn table_at(first: u32, theta: f32, phi: f32) -> f32 {
    let head = lamp_texel(first);
    let even = lamp_texel(first + 1u);
    let across = u32(head.y);
    let up = u32(head.z);
    // Rounded angles are not beyond the poles.
    var angles = vec2f(-degrees(phi), min(degrees(theta), 180.0));
    if head.x == 2.0 {
        angles.x -= 360.0 * floor((angles.x - even.x) / 360.0);
        angles.x = clamp(angles.x, even.x, even.x + 360.0);
    } else {
        let ahead = cos(theta);
        let right = sin(theta) * sin(phi);
        let above = sin(theta) * cos(phi);
        let a = vec2f(atan2(right, ahead), atan2(above, length(vec2f(right, ahead))));
        let b = vec2f(atan2(right, length(vec2f(above, ahead))), atan2(above, ahead));
        angles = degrees(select(b, a, head.x == 0.0));
    }
    let numbers = first + 2u;
    let x = table_place(numbers, 0u, across, even.xy, angles.x);
    let y = table_place(numbers, across, up, even.zw, angles.y);
    if x.x < 0.0 || y.x < 0.0 {
        return 0.0;
    }
    let near = across + up + u32(x.x) * up + u32(y.x);
    let a = mix(table_number(numbers, near), table_number(numbers, near + 1u), y.y);
    let b = mix(table_number(numbers, near + up), table_number(numbers, near + up + 1u), y.y);
    return mix(a, b, x.y);
}

// The lamp's intensity along a direction away from it, of any length: relative to the greatest, of a table in candela.
fn lamp_shape(lamp: Lamp, direction: vec3f) -> f32 {
    if lamp.kind == LIGHT_EVEN {
        return 1.0;
    }
    let across = vec2f(dot(direction, lamp.around), dot(direction, lamp.third));
    let theta = min(atan2(length(across), dot(direction, lamp.toward)), 3.14159265);
    let phi = select(atan2(across.y, across.x), 0.0, all(across == vec2f(0.0)));
    if theta > lamp.cone {
        return 0.0;
    }
    let n = lamp.numbers;
    var shape = 0.0;
    switch lamp.kind {
        case LIGHT_CONE: {
            let width = max(lamp_cosines(n.x, n.y), 1e-3);
            let share = clamp(lamp_cosines(theta, n.y) / width, 0.0, 1.0);
            shape = share * share;
        }
        case LIGHT_ELLIPSE: {
            let turn = vec2f(cos(phi), sin(phi));
            let along = length(vec2f(turn.x * cos(n.x) * sin(n.z), turn.y * sin(n.x) * cos(n.z)));
            let wide = max(n.x, n.z) > 1.5707963;
            shape = lamp_beam(theta, atan2(sin(n.x) * sin(n.z), select(along, -along, wide)), n.y);
        }
        case LIGHT_TABLE: {}
        default: {
            shape = lamp_beam(theta, n.x, n.y);
            let along = phi / 6.28318530717959 * n.z;
            if lamp.kind != LIGHT_SPOT {
                shape *= lamp_pattern(along, n.w);
            }
            if lamp.kind == LIGHT_DOTS {
                let out = select(0.0, theta / n.x * lamp.rings, n.x > 0.0);
                let cell = 0.5 * (floor(along + 0.5) + floor(out + 0.5));
                shape *= select(0.0, lamp_pattern(out, n.w), cell - floor(cell) > 0.25);
            }
        }
    }
    // A loop, since some drivers go through branches that nobody takes.
    for (var is_table = lamp.kind == LIGHT_TABLE; is_table; is_table = false) {
        shape = table_at(lamp.table, theta, phi);
    }
    return shape;
}

// The same of a spot of it.
fn spot_shape(lamp: Lamp, spot: Spot, direction: vec3f) -> f32 {
    let cosine = dot(spot.side, direction);
    if spot.one_sided != 0u && cosine <= 0.0 {
        return 0.0;
    }
    let before = select(1.0, cosine / max(length(direction), 1e-30), spot.one_sided == 2u);
    return spot.share * before * lamp_shape(lamp, direction);
}

fn lamp_luminance(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(knobs.luminous_red, knobs.luminous_green, knobs.luminous_blue));
}

// Whether the ground stops the light of a spot on its way to a height: both over the ground's own.
fn is_under_ground(y: f32) -> bool {
    return tile.grounded != 0u && y < -tile.ground.w;
}

// The part of a line inside a box or a haze: without loops, whose turns some drivers count.
fn span_within(medium: Medium, origin: vec3f, direction: vec3f) -> vec2f {
    let tiny = select(vec3f(-1e-20), vec3f(1e-20), direction >= vec3f(0.0));
    let per_metre = 1.0 / select(direction, tiny, abs(direction) < vec3f(1e-20));
    let a = (medium.least - origin) * per_metre;
    let b = (medium.greatest - origin) * per_metre;
    var low = min(a, b);
    var high = max(a, b);
    if medium.shape == HAZE {
        low = vec3f(-FARTHEST, low.y, -FARTHEST);
        high = vec3f(FARTHEST, high.y, FARTHEST);
    }
    return vec2f(max(low.x, max(low.y, low.z)), min(high.x, min(high.y, high.z)));
}

fn length_within(medium: Medium, origin: vec3f, direction: vec3f, distance: f32) -> f32 {
    let span = span_within(medium, origin, direction);
    return max(min(span.y, distance) - max(span.x, 0.0), 0.0);
}

// Of the first `distance` metres of a ray, all media.
fn depth_along(origin: vec3f, direction: vec3f, distance: f32) -> vec3f {
    var depth = vec3f(0.0);
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        if medium.shape == HEIGHT {
            depth += depth_of(medium.extinction, base_length(medium, origin, direction, 0.0, distance));
        } else {
            depth += depth_of(medium.extinction, length_within(medium, origin, direction, distance));
        }
    }
    return depth;
}
