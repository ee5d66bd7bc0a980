// A map of the whole sky: the sky of common/sky_table.wgsl above the horizon, an even ground below, black outside the circle of a fisheye.

struct SkyMap {
    size: vec2u,
    // EQUIRECTANGULAR, FISHEYE or CUBE.
    projection: u32,
    // First row of this band, and rows in it.
    first: u32,
    ground: vec3f,
    rows: u32,
}

@group(0) @binding(0) var<uniform> map: SkyMap;
// Sine and cosine of each row's elevation and then of each column's azimuth, in an equirectangular map. They are made from
// f64: a device's own sine may be off by 5e-4.
@group(0) @binding(1) var<storage, read> turns: array<vec2f>;
@group(0) @binding(2) var<storage, read_write> texels: array<vec4f>;

// Sine of 0 to pi/2, within 1e-7.
fn sine(x: f32) -> f32 {
    let q = x * x;
    return x * (1.0 + q * (-1.66666666e-1 + q * (8.33333097e-3 + q * (-1.98408612e-4 + q * (2.75252698e-6 - q * 2.38892178e-8)))));
}

// The direction of a texel's middle; zero where there is none.
fn direction_of(x: u32, y: u32) -> vec3f {
    const HALF_PI = 1.5707963267949;
    // Twice the way from the map's middle, in texels: whole numbers, so that nothing is lost at the horizon.
    let side = i32(map.size.y);
    let down = 2 * i32(y) + 1 - side;
    if map.projection == EQUIRECTANGULAR {
        let elevation = turns[y];
        let azimuth = turns[map.size.y + x];
        return vec3f(elevation.y * azimuth.x, elevation.x, -elevation.y * azimuth.y);
    }
    if map.projection == FISHEYE {
        let right = 2 * i32(x) + 1 - side;
        let square = right * right + down * down;
        if square > side * side {
            return vec3f(0.0);
        }
        let r = sqrt(f32(square)) / f32(side);
        // 1 - r without cancellation.
        let rest = f32(side * side - square) / (f32(side) * f32(side) * (1.0 + r));
        let flat = vec2f(f32(-right), f32(down)) * (sine(HALF_PI * r) / max(r * f32(side), 1e-30));
        return vec3f(flat.x, sine(HALF_PI * rest), flat.y);
    }
    let face = x / map.size.y;
    let s = f32(2 * i32(x % map.size.y) + 1 - side) / f32(side);
    let t = f32(down) / f32(side);
    var v = vec3f(-s, -t, -1.0);
    switch face {
        case 0u: { v = vec3f(1.0, -t, -s); }
        case 1u: { v = vec3f(-1.0, -t, s); }
        case 2u: { v = vec3f(s, 1.0, t); }
        case 3u: { v = vec3f(s, -1.0, -t); }
        case 4u: { v = vec3f(s, -t, 1.0); }
        default: {}
    }
    return normalize(v);
}

@compute @workgroup_size(8, 8)
fn paint(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= map.size.x || id.y >= map.rows {
        return;
    }
    let direction = direction_of(id.x, map.first + id.y);
    var colour = vec3f(0.0);
    if direction.y < 0.0 {
        colour = map.ground;
    } else if any(direction != vec3f(0.0)) {
        colour = sky(direction);
    }
    texels[id.y * map.size.x + id.x] = vec4f(colour, 0.0);
}
