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

use super::pass::TILE;
use super::shafts;
use super::{Field, Knob, Number, Over, Pass, Product, Resource, Settings, When};
use crate::conditions::{Conditions, Input};

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

/// No tile has more rows than this for each pixel of its diagonal.
const ROWS_A_PIXEL: f64 = 32.0;

/// The number of rows across a tile's diagonal: the knob's, or as many as a small picture's pixels can tell apart.
fn rows(conditions: &Conditions, settings: &Settings<'_>) -> u32 {
    let [width, height] = conditions.view.size.map(|side| f64::from(side.min(TILE)));
    let enough = (ROWS_A_PIXEL * width.hypot(height)).ceil();
    settings.get("rows").min(enough) as u32
}

/// The most rows that a tile may have.
pub fn most_rows(conditions: &Conditions, settings: &Settings<'_>) -> u32 {
    4 * rows(conditions, settings)
}

/// The number of columns: the knob's, rounded up to whole nodes.
pub fn columns(settings: &Settings<'_>) -> u32 {
    (settings.get("columns") as u32).div_ceil(COLUMNS_STEP) * COLUMNS_STEP
}

/// The numbers that shaders with rows know.
pub fn knobs(conditions: &Conditions, settings: &Settings<'_>) -> Vec<(&'static str, Number)> {
    vec![
        ("rows", Number::Count(rows(conditions, settings))),
        ("most_rows", Number::Count(most_rows(conditions, settings))),
        ("columns", Number::Count(columns(settings))),
    ]
}

/// What rows are made of, which makes their life that of a beam in a tile.
pub const MADE_OF: &[Input] = &[
    Input::Geometry,
    Input::Materials,
    Input::View,
    Input::Tile,
    Input::Beam,
];

/// Least and greatest row coordinate, a and c that the tile's pixels ask for, as integers of the same order; last a sum of the
/// logarithms of their greatest a, and of how many.
pub const ASKED: Product = Product {
    name: "asked",
    wgsl: "array<atomic<u32>, 16>",
    bytes: |_| 64,
    reads: MADE_OF,
    zeroed: false,
};

/// The rows with their trees. Row by row: leaves of eight columns each, 16 bits a column; then nodes, least (low half) and greatest
/// (high half) threshold of four children each: of 8, then of 32, then of 128 columns.
pub const TREE: Product = Product {
    name: "tree",
    wgsl: "array<vec4u>",
    // 16 bytes for each 8, 32, 128 and 512 columns.
    bytes: |extent| {
        let settings = &extent.settings;
        16 * 85
            * u64::from(most_rows(extent.conditions, settings))
            * u64::from(columns(settings) / COLUMNS_STEP)
    },
    reads: MADE_OF,
    zeroed: false,
};

const SHADER: &str = concat!(
    include_str!("../../shaders/rows.wgsl"),
    include_str!("../../shaders/common/rows.wgsl"),
);

const USES: &[Resource] = &[
    Resource::Read(Field::Surface),
    Resource::Knobs(knobs),
    Resource::Make(&ASKED),
    Resource::Make(&TREE),
];

const fn pass(entry: &'static str, over: Over) -> Pass {
    Pass {
        shader: SHADER,
        entry,
        over,
        when: When::EachBeam(shafts::beams),
        uses: USES,
    }
}

/// Nothing has been asked for yet.
pub const BEGIN: Pass = pass("begin", Over::Groups(|_| [1, 1]));

/// What the pixels of the tile ask for.
pub const MEASURE: Pass = pass("measure", Over::Pixels);

/// Reads the z-partitions' maps into rows and builds their trees, one workgroup a row.
pub const BUILD: Pass = pass(
    "build",
    Over::Groups(|extent| [most_rows(extent.conditions, &extent.settings), 1]),
);
