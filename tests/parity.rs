//! The GPU's pictures against the reference's, on whatever adapter there is.

mod common;

use common::build::*;
use common::shafts::render;
use common::views::*;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Made};
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Request, toward};
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{self, Camera, Ground, Projection, Scene, Texture, Wrap};

const DEG: f64 = PI / 180.0;
type Settings<'a> = &'a [(&'a str, f64)];

/// One point for the sun, 512 steps, maps whose texels are smaller than a pixel.
const ADEQUATE: Settings = &[
    ("shafts_march.steps", 512.0),
    ("shafts_march.halvings", 3.0),
    ("shadow.resolution", 3072.0),
    ("shadow.density", 1024.0),
];

fn plan<'c>(conditions: &'c Conditions, set: Settings) -> Plan<'c> {
    plan_by(conditions, Method::March, set)
}

fn plan_by<'c>(conditions: &'c Conditions, method: Method, set: Settings) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Draft,
        method: Some(method),
        set: set
            .iter()
            .chain(&[("visibility.silhouettes", 1.0)])
            .map(|(knob, v)| (knob.to_string(), *v))
            .collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

fn by_gpu(conditions: &Conditions, set: Settings) -> Frame {
    render(&plan(conditions, set)).frame
}

fn render_by_reference(plan: &Plan) -> Frame {
    let rendered = Reference::new(plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {});
    rendered.expect("the picture fits into memory").frame
}

fn by_reference(conditions: &Conditions) -> Frame {
    render_by_reference(&plan(conditions, &[]))
}

/// Relative RMSE of a layer's luminance over the pixels that are kept.
fn rmse(found: &Frame, truth: &Frame, field: Field, keep: impl Fn(usize) -> bool) -> f64 {
    let (found, truth) = (layer(found, field), layer(truth, field));
    let (mut square, mut sum, mut n) = (0.0, 0.0, 0.0);
    for i in (0..truth.len()).filter(|i| keep(*i)) {
        square += (luminance(found[i]) - luminance(truth[i])).powi(2);
        sum += luminance(truth[i]);
        n += 1.0;
    }
    if square == 0.0 {
        0.0
    } else {
        (square / n).sqrt() / (sum / n)
    }
}

/// The pixels within two of which `mark` is the same everywhere.
fn even<T: PartialEq>(frame: &Frame, mark: impl Fn(usize) -> T) -> Vec<bool> {
    let (w, h) = (frame.width as i32, frame.height as i32);
    (0..w * h)
        .map(|i| {
            let (x, y) = (i % w, i / w);
            let own = mark(i as usize);
            (-2..=2).all(|dy| {
                (-2..=2).all(|dx| {
                    let (u, v) = (x + dx, y + dy);
                    let outside = u < 0 || v < 0 || u >= w || v >= h;
                    outside || mark((v * w + u) as usize) == own
                })
            })
        })
        .collect()
}

/// What a layer may be off by, and where: sunlight on surfaces away from shadow edges, all else everywhere.
fn allowed(field: Field) -> f64 {
    match field {
        Field::InscatterSun => 0.02,
        Field::Background => 1e-4,
        _ => 0.01,
    }
}

/// The layers that are further off than is allowed.
fn disagreements(found: &Frame, truth: &Frame) -> Vec<String> {
    let sun = layer(truth, Field::Sun);
    let mut away = even(truth, |i| (sun[i].y > 0.0, truth.depth[i] < 1e9));
    let mut complaints = Vec::new();
    // A pixel whose centre lies on a crease within f32's rounding may show either face. There are few such pixels.
    let other_face: Vec<usize> = (0..truth.pixels())
        .filter(|&i| away[i] && found.normal[i].distance(truth.normal[i]) > 0.1)
        .collect();
    if other_face.len() * 1000 > truth.pixels() {
        complaints.push(format!("{} pixels show another face", other_face.len()));
    }
    for i in other_face {
        away[i] = false;
    }
    // All layers of the list: one that an effect adds later is compared without a change here.
    for field in Field::layers() {
        let error = match field {
            Field::InscatterSun => rmse(found, truth, field, |_| true),
            _ => rmse(found, truth, field, |i| away[i]),
        };
        if error > 0.0 {
            eprintln!("  {:<14}{error:.2e}", field.name());
        }
        // NaN is no agreement.
        if error.is_nan() || error > allowed(field) {
            complaints.push(format!("{}: {error:.2e}", field.name()));
        }
    }
    let geometry = away.iter().enumerate().filter(|(_, away)| **away);
    let (mut depth, mut transmittance) = (0.0f32, 0.0f32);
    for (i, _) in geometry {
        depth = depth.max((found.depth[i] / truth.depth[i] - 1.0).abs());
        let t = found.transmittance[i] - truth.transmittance[i];
        transmittance = transmittance.max(t.abs().max_element());
    }
    // A pixel of a far surface seen at a grazing angle has few digits of its distance.
    if depth.is_nan() || depth > 1e-3 {
        complaints.push(format!("distance: {depth:.2e}"));
    }
    if transmittance.is_nan() || transmittance > 1e-3 {
        complaints.push(format!("transmittance: {transmittance:.2e}"));
    }
    complaints
}

/// The scene that is built in, with its own place, time and camera.
fn nave() -> Conditions {
    let scene = Scene::builtin(scene::BUILTIN[0]).expect("it is sound");
    let request = Request {
        size: Some(SIZE),
        samples: Some(1),
        ..Request::default()
    };
    Conditions::new(scene, &request).expect("it is sound")
}

/// Scenes by others, in haze as high as themselves.
fn real_scenes(test: &str) -> Vec<(String, Conditions)> {
    let Some(folder) = common::data(test) else {
        return Vec::new();
    };
    [
        "gazebo/gazebo.obj",
        "living_room/living_room.glb",
        "terrain/Mountains.gltf",
        "volumetric_fog/VolumetricFogExample.glb",
    ]
    .map(|name| {
        let mut scene = scene::load(&folder.join("scenes").join(name)).expect("the scene is sound");
        scene.sun = Some(point_sun(120.0, 35.0));
        let (min, max) = scene.mesh.bounds().expect("it has triangles");
        let size = (max - min).length();
        scene.media = vec![fog(
            Shape::Haze {
                top: max.y + 0.1 * size,
            },
            0.3 / size,
            0.03 / size,
            Phase::HenyeyGreenstein { g: 0.6 },
        )];
        let request = Request {
            size: Some(SIZE),
            samples: Some(1),
            camera: CameraChoice::Scene,
            ..Request::default()
        };
        let conditions = Conditions::new(scene, &request).expect("the scene is sound");
        (name.to_owned(), conditions)
    })
    .into()
}

#[test]
fn every_layer_agrees_with_the_reference() {
    let test = "every_layer_agrees_with_the_reference";
    if !common::gpu(test) {
        return;
    }
    let made = [slats(1.0), colonnade(), hills(), into_the_sun()];
    let made = made.map(|view| (view.name.to_owned(), at_size(&view)));
    for (name, conditions) in made
        .into_iter()
        .chain([("nave".to_owned(), nave())])
        .chain(real_scenes(test))
    {
        eprintln!("{name}");
        let found = by_gpu(&conditions, ADEQUATE);
        let complaints = disagreements(&found, &by_reference(&conditions));
        assert_eq!(complaints, [""; 0], "{name}");
    }
}

#[test]
fn the_comparison_notices_half_a_degree_and_half_a_pixel() {
    if !common::gpu("the_comparison_notices_half_a_degree_and_half_a_pixel") {
        return;
    }
    for view in [slats(1.0), colonnade(), hills()] {
        let truth = by_reference(&at_size(&view));
        let mut sun = view.scene.clone();
        if let Some(entry) = &mut sun.sun {
            entry.elevation_deg -= 0.5;
        }
        let sun = by_gpu(&conditions(sun, view.camera, SIZE), ADEQUATE);
        let mut camera = view.camera;
        camera.shift = DVec2::new(0.5 / f64::from(SIZE[0]), 0.0);
        let camera = by_gpu(&conditions(view.scene.clone(), camera, SIZE), ADEQUATE);
        for (what, found) in [("sun", sun), ("camera", camera)] {
            eprintln!("{}, {what} moved", view.name);
            let complaints = disagreements(&found, &truth);
            assert!(!complaints.is_empty(), "{}: {what}", view.name);
        }
    }
}

#[test]
fn the_error_falls_as_steps_and_maps_grow() {
    if !common::gpu("the_error_falls_as_steps_and_maps_grow") {
        return;
    }
    for view in [slats(1.0), colonnade(), hills()] {
        let conditions = at_size(&view);
        let truth = by_reference(&conditions);
        let errors: Vec<f64> = [1.0, 2.0, 4.0, 8.0]
            .iter()
            .map(|finer| {
                let set = [
                    ("shafts_march.steps", 48.0 * finer),
                    ("shadow.resolution", 384.0 * finer),
                    ("shadow.density", 1024.0),
                ];
                let found = by_gpu(&conditions, &set);
                rmse(&found, &truth, Field::InscatterSun, |_| true)
            })
            .collect();
        eprintln!("{}: {errors:.5?}", view.name);
        // Over three doublings: one of them alone may be lucky, and make the next look bad.
        let factor = (errors[3] / errors[0]).cbrt();
        assert!(factor <= 0.6, "{}: {errors:?}, {factor}", view.name);
        assert!(errors.windows(2).all(|e| e[1] < e[0]), "{errors:?}");
    }
}

/// One small triangle far below everything, since a scene must have one.
fn speck() -> Vec<[DVec3; 3]> {
    vec![[
        DVec3::new(0.0, -50.0, 0.0),
        DVec3::new(1e-3, -50.0, 0.0),
        DVec3::new(0.0, -50.0, 1e-3),
    ]]
}

/// The integral of exp(-a - b t) over t0..t1.
fn exponential(a: f64, b: f64, t0: f64, t1: f64) -> f64 {
    let x = b * (t1 - t0);
    let mean = if x.abs() < 1e-5 {
        1.0 - x / 2.0 + x * x / 6.0
    } else {
        -(-x).exp_m1() / x
    };
    (-a - b * t0).exp() * (t1 - t0) * mean
}

fn henyey_greenstein(g: f64, mu: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5))
}

/// Compares every pixel with what `expected` says of its ray's direction.
fn at_every_pixel(conditions: &Conditions, what: &str, expected: impl Fn(DVec3) -> f64) {
    let frame = by_gpu(conditions, &[]);
    for (i, got) in layer(&frame, Field::InscatterSun).iter().enumerate() {
        let (x, y) = (i as u32 % frame.width, i as u32 / frame.width);
        let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let r = conditions
            .view
            .camera
            .ray(at, conditions.view.size)
            .direction;
        let expected = expected(r);
        let error = (got.x / expected - 1.0).abs();
        assert!(
            error < 1e-4,
            "{what}, pixel {x} {y}, {r}: {} instead of {expected}",
            got.x
        );
    }
}

#[test]
fn air_without_occluder_has_its_closed_form_at_every_pixel() {
    if !common::gpu("air_without_occluder_has_its_closed_form_at_every_pixel") {
        return;
    }
    let size = [65, 49];
    let eye = DVec3::new(3.0, 2.0, -1.0);
    for (elevation, g) in [(35.0, 0.0), (35.0, 0.9), (4.0, -0.4)] {
        let sun = toward(120.0 * DEG, elevation * DEG, 0.0);
        // One looks exactly into the sun, the other along the horizon.
        for forward in [sun, DVec3::new(sun.x, 0.0, sun.z)] {
            let camera = Camera::look_at(eye, eye + forward, 80.0 * DEG);
            let (top, sigma_s, sigma) = (40.0, 0.011, 0.015);
            let mut haze = scene(&speck(), 120.0, elevation);
            haze.media = vec![fog(
                Shape::Haze { top },
                sigma_s,
                sigma - sigma_s,
                Phase::HenyeyGreenstein { g },
            )];
            at_every_pixel(&conditions(haze, camera, size), "haze", |r| {
                let end = match r.y {
                    y if y > 0.0 => (top - eye.y) / y,
                    y if y < 0.0 => -eye.y / y,
                    _ => 1e9,
                };
                let (a, b) = (sigma * (top - eye.y) / sun.y, sigma * (1.0 - r.y / sun.y));
                1e5 * sigma_s * henyey_greenstein(g, r.dot(sun)) * exponential(a, b, 0.0, end)
            });
            let (scale_height, far, beta) = (30.0, 3000.0, 0.02);
            let mut height = scene(&speck(), 120.0, elevation);
            height.media = vec![fog(
                Shape::Height {
                    base: 1.0,
                    scale_height,
                    far,
                },
                0.8 * beta,
                0.2 * beta,
                Phase::HenyeyGreenstein { g },
            )];
            at_every_pixel(&conditions(height, camera, size), "height", |r| {
                // Of the equation itself by many small steps, each by Simpson's rule.
                let density = |t: f64| (-(eye.y + t * r.y - 1.0) / scale_height).exp();
                let k = r.y / scale_height;
                let length = |t: f64| {
                    let x = k * t;
                    let mean = if x.abs() < 1e-6 {
                        1.0 - x / 2.0
                    } else {
                        -(-x).exp_m1() / x
                    };
                    density(0.0) * t * mean
                };
                let f = |t: f64| {
                    let depth = beta * (length(t) + density(t) * scale_height / sun.y);
                    if depth > 300.0 {
                        0.0
                    } else {
                        density(t) * (-depth).exp()
                    }
                };
                // Steps grow with distance.
                let n = 4000;
                let place = |i: usize| far * (i as f64 / n as f64).powi(3);
                let sum: f64 = (0..n)
                    .map(|i| {
                        let (a, b) = (place(i), place(i + 1));
                        (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b))
                    })
                    .sum();
                1e5 * 0.8 * beta * henyey_greenstein(g, r.dot(sun)) * sum
            });
        }
    }
}

#[test]
fn nothing_leaks_through_a_roof() {
    if !common::gpu("nothing_leaks_through_a_roof") {
        return;
    }
    let roof = quad(
        DVec3::new(-500.0, 4.0, -500.0),
        DVec3::X * 1000.0,
        DVec3::Z * 1000.0,
    );
    let mut scene = scene(&roof, 30.0, 60.0);
    scene.media = vec![fog(
        Shape::Box {
            min: DVec3::new(-9.0, 0.0, -9.0),
            max: DVec3::new(9.0, 3.9, 9.0),
        },
        0.1,
        0.0,
        Phase::Isotropic,
    )];
    let camera = Camera::look_at(DVec3::new(0.0, 2.0, 8.0), DVec3::Y, 70.0 * DEG);
    let conditions = conditions(scene, camera, SIZE);
    // However few steps there are: the first and the last count.
    for steps in [64.0, 1.0] {
        let frame = by_gpu(&conditions, &[("shafts_march.steps", steps)]);
        let light = layer(&frame, Field::InscatterSun);
        assert!(light.iter().all(|v| *v == DVec3::ZERO), "{steps}");
    }
}

#[test]
fn pictures_do_not_depend_on_units_origin_or_repetition() {
    if !common::gpu("pictures_do_not_depend_on_units_origin_or_repetition") {
        return;
    }
    let truth = by_gpu(&at_size(&slats(1.0)), ADEQUATE);
    let again = by_gpu(&at_size(&slats(1.0)), ADEQUATE);
    assert!(truth == again, "the same input makes other bytes");
    for scale in [2f64.powi(-10), 1e-3, 1e4] {
        let found = by_gpu(&at_size(&slats(scale)), ADEQUATE);
        let error = rmse(&found, &truth, Field::InscatterSun, |_| true);
        eprintln!("scale {scale}: {error:.2e}");
        // A step that lies on a texel's border to f32's last digit may change sides.
        assert!(error < 1e-3, "{scale}: {error}");
    }
    // An ECEF origin leaves 1e-9 m in f64, more than nothing where a sample meets an edge.
    for shift in [DVec3::new(1e6, 0.0, -1e6), DVec3::new(6.4e6, 0.0, 0.0)] {
        let mut view = slats(1.0);
        for p in &mut view.scene.mesh.positions {
            *p += shift;
        }
        view.camera.eye += shift;
        if let Shape::Box { min, max } = &mut view.scene.media[0].shape {
            (*min, *max) = (*min + shift, *max + shift);
        }
        let found = by_gpu(&at_size(&view), ADEQUATE);
        let error = rmse(&found, &truth, Field::InscatterSun, |_| true);
        eprintln!("origin {shift}: {error:.2e}");
        assert!(error < 1e-3, "{shift}: {error}");
    }
}

#[test]
fn partitions_have_no_seams_and_every_projection_works() {
    if !common::gpu("partitions_have_no_seams_and_every_projection_works") {
        return;
    }
    let view = colonnade();
    let conditions = at_size(&view);
    let truth = by_reference(&conditions);
    for partitions in [1.0, 2.0, 5.0, 16.0] {
        let set = [
            ("shafts_march.steps", 512.0),
            ("shadow.resolution", 1500.0),
            ("shadow.density", 1024.0),
            ("shadow.partitions", partitions),
        ];
        let found = by_gpu(&conditions, &set);
        let error = rmse(&found, &truth, Field::InscatterSun, |_| true);
        eprintln!("{partitions} partitions: {error:.2e}");
        assert!(error < 0.02, "{partitions}: {error}");
    }
    for projection in [
        Projection::Orthographic { height: 6.0 },
        Projection::Panorama,
    ] {
        let mut view = slats(1.0);
        view.camera.projection = projection;
        view.camera.shift = match projection {
            Projection::Panorama => DVec2::ZERO,
            _ => DVec2::new(0.05, -0.1),
        };
        let conditions = at_size(&view);
        eprintln!("{projection:?}");
        let found = by_gpu(&conditions, ADEQUATE);
        let complaints = disagreements(&found, &by_reference(&conditions));
        assert_eq!(complaints, [""; 0], "{projection:?}");
    }
}

#[test]
fn dark_texels_however_wrapped_and_the_ground_of_a_parallel_view_are_the_references() {
    let test = "dark_texels_however_wrapped_and_the_ground_of_a_parallel_view_are_the_references";
    if !common::gpu(test) {
        return;
    }
    // Codes up to 10 are on the straight toe of sRGB. The ground is as dark, so that they count.
    let codes = [[2, 3, 5, 9], [10, 7, 4, 1], [1, 8, 3, 6]];
    let corner = DVec3::new(-4.0, 0.3, -4.0);
    let uvs = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
    ];
    let mut camera = Camera::look_at(DVec3::new(0.5, 6.0, 5.0), DVec3::ZERO, 1.0);
    camera.projection = Projection::Orthographic { height: 11.0 };
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let floor = quad(corner, DVec3::Z * 8.0, DVec3::X * 8.0);
        let mut scene = scene(&floor, 120.0, 40.0);
        scene.ground = Ground {
            enabled: true,
            height: Some(0.0),
            albedo: 0.002,
        };
        let uv = |at| DVec2::splat(-1.13) + 3.4 * DVec2::from_array(at);
        scene.mesh.uvs = uvs.map(uv).into();
        scene.textures = vec![Texture {
            name: "dark".into(),
            width: 4,
            height: 3,
            pixels: codes.concat().iter().map(|c| [*c, *c, *c, 255]).collect(),
            wrap: [wrap; 2],
        }];
        scene.materials[0].texture = Some(0);
        let conditions = conditions(scene, camera, [64, 48]);
        eprintln!("{wrap:?}");
        let truth = by_reference(&conditions);
        assert!(truth.depth.iter().all(|depth| *depth < 1e3));
        let complaints = disagreements(&by_gpu(&conditions, ADEQUATE), &truth);
        assert_eq!(complaints, [""; 0], "{wrap:?}");
    }
}

#[test]
fn an_epipole_anywhere_is_no_special_case() {
    if !common::gpu("an_epipole_anywhere_is_no_special_case") {
        return;
    }
    let base = slats(1.0);
    let set: Settings = &[
        ("shafts_march.steps", 256.0),
        ("shadow.resolution", 1024.0),
        ("shadow.density", 1024.0),
    ];
    // The sun from across the view over the picture's corner to behind the eye.
    let errors: Vec<f64> = [88.0, 89.9, 90.0, 90.1, 92.0, 30.0, 0.0, 180.0, 179.99]
        .map(|azimuth| {
            let mut scene = base.scene.clone();
            if let Some(entry) = &mut scene.sun {
                entry.azimuth_deg = azimuth;
            }
            let conditions = conditions(scene, base.camera, SIZE);
            let truth = by_reference(&conditions);
            rmse(
                &by_gpu(&conditions, set),
                &truth,
                Field::InscatterSun,
                |_| true,
            )
        })
        .into();
    eprintln!("{errors:.5?}");
    assert!(errors.iter().all(|e| *e < 0.02), "{errors:?}");
    // Across the view: no spike.
    let across = &errors[..5];
    let mut sorted = across.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    assert!(sorted[4] < 1.3 * sorted[2], "{across:?}");
}

#[test]
fn hard_cases_stay_finite_and_in_order() {
    if !common::gpu("hard_cases_stay_finite_and_in_order") {
        return;
    }
    let mut triangles = cuboid(DVec3::new(-3.0, 0.0, -3.0), DVec3::new(3.0, 3.0, 3.0));
    triangles.truncate(10);
    let suns = [
        (0.0, 90.0),
        (0.0, 0.0),
        (180.0, 0.2),
        (90.0, -0.1),
        (0.0, -5.0),
        (0.0, 30.0),
        (0.0, 1e-9),
    ];
    let extinctions = [0.0, 1e-300, 1e-9, 0.05, 1e6, 1e12];
    let eyes = [
        DVec3::new(0.0, 1.5, 0.0),
        DVec3::new(-3.0, 1.0, 0.0),
        DVec3::new(0.0, 50.0, 40.0),
        DVec3::new(0.0, -2.0, 0.0),
    ];
    for k in 0..42 {
        let (azimuth, elevation) = suns[k % 7];
        let extinction = extinctions[k % 6];
        let eye = eyes[k % 4];
        let sun = toward(azimuth * DEG, elevation * DEG, 0.0);
        let forward = [
            sun,
            -sun,
            DVec3::Y,
            DVec3::NEG_Y,
            sun.any_orthonormal_vector(),
        ][k % 5];
        let mut scene = scene(&triangles, azimuth, elevation);
        if let Some(entry) = &mut scene.sun {
            entry.diameter_deg = [Some(0.0), None, Some(5.0)][k % 3];
        }
        scene.sky.model = Some("preetham".into());
        scene.ground.enabled = k % 2 == 0;
        let haze = Shape::Haze { top: 20.0 };
        let room = Shape::Box {
            min: DVec3::splat(-2.0),
            max: DVec3::splat(2.0),
        };
        let height = Shape::Height {
            base: 0.0,
            scale_height: 30.0,
            far: 1e5,
        };
        scene.media = vec![
            fog(haze, extinction, extinction, Phase::NishitaMurky),
            fog(room, extinction, 0.0, Phase::CornetteShanks { g: -0.9 }),
            fog(height, extinction, 0.0, Phase::Rayleigh),
        ];
        scene.media.rotate_left(k % 3);
        scene.media.truncate(1 + (k / 3) % 3);
        let mut camera = Camera::look_at(eye, eye + forward, 60.0 * DEG);
        camera.projection = match k % 3 {
            0 => Projection::Perspective { fov_y: 60.0 * DEG },
            1 => Projection::Orthographic { height: 3.0 },
            _ => Projection::Panorama,
        };
        let size = [[1, 1], [1, 7], [13, 5]][(k / 2) % 3];
        let conditions = conditions(scene, camera, size);
        let set = [
            ("shadow.resolution", 100.0),
            ("shadow.density", 1024.0),
            ("shafts_march.steps", 33.0),
        ];
        let truth = by_reference(&conditions);
        for method in Method::ALL {
            let found = render(&plan_by(&conditions, method, &set)).frame;
            assert!(found.transmittance.iter().all(|t| t.max_element() <= 1.0));
            let names = |f: &Frame| f.layers.iter().map(|l| l.name).collect::<Vec<_>>();
            assert_eq!(names(&found), names(&truth), "{k} {method:?}");
        }
    }
}

#[test]
fn nothing_is_made_for_an_effect_that_does_not_run() {
    if !common::gpu("nothing_is_made_for_an_effect_that_does_not_run") {
        return;
    }
    let made = |conditions: &Conditions| {
        let plan = plan(conditions, &[]);
        let mut gpu = Gpu::open(Choice::Any).expect("there is an adapter");
        let mut render = || {
            let rendered = gpu.render(&plan, &Limits::memory(1 << 30), &|_| {});
            rendered.expect("the device works")
        };
        let first = render();
        let second = render();
        assert!(first.frame == second.frame);
        // All is made once, and allocated once.
        assert!(first.made.scene && first.made.pipelines > 0 && first.made.maps < 100);
        assert_eq!(second.made, Made::default());
        assert_eq!(first.traffic.allocated, second.traffic.allocated);
        let running: Vec<&str> = plan.running().map(|step| step.effect.name).collect();
        let ran: Vec<String> = second
            .steps
            .iter()
            .map(|step| {
                assert!(running.contains(&step.effect.name), "{}", step.effect.name);
                format!("{}.{}", step.effect.name, step.pass)
            })
            .collect();
        let compiled = second.steps.iter().filter(|step| step.pass != "reference");
        // Passes over fields and those for several beams are compiled once.
        assert!(first.made.pipelines <= compiled.count());
        (
            ran,
            plan.written(),
            second.traffic.allocated,
            first.made.maps,
        )
    };
    let whole = slats(1.0);
    let (pipelines, fields, bytes, maps) = made(&at_size(&whole));
    assert!(pipelines.iter().any(|p| p == "shafts_march.march"));
    assert!(fields.contains(&Field::InscatterSun) && maps > 0);
    let mut clear = whole.scene.clone();
    clear.media.clear();
    let (pipelines, fields, less, maps) = made(&conditions(clear, whole.camera, SIZE));
    assert!(
        !pipelines
            .iter()
            .any(|p| p.starts_with("shafts") || p.starts_with("transmittance"))
    );
    assert!(pipelines.iter().any(|p| p == "surface_sun.light_surfaces"));
    assert!(!fields.contains(&Field::InscatterSun) && !fields.contains(&Field::Transmittance));
    // Two fields of 16 bytes a pixel, once as themselves and once to read them back; and shadow maps, of depths and of casters,
    // which sunlight on surfaces has no use for.
    assert_eq!(maps, 0);
    assert!(
        less + 64 * 96 * 64 + 2 * 4 * 512 * 512 <= bytes,
        "{less} {bytes}"
    );
    let mut night = whole.scene.clone();
    if let Some(entry) = &mut night.sun {
        entry.elevation_deg = -20.0;
    }
    let (pipelines, _, least, maps) = made(&conditions(night, whole.camera, SIZE));
    assert!(!pipelines.iter().any(|p| p.starts_with("shadow")));
    assert!(maps == 0 && least < less, "{least} {less}");
}
