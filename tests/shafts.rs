//! Sunlight in the air: every method against the reference.

mod common;

use common::build::*;
use common::views::*;
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::gpu::{Choice, Device, Gpu, Rendered};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::reference::Reference;

type Settings<'a> = &'a [(&'a str, f64)];

fn plan<'c>(conditions: &'c Conditions, method: Method, set: Settings) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Preview,
        method: Some(method),
        set: set.iter().map(|(knob, v)| (knob.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

fn by_gpu(conditions: &Conditions, method: Method, set: Settings) -> Rendered {
    let plan = plan(conditions, method, set);
    let device = Device::open(Choice::Any).expect("there is an adapter");
    let mut gpu = Gpu::counting(&plan, device).expect("the plan fits the device");
    let rendered = gpu.render(1 << 30, &|_| {}).expect("the device works");
    rendered
        .frame
        .check()
        .expect("every value is finite and not negative");
    rendered
}

fn by_reference(conditions: &Conditions, set: Settings) -> Frame {
    let plan = plan(conditions, Method::Rectified, set);
    let rendered = Reference::new(&plan).render(1 << 30, &|_| {});
    rendered.expect("the picture fits into memory").frame
}

#[test]
fn first() {
    for view in [slats(1.0), colonnade(), hills(), into_the_sun()] {
        let conditions = conditions(view.scene.clone(), view.camera, [256, 192]);
        let truth = by_reference(&conditions, &[]);
        for (method, set) in [
            (Method::Rectified, &[][..]),
            (Method::Rectified, &[("shafts.blend", 2.0)]),
        ] {
            let found = by_gpu(&conditions, method, set);
            let (a, b) = (
                layer(&found.frame, Field::InscatterSun),
                layer(&truth, Field::InscatterSun),
            );
            let bias = a.iter().map(|v| v.x).sum::<f64>() / b.iter().map(|v| v.x).sum::<f64>();
            eprintln!(
                "{} {method:?} {set:?}: {:.4} bias {:.5}",
                view.name,
                relative_rmse(&a, &b),
                bias - 1.0
            );
            for pass in found.passes.iter().filter(|p| p.effect.starts_with("shaf")) {
                let per = |n: u64| n as f64 / (256.0 * 192.0) / f64::from(pass.runs.max(1));
                eprintln!(
                    "   {} {} runs {:?} {:?}",
                    pass.pass,
                    pass.runs,
                    pass.time,
                    pass.counted.map(|c| c.map(per))
                );
            }
        }
    }
}

#[test]
fn grid() {
    let scene = tyndall::scene::Scene::builtin(tyndall::scene::BUILTIN[0]).unwrap();
    let request = tyndall::conditions::Request {
        size: Some([256, 160]),
        samples: Some(1),
        ..Default::default()
    };
    let nave = Conditions::new(scene, &request).unwrap();
    let slats = conditions(slats(1.0).scene.clone(), slats(1.0).camera, [256, 192]);
    for (name, conditions) in [("nave", &nave), ("slats", &slats)] {
        let truth = by_reference(conditions, &[("shafts.suns", 1.0)]);
        let b = layer(&truth, Field::InscatterSun);
        for maps in [2048.0, 8192.0] {
            for blend in [1.0, 2.0] {
                for rows in [1024.0, 4096.0] {
                    for columns in [1024.0, 2048.0, 4096.0] {
                        let set = [
                            ("shafts.suns", 1.0),
                            ("shadow.resolution", maps),
                            ("shafts.rows", rows),
                            ("shafts.columns", columns),
                            ("shafts.blend", blend),
                        ];
                        let found = by_gpu(conditions, Method::Rectified, &set);
                        let a = layer(&found.frame, Field::InscatterSun);
                        let counted: Vec<_> = found
                            .passes
                            .iter()
                            .filter(|p| p.pass == "integrate")
                            .map(|p| p.counted.unwrap().map(|n| n / a.len() as u64))
                            .collect();
                        eprintln!(
                            "{name} maps {maps} blend {blend} rows {rows} columns {columns}: {:.4} {counted:?}",
                            relative_rmse(&a, &b)
                        );
                    }
                }
            }
        }
    }
}
