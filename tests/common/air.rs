//! Light of the sky in the air alone, and skies for it.

use glam::DVec3;
use std::sync::Arc;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::Conditions;
use tyndall::effect::{ALL, Effect, Field};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::sky::{Model, Sky, SunAt};

/// The effects that the air's light from sky and surfaces needs.
pub fn effects() -> Vec<&'static Effect> {
    effects_with(&[])
}

fn effects_with(others: &[&str]) -> Vec<&'static Effect> {
    let named = |effect: &&&Effect| {
        ["visibility", "air_sky"].contains(&effect.name) || others.contains(&effect.name)
    };
    ALL.iter().filter(named).copied().collect()
}

/// The same conditions under another sky.
pub fn under(mut conditions: Conditions, model: Model) -> Conditions {
    let sun = SunAt::unrefracted(conditions.sun.toward);
    conditions.sky = Some(Arc::new(Sky::new(model, sun).expect("the sky is sound")));
    conditions
}

/// A sky of the same white luminance everywhere.
pub const UNIFORM: Model = Model::Uniform { luminance: 1000.0 };

/// The layer of the air's light from sky and surfaces, with knobs of the effect set.
pub fn air_light(conditions: &Conditions, quality: Quality, set: &[(&str, f64)]) -> Vec<DVec3> {
    air_light_after(&[], conditions, quality, set)
}

/// The same after other effects: of `radiosity` it takes who sees whom and how bright surfaces are.
pub fn air_light_after(
    others: &[&str],
    conditions: &Conditions,
    quality: Quality,
    set: &[(&str, f64)],
) -> Vec<DVec3> {
    let overrules = Overrules {
        quality,
        set: set
            .iter()
            .map(|(knob, v)| (format!("air_sky.{knob}"), *v))
            .collect(),
        ..Overrules::default()
    };
    let plan =
        Plan::with(conditions, &overrules, &effects_with(others)).expect("the plan is sound");
    let rendered = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {})
        .expect("the picture fits into memory");
    rendered
        .frame
        .check()
        .expect("all values are finite and not negative");
    super::build::layer(&rendered.frame, Field::InscatterSky)
}

/// The same layer of a plan by the `gpu` backend.
pub fn by_gpu(plan: &Plan) -> Vec<DVec3> {
    let rendered = Backend::open(Wanted::Gpu)
        .and_then(|mut backend| backend.render(plan, &Limits::memory(1 << 30), &|_| {}))
        .expect("it renders");
    super::build::layer(&rendered.frame, Field::InscatterSky)
}
