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
fn worst() {
    for view in [colonnade(), hills()] {
        let conditions = conditions(view.scene.clone(), view.camera, [256, 192]);
        let truth = by_reference(&conditions, &[]);
        let found = by_gpu(&conditions, Method::Rectified, &[]).frame;
        let (a, b) = (
            layer(&found, Field::InscatterSun),
            layer(&truth, Field::InscatterSun),
        );
        let mut order: Vec<usize> = (0..a.len()).collect();
        order.sort_by(|&i, &j| (a[j].x - b[j].x).abs().total_cmp(&(a[i].x - b[i].x).abs()));
        let total: f64 = a.iter().zip(&b).map(|(a, b)| (a.x - b.x).powi(2)).sum();
        for &i in &order[..12] {
            eprintln!(
                "{} {} {}: {:.1} {:.1} depth {} {} share {:.3}",
                view.name,
                i % 256,
                i / 256,
                a[i].x,
                b[i].x,
                found.depth[i],
                truth.depth[i],
                (a[i].x - b[i].x).powi(2) / total
            );
        }
    }
}
