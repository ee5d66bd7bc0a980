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

use super::shafts::{self, Method, SUNS};
use super::{Effect, Field, Kind, Knob, Over, Pass, Resource, Scratch, Settings, rows};

/// Sparse rays.
pub const SHAFTS_EPIPOLAR: Effect = Effect {
    name: "shafts_epipolar",
    summary: "sunlight scattered by the air, at sparse places of rows around the sun and between them",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    remembers: false,
    method: Some(Method::Epipolar),
    knobs: &[
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
    passes: &[
        rows::BEGIN,
        rows::MEASURE,
        rows::BUILD,
        Pass {
            shader: SHADER,
            entry: "place",
            kind: Kind::EachSun(
                "suns",
                Over::Groups(|settings| [samples(settings) / 16, slices(settings).div_ceil(16)]),
            ),
            uses: USES,
            scratch: SCRATCH,
        },
        over_samples("seed", |settings| groups(settings, 16)),
        over_samples("refine_16", |settings| groups(settings, 16)),
        over_samples("refine_8", |settings| groups(settings, 8)),
        over_samples("refine_4", |settings| groups(settings, 4)),
        over_samples("refine_2", |settings| groups(settings, 2)),
        Pass {
            shader: SHADER,
            entry: "unwarp",
            kind: Kind::EachSun("suns", Over::Pixels),
            uses: USES,
            scratch: SCRATCH,
        },
    ],
};

const SHADER: &str = include_str!("../../shaders/shafts_epipolar.wgsl");

fn slices(settings: &Settings<'_>) -> u32 {
    (settings.get("slices") as u32).min(rows::most_rows(settings))
}

/// Samples of a slice: whole sixteens.
fn samples(settings: &Settings<'_>) -> u32 {
    (settings.get("samples") as u32).next_multiple_of(16)
}

/// Workgroups of 8 by 8 that cover all slices and the samples of each that are so far `apart`.
fn groups(settings: &Settings<'_>, apart: u32) -> [u32; 2] {
    [slices(settings), samples(settings) / apart].map(|count| count.div_ceil(8))
}

/// A pass over samples.
const fn over_samples(entry: &'static str, groups: fn(&Settings<'_>) -> [u32; 2]) -> Pass {
    Pass {
        shader: SHADER,
        entry,
        kind: Kind::EachSun("suns", Over::Groups(groups)),
        uses: USES,
        scratch: SCRATCH,
    }
}

const USES: &[Resource] = &[
    Resource::Read(Field::Surface),
    Resource::Table(|_, settings| {
        let mut table = rows::table(settings);
        table.extend([slices(settings) as f32, samples(settings) as f32]);
        table.extend(["tolerance", "halvings"].map(|knob| settings.get(knob) as f32));
        table
    }),
    Resource::Update(Field::InscatterSun),
];

const SCRATCH: &[Scratch] = &[
    rows::SCRATCH[0],
    rows::SCRATCH[1],
    Scratch {
        name: "samples of slices",
        // One more than the last interval needs, a slice.
        bytes: |settings, _| 16 * u64::from(slices(settings)) * u64::from(samples(settings) + 1),
    },
];
