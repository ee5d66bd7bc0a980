//! Sunlight in the air on virtual planes across the view: the first method that ran on graphics hardware.
//!
//! Planes stand at even distances between the nearest and the farthest air that the tile shows (up to an optical depth of 9 before
//! the eye; what lies behind, 1.2e-4 of whose light comes through, is left out), each in the middle of its slab: at depths of a
//! perspective or orthographic view, at distances of a panorama. A ray's light is
//!
//! L = E sum over k of V_k xi_k Delta t_k, xi = sum over i of sigma_s,i p_i(mu) e^-(tau_eye + tau_sun)
//!
//! (equations 5 and 6). V_k, whether the sun reaches plane k, is read from the sun's maps for every pixel. The smooth factor xi is
//! computed once for each point of a coarse lattice on each plane and interpolated bilinearly between them.
//!
//! Source: Y. Dobashi, T. Yamamoto, T. Nishita, "Interactive Rendering Method for Displaying Shafts of Light", Proc. Pacific
//! Graphics 2000, sections 4 and 5. Two misprints are put right: the attenuation toward the light in equation 6 is exp(-kappa rho r),
//! not exp(-r); the density rho of equation 2 is a factor of what scatters, not of the transmittance beta. Their sunlight is not
//! attenuated on its way through the air; ours is.
//!
//! Differs: where there is air, and how dense, is known exactly for each ray, so that Delta t_k is the length of ray (in air that
//! thins with height, the length of air as dense as at its base) inside the medium, in front of the surface and inside the slab,
//! where theirs is the planes' distance. The lattice holds e^-(tau_eye + tau_sun); sigma_s p(mu), the same on all planes under parallel
//! light, is interpolated between the same four points' rays. Where a surface or a border of the air cuts a slab, the shadow is
//! read in the middle of what is left, since the plane may lie behind the surface. There is no sum in 8 bits.
//!
//! Without shadows the error falls as 1 / planes^2 and 1 / lattice^2. A slab is lit or dark as a whole: with shadows the error falls
//! as 1 / planes, and whatever is thinner than a slab is seen or missed by chance, on neighbouring rays alike.

use super::method::Method;
use super::shafts::{self, DISC, SUNS};
use super::soft_edges::SOFTEN_AFTER;
use super::{Effect, Field, Knob, Number, Over, Pass, Product, Resource, Settings, When};
use crate::conditions::Input;

/// Virtual planes.
pub const SHAFTS_PLANES: Effect = Effect {
    name: "shafts_planes",
    summary: "sunlight scattered by the air, on virtual planes across the view",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    method: Some(Method::Planes),
    knobs: &[
        DISC,
        SUNS,
        Knob {
            name: "planes",
            meaning: "virtual planes through the air that each tile of the picture shows",
            values: [15.0, 75.0, 150.0, 600.0],
            range: [1.0, 4096.0],
        },
        Knob {
            name: "lattice",
            meaning: "lattice points along each side of a plane (never more than pixels)",
            values: [10.0, 20.0, 40.0, 80.0],
            range: [2.0, 512.0],
        },
    ],
    decide: shafts::decide,
    reference: shafts::reference,
    note: shafts::note,
    passes: &[
        pass("begin", Over::Groups(|_| [1, 1]), USES),
        pass("measure", Over::Pixels, USES),
        pass(
            "weigh",
            Over::Groups(|extent| {
                let settings = &extent.settings;
                [lattice(settings).pow(2).div_ceil(64), planes(settings)]
            }),
            USES,
        ),
        pass("integrate", Over::Pixels, SUMS),
        SOFTEN_AFTER,
    ],
    ..Effect::NOTHING
};

const fn pass(entry: &'static str, over: Over, uses: &'static [Resource]) -> Pass {
    Pass {
        shader: include_str!("../../shaders/shafts_planes.wgsl"),
        entry,
        over,
        when: When::EachBeam(shafts::beams),
        uses,
    }
}

const SURFACES: Resource = Resource::Read(Field::Surface);
const KNOBS: Resource = Resource::Knobs(|_, settings| {
    vec![
        ("planes", Number::Count(planes(settings))),
        ("lattice", Number::Count(lattice(settings))),
    ]
});
const USES: &[Resource] = &[
    SURFACES,
    KNOBS,
    Resource::Make(&DEPTHS),
    Resource::Make(&LATTICE),
];
const SUMS: &[Resource] = &[
    SURFACES,
    KNOBS,
    Resource::Make(&DEPTHS),
    Resource::Make(&LATTICE),
    Resource::Update(Field::InscatterSun),
];

const MADE_OF: &[Input] = &[Input::Media, Input::View, Input::Tile, Input::Beam];

/// Depths of the nearest and the farthest air that the tile shows, as the bits of numbers not below 0, which have their order.
const DEPTHS: Product = Product {
    name: "depths",
    wgsl: "array<atomic<u32>, 2>",
    bytes: |_| 8,
    reads: MADE_OF,
    zeroed: false,
};

/// Share of sunlight that comes through to each lattice point and from there to the eye, plane by plane, row by row.
const LATTICE: Product = Product {
    name: "lattice",
    wgsl: "array<vec4f>",
    // Never more points than pixels.
    bytes: |extent| {
        let settings = &extent.settings;
        let points = u64::from(lattice(settings)).pow(2).min(extent.pixels);
        16 * u64::from(planes(settings)) * points
    },
    reads: MADE_OF,
    zeroed: false,
};

fn planes(settings: &Settings<'_>) -> u32 {
    settings.get("planes") as u32
}

fn lattice(settings: &Settings<'_>) -> u32 {
    settings.get("lattice") as u32
}
