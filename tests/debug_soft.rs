mod common;
use common::build::layer;
use common::shafts::{by_gpu, by_reference};
use common::soft::*;
use tyndall::effect::{Field, Method};
#[test]
fn debug() {
    let want = std::env::var("CASE").unwrap();
    let cam: usize = std::env::var("CAM").unwrap().parse().unwrap();
    for (name, triangles, sun) in &casters() {
        if !name.contains(&want) {
            continue;
        }
        let camera = cameras()[cam];
        let conditions = view(triangles, *sun, camera)
            .conditions([24, 18])
            .expect("sound");
        let l = |f: &tyndall::frame::Frame| -> Vec<f64> {
            layer(f, Field::InscatterSun).iter().map(|v| v.y).collect()
        };
        let truth = l(&by_reference(&conditions, &[]));
        let point_truth = l(&by_reference(
            &conditions,
            &[("shafts.disc", 0.0), ("shafts.suns", 1.0)],
        ));
        let found = l(&by_gpu(&conditions, Method::Rectified, &[]));
        let point = l(&by_gpu(
            &conditions,
            Method::Rectified,
            &[("shafts.disc", 0.0), ("shafts.suns", 1.0)],
        ));
        let most = truth.iter().copied().fold(0.0, f64::max);
        println!("{name} most {most}");
        for (title, a, b) in [
            ("truth", &truth, None),
            ("diff", &found, Some(&truth)),
            ("diff of point", &point, Some(&point_truth)),
        ] {
            println!("{title}");
            for y in 0..18 {
                let row: Vec<String> = (0..24)
                    .map(|x| {
                        let i = y * 24 + x;
                        format!(
                            "{:5.1}",
                            100.0 * (a[i] - b.map_or(0.0, |b: &Vec<f64>| b[i])) / most
                        )
                    })
                    .collect();
                println!("{}", row.join(" "));
            }
        }
    }
}
