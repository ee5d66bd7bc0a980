mod common;
use common::shafts::{Settings, by_reference, error, plan, render};
use common::views::*;
use glam::DVec2;
use tyndall::effect::Method;
use tyndall::plan::Quality;
#[test]
fn cost() {
    let size = [256, 192];
    let _stats = ();
    let only = std::env::var("ONLY").unwrap_or_default();
    for (name, mut view) in [
        ("slats", slats(1.0)),
        ("colonnade", colonnade()),
        ("gates", gates()),
        ("slit", slit()),
        ("room", room()),
        ("mountains", mountains()),
        ("hills", hills()),
    ] {
        if !only.is_empty() && !name.contains(&only) {
            continue;
        }
        if let Some(sun) = &mut view.scene.sun {
            sun.diameter_deg = Some(0.533);
        }
        let conditions = view.conditions(size).expect("sound");
        println!(
            "{name}: {:?} {:.1}",
            conditions.disc_in_air().map(|d| d.told),
            conditions.widest_penumbra()
        );
        let small = view.conditions([64, 48]).expect("sound");
        let sets: [(&str, Settings); 3] = [
            ("disc", &[]),
            ("a point", &[("shafts.disc", 0.0), ("shafts.suns", 1.0)]),
            ("4 points", &[("shafts.disc", 0.0)]),
        ];
        let truth = by_reference(&small, &[]);
        let many = by_reference(&small, &[("shafts.disc", 0.0), ("shafts.suns", 256.0)]);
        let lit = |f: &tyndall::frame::Frame| error(f, &truth);
        println!("   256 points by reference {:.4?}", error(&truth, &many));
        for (title, set) in sets {
            let p = plan(&conditions, Method::Rectified, Quality::Preview, set);
            let mut all = Vec::new();
            for _ in 0..3 {
                let r = render(&p);
                if std::env::var("STATS").is_ok() {
                    let l = common::build::layer(&r.frame, tyndall::effect::Field::InscatterSun);
                    let mean: glam::DVec3 =
                        l.iter().copied().sum::<glam::DVec3>() / l.len() as f64 / 1e6;
                    let most = l.iter().copied().fold(glam::DVec3::ZERO, glam::DVec3::max) / 1e6;
                    println!("   mean {mean:.1} most {most:.1}");
                    return;
                }
                let times: Vec<(&str, f64)> = r
                    .steps
                    .iter()
                    .filter(|s| s.effect.method.is_some())
                    .map(|s| (s.pass, s.time.map_or(0.0, |t| 1e3 * t.as_secs_f64())))
                    .collect();
                all.push(times);
            }
            all.sort_by(|a, b| {
                a.iter()
                    .map(|t| t.1)
                    .sum::<f64>()
                    .total_cmp(&b.iter().map(|t| t.1).sum::<f64>())
            });
            let best = &all[0];
            let e = lit(&render(&plan(&small, Method::Rectified, Quality::Preview, set)).frame);
            println!(
                "   {title}: {:.0} ms {:?}, error {:.4?}",
                best.iter().map(|t| t.1).sum::<f64>(),
                best.iter()
                    .map(|t| format!("{} {:.0}", t.0, t.1))
                    .collect::<Vec<_>>(),
                e
            );
        }
        let _ = DVec2::ZERO;
    }
}
