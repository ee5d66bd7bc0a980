//! Light of lamps on surfaces, with exact shadows.
//!
//! L = albedo / pi * sum over lamps of integral over the lamp of I(direction) cos(theta) V e^-tau / d^2 ([`crate::conditions::received`]
//! has the method). A surface whose own triangle faces away is dark, whatever its interpolated normal says. On a GPU shadow rays go through
//! the tree of casters in f32, and lamps are divided in the same way.

use super::surface_sun::shadow_start;
use super::{
    Contribution, Decision, Effect, Field, Knob, Number, Over, Paid, Pass, Resource, Surface, When,
    lamps_on_device,
};
use crate::conditions::received::{Care, Place, received};
use crate::conditions::volumes::Queue;
use crate::conditions::{Conditions, Receivers};
use std::f64::consts::PI;

/// Light of lamps reflected by surfaces.
pub const SURFACE_LAMPS: Effect = Effect {
    name: "surface_lamps",
    summary: "light of lamps reflected by surfaces, with exact shadows",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    knobs: &[
        Knob {
            name: "cells",
            meaning: "parts of a lamp with an extent, each way, before they are divided",
            values: [1.0, 2.0, 4.0, 8.0],
            range: [1.0, 64.0],
        },
        Knob {
            name: "share",
            meaning: "share of a lamp's light by which its finest parts may differ",
            values: [2e-2, 5e-3, 2e-3, 5e-4],
            range: [1e-6, 1.0],
        },
        LEFT_OUT,
    ],
    decide: |conditions| {
        if conditions.lamps.is_empty() {
            return Decision::nothing(NO_LAMPS);
        }
        let share = match conditions.view.receivers {
            Receivers::Points(_) => 1.0,
            Receivers::Pixels => conditions.greatest_albedo() / PI,
        };
        let contribution = match PI * share * conditions.greatest_lamp_luminance() {
            bound if bound.is_finite() => Contribution::Bound(bound),
            _ => Contribution::Estimate(share * conditions.typical_lamp_light()),
        };
        Decision::run(
            format!("{} lit", counted(conditions.lamps.len())),
            contribution,
        )
    },
    reference: |conditions, settings, _| {
        let care = Care {
            cells: settings.get("cells") as u32,
            share: settings.get("share"),
            left_out: settings.get("left_out"),
        };
        Ok(Box::new(move |fields| {
            let mut queue = Queue::default();
            let mut paid = Paid::default();
            fields.update(Field::Lights, |_, _, surface, present| {
                if !surface.is_met() {
                    return present;
                }
                let place = place(conditions, surface);
                let (received, lamps) = received(conditions, &place, &care, &mut queue);
                paid.add(lamps);
                present + surface.albedo / PI * received
            });
            fields.pay(paid);
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/surface_lamps.wgsl"),
        entry: "receive",
        over: Over::Pixels,
        when: When::Parts(lamps_on_device::parts),
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Lights),
            Resource::Knobs(|conditions, settings| {
                let mut knobs = lamps_on_device::knobs(conditions, settings);
                knobs.push(("cells", Number::count(settings.get("cells"))));
                // A difference of f32 is no less than this.
                knobs.push(("share", Number::float(settings.get("share").max(1e-5))));
                knobs
            }),
            Resource::Part,
            Resource::Lamps(lamps_on_device::texels),
            Resource::CasterTree,
            Resource::CasterCorners,
            Resource::Attributes,
            Resource::Facets,
            Resource::Materials,
            Resource::Texels,
        ],
    }],
    ..Effect::NOTHING
};

/// Why there is no light of lamps.
pub(super) const NO_LAMPS: &str = "the scene has no lamps";

/// What of the light of many lamps may be missing.
pub(super) const LEFT_OUT: Knob = Knob {
    name: "left_out",
    meaning: "share of the light that the weakest lamps together could add and are left out for",
    values: [1e-2, 3e-3, 1e-3, 1e-4],
    range: [0.0, 0.5],
};

/// Lamps in words.
pub(super) fn counted(lamps: usize) -> String {
    match lamps {
        1 => "1 lamp is".to_owned(),
        n => format!("{n} lamps are"),
    }
}

/// A surface as a place that receives light.
fn place(conditions: &Conditions, surface: &Surface) -> Place {
    let (origin, near) = shadow_start(conditions, surface);
    Place {
        position: surface.position,
        origin,
        near,
        facet: surface.facet,
        normal: surface.normal,
    }
}
