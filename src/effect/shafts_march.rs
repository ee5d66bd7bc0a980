//! Sunlight in the air by marching: what games do, and the baseline of every comparison.
//!
//! Even steps over the part of the ray that anything can shade; the middle of a step says whether all of it is lit, and runs
//! of lit steps are integrated with analytic transmittance, split at the faces of boxes. With `jitter` each pixel's steps are
//! shifted by a share of their own (Jorge Jimenez's interleaved gradient noise), which turns bands into noise of the same
//! error; with `halvings` the borders that are found are made finer. A thing thinner than a step is seen or missed by chance: the error falls only as 1 / steps.

use super::method::Method;
use super::shafts::{self, DISC, SUNS};
use super::soft_edges::{self, PENUMBRAE, SOFTEN};
use super::{Effect, Field, Knob, Number, Over, Pass, Resource, When};

/// Marching.
pub const SHAFTS_MARCH: Effect = Effect {
    name: "shafts_march",
    summary: "sunlight scattered by the air, in even steps",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    method: Some(Method::March),
    knobs: &[
        DISC,
        SUNS,
        Knob {
            name: "steps",
            meaning: "steps along each ray",
            values: [64.0, 192.0, 512.0, 2048.0],
            range: [1.0, 65536.0],
        },
        Knob {
            name: "jitter",
            meaning: "1: each pixel's steps are shifted by a share of their own; 0: not",
            values: [0.0; 4],
            range: [0.0, 1.0],
        },
        Knob {
            name: "halvings",
            meaning: "reads of the maps by which each border of light is made finer than steps",
            values: [0.0; 4],
            range: [0.0, 8.0],
        },
    ],
    decide: shafts::decide,
    reference: shafts::reference,
    note: shafts::note,
    passes: &[
        SOFTEN,
        Pass {
            shader: include_str!("../../shaders/shafts_march.wgsl"),
            entry: "march",
            over: Over::Pixels,
            when: When::EachBeam(shafts::beams),
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Update(Field::InscatterSun),
                Resource::Use(&PENUMBRAE),
                Resource::Knobs(|conditions, settings| {
                    vec![
                        ("steps", Number::Count(settings.get("steps") as u32)),
                        ("jitter", Number::float(settings.get("jitter"))),
                        ("halvings", Number::Count(settings.get("halvings") as u32)),
                        (
                            "soft",
                            Number::Count(soft_edges::is_soft(conditions, settings).into()),
                        ),
                    ]
                }),
            ],
        },
    ],
    ..Effect::NOTHING
};
