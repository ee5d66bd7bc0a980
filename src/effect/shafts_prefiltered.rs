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

use super::method::Method;
use super::shafts::{self, DISC, SUNS};
use super::soft_edges::SOFTEN_AFTER;
use super::{Effect, Field, Knob, Number, Over, Pass, Product, Resource, When, rows};

/// Prefix sums of filtered rows.
pub const SHAFTS_PREFILTERED: Effect = Effect {
    name: "shafts_prefiltered",
    summary: "sunlight scattered by the air, from prefix sums of filtered rows",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    method: Some(Method::Prefiltered),
    knobs: &[
        DISC,
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
    note: shafts::note,
    passes: &[
        rows::BEGIN,
        rows::MEASURE,
        rows::BUILD,
        pass(
            "sum_rows",
            Over::Groups(|extent| [rows::most_rows(extent.conditions, &extent.settings), 1]),
        ),
        pass("look_up", Over::Pixels),
        SOFTEN_AFTER,
    ],
    ..Effect::NOTHING
};

const fn pass(entry: &'static str, over: Over) -> Pass {
    Pass {
        shader: concat!(
            include_str!("../../shaders/shafts_prefiltered.wgsl"),
            include_str!("../../shaders/common/rows.wgsl"),
        ),
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
        knobs
            .extend(["thresholds", "blocks"].map(|knob| (knob, Number::count(settings.get(knob)))));
        knobs
    }),
    Resource::Update(Field::InscatterSun),
    Resource::Make(&rows::ASKED),
    Resource::Make(&rows::TREE),
    Resource::Make(&SUMS),
];

/// Lit columns before every eighth, row by row, place by place: for a threshold (low half) and the next (high half).
const SUMS: Product = Product {
    name: "sums",
    wgsl: "array<u32>",
    bytes: |extent| {
        let settings = &extent.settings;
        let places = u64::from(rows::columns(settings) / 8 + 1);
        let thresholds = settings.get("thresholds").round() as u64;
        4 * u64::from(rows::most_rows(extent.conditions, settings)) * places * thresholds
    },
    reads: rows::MADE_OF,
    zeroed: false,
};
