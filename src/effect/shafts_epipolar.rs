//! Sunlight in the air at sparse places along epipolar lines, and in between from what lies next to it (Engelhardt &
//! Dachsbacher 2010; Yusov 2013).
//!
//! On the picture shadows in the air run toward the sun's place, so that light changes slowly along these lines and quickly
//! across them. Slices are some of the rows of the rectified map ([`super::rows`]); along each lie samples at even steps of c,
//! which are even steps of angle within a factor of two, wherever the sun stands. Every sixteenth sample is integrated exactly
//! as [`super::shafts_rectified`] does it. Between two of them the middle one is integrated as well, and the rest is
//! interpolated only where the air goes on without a break (one over its depth is straight) and the middle is within `tolerance`
//! of the straight line; else both halves are asked again by the next pass, down to single samples. Depth alone, which older
//! systems ask, misses the borders of shadows that no surface shows.
//!
//! A pixel then blends the samples of two slices around it whose air is about as deep as its own. Where these weigh less than
//! half it is integrated exactly.
//!
//! Every camera has samples. From the eye or all around it, row and c are a direction, which lies in one pixel at most. On the
//! plane of an orthographic camera they are coordinates along axes at right angles, wherever the sun stands: rows across the
//! light's direction on the picture, c along it. Rays so nearly along the light that one place across it decides for all of the
//! ray need no samples: their pixels read that place.

use super::method::Method;
use super::shafts::{self, DISC, SUNS};
use super::soft_edges::SOFTEN_AFTER;
use super::{
    Effect, Extent, Field, Knob, Number, Over, Pass, Product, Resource, Settings, When, rows,
};
use crate::conditions::Conditions;

/// Sparse rays.
pub const SHAFTS_EPIPOLAR: Effect = Effect {
    name: "shafts_epipolar",
    summary: "sunlight scattered by the air, at sparse places of rows around the sun and between them",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    method: Some(Method::Epipolar),
    knobs: &[
        DISC,
        SUNS,
        rows::ROWS,
        rows::COLUMNS,
        Knob {
            name: "slices",
            meaning: "lines of samples, at most one a row",
            values: [512.0, 1024.0, 2048.0, 4096.0],
            range: [8.0, 8192.0],
        },
        Knob {
            name: "samples",
            meaning: "samples along each slice (a multiple of 16 is taken)",
            values: [256.0, 512.0, 1024.0, 1024.0],
            range: [16.0, 4096.0],
        },
        Knob {
            name: "tolerance",
            meaning: "relative difference from a straight line that is let pass",
            values: [0.05, 0.02, 0.01, 0.002],
            range: [0.0, 1.0],
        },
        rows::HALVINGS,
    ],
    decide: shafts::decide,
    reference: shafts::reference,
    note: shafts::note,
    passes: &[
        rows::BEGIN,
        rows::MEASURE,
        rows::BUILD,
        pass(
            "place",
            Over::Groups(|extent| {
                let settings = &extent.settings;
                [
                    samples(settings) / 16,
                    slices(extent.conditions, settings).div_ceil(16),
                ]
            }),
        ),
        pass("seed", Over::Groups(|extent| groups(extent, 16))),
        pass("refine_16", Over::Groups(|extent| groups(extent, 16))),
        pass("refine_8", Over::Groups(|extent| groups(extent, 8))),
        pass("refine_4", Over::Groups(|extent| groups(extent, 4))),
        pass("refine_2", Over::Groups(|extent| groups(extent, 2))),
        pass("unwarp", Over::Pixels),
        SOFTEN_AFTER,
    ],
    ..Effect::NOTHING
};

const SHADER: &str = concat!(
    include_str!("../../shaders/shafts_epipolar.wgsl"),
    include_str!("../../shaders/common/rows.wgsl"),
);

fn slices(conditions: &Conditions, settings: &Settings<'_>) -> u32 {
    (settings.get("slices") as u32).min(rows::most_rows(conditions, settings))
}

/// Samples of a slice: whole sixteens.
fn samples(settings: &Settings<'_>) -> u32 {
    (settings.get("samples") as u32).next_multiple_of(16)
}

/// Workgroups of 8 by 8 that cover all slices and the samples of each that are so far `apart`.
fn groups(extent: &Extent<'_>, apart: u32) -> [u32; 2] {
    let settings = &extent.settings;
    [
        slices(extent.conditions, settings),
        samples(settings) / apart,
    ]
    .map(|count| count.div_ceil(8))
}

const fn pass(entry: &'static str, over: Over) -> Pass {
    Pass {
        shader: SHADER,
        entry,
        over,
        when: When::EachBeam(shafts::beams),
        uses: USES,
    }
}

const USES: &[Resource] = &[
    Resource::Read(Field::Surface),
    Resource::Knobs(|conditions, settings| {
        let mut knobs = rows::knobs(conditions, settings);
        knobs.extend([
            ("slices", Number::Count(slices(conditions, settings))),
            ("samples", Number::Count(samples(settings))),
            ("tolerance", Number::float(settings.get("tolerance"))),
            ("halvings", Number::Count(settings.get("halvings") as u32)),
        ]);
        knobs
    }),
    Resource::Update(Field::InscatterSun),
    Resource::Make(&rows::ASKED),
    Resource::Make(&rows::TREE),
    Resource::Make(&SAMPLES),
];

/// Light [1/sr], negative until it is known, and the depth of the air that it comes from, which ends at a surface (positive) or
/// not (negative); 0 off the tile.
const SAMPLES: Product = Product {
    name: "samples",
    wgsl: "array<vec4f>",
    bytes: |extent| {
        let settings = &extent.settings;
        // One more than the last interval needs, a slice.
        16 * u64::from(slices(extent.conditions, settings)) * u64::from(samples(settings) + 1)
    },
    reads: rows::MADE_OF,
    zeroed: false,
};
