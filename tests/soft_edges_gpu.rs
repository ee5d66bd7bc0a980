//! The sun's disc in the air on a device: against the reference, which is as exact as thousands of points, and a closed form.

mod common;

use common::build::layer;
use common::shafts::{Settings, by_gpu, by_reference, error};
use common::soft::*;
use common::views::*;
use glam::{DVec2, DVec3};
use tyndall::conditions::{Conditions, Told};
use tyndall::effect::{Field, Method};
use tyndall::medium::{Phase, Shape};
use tyndall::scene::Camera;
use tyndall::studies::scenes::fog;

/// One point stands for the sun.
const POINT: Settings = &[("shafts.disc", 0.0), ("shafts.suns", 1.0)];

/// Steps that are short beside penumbrae.
const STEPS: Settings = &[
    ("shafts_march.steps", 512.0),
    ("shafts_march.halvings", 5.0),
];

#[test]
fn edges_in_the_air_are_those_of_the_reference() {
    let test = "edges_in_the_air_are_those_of_the_reference";
    if !common::gpu(test) {
        return;
    }
    for (name, triangles, sun) in &casters() {
        // The last eye is in the penumbra of what stands near z = 0.
        let inside = Camera::look_at(
            DVec3::new(0.0, 2.0, 0.4),
            DVec3::new(-4.0, 0.0, -3.0),
            60f64.to_radians(),
        );
        for (k, camera) in cameras().into_iter().chain([inside]).enumerate() {
            let conditions = view(triangles, *sun, camera)
                .conditions([24, 18])
                .expect("sound");
            let truth = by_reference(&conditions, &[]);
            if layer(&truth, Field::InscatterSun)
                .iter()
                .all(|v| v.y == 0.0)
            {
                continue;
            }
            let off = |method, set| error(&by_gpu(&conditions, method, set), &truth).0;
            let found = off(Method::Rectified, &[]);
            let march = off(Method::March, STEPS);
            let point = off(Method::Rectified, POINT);
            println!("{name}, camera {k}: {found:.5}, march {march:.5}, a point {point:.4}");
            // Nowhere does the small window let half of the light in: what is off is a small part of full light.
            let most = if name.starts_with("small") {
                0.025
            } else {
                0.01
            };
            assert!(found < most && march < most, "{name}: {found} {march}");
        }
    }
}

#[test]
fn a_penumbra_around_the_eye_in_dense_fog_is_that_of_the_reference() {
    let test = "a_penumbra_around_the_eye_in_dense_fog_is_that_of_the_reference";
    if !common::gpu(test) {
        return;
    }
    // The edge of a plate 100 m toward the sun, seen from within its penumbra: the first skin of the fog is what is seen.
    let camera = Camera::look_at(
        DVec3::new(0.0, 2.0, 0.2),
        DVec3::new(-4.0, 1.5, -0.2),
        40f64.to_radians(),
    );
    let plate = plate(100.0, [0.0, 60.0], 0.0);
    for sigma in [1.0, 30.0, 1000.0] {
        let mut view = view(&plate, [90.0, 30.0], camera);
        let all = Shape::Box {
            min: DVec3::splat(-1500.0),
            max: DVec3::new(1500.0, 2.5, 1500.0),
        };
        view.scene.media = vec![fog(all, sigma, 0.0, Phase::Isotropic)];
        let conditions = view.conditions([12, 9]).expect("sound");
        let truth = by_reference(&conditions, &[]);
        let sum: f64 = layer(&truth, Field::InscatterSun).iter().map(|v| v.y).sum();
        let (off, _) = error(&by_gpu(&conditions, Method::Rectified, &[]), &truth);
        println!("{sigma} / m: {off:.5} of {sum:e}");
        assert!(sum == 0.0 || off < 0.01, "{sigma}: {off}");
    }
}

#[test]
fn a_far_slit_has_the_profile_of_a_uniform_disc() {
    let test = "a_far_slit_has_the_profile_of_a_uniform_disc";
    if !common::gpu(test) {
        return;
    }
    let view = far_slit();
    let size = [8, 128];
    let conditions = view.conditions(size).expect("sound");
    let open = without_casters(&view);
    let column = |conditions: &Conditions, method, set| -> Vec<f64> {
        let frame = by_gpu(conditions, method, set);
        let light = layer(&frame, Field::InscatterSun);
        (0..size[1] as usize)
            .map(|y| light[y * size[0] as usize + 4].y)
            .collect()
    };
    let open = column(
        &open.conditions(size).expect("sound"),
        Method::Rectified,
        POINT,
    );
    let expected: Vec<f64> = (0..size[1])
        .map(|y| {
            let at = DVec2::new(4.5, f64::from(y) + 0.5);
            let ray = conditions.view.camera.ray(at, size);
            slit_share(&ray)
        })
        .collect();
    let profile = |method, set| -> [f64; 2] {
        let found = column(&conditions, method, set);
        let found: Vec<f64> = found.iter().zip(&open).map(|(a, b)| a / b).collect();
        off(&found, &expected)
    };
    for method in [Method::Rectified, Method::Epipolar, Method::Prefiltered] {
        let disc = profile(method, &[]);
        println!("{method:?}: {disc:.5?}");
        // What is left of the last one are its averages of a point's light and shadow.
        if method != Method::Prefiltered {
            assert!(disc[0] < 0.01 && disc[1] < 0.02, "{method:?}: {disc:?}");
        }
    }
    let point = profile(Method::Rectified, POINT);
    println!("a point {point:.5?}");
    assert!(point[0] > 0.1 && point[1] > 0.4, "{point:?}");
}

#[test]
fn leaves_go_by_points_on_both_backends() {
    let test = "leaves_go_by_points_on_both_backends";
    if !common::gpu(test) {
        return;
    }
    let mut view = forest(100);
    if let Some(sun) = &mut view.scene.sun {
        sun.diameter_deg = Some(DIAMETER);
    }
    let conditions = view.conditions([24, 18]).expect("sound");
    let disc = conditions.disc_in_air().expect("the disc is wide enough");
    assert_ne!(disc.told, Told::Everywhere);
    let [found, points] = [&[][..], &[("shafts.disc", 0.0)]].map(|set| {
        layer(
            &by_gpu(&conditions, Method::Rectified, set),
            Field::InscatterSun,
        )
    });
    assert_eq!(found, points);
}
