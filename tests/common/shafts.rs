//! Sunlight in the air alone: by a method on a device, by the reference, and the error between them.

use super::build::layer;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::studies::shafts::errors;

/// Knobs and values.
pub type Settings<'a> = &'a [(&'a str, f64)];

/// A plan of sunlight in the air alone.
pub fn plan<'c>(
    conditions: &'c Conditions,
    method: Method,
    quality: Quality,
    set: Settings,
) -> Plan<'c> {
    let overrules = Overrules {
        quality,
        method: Some(method),
        set: set.iter().map(|(knob, v)| (knob.to_string(), *v)).collect(),
        without: [
            "surface_sun",
            "radiosity",
            "air_sky",
            "sky_dome",
            "sun_disc",
        ]
        .map(str::to_owned)
        .to_vec(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

/// The device that all tests of a process share.
pub fn gpu() -> MutexGuard<'static, Gpu> {
    static GPU: OnceLock<Mutex<Gpu>> = OnceLock::new();
    let open = || Mutex::new(Gpu::open(Choice::Any).expect("there is an adapter"));
    let lock = GPU.get_or_init(open).lock();
    lock.unwrap_or_else(PoisonError::into_inner)
}

/// What a device makes of a plan, all of whose values have been checked.
pub fn render(plan: &Plan) -> Rendered {
    let rendered = gpu().render(plan, &Limits::memory(1 << 30), &|_| {});
    let rendered = rendered.expect("the device works");
    rendered
        .frame
        .check()
        .expect("every value is finite and not negative");
    rendered
}

/// What the passes of a plan's method read, by their names: reads of maps, leaves and samples, and nodes of trees.
pub fn counted(plan: &Plan) -> Vec<(&'static str, [u64; 2])> {
    let rendered = gpu().count(plan, &Limits::memory(1 << 30), &|_| {});
    let steps = rendered.expect("the device works").steps;
    steps
        .iter()
        .filter(|step| step.effect.method.is_some())
        .filter_map(|step| Some((step.pass, step.counted?)))
        .collect()
}

/// A picture by a method on a device, at the quality `preview`.
pub fn by_gpu(conditions: &Conditions, method: Method, set: Settings) -> Frame {
    render(&plan(conditions, method, Quality::Preview, set)).frame
}

/// The picture by exact shadows.
pub fn by_reference(conditions: &Conditions, set: Settings) -> Frame {
    let plan = plan(conditions, Method::Rectified, Quality::Preview, set);
    let rendered = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {});
    rendered.expect("the picture fits into memory").frame
}

/// Relative RMSE and bias of the light in the air.
pub fn error(found: &Frame, truth: &Frame) -> (f64, f64) {
    let light = |frame: &Frame| -> Vec<glam::Vec3> {
        layer(frame, Field::InscatterSun)
            .iter()
            .map(|v| v.as_vec3())
            .collect()
    };
    let (rmse, _, bias) = errors(&light(found), &light(truth));
    (rmse, bias)
}
