//! Light of the sky and of other surfaces on surfaces.
//!
//! L = albedo / pi * integral of L_in cos(theta) dw. What comes straight from the sky is the layer `sky`, what other surfaces send is
//! `indirect`, whatever its source. What surfaces send is found by progressive refinement over patches ([`crate::radiosity`]); what
//! a place receives of it, and of the sky, by rays from that place, so that contact shadows and outlines of windows are as sharp as
//! they are, and no patch shows.

use super::{Contribution, Decision, Effect, Field, Keep, Keeper, Knob, Settings, Source, Surface};
use crate::colour::luminance;
use crate::conditions::{Conditions, Input, Receivers};
use crate::error::Result;
use crate::radiosity::{Arrival, Care, Detail, Lattice, Light, Source as From, Transport};
use crate::units::brief;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Light of sky and surfaces on surfaces.
pub const RADIOSITY: Effect = Effect {
    name: "radiosity",
    summary: "light of the sky and of other surfaces on surfaces",
    reads: &[Field::Surface],
    writes: &[Field::Sky, Field::Indirect],
    keeps: &[&TRANSPORT, &LIGHT, &LATTICE],
    knobs: &[
        Knob {
            name: "sky",
            meaning: "parts of each of the sky's 145 patches, each way; 0 for 5 728 triangles",
            values: [4.0, 8.0, 16.0, 16.0],
            range: [0.0, 16.0],
        },
        Knob {
            name: "rays",
            meaning: "rays from a place, before outlines are refined",
            values: [64.0, 100.0, 784.0, 2500.0],
            range: [4.0, 65536.0],
        },
        Knob {
            name: "outline",
            meaning: "share of a place's light that may be uncertain at outlines",
            values: [0.2, 0.08, 0.005, 0.0015],
            range: [1e-5, 1.0],
        },
        Knob {
            name: "patch",
            meaning: "size of a patch as a share of what it is a part of or stands next to",
            values: [0.25, 0.125, 0.0625, 0.04],
            range: [0.01, 1.0],
        },
        Knob {
            name: "patches",
            meaning: "the most patches",
            values: [4e3, 2.4e4, 4e4, 4e4],
            range: [16.0, 1e6],
        },
        Knob {
            name: "patch_rays",
            meaning: "rays from all patches together",
            values: [1e5, 5e5, 4e6, 8e6],
            range: [16.0, 1e9],
        },
        Knob {
            name: "hemicube",
            meaning: "texels on a side of patches' hemicubes, an even number; 0 for rays",
            values: [0.0; 4],
            range: [0.0, 1024.0],
        },
        Knob {
            name: "hemicube_spots",
            meaning: "points of a patch on which a hemicube stands; 1 for its middle",
            values: [1.0; 4],
            range: [1.0, 256.0],
        },
        Knob {
            name: "patch_spots",
            meaning: "points of patches from which small openings are looked at",
            values: [0.0, 1.5e3, 1e4, 1.5e4],
            range: [0.0, 1e7],
        },
        Knob {
            name: "bend",
            meaning: "share of light by which the middle between points may be off what they say",
            values: [0.3, 0.1, 0.04, 0.02],
            range: [1e-4, 10.0],
        },
        Knob {
            name: "depth",
            meaning: "how often cells between points may be quartered",
            values: [1.0, 2.0, 4.0, 5.0],
            range: [0.0, 8.0],
        },
        Knob {
            name: "unshot",
            meaning: "share of the light that may remain unshot",
            values: [1e-2, 1e-3, 1e-4, 1e-5],
            range: [1e-9, 0.5],
        },
    ],
    decide: |conditions| {
        if !conditions.is_lit() {
            return Decision::nothing("neither sky nor sun nor a lamp gives light");
        }
        let sky = conditions.sky.as_ref();
        let sky = sky.map_or(0.0, |sky| luminance(sky.horizontal_illuminance()));
        // Points tell the illuminance, whatever stands there.
        let (share, unit) = match conditions.view.receivers {
            Receivers::Points(_) => (PI, "lx"),
            Receivers::Pixels => (conditions.greatest_albedo(), "cd/m2"),
        };
        let brightest = conditions.brightest();
        // Ground that is flat and alone sends nothing to itself.
        let alone = conditions.geometry.triangle_count() == 0;
        let others = match alone {
            true => 0.0,
            false => share * brightest.surface,
        };
        let said = match alone {
            true => ", and no surface sends light to another".to_owned(),
            false if others.is_finite() => {
                format!(", surfaces add at most {} {unit}", brief(others))
            }
            false => String::new(),
        };
        Decision::run(
            format!("the sky gives {} lx on open ground{said}", brief(sky)),
            Contribution::at_most(share * brightest.sky + others, conditions),
        )
    },
    reference: |conditions, settings, kept| {
        let (transport, light) = solution(conditions, settings, kept)?;
        if conditions.geometry.triangle_count() > 0 {
            kept.note(light.describe(&transport));
            transport.notes().iter().for_each(|n| kept.note(n.clone()));
        }
        let lattice = kept.get(&LATTICE, conditions, settings, |_| {
            let [bend, depth] = ["bend", "depth"].map(|knob| settings.get(knob));
            Ok(Lattice::new(&transport, &light, bend, depth as u32))
        })?;
        Ok(Box::new(move |fields| {
            let received: Vec<[DVec3; 2]> = fields
                .surfaces
                .iter()
                .map(|surface| match surface.source {
                    Source::Nothing => [DVec3::ZERO; 2],
                    Source::Ground => lattice.on_ground(&transport, &light, surface.position),
                    Source::Receiver => gathered(&transport, &light, surface),
                    Source::Triangle(triangle, weights) => lattice.on_triangle(
                        &transport,
                        &light,
                        triangle,
                        weights,
                        surface.facet,
                        surface.position,
                    ),
                })
                .collect();
            for (place, field) in [Field::Sky, Field::Indirect].into_iter().enumerate() {
                let mut received = received.iter();
                fields.update(field, |_, _, surface, present| {
                    let received = received.next().map_or(DVec3::ZERO, |r| r[place]);
                    present + surface.albedo / PI * received
                });
            }
        }))
    },
    passes: &[],
    ..Effect::NOTHING
};

/// Who sees whom.
const TRANSPORT: Keep = Keep {
    name: "who sees whom",
    reads: &[
        Input::Geometry,
        Input::Materials,
        Input::Extinction,
        Input::Lamps,
    ],
};

/// How bright all sources are.
const LIGHT: Keep = Keep {
    name: "the light of all patches",
    reads: &[
        Input::Geometry,
        Input::Materials,
        Input::Media,
        Input::Sky,
        Input::Sun,
        Input::Lamps,
    ],
};

/// The light on surfaces where a picture needed it.
const LATTICE: Keep = Keep {
    name: "the light on surfaces",
    reads: LIGHT.reads,
};

/// How finely light is carried by the knobs of this effect.
pub fn detail(settings: &Settings<'_>) -> Detail {
    Detail {
        sky: settings.get("sky") as u32,
        care: Care {
            rays: settings.get("rays") as usize,
            outline: settings.get("outline"),
        },
        patch: settings.get("patch"),
        patches: settings.get("patches") as usize,
        patch_rays: settings.get("patch_rays") as usize,
        hemicube: settings.get("hemicube") as usize,
        hemicube_spots: settings.get("hemicube_spots") as usize,
        patch_spots: settings.get("patch_spots") as usize,
    }
}

/// Transport and light of a scene, kept.
fn solution(
    conditions: &Conditions,
    settings: &Settings<'_>,
    kept: &Keeper<'_>,
) -> Result<(Arc<Transport>, Arc<Light>)> {
    let detail = detail(settings);
    let transport = kept.get(&TRANSPORT, conditions, settings, |task| {
        Transport::new(conditions, detail, kept.drawer(), task)
    })?;
    let light = kept.get(&LIGHT, conditions, settings, |task| {
        Light::new(&transport, conditions, settings.get("unshot"), task)
    })?;
    Ok((transport, light))
}

/// Transport and light as this effect has made them for the plan at hand; of a plan without it, as it would by its knobs at the
/// quality `preview`.
pub(super) fn shared(
    conditions: &Conditions,
    kept: &Keeper<'_>,
) -> Result<(Arc<Transport>, Arc<Light>)> {
    let transport = kept.of_other(RADIOSITY.name, &TRANSPORT, conditions);
    let light = kept.of_other(RADIOSITY.name, &LIGHT, conditions);
    if let (Some(transport), Some(light)) = (transport, light) {
        return Ok((transport, light));
    }
    let values: Vec<_> = RADIOSITY
        .knobs
        .iter()
        .map(|k| (k.name, k.values[1]))
        .collect();
    let settings = Settings {
        effect: RADIOSITY.name,
        values: &values,
    };
    solution(conditions, &settings, kept)
}

/// What a surface receives by rays of its own [lx, RGB]: straight from the sky, and from surfaces.
fn gathered(transport: &Transport, light: &Light, surface: &Surface) -> [DVec3; 2] {
    let arrivals = transport.before(surface.position, surface.normal, surface.facet);
    let sum = |is: fn(&Arrival) -> bool| -> DVec3 {
        PI * arrivals
            .iter()
            .filter(|a| is(a))
            .map(|a| light.of(a))
            .sum::<DVec3>()
    };
    [
        sum(|a| matches!(a.source, From::Sky(_))),
        sum(|a| !matches!(a.source, From::Sky(_))),
    ]
}
