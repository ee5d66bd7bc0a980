//! The rectified map: what stands between the air and the sun, in rows around the sun's direction as seen from the eye.
//!
//! A half-plane that holds the eye and the sun's direction w is a slice, of azimuth phi around w. A point of it is given by a,
//! its distance from the axis, and b, its height along w; for parallel light it is lit exactly where b >= h(phi, a), h being
//! the first surface that the light meets. A ray at the angle theta from w runs at a = t sin(theta), b = t cos(theta), so that
//! h / a <= cot(theta) says whether it is lit: one number a ray against one number a place (Baran et al. 2010; Chen et al.
//! 2011). Both are kept in the bounded form c = cos / (|cos| + sin) and d = h / (|h| + a), which needs no division by nearly
//! nothing. Nothing knows where the sun stands on the picture: inside, outside, behind, or exactly across the view.
//!
//! Rows and columns cover just what the pixels of a tile ask for: [`MEASURE`] finds the least and greatest phi, a and c of
//! theirs. Columns are spaced as a + s = (a_0 + s) ((a_1 + s) / (a_0 + s))^x with s = a_1 / 20, finer near the axis, where rays
//! are dense. A leaf is eight columns, d in 16 bits of the tile's range of c (1/128 of a pixel's angle): one read. Above stand
//! nodes of four children's least and greatest d, also one read each: a min-max tree.
//!
//! A row says which borders of light a ray has, in which order, and which casters make them; not where they are exactly, for
//! maps have texels and rows have columns. Each texel also holds the number of its caster, so that a border is taken from the
//! caster itself: the ray is in the shadow of a triangle where it is inside of its three edges, seen along the light, and not
//! over its plane, which are four divisions. From there shadow is followed to the triangle over the edge, or to what the maps
//! show next to it, until nothing throws it on. Texels then decide only which casters are found, and no straight edge is
//! stepped. Casters with holes have no such edge: a border is halved there by asking the maps, or stays at its column if it is
//! one of many along the ray.
//!
//! An orthographic view has parallel rays. A slice is then a plane along r and w, rows are spaced by its offset, columns by
//! the place across it, and the number that a ray keeps is its offset along m = sin(theta) w - cos(theta) e, e the unit vector
//! across w in the slice: d = h sin(theta) - a cos(theta) against c = o . m.

use super::{Kind, Knob, Over, Pass, Resource, Scratch, Settings};
use crate::effect::Field;

/// Columns of a leaf times the children of the nodes of three levels: rows are as long as a multiple of this.
const COLUMNS_STEP: u32 = 512;

/// How many rows there are.
pub const ROWS: Knob = Knob {
    name: "rows",
    meaning: "rows across the diagonal of each tile of the picture; around the sun's own place up to pi times as many",
    values: [512.0, 2048.0, 4096.0, 4096.0],
    range: [8.0, 4096.0],
};

/// How long they are.
pub const COLUMNS: Knob = Knob {
    name: "columns",
    meaning: "columns of each row (a multiple of 512 is taken)",
    values: [512.0, 1024.0, 2048.0, 2048.0],
    range: [512.0, 8192.0],
};

/// How exactly borders of light are found.
pub const HALVINGS: Knob = Knob {
    name: "halvings",
    meaning: "reads of the maps for a border of light whose caster has holes, unless there are many; other borders are exact, unless this is 0",
    values: [0.0, 4.0, 5.0, 5.0],
    range: [0.0, 8.0],
};

/// The number of rows across a tile's diagonal.
fn rows(settings: &Settings<'_>) -> u32 {
    settings.get("rows") as u32
}

/// The most rows that a tile may have.
pub fn most_rows(settings: &Settings<'_>) -> u32 {
    4 * rows(settings)
}

/// The number of columns: the knob's, rounded up to whole nodes.
pub fn columns(settings: &Settings<'_>) -> u32 {
    (settings.get("columns") as u32).div_ceil(COLUMNS_STEP) * COLUMNS_STEP
}

/// The first two numbers of the table of an effect that has rows.
pub fn table(settings: &Settings<'_>) -> Vec<f32> {
    vec![rows(settings) as f32, columns(settings) as f32]
}

/// What the tile's pixels ask for, and the rows with their trees.
pub const SCRATCH: [Scratch; 2] = [
    Scratch {
        name: "bounds of rows",
        bytes: |_, _| 64,
    },
    Scratch {
        name: "rows around the sun (their knobs rows and columns)",
        // 16 bytes for each 8, 32, 128 and 512 columns.
        bytes: |settings, _| {
            16 * 85 * u64::from(most_rows(settings)) * u64::from(columns(settings) / COLUMNS_STEP)
        },
    },
];

const SHADER: &str = include_str!("../../shaders/rows.wgsl");

const USES: &[Resource] = &[
    Resource::Read(Field::Surface),
    Resource::Table(|_, settings| table(settings)),
];

/// Nothing has been asked for yet.
pub const BEGIN: Pass = Pass {
    shader: SHADER,
    entry: "begin",
    kind: Kind::EachSun("suns", Over::Groups(|_| [1, 1])),
    uses: USES,
    scratch: &SCRATCH,
};

/// What the pixels of the tile ask for.
pub const MEASURE: Pass = Pass {
    shader: SHADER,
    entry: "measure",
    kind: Kind::EachSun("suns", Over::Pixels),
    uses: USES,
    scratch: &SCRATCH,
};

/// Reads the z-partitions' maps into rows and builds their trees, one workgroup a row.
pub const BUILD: Pass = Pass {
    shader: SHADER,
    entry: "build",
    kind: Kind::EachSun("suns", Over::Groups(|settings| [most_rows(settings), 1])),
    uses: USES,
    scratch: &SCRATCH,
};
