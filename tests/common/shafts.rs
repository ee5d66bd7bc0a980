//! Sunlight in the air alone: by a method on a device, by the reference, and the error between them.

use super::build::layer;
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::gpu::{Choice, Device, Gpu, Rendered};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::reference::Reference;
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
        without: ["surface_sun", "surface_sky", "sky_dome", "sun_disc"]
            .map(str::to_owned)
            .to_vec(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

/// What a device makes of a plan, all of whose values have been checked.
pub fn render(plan: &Plan) -> Rendered {
    let device = Device::open(Choice::Any).expect("there is an adapter");
    let mut gpu = Gpu::new(plan, device).expect("the plan fits the device");
    let rendered = gpu.render(1 << 30, &|_| {}).expect("the device works");
    rendered
        .frame
        .check()
        .expect("every value is finite and not negative");
    rendered
}

/// What the passes of a plan's method read, by their names: reads of maps, leaves and samples, and nodes of trees.
pub fn counted(plan: &Plan) -> Vec<(&'static str, [u64; 2])> {
    let device = Device::open(Choice::Any).expect("there is an adapter");
    let mut gpu = Gpu::counting(plan, device).expect("the plan fits the device");
    let rendered = gpu.render(1 << 30, &|_| {}).expect("the device works");
    let passes = rendered.passes.iter();
    passes
        .filter(|pass| pass.effect.starts_with("shafts_"))
        .filter_map(|pass| Some((pass.pass, pass.counted?)))
        .collect()
}

/// A picture by a method on a device, at the quality `preview`.
pub fn by_gpu(conditions: &Conditions, method: Method, set: Settings) -> Frame {
    render(&plan(conditions, method, Quality::Preview, set)).frame
}

/// The picture by exact shadows.
pub fn by_reference(conditions: &Conditions, set: Settings) -> Frame {
    let plan = plan(conditions, Method::Rectified, Quality::Preview, set);
    let rendered = Reference::new(&plan).render(1 << 30, &|_| {});
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
