//! The soft edges of shadows in the air under the sun's whole disc: a pass that all methods of integrating sunlight there have in common.
//!
//! A method integrates what a point in the disc's middle lights, V f, V being 0 or 1 and f what the air sends from a place that is lit.
//! This pass adds the integral of (S - V) f, S the share of the disc's light that arrives: it is nothing but where the ray is within an
//! edge's penumbra. As in the reference ([`crate::scene::penumbra`]), edges are found from where the ray is, whether or not their shadow
//! meets it: a tree of all edges at which surfaces end, as the disc sees them ([`crate::scene::ends`]), is searched with the wedge
//! between ray and disc. The places of ray and edge that see each other within the disc make a conic section, whose extent on
//! the ray is where the edge counts. Where one edge alone crosses the disc, S is the share beside a chord, if a ray to the part left
//! open is free; where several do, or ends of edges lie within the disc, it is what casters leave of 512 parts of the disc
//! (`shaders/common/disc.wgsl`). Parts are bounded by where edges come, pass the middle and go, so that V is constant and S smooth
//! in each: three Gauss-Legendre nodes.
//!
//! More than 32 penumbrae along one ray share nodes with their neighbours. Casters with holes have no part in it: what they shade keeps
//! the edges that a point gives.

use super::shafts;
use super::{Field, Number, Over, Pass, Resource, When};

/// Adds what the disc's light is more or less than its middle's.
pub const SOFTEN: Pass = Pass {
    shader: include_str!("../../shaders/soft_edges.wgsl"),
    entry: "soften",
    over: Over::Pixels,
    when: When::EachBeam(shafts::soft_beams),
    uses: &[
        Resource::Read(Field::Surface),
        Resource::Update(Field::InscatterSun),
        Resource::Knobs(|conditions, _| {
            let limb = conditions.sun.limb_exponent();
            vec![
                ("limb_red", Number::float(limb.x)),
                ("limb_green", Number::float(limb.y)),
                ("limb_blue", Number::float(limb.z)),
            ]
        }),
        Resource::CasterTree,
        Resource::Ends,
        Resource::Facets,
        Resource::Materials,
    ],
};
