// The sky of one place of the sun, from the numbers that src/sky/table.rs makes; vectors take three places.

fn vector(at: u32) -> vec3f {
    return vec3f(sky_numbers[at], sky_numbers[at + 1u], sky_numbers[at + 2u]);
}

// The angle of (x, y) from the x axis over pi, for y >= 0: within 2e-7. A device's own atan2 may be off by 5e-4.
fn half_turns(y: f32, x: f32) -> f32 {
    let less = min(y, abs(x));
    let more = max(y, abs(x));
    let steep = less > 0.41421356 * more;
    let over = select(less, less - more, steep);
    let under = select(more, less + more, steep);
    let r = over / max(under, 1e-30);
    let q = r * r;
    let series = r * (0.318309886 + q * (-0.106103211 + q * (0.0636561916 + q * (-0.0453258015 + q * (0.0336445211 - q * 0.0191815796)))));
    let acute = select(0.0, 0.25, steep) + series;
    let right = select(acute, 0.5 - acute, y > abs(x));
    return select(right, 1.0 - right, x < 0.0);
}

// The factor of a luminance (0, 1) or a colour (2 to 4) that depends on height alone; `up` is the cosine of the zenith angle.
fn height_factor(number: u32, up: f32) -> f32 {
    let at = FACTORS + 6u * number;
    let gradation = sky_numbers[at + 1u] * exp(sky_numbers[at + 2u] / max(up + sky_numbers[at + 3u], COSINE_FLOOR));
    return sky_numbers[at] * (1.0 + gradation + sky_numbers[at + 4u] * up);
}

// What depends on the angle from the sun alone, between two of its values.
fn around_sun(number: u32, below: u32, share: f32) -> f32 {
    let at = ANGLES + 5u * below + number;
    return mix(sky_numbers[at], sky_numbers[at + 5u], share);
}

// The nearest colour without negative channels toward the grey of the same luminance.
fn into_gamut(rgb: vec3f) -> vec3f {
    let least = min(rgb.x, min(rgb.y, rgb.z));
    if least >= 0.0 {
        return rgb;
    }
    let grey = dot(rgb, vector(LUMINANCE));
    if grey <= 0.0 {
        return vec3f(0.0);
    }
    return max(mix(vec3f(grey), rgb, grey / (grey - least)), vec3f(0.0));
}

// The day's sky; `haversine` is that of the angle from the sun.
fn day(up: f32, haversine: f32) -> vec3f {
    // t = tan(angle / 2) / (1 + tan(angle / 2)), 0 at the sun and 1 opposite.
    let sin_half = sqrt(haversine);
    let x = sin_half / (sin_half + sqrt(1.0 - haversine)) * sky_numbers[PIECES];
    let below = min(u32(x), u32(sky_numbers[PIECES]) - 1u);
    let share = x - f32(below);
    var colour = vec3f(0.0);
    for (var c = 0u; c < 3u; c += 1u) {
        let addend = sky_numbers[FACTORS + 6u * (c + 2u) + 5u] * sqrt(up);
        colour[c] = height_factor(c + 2u, up) * (around_sun(c + 2u, below, share) + addend);
    }
    if sky_numbers[FORM] == FORM_XYY {
        // Y, x, y to X, Y, Z.
        colour = colour.x * vec3f(colour.y / colour.z, 1.0, (1.0 - colour.y - colour.z) / colour.z);
    }
    var working = mat3x3f(vector(COLOURS), vector(COLOURS + 3u), vector(COLOURS + 6u)) * colour;
    if sky_numbers[FORM] == FORM_LUMINANCE {
        let luminance = max(height_factor(0u, up) * around_sun(0u, below, share), 0.0)
            + max(height_factor(1u, up) * around_sun(1u, below, share), 0.0);
        working *= luminance / dot(working, vector(LUMINANCE));
        working = mix(working, vector(OVERCAST) * luminance, sky_numbers[GREY]);
    }
    return into_gamut(working);
}

fn dusk_at(row: u32, column: u32, part: u32) -> vec3f {
    let first = ANGLES + 5u * (u32(sky_numbers[PIECES]) + 1u);
    return vector(first + 6u * (row * u32(sky_numbers[DUSK_SIZE + 1u]) + column) + 3u * part);
}

// The twilight's sky.
fn dusk(direction: vec3f, up: f32, haversine: f32) -> vec3f {
    let azimuth = vec2f(sky_numbers[TOWARD_AZIMUTH], sky_numbers[TOWARD_AZIMUTH + 1u]);
    let across = abs(direction.x * azimuth.y - direction.z * azimuth.x);
    let y = sqrt(min(up, 1.0)) * (sky_numbers[DUSK_SIZE] - 1.0);
    let x = half_turns(across, dot(direction.xz, azimuth)) * (sky_numbers[DUSK_SIZE + 1u] - 1.0);
    let row = min(u32(y), u32(sky_numbers[DUSK_SIZE]) - 2u);
    let column = min(u32(x), u32(sky_numbers[DUSK_SIZE + 1u]) - 2u);
    let at = vec2f(x - f32(column), y - f32(row));
    var parts = array<vec3f, 2>();
    for (var part = 0u; part < 2u; part += 1u) {
        let low = mix(dusk_at(row, column, part), dusk_at(row, column + 1u, part), at.x);
        let high = mix(dusk_at(row + 1u, column, part), dusk_at(row + 1u, column + 1u, part), at.x);
        parts[part] = mix(low, high, at.y);
    }
    // Henyey-Greenstein.
    let d = (1.0 - AEROSOL_G) * (1.0 - AEROSOL_G) + 4.0 * AEROSOL_G * haversine;
    let phase = (1.0 - AEROSOL_G * AEROSOL_G) / (12.566370614359172 * d * sqrt(d));
    return into_gamut(parts[0] + parts[1] * phase);
}

// Radiance toward a unit direction that is not below the horizon.
fn sky(direction: vec3f) -> vec3f {
    let up = max(direction.y, 0.0);
    let sun = vector(TOWARD_SUN);
    let away = direction - sun;
    let toward = direction + sun;
    let near = dot(away, away);
    let haversine = near / (near + dot(toward, toward));
    var sum = vector(UNIFORM) + vector(CLOUD) * (1.0 + 2.0 * up);
    if sky_numbers[DAY_SCALE] > 0.0 {
        sum += day(up, haversine) * sky_numbers[DAY_SCALE];
    }
    if sky_numbers[DUSK_SCALE] > 0.0 {
        sum += dusk(direction, up, haversine) * sky_numbers[DUSK_SCALE];
    }
    return sum;
}
