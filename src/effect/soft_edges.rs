//! The soft edges of shadows in the air under the sun's whole disc: a pass that all methods of integrating sunlight there have in common.
//!
//! As in the reference ([`crate::scene::penumbra`]), edges are found from where the ray is, whether or not their shadow meets it: a
//! tree of all edges at which surfaces end, as the disc sees them ([`crate::scene::ends`]), is searched with the wedge between ray and
//! disc. The places of ray and edge that see each other within the disc make a conic section; its extent on the ray is where the
//! edge counts. There, the integral of S f is taken by four Gauss-Legendre nodes between the places where edges come and go, S the
//! share of the disc's light that arrives, f what the air sends to the eye from a place that all of it reaches. Where one edge alone
//! crosses the disc, S is the share beside a chord, if a ray to the part left open is free; where several do, or ends of edges
//! lie within the disc, it is what casters leave of 512 parts of the disc (`shaders/common/disc.wgsl`).
//!
//! Elsewhere the disc is seen whole or not at all, as its middle is: methods that know runs of light ([`SOFTEN`] comes before them)
//! leave the parts in penumbrae out. Others have taken what a point in the middle lights, V f with V of 0 or 1, all along the ray:
//! [`SOFTEN_AFTER`] adds the integral of (S - V) f, V found by rays between the places where edges pass the middle.
//!
//! More than 24 penumbrae along one ray share nodes with their neighbours ([`SOFTEN_AFTER`] leaves these to the point). Where casters have
//! holes the pass does not run.

use super::shafts;
use super::{Field, Number, Over, Pass, Product, Resource, Settings, When, rows};
use crate::conditions::Conditions;

/// Numbers a pixel: how many parts of its ray lie in penumbrae, and these.
pub const PENUMBRA_NUMBERS: u32 = 25;

/// The parts of each pixel's ray that lie in penumbrae: how many, and where they begin and end [m].
pub const PENUMBRAE: Product = Product {
    name: "penumbrae",
    wgsl: "array<vec4f>",
    bytes: |extent| {
        let pixels = match is_soft(extent.conditions, &extent.settings) {
            true => extent.pixels,
            false => 1,
        };
        16 * u64::from(PENUMBRA_NUMBERS) * pixels
    },
    reads: rows::MADE_OF,
    zeroed: false,
};

/// Whether [`SOFTEN`] runs.
pub fn is_soft(conditions: &Conditions, settings: &Settings<'_>) -> bool {
    !shafts::soft_beams(conditions, settings).is_empty()
}

/// Adds the light of parts of rays in penumbrae, and tells which these are.
pub const SOFTEN: Pass = Pass {
    uses: &[
        Resource::Read(Field::Surface),
        Resource::Update(Field::InscatterSun),
        Resource::Knobs(|conditions, _| knobs(conditions, true)),
        Resource::Make(&PENUMBRAE),
        Resource::CasterTree,
        Resource::Ends,
        Resource::Facets,
        Resource::Materials,
    ],
    ..PASS
};

/// Adds what the light of these parts is more than that of the disc's middle.
pub const SOFTEN_AFTER: Pass = Pass {
    uses: &[
        Resource::Read(Field::Surface),
        Resource::Update(Field::InscatterSun),
        Resource::Knobs(|conditions, _| knobs(conditions, false)),
        Resource::Make(&PENUMBRAE),
        Resource::CasterTree,
        Resource::Ends,
        Resource::Facets,
        Resource::Materials,
    ],
    ..PASS
};

const PASS: Pass = Pass {
    shader: include_str!("../../shaders/soft_edges.wgsl"),
    entry: "soften",
    over: Over::Pixels,
    when: When::EachBeam(shafts::soft_beams),
    uses: &[],
};

fn knobs(conditions: &Conditions, replaces: bool) -> Vec<(&'static str, Number)> {
    let limb = conditions.sun.limb_exponent();
    vec![
        ("replaces", Number::Count(replaces.into())),
        ("limb_red", Number::float(limb.x)),
        ("limb_green", Number::float(limb.y)),
        ("limb_blue", Number::float(limb.z)),
    ]
}
