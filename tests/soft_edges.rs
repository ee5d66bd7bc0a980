//! The sun's disc: its soft edges in the air and on surfaces against closed forms and against thousands of points.

mod common;

use common::build::layer;
use common::shafts::by_reference;
use common::soft::*;
use common::views::*;
use glam::{DVec2, DVec3};
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{Camera, Projection};

fn light(conditions: &Conditions, disc: f64, suns: f64) -> Vec<f64> {
    let set = [("shafts.disc", disc), ("shafts.suns", suns)];
    let frame = by_reference(conditions, &set);
    layer(&frame, Field::InscatterSun)
        .iter()
        .map(|v| v.y)
        .collect()
}

#[test]
fn edges_in_the_air_are_those_of_thousands_of_points() {
    for (name, triangles, sun) in &casters() {
        for (k, camera) in cameras().into_iter().enumerate() {
            let conditions = view(triangles, *sun, camera)
                .conditions([24, 18])
                .expect("sound");
            let truth = light(&conditions, 0.0, MANY);
            let exact = off(&light(&conditions, 1.0, 4.0), &truth);
            let few = off(&light(&conditions, 0.0, 4.0), &truth);
            println!("{name}, camera {k}: {exact:.5?}, by 4 points {few:.5?}");
            // Of a sliver between two edges points know little.
            let most = match name.contains(" 0 deg") {
                true => [0.01, 0.01],
                false => [0.002, 0.005],
            };
            let is_near = exact[0] < most[0] && exact[1] < most[1];
            assert!(is_near, "{name}: {exact:?}");
        }
    }
}

#[test]
fn a_far_slit_has_the_profile_of_a_uniform_disc() {
    let view = far_slit();
    let size = [8, 128];
    let conditions = view.conditions(size).expect("sound");
    let open = without_casters(&view);
    let column = |light: Vec<f64>| -> Vec<f64> {
        (0..size[1] as usize)
            .map(|y| light[y * size[0] as usize + 4])
            .collect()
    };
    let open = column(light(&open.conditions(size).expect("sound"), 1.0, 1.0));
    let profile = |disc: f64| -> [f64; 2] {
        let found = column(light(&conditions, disc, 1.0));
        let found: Vec<f64> = found.iter().zip(&open).map(|(a, b)| a / b).collect();
        let expected: Vec<f64> = (0..size[1])
            .map(|y| {
                let ray = conditions
                    .view
                    .camera
                    .ray(DVec2::new(4.5, f64::from(y) + 0.5), size);
                slit_share(&ray)
            })
            .collect();
        off(&found, &expected)
    };
    let [disc, point] = [1.0, 0.0].map(profile);
    println!("disc {disc:.5?}, point {point:.5?}");
    assert!(disc[0] < 0.002 && disc[1] < 0.005, "{disc:?}");
    assert!(
        point[0] > 0.1 && point[1] > 0.4,
        "a point passes for a disc: {point:?}"
    );
}

/// A floor on which plates, a column and a picket fence throw shadows: narrow ones, and wide ones from far above.
fn floor() -> StudyView {
    let mut triangles = quad(
        DVec3::new(-30.0, 0.0, 30.0),
        DVec3::X * 60.0,
        DVec3::NEG_Z * 60.0,
    )
    .to_vec();
    let plate = |x: [f64; 2], y: f64, z: [f64; 2]| {
        let (wide, deep) = (x[1] - x[0], z[1] - z[0]);
        quad(DVec3::new(x[0], y, z[0]), DVec3::X * wide, DVec3::Z * deep)
    };
    triangles.extend(plate([-9.0, -6.0], 40.0, [-70.0, 70.0]));
    triangles.extend(plate([-60.0, 60.0], 80.0, [-60.0, -50.0]));
    triangles.extend(column(DVec3::new(0.0, 0.0, -3.0), 0.4, 5.0));
    for i in 0..12 {
        let x = 2.0 + 0.5 * f64::from(i);
        triangles.extend(quad(
            DVec3::new(x, 0.0, 2.0),
            DVec3::X * 0.3,
            DVec3::Y * 3.0,
        ));
    }
    let mut scene = scene(&triangles, 20.0, 50.0);
    if let Some(sun) = &mut scene.sun {
        sun.diameter_deg = Some(DIAMETER);
    }
    StudyView {
        name: "floor",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.0, 12.0, 14.0),
            DVec3::new(0.0, 0.0, -4.0),
            60f64.to_radians(),
        ),
    }
}

fn floor_light(conditions: &Conditions, on_gpu: bool, set: &[(&str, f64)]) -> Vec<f64> {
    let overrules = Overrules {
        set: set.iter().map(|(knob, v)| (knob.to_string(), *v)).collect(),
        without: ["radiosity", "air_sky", "sky_dome", "sun_disc"]
            .map(str::to_owned)
            .to_vec(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let frame = match on_gpu {
        true => common::shafts::render(&plan).frame,
        false => {
            let reference = Reference::new(&plan).expect("nothing stops it");
            let rendered = reference.render(&Limits::memory(1 << 30), &|_| {});
            rendered.expect("it fits").frame
        }
    };
    layer(&frame, Field::Sun).iter().map(|v| v.y).collect()
}

#[test]
fn edges_on_a_floor_are_those_of_thousands_of_points() {
    let conditions = floor().conditions([160, 120]).expect("sound");
    let by_points = |count: f64| {
        let set = [("surface_sun.disc", 0.0), ("surface_sun.suns", count)];
        floor_light(&conditions, false, &set)
    };
    let truth = by_points(4096.0);
    let [exact, few] =
        [floor_light(&conditions, false, &[]), by_points(4.0)].map(|f| off(&f, &truth));
    println!("floor: {exact:.5?}, by 4 points {few:.5?}");
    assert!(exact[0] < 0.005 && exact[1] < 0.02, "{exact:?}");
    assert!(few[0] > 0.01, "nothing is soft: {few:?}");
    if common::gpu("edges_on_a_floor_are_those_of_thousands_of_points") {
        let found = off(&floor_light(&conditions, true, &[]), &truth);
        println!("on a GPU {found:.5?}");
        assert!(found[0] < 0.005 && found[1] < 0.02, "{found:?}");
    }
}

/// Views of slats in fog under the disc, whose sun moves on by `step` [deg] from one to the next.
fn sweep(count: u32, azimuth: f64, step: f64) -> Vec<Conditions> {
    (0..count)
        .map(|i| {
            let mut view = slats(1.0);
            if let Some(sun) = &mut view.scene.sun {
                sun.azimuth_deg = azimuth + step * f64::from(i);
                sun.diameter_deg = Some(DIAMETER);
            }
            // So near that penumbrae are wider than pixels.
            view.camera.projection = Projection::Perspective {
                fov_y: 5f64.to_radians(),
            };
            let conditions = view.conditions([32, 24]).expect("sound");
            assert!(
                conditions.whole_sun().is_some(),
                "a point stands for the sun"
            );
            conditions
        })
        .collect()
}

#[test]
fn a_slow_sun_does_not_flicker() {
    let errors: Vec<Vec<f64>> = sweep(8, 65.0, 1.0 / 60.0)
        .iter()
        .map(|conditions| {
            let truth = light(conditions, 0.0, 1024.0);
            let mean = truth.iter().sum::<f64>() / truth.len() as f64;
            let found = light(conditions, 1.0, 4.0);
            let off = found.iter().zip(&truth).map(|(a, b)| (a - b) / mean);
            off.collect()
        })
        .collect();
    let second = errors.windows(3).flat_map(|e| {
        let difference = |p: usize| e[0][p] - 2.0 * e[1][p] + e[2][p];
        (0..e[0].len()).map(difference).collect::<Vec<_>>()
    });
    let second: Vec<f64> = second.collect();
    let square: f64 = second.iter().map(|e| e * e).sum();
    let rms = (square / second.len() as f64).sqrt();
    println!("second difference {rms:.2e}");
    assert!(rms < 2e-4, "{rms}");
}

#[test]
fn the_sun_across_the_view_is_nothing_special() {
    // The view is along -z, as the slats are.
    let errors: Vec<f64> = sweep(9, 89.96, 0.01)
        .iter()
        .map(|conditions| off(&light(conditions, 1.0, 4.0), &light(conditions, 0.0, 512.0))[0])
        .collect();
    println!("{errors:.6?}");
    assert!(errors.iter().all(|e| *e < 1e-3), "{errors:?}");
}

#[test]
fn penumbrae_in_thin_layers_and_dense_fog_are_those_of_points() {
    let far = Shape::Box {
        min: DVec3::splat(-12.0),
        max: DVec3::splat(12.0),
    };
    let layer = Shape::Height {
        base: -10.0,
        scale_height: 0.4,
        far: 200.0,
    };
    // The light must not run along a face of dense fog, whose skin then sees the disc's directions one by one.
    for (name, shape, scattering, azimuth) in [
        ("layer", layer, 1e-2, 90.0f64),
        ("dense fog", far, 1.0, 105.0),
    ] {
        let place = 400.0 * (azimuth - 90.0).to_radians().tan() + 0.3;
        let edge = plate(400.0, [place, place + 200.0], 0.0);
        for (k, camera) in cameras().into_iter().enumerate() {
            let mut view = view(&edge, [azimuth, 30.0], camera);
            view.scene.media = vec![fog(shape.clone(), scattering, 0.0, Phase::Isotropic)];
            let conditions = view.conditions([24, 18]).expect("sound");
            let truth = light(&conditions, 0.0, 1024.0);
            let found = off(&light(&conditions, 1.0, 4.0), &truth);
            println!("{name}, camera {k}: {found:.5?}");
            assert!(found[0] < 0.002 && found[1] < 0.01, "{name}: {found:?}");
        }
    }
}
