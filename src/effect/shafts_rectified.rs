//! Sunlight in the air between exact borders of light and shadow: the main method.
//!
//! A pixel finds its row of the rectified map ([`super::rows`]) and goes through the row's tree from the eye outward: a node
//! whose d are all below the ray's c is lit, one whose d are all above is dark, any other is opened. What comes out are the
//! lit runs of the ray; each is integrated in closed form, or by Gauss-Legendre quadrature where media of several kinds
//! overlap. There is no step. A border of light lies between the middles of two columns; the triangles that throw the shadow
//! then say where exactly. What is left of error are beams that a pixel's row just misses, what is thinner than a texel, and
//! leaves, whose borders stay at columns where there are many.
//!
//! With two rows a pixel their light is blended by the pixel's place between them; a pixel then uses its own end with a
//! neighbour's heights, which darkens the last cells at silhouettes and on grazing ground. One row is the default.

use super::method::Method;
use super::shafts::{self, DISC, SUNS};
use super::soft_edges::{self, PENUMBRAE, SOFTEN};
use super::{Effect, Field, Knob, Number, Over, Pass, Resource, When, rows};

/// The main method.
pub const SHAFTS_RECTIFIED: Effect = Effect {
    name: "shafts_rectified",
    summary: "sunlight scattered by the air, between exact shadows in rows around the sun",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    method: Some(Method::Rectified),
    knobs: &[
        DISC,
        SUNS,
        rows::ROWS,
        rows::COLUMNS,
        Knob {
            name: "blend",
            meaning: "rows that a pixel reads, 1 or 2",
            values: [1.0; 4],
            range: [1.0, 2.0],
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
        SOFTEN,
        Pass {
            shader: concat!(
                include_str!("../../shaders/shafts_rectified.wgsl"),
                include_str!("../../shaders/common/rows.wgsl"),
            ),
            entry: "integrate",
            over: Over::Pixels,
            when: When::EachBeam(shafts::beams),
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Knobs(|conditions, settings| {
                    let mut knobs = rows::knobs(conditions, settings);
                    knobs.extend([
                        ("blend", Number::count(settings.get("blend"))),
                        ("halvings", Number::Count(settings.get("halvings") as u32)),
                        (
                            "soft",
                            Number::Count(soft_edges::is_soft(conditions, settings).into()),
                        ),
                    ]);
                    knobs
                }),
                Resource::Update(Field::InscatterSun),
                Resource::Make(&rows::ASKED),
                Resource::Make(&rows::TREE),
                Resource::Use(&PENUMBRAE),
            ],
        },
    ],
    ..Effect::NOTHING
};
