// The sky behind everything, from a table over elevation and angle to the sun: a sky model depends on nothing else.

@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;
@group(1) @binding(1) var<storage, read_write> background: array<vec4f>;
// Rows, columns, direction toward the sun; the rows' elevations; logarithms of RGB, row by row. The columns of a row
// divide the angles to the sun that its elevation knows.
@group(1) @binding(2) var<storage, read> table: array<f32>;

fn entry(rows: u32, columns: u32, row: u32, column: u32) -> vec3f {
    let at = 5u + rows + 3u * (row * columns + column);
    return vec3f(table[at], table[at + 1u], table[at + 2u]);
}

fn row_value(rows: u32, columns: u32, row: u32, x: f32) -> vec3f {
    let column = min(u32(x), columns - 2u);
    return mix(entry(rows, columns, row, column), entry(rows, columns, row, column + 1u), x - f32(column));
}

fn sky(direction: vec3f) -> vec3f {
    const PI = 3.14159265358979;
    let rows = u32(table[0]);
    let columns = u32(table[1]);
    let sun = vec3f(table[2], table[3], table[4]);
    let elevation = atan2(direction.y, length(direction.xz));
    let sun_elevation = atan2(sun.y, length(sun.xz));
    let apart = length(cross(direction, sun));
    let gamma = atan2(apart, dot(direction, sun));
    let least = abs(elevation - sun_elevation);
    let greatest = min(PI - elevation - sun_elevation, PI + elevation + sun_elevation);
    let share = clamp((gamma - least) / max(greatest - least, 1e-6), 0.0, 1.0);
    var low = 0u;
    var high = rows - 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if table[5u + middle] <= elevation {
            low = middle;
        } else {
            high = middle;
        }
    }
    let a = table[5u + low];
    let f = clamp((elevation - a) / (table[5u + high] - a), 0.0, 1.0);
    let x = share * f32(columns - 1u);
    return exp(mix(row_value(rows, columns, low, x), row_value(rows, columns, high, x), f));
}

@compute @workgroup_size(8, 8)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let direction = ray_direction(id);
    let i = pixel_index(id);
    if surfaces[i].number == 0u && direction.y >= 0.0 {
        background[i] += vec4f(sky(direction), 0.0);
    }
}
