//! The sun's disc: its soft edges in the air and on surfaces against closed forms and against thousands of points.

mod common;

use common::build::layer;
use common::shafts::by_reference;
use common::views::*;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{Camera, Projection};

/// As many points as are held to be the truth.
const MANY: f64 = 2048.0;

/// The sun's diameter [deg].
const DIAMETER: f64 = 0.533;

/// A scene in clear fog between x = -10 and 10 under a uniform disc.
fn view(triangles: &[Corners], [azimuth, elevation]: [f64; 2], camera: Camera) -> StudyView {
    let mut scene = scene(triangles, azimuth, elevation);
    if let Some(sun) = &mut scene.sun {
        sun.diameter_deg = Some(DIAMETER);
    }
    let shape = Shape::Box {
        min: DVec3::new(-10.0, -10.0, -12.0),
        max: DVec3::new(10.0, 10.0, 12.0),
    };
    scene.media = vec![fog(shape, 1e-4, 0.0, Phase::Isotropic)];
    StudyView {
        name: "made in the test",
        scene,
        camera,
    }
}

/// Seen from above, or along the fog, or aslant.
fn cameras() -> [Camera; 3] {
    let at = |eye: DVec3, target: DVec3| Camera::look_at(eye, target, 24f64.to_radians());
    [
        at(DVec3::new(0.0, 60.0, 0.0), DVec3::new(0.1, 0.0, 0.0)),
        at(DVec3::new(0.5, 0.3, 40.0), DVec3::new(0.0, 0.0, 0.0)),
        at(DVec3::new(-3.0, 1.0, 6.0), DVec3::new(8.0, 2.0, -6.0)),
    ]
}

/// A plate at right angles to the x axis, `distance` sunward, between two places along z, turned about the x axis.
fn plate(distance: f64, z: [f64; 2], turn_deg: f64) -> Vec<Corners> {
    let turn = |y: f64, z: f64| {
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        DVec3::new(distance, y * cos - z * sin, y * sin + z * cos)
    };
    let corner = turn(-200.0, z[0]);
    quad(
        corner,
        turn(200.0, z[0]) - corner,
        turn(-200.0, z[1]) - corner,
    )
    .to_vec()
}

fn slit(distance: f64, width: f64, turn_deg: f64) -> Vec<Corners> {
    let half = 0.5 * width;
    let mut plates = plate(distance, [-200.0, -half], turn_deg);
    plates.extend(plate(distance, [half, 200.0], turn_deg));
    plates
}

/// A column of 32 sides.
fn column(foot: DVec3, radius: f64, height: f64) -> Vec<Corners> {
    let at = |i: u32| {
        let angle = TAU * f64::from(i) / 32.0;
        foot + radius * DVec3::new(angle.cos(), 0.0, angle.sin())
    };
    (0..32)
        .flat_map(|i| quad(at(i), at(i + 1) - at(i), DVec3::Y * height))
        .collect()
}

/// A quad's triangles for a fence of upright pickets.
fn pickets(distance: f64, period: f64, share: f64) -> Vec<Corners> {
    (-20..20)
        .flat_map(|i| {
            let corner = DVec3::new(distance, -60.0, period * f64::from(i));
            quad(
                corner,
                DVec3::Y * 150.0,
                DVec3::Z * (period * (1.0 - share)),
            )
        })
        .collect()
}

fn light(conditions: &Conditions, disc: f64, suns: f64) -> Vec<f64> {
    let set = [("shafts.disc", disc), ("shafts.suns", suns)];
    let frame = by_reference(conditions, &set);
    layer(&frame, Field::InscatterSun)
        .iter()
        .map(|v| v.y)
        .collect()
}

/// Root mean square and greatest difference over the greatest light.
fn off(found: &[f64], truth: &[f64]) -> [f64; 2] {
    let most = truth.iter().copied().fold(1e-30, f64::max);
    let off = || found.iter().zip(truth).map(|(a, b)| (a - b).abs() / most);
    let square: f64 = off().map(|e| e * e).sum();
    [
        (square / found.len() as f64).sqrt(),
        off().fold(0.0, f64::max),
    ]
}

#[test]
fn edges_in_the_air_are_those_of_thousands_of_points() {
    let far = 500.0;
    // The width of a penumbra.
    let wide = far * 2.0 * (0.5 * DIAMETER).to_radians().tan();
    let mut scenes: Vec<(String, Vec<Corners>, [f64; 2])> = Vec::new();
    let mut add = |name: String, triangles: Vec<Corners>, sun| scenes.push((name, triangles, sun));
    for widths in [0.5, 1.0, 3.0, 10.0] {
        add(
            format!("slit of {widths} penumbrae"),
            slit(far, widths * wide, 0.0),
            [90.0, 5.0],
        );
    }
    for turn in [0.0, 30.0, 90.0] {
        let mut both = plate(far, [0.4, 200.0], 0.0);
        both.extend(plate(100.0, [-200.0, -0.2], turn));
        add(
            format!("edges at 100 and 500 m, {turn} deg"),
            both,
            [90.0, 5.0],
        );
    }
    let window = |distance: f64, half: [f64; 2]| {
        let [y, z] = half;
        let at = |y: f64, z: f64| DVec3::new(distance, y + 0.0875 * distance, z);
        [
            quad(at(-99.0, -99.0), DVec3::Y * (99.0 - y), DVec3::Z * 198.0),
            quad(at(y, -99.0), DVec3::Y * (99.0 - y), DVec3::Z * 198.0),
            quad(at(-y, -99.0), DVec3::Y * (2.0 * y), DVec3::Z * (99.0 - z)),
            quad(at(-y, z), DVec3::Y * (2.0 * y), DVec3::Z * (99.0 - z)),
        ]
        .concat()
    };
    add(
        "window 100 m off".into(),
        window(100.0, [1.5, 0.8]),
        [90.0, 5.0],
    );
    add(
        "small window 300 m off".into(),
        window(300.0, [0.9, 0.7]),
        [90.0, 5.0],
    );
    add(
        "column".into(),
        column(DVec3::new(150.0, -50.0, 0.5), 1.2, 66.0),
        [90.0, 5.0],
    );
    add(
        "edge 0.3 deg from the light".into(),
        {
            let toward = DVec3::new(5.3f64.to_radians().cos(), 5.3f64.to_radians().sin(), 0.0);
            quad(
                DVec3::new(80.0, 0.0, 0.0),
                400.0 * toward,
                DVec3::new(0.0, 0.0, 50.0),
            )
            .to_vec()
        },
        [90.0, 5.0],
    );
    add("fence".into(), pickets(60.0, 0.9, 0.4), [90.0, 5.0]);
    add(
        "high sun, a ridge".into(),
        plate(40.0, [-3.0, 0.3], 80.0),
        [75.0, 48.0],
    );
    for (name, triangles, sun) in &scenes {
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

/// The share of a uniform disc on one side of a chord at x radii from its middle.
fn share(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

#[test]
fn a_far_slit_has_the_profile_of_a_uniform_disc() {
    let view = far_slit();
    let size = [8, 128];
    let conditions = view.conditions(size).expect("sound");
    let mut open = view.clone();
    let low = DVec3::new(0.0, -500.0, 0.0);
    open.scene.mesh = scene(
        &[[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]],
        0.0,
        0.0,
    )
    .mesh;
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
                let steps = 200;
                let shares = (0..steps).map(|i| {
                    // Fog of no weight fills heights of -10 to 10 m; rays run down from 60 m.
                    let height = 10.0 - 20.0 * (f64::from(i) + 0.5) / f64::from(steps);
                    let place = ray.at((height - ray.origin.y) / ray.direction.y);
                    let throw = (500.0 - place.x) / 5f64.to_radians().cos();
                    let radius = throw * (0.5 * DIAMETER).to_radians().tan();
                    share((place.z + 1.5) / radius) + share((1.5 - place.z) / radius) - 1.0
                });
                shares.sum::<f64>() / f64::from(steps)
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
