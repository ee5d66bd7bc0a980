//! Sunlight in the air from prefix sums: as many reads a pixel whatever stands in the way. The outdoor method of ReLiShaft
//! (Kolivand et al. 2018).
//!
//! Klehm et al. (2014) noticed that the number which a ray compares with all places of a row of the rectified map
//! ([`super::rows`]) does not change along the ray, so that rows can be filtered once for all rays: sum_i f_j(d_i) up to every
//! place, for a few basis functions f_j, and a ray takes the difference of two sums. Theirs are Fourier's, which ring: a
//! visibility of 16 terms is off by 1 to 2 % of the light, by up to half of it at single pixels. Ours are steps at
//! `thresholds` values spread evenly over the c that the tile's pixels have: the sums are whole numbers without rounding, exact
//! at those values and linear in c between them, so that what comes out is never negative and never more than all light.
//!
//! A ray is cut into `blocks` parts of equal columns; in each the share of lit columns weights the light that the whole part
//! would scatter, integrated in closed form. What is lost is where in its part the light falls: at most
//! sum_j osc_j (t_j+1 - t_j) F_j (1 - F_j), osc_j the range of the integrand in the part.

use super::shafts::{self, Method, SUNS};
use super::{Effect, Field, Kind, Knob, Over, Pass, Resource, Scratch, Settings, rows};

/// Prefix sums of filtered rows.
pub const SHAFTS_PREFILTERED: Effect = Effect {
    name: "shafts_prefiltered",
    summary: "sunlight scattered by the air, from prefix sums of filtered rows",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    remembers: false,
    method: Some(Method::Prefiltered),
    knobs: &[
        SUNS,
        // No finer than that the sums stay below the 128 MiB that every device takes.
        Knob {
            values: [512.0, 1024.0, 1024.0, 1024.0],
            ..rows::ROWS
        },
        Knob {
            values: [512.0, 1024.0, 1024.0, 1024.0],
            ..rows::COLUMNS
        },
        Knob {
            name: "thresholds",
            meaning: "values of c at which rows are filtered",
            values: [32.0, 32.0, 60.0, 60.0],
            range: [2.0, 512.0],
        },
        Knob {
            name: "blocks",
            meaning: "parts of each ray in which light and shadow are averaged",
            values: [4.0, 8.0, 16.0, 16.0],
            range: [1.0, 256.0],
        },
    ],
    decide: shafts::decide,
    reference: shafts::reference,
    passes: &[
        rows::BEGIN,
        rows::MEASURE,
        rows::BUILD,
        Pass {
            shader: SHADER,
            entry: "sum_rows",
            kind: Kind::EachSun(
                "suns",
                Over::Groups(|settings| [rows::most_rows(settings), 1]),
            ),
            uses: USES,
            scratch: SCRATCH,
        },
        Pass {
            shader: SHADER,
            entry: "look_up",
            kind: Kind::EachSun("suns", Over::Pixels),
            uses: USES,
            scratch: SCRATCH,
        },
    ],
};

const SHADER: &str = include_str!("../../shaders/shafts_prefiltered.wgsl");

const USES: &[Resource] = &[
    Resource::Read(Field::Surface),
    Resource::Table(|_, settings| {
        let mut table = rows::table(settings);
        table.extend(["thresholds", "blocks"].map(|knob| settings.get(knob).round() as f32));
        table
    }),
    Resource::Update(Field::InscatterSun),
];

const SCRATCH: &[Scratch] = &[
    rows::SCRATCH[0],
    rows::SCRATCH[1],
    Scratch {
        name: "prefix sums of rows",
        bytes: |settings: &Settings<'_>, _| {
            let places = u64::from(rows::columns(settings) / 8 + 1);
            let thresholds = settings.get("thresholds").round() as u64;
            4 * u64::from(rows::most_rows(settings)) * places * thresholds
        },
    },
];
