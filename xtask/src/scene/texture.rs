//! Pictures for stone: courses of ashlar, and slabs of a floor.

/// Side of a picture [texels].
const SIDE: usize = 512;

/// A well-mixed number in 0 to 1 for whole numbers (Wang's hash, integers only: the same everywhere).
pub fn noise(a: usize, b: usize, seed: usize) -> f64 {
    let mut h = (a as u32).wrapping_mul(0x9E37_79B1)
        ^ (b as u32).wrapping_mul(0x85EB_CA77)
        ^ (seed as u32).wrapping_mul(0xC2B2_AE3D);
    for _ in 0..2 {
        h = (h ^ 61) ^ (h >> 16);
        h = h.wrapping_mul(9);
        h ^= h >> 4;
        h = h.wrapping_mul(0x27D4_EB2D);
        h ^= h >> 15;
    }
    f64::from(h) / f64::from(u32::MAX)
}

/// Noise that is smooth over `cell` texels and repeats with the picture.
fn clouds(x: usize, y: usize, cell: usize, seed: usize) -> f64 {
    let cells = SIDE / cell;
    let (i, j) = (x / cell, y / cell);
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v) = (
        ease((x % cell) as f64 / cell as f64),
        ease((y % cell) as f64 / cell as f64),
    );
    let at = |i: usize, j: usize| noise(i % cells, j % cells, seed);
    let low = at(i, j) * (1.0 - u) + at(i + 1, j) * u;
    let high = at(i, j + 1) * (1.0 - u) + at(i + 1, j + 1) * u;
    low * (1.0 - v) + high * v
}

/// Squared stones in courses with bed joints: 4 m by 4 m, sRGB.
pub fn ashlar() -> Vec<u8> {
    // Course heights in texels of 7.8 mm; they add up to the picture.
    let courses = [46, 38, 52, 42, 48, 40, 54, 44, 38, 58, 52];
    picture(|x, y| {
        let (mut top, mut course) = (0, 0);
        while y >= top + courses[course] {
            top += courses[course];
            course += 1;
        }
        let count = 5 + (noise(course, 0, 1) * 3.0) as usize;
        let shift = (noise(course, 1, 1) * SIDE as f64) as usize;
        // Joints stand at uneven places.
        let joint = |k: usize| {
            let even = k * SIDE / count;
            even + (noise(course, k % count, 2) * 0.4 * (SIDE / count) as f64) as usize
        };
        let along = (x + shift) % SIDE;
        let stone = (0..count)
            .rev()
            .find(|&k| along >= joint(k))
            .unwrap_or(count - 1);
        let left = if along >= joint(stone) {
            joint(stone)
        } else {
            0
        };
        let edge = (y - top)
            .min(top + courses[course] - 1 - y)
            .min(along.abs_diff(left));
        let tone = noise(course, stone, 3) - 0.5;
        let warm = noise(course, stone, 4) - 0.5;
        let grain = 0.5 * clouds(x, y, 4, 5) + 0.5 * clouds(x, y, 32, 6) - 0.5;
        let light = 0.86 + 0.15 * tone + 0.13 * grain;
        let light = match edge {
            0 => light * 0.82,
            1 => light * 0.94,
            _ => light,
        };
        [
            light * (1.0 + 0.03 * warm),
            light * (0.955 + 0.01 * warm),
            light * (0.865 - 0.06 * warm),
        ]
    })
}

/// Slabs in two stones laid cornerwise: 4.8 m by 4.8 m, sRGB.
pub fn slabs() -> Vec<u8> {
    let cells = 8;
    let size = SIDE / cells;
    picture(|x, y| {
        let (u, v) = ((x + y) % SIDE, (x + SIDE - y) % SIDE);
        let (i, j) = (u / size, v / size);
        let dark = (i + j) % 2 == 0;
        let edge = (u % size).min(v % size);
        let tone = noise(i, j, 11) - 0.5;
        let grain = 0.6 * clouds(x, y, 64, 12) + 0.4 * clouds(x, y, 8, 13) - 0.5;
        let base = if dark {
            [0.50, 0.43, 0.37]
        } else {
            [0.80, 0.74, 0.64]
        };
        let worn = 1.0 + 0.12 * tone + 0.22 * grain;
        let worn = if edge == 0 { worn * 0.75 } else { worn };
        base.map(|c: f64| c * worn)
    })
}

/// A PNG of what `color` gives at each texel, in steps that compress well.
fn picture(color: impl Fn(usize, usize) -> [f64; 3]) -> Vec<u8> {
    let step = |c: f64| ((c.clamp(0.0, 1.0) * 63.0).round() * 255.0 / 63.0).round() as u8;
    let pixels: Vec<u8> = (0..SIDE * SIDE)
        .flat_map(|i| color(i % SIDE, i / SIDE).map(step))
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::Adaptive);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&pixels)?;
        writer.finish()
    });
    written.expect("a PNG in memory");
    bytes
}
