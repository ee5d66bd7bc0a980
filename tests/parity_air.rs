//! The clear air: the GPU against the reference, and both against what is known.

mod common;

use common::build::*;
use common::views::*;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, toward};
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::medium::{ClearAir, Medium, Phase, Scattering, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Projection, Scene, SunEntry};

const DEG: f64 = PI / 180.0;

const FINE: &[(&str, f64)] = &[
    ("shafts_march.steps", 512.0),
    ("air_shadow.steps", 512.0),
    ("shadow.resolution", 2048.0),
    ("shadow.density", 1024.0),
];

fn plan(conditions: &Conditions) -> Plan<'_> {
    let overrules = Overrules {
        quality: Quality::Draft,
        method: Some(Method::March),
        set: FINE
            .iter()
            .map(|(knob, v)| (knob.to_string(), *v))
            .collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

fn by_gpu(conditions: &Conditions) -> Frame {
    let plan = plan(conditions);
    common::shafts::render(&plan).frame
}

fn by_reference(conditions: &Conditions) -> Frame {
    let plan = plan(conditions);
    let frame = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {})
        .expect("the picture fits into memory")
        .frame;
    frame
        .check()
        .expect("every value is finite and not negative");
    frame
}

/// The picture's luminance at every pixel.
fn picture(frame: &Frame) -> Vec<f64> {
    (0..frame.pixels())
        .map(|i| luminance(frame.picture(i)))
        .collect()
}

/// Mountains 30 km across under the real sun of a low elevation, in the clear air.
fn mountains(elevation_deg: f64) -> StudyView {
    let mut view = hills();
    view.name = "mountains in the clear air";
    for p in &mut view.scene.mesh.positions {
        *p *= DVec3::new(15.0, 25.0, 15.0);
    }
    view.scene.media.clear();
    view.scene.air = Some(ClearAir::default());
    view.scene.sky.model = Some("hosek".into());
    view.scene.sun = Some(SunEntry {
        azimuth_deg: -40.0,
        elevation_deg,
        illuminance: None,
        diameter_deg: Some(0.0),
    });
    view.camera = Camera::look_at(
        DVec3::new(1500.0, 1900.0, 14_500.0),
        DVec3::new(0.0, 1700.0, -4500.0),
        55.0 * DEG,
    );
    view
}

/// What the clear air changes on rays that meet nothing: pixels, and the mean share of light that is missing.
fn missing(with: &Frame, without: &Frame) -> (usize, f64) {
    let (a, b) = (picture(with), picture(without));
    let open: Vec<usize> = (0..a.len())
        .filter(|i| with.depth[*i] >= 1e9 && b[*i] > 0.0)
        .collect();
    let share = open.iter().map(|&i| 1.0 - a[i] / b[i]).sum::<f64>();
    (open.len(), share / open.len() as f64)
}

#[test]
fn mountains_in_the_clear_air_agree_with_the_reference() {
    if !common::gpu("mountains_in_the_clear_air_agree_with_the_reference") {
        return;
    }
    let mut hazy = mountains(8.0);
    hazy.name = "with a haze below";
    hazy.scene.media = vec![fog(
        Shape::Haze { top: 1500.0 },
        5e-5,
        1e-5,
        Phase::Fog { droplet: 8e-6 },
    )];
    for view in [mountains(2.0), mountains(8.0), mountains(30.0), hazy] {
        eprintln!("{}", view.name);
        let conditions = at_size(&view);
        let (found, truth) = (by_gpu(&conditions), by_reference(&conditions));
        let same = |i: &usize| (found.depth[*i] / truth.depth[*i] - 1.0).abs() < 1e-3;
        let kept: Vec<usize> = (0..truth.pixels()).filter(same).collect();
        assert!(kept.len() * 100 > 99 * truth.pixels(), "{}", kept.len());
        for field in [Field::InscatterSun, Field::Background] {
            let (a, b) = (layer(&found, field), layer(&truth, field));
            let pick = |v: &[DVec3]| -> Vec<DVec3> {
                kept.iter()
                    .map(|i| DVec3::splat(luminance(v[*i])))
                    .collect()
            };
            let error = relative_rmse(&pick(&a), &pick(&b));
            eprintln!("  {:<14}{error:.2e}", field.name());
            assert!(error < 0.02, "{}: {}: {error}", view.name, field.name());
        }
        // The comparison notices half a degree of the sun.
        let mut moved = view.scene.clone();
        if let Some(entry) = &mut moved.sun {
            entry.elevation_deg += 0.5;
        }
        let moved = by_gpu(&common::build::conditions(moved, view.camera, SIZE));
        let error = relative_rmse(
            &layer(&moved, Field::InscatterSun),
            &layer(&truth, Field::InscatterSun),
        );
        assert!(error > 0.02, "{}: {error}", view.name);
        for i in kept {
            let off = (found.transmittance[i] - truth.transmittance[i]).abs();
            assert!(off.max_element() < 1e-3, "{}: {off}", view.name);
        }
    }
}

/// A speck, which shadows nothing, in the clear air under a sky.
fn open_air(elevation_deg: f64) -> Scene {
    let mut scene = scene(
        &[[
            DVec3::new(0.0, -50.0, 0.0),
            DVec3::new(1e-3, -50.0, 0.0),
            DVec3::new(0.0, -50.0, 1e-3),
        ]],
        30.0,
        elevation_deg,
    );
    scene.sun = Some(SunEntry {
        azimuth_deg: 30.0,
        elevation_deg,
        illuminance: None,
        diameter_deg: None,
    });
    scene.sky.model = Some("hosek".into());
    scene.air = Some(ClearAir::default());
    scene
}

#[test]
fn without_geometry_the_sky_is_the_same_with_and_without_air() {
    let gpu = common::gpu("without_geometry_the_sky_is_the_same_with_and_without_air");
    for elevation in [1.0, 12.0] {
        let with = open_air(elevation);
        let mut without = with.clone();
        without.air = None;
        let sun = toward(30.0 * DEG, elevation * DEG, 0.0);
        let camera = Camera::look_at(DVec3::ZERO, sun + 0.2 * DVec3::Y, 60.0 * DEG);
        let [with, without] = [with, without].map(|s| conditions(s, camera, [48, 32]));
        let mut frames = vec![(by_reference(&with), by_reference(&without))];
        if gpu {
            frames.push((by_gpu(&with), by_gpu(&without)));
        }
        for (frame, truth) in frames {
            for i in (0..truth.pixels()).filter(|i| truth.depth[*i] >= 1e9) {
                let (a, b) = (frame.picture(i), truth.picture(i));
                assert!(
                    (a - b).abs().max_element() <= 1e-6 * b.max_element(),
                    "{i}: {a} {b}"
                );
                assert_eq!(frame.transmittance[i], glam::Vec3::ONE);
            }
        }
    }
}

#[test]
fn shadows_of_mountains_are_missing_from_the_sky_and_only_they() {
    let gpu = common::gpu("shadows_of_mountains_are_missing_from_the_sky_and_only_they");
    let view = mountains(8.0);
    let with = by_reference(&at_size(&view));
    let mut clear = view.scene.clone();
    clear.air = None;
    let without = by_reference(&conditions(clear, view.camera, SIZE));
    let (open, share) = missing(&with, &without);
    assert!(open > 500, "{open}");
    assert!(share > 1e-4 && share < 0.5, "{share}");
    for i in (0..with.pixels()).filter(|i| with.depth[*i] >= 1e9) {
        let (a, b) = (with.picture(i), without.picture(i));
        assert!(
            a.cmple(b * (1.0 + 1e-6)).all() && a.min_element() >= 0.0,
            "{i}: {a} {b}"
        );
    }
    // A wall between the sun and all of the ray leaves what single scattering does not explain, and nothing below zero.
    let mut walled = open_air(5.0);
    let sun = toward(30.0 * DEG, 5.0 * DEG, 0.0);
    let aside = sun.cross(DVec3::Y).normalize();
    let reach = 2e6;
    let base = 3e3 * sun - reach * aside - 1e5 * DVec3::Y;
    let wall = quad(base, 2.0 * reach * aside, reach * DVec3::Y);
    walled.mesh = scene(&wall, 0.0, 0.0).mesh;
    let mut bare = walled.clone();
    bare.air = None;
    let camera = Camera::look_at(DVec3::ZERO, 0.3 * DVec3::Y - sun, 50.0 * DEG);
    let both = [walled, bare].map(|s| conditions(s, camera, [24, 16]));
    let [walled, bare] = both.each_ref().map(by_reference);
    let (open, share) = missing(&walled, &bare);
    assert!(open > 100 && share > 0.05 && share <= 1.0, "{open} {share}");
    if gpu {
        let [walled, bare] = both.each_ref().map(by_gpu);
        let (_, found) = missing(&walled, &bare);
        eprintln!("missing behind a wall {share:.4}, on the device {found:.4}");
        assert!((found / share - 1.0).abs() < 0.02, "{found} {share}");
    }
}

#[test]
fn the_air_before_a_wall_is_its_integral_and_takes_its_transmittance() {
    // A black wall 12 km away; the sun from behind the eye lights all of the way.
    let mut scene = open_air(20.0);
    scene.mesh = common::build::scene(
        &quad(
            DVec3::new(-4e4, -1e4, -12e3),
            DVec3::X * 8e4,
            DVec3::Y * 2e4,
        ),
        0.0,
        0.0,
    )
    .mesh;
    scene.materials = vec![material(0.0)];
    scene.ground.height = Some(-100.0);
    if let Some(sun) = &mut scene.sun {
        sun.azimuth_deg = 160.0;
        sun.diameter_deg = Some(0.0);
    }
    let camera = Camera::look_at(DVec3::ZERO, DVec3::new(0.0, 0.05, -1.0), 30.0 * DEG);
    let conditions = conditions(scene, camera, [24, 16]);
    let mut frames = vec![by_reference(&conditions)];
    if common::gpu("the_air_before_a_wall_is_its_integral_and_takes_its_transmittance") {
        frames.push(by_gpu(&conditions));
    }
    let media = &conditions.air.media;
    assert_eq!(media.len(), 2);
    let sun = conditions.sun.toward;
    for frame in frames {
        for i in 0..frame.pixels() {
            assert!(frame.depth[i] < 1e9);
            let at = DVec2::new(
                f64::from(i as u32 % 24) + 0.5,
                f64::from(i as u32 / 24) + 0.5,
            );
            let r = camera.ray(at, [24, 16]).direction;
            let (end, n) = (12e3 / -r.z, 4000);
            let step = end / f64::from(n);
            let (mut eye, mut sum) = (DVec3::ZERO, DVec3::ZERO);
            for k in 0..n {
                let y = (f64::from(k) + 0.5) * step * r.y;
                let (mut source, mut extinction, mut depth) =
                    (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
                for m in media {
                    let Shape::Air {
                        base,
                        scale_height,
                        overhead,
                        ..
                    } = m.shape
                    else {
                        panic!("there is only clear air");
                    };
                    assert_eq!(base, -100.0);
                    let density = (-(y - base) / scale_height).exp();
                    source += m.scattering * density * m.phase.value(1.0 - r.dot(sun));
                    extinction += m.extinction() * density;
                    depth += overhead * (density - 1.0);
                }
                sum += step * source * (-(eye + 0.5 * step * extinction + depth)).exp();
                eye += step * extinction;
            }
            let expected = conditions.sun.light.illuminance * sum;
            let found = layer(&frame, Field::InscatterSun)[i];
            let error = (found / expected - 1.0).abs().max_element();
            assert!(error < 1e-4, "{i}: {found} {expected}");
            let through = (frame.transmittance[i].as_dvec3() - (-eye).exp()).abs();
            assert!(through.max_element() < 1e-5, "{i}: {through}");
        }
    }
}

#[test]
fn sunlight_on_high_ground_is_brighter_by_the_air_below_it() {
    // Three tables, at the site's height, 1 500 m above it and 300 m below it, seen from just above each.
    let on_gpu = common::gpu("sunlight_on_high_ground_is_brighter_by_the_air_below_it");
    for elevation in [3.0, 35.0] {
        for height in [0.0, 1500.0, -300.0] {
            let mut scene = open_air(elevation);
            let corner = DVec3::new(-10.0, height, -10.0);
            scene.mesh =
                common::build::scene(&quad(corner, DVec3::X * 20.0, DVec3::Z * 20.0), 0.0, 0.0)
                    .mesh;
            scene.materials = vec![material(1.0)];
            if let Some(sun) = &mut scene.sun {
                sun.diameter_deg = Some(0.0);
            }
            scene.ground.height = Some(0.0);
            let eye = DVec3::new(0.0, height + 5.0, 1.0);
            let camera = Camera::look_at(eye, DVec3::Y * height, 30.0 * DEG);
            let conditions = conditions(scene, camera, [9, 9]);
            let sun = &conditions.sun;
            let overhead = conditions.air.media.iter().map(|m| match m.shape {
                Shape::Air {
                    scale_height,
                    overhead,
                    ..
                } => overhead * (1.0 - (-height / scale_height).exp()),
                _ => panic!("there is only clear air"),
            });
            let gain = overhead.sum::<DVec3>().exp();
            assert!(height != 0.0 || gain == DVec3::ONE);
            let expected = sun.light.illuminance * gain * sun.toward.y / PI;
            let mut frames = vec![by_reference(&conditions)];
            if on_gpu {
                frames.push(by_gpu(&conditions));
            }
            for frame in frames {
                // Five metres of air lie before the table.
                for (got, through) in layer(&frame, Field::Sun).iter().zip(&frame.transmittance) {
                    let found = *got / through.as_dvec3();
                    let error = (found / expected - 1.0).abs().max_element();
                    assert!(error < 1e-4, "{elevation} {height}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn hard_cases_stay_finite_and_in_order() {
    if !common::gpu("hard_cases_stay_finite_and_in_order") {
        return;
    }
    let ridge = cuboid(
        DVec3::new(-3e3, -200.0, -9e3),
        DVec3::new(3e3, 2500.0, -8e3),
    );
    let suns = [90.0, 0.0, 0.2, -0.1, -5.0, 30.0, 1e-9];
    let eyes = [0.0, 2e3, 4e5, -150.0, -9e4];
    for k in 0..70 {
        let elevation = suns[k % 7];
        let sun = toward(10.0 * DEG, elevation * DEG, 0.0);
        let eye = DVec3::Y * eyes[k % 5];
        let forward = [sun, -sun, DVec3::Y, DVec3::NEG_Y, DVec3::NEG_Z][(k / 2) % 5];
        let mut scene = scene(&ridge, 10.0, elevation);
        scene.sun = Some(SunEntry {
            azimuth_deg: 10.0,
            elevation_deg: elevation,
            illuminance: None,
            diameter_deg: [Some(0.0), None, Some(5.0)][k % 3],
        });
        scene.ground.enabled = k % 2 == 0;
        scene.air = Some(ClearAir {
            turbidity: Some([1.0, 3.0, 20.0][k % 3]),
            aerosol_phase: Phase::Fog { droplet: 50e-6 },
            ..ClearAir::default()
        });
        let haze = fog(Shape::Haze { top: 1e3 }, 1e-4, 1e-5, Phase::Rayleigh);
        scene.media = vec![haze];
        scene.media.truncate(k % 2);
        let mut camera = Camera::look_at(eye, eye + forward, 60.0 * DEG);
        camera.projection = match k % 3 {
            0 => Projection::Perspective { fov_y: 60.0 * DEG },
            1 => Projection::Orthographic { height: 3e3 },
            _ => Projection::Panorama,
        };
        let size = [[1, 1], [1, 7], [13, 5]][(k / 2) % 3];
        let conditions = conditions(scene, camera, size);
        // Both are checked to be finite and not negative.
        let (found, truth) = (by_gpu(&conditions), by_reference(&conditions));
        for frame in [&found, &truth] {
            assert!(frame.transmittance.iter().all(|t| t.max_element() <= 1.0));
        }
        let names = |f: &Frame| f.layers.iter().map(|l| l.name).collect::<Vec<_>>();
        assert_eq!(names(&found), names(&truth), "{k}");
        // No light is stronger than all sunlight there is, thrown straight back by the sharpest phase function.
        let most = 2e5 * Phase::Fog { droplet: 50e-6 }.peak();
        for value in layer(&found, Field::InscatterSun) {
            assert!(value.max_element() <= most, "{k}: {value}");
        }
    }
}

/// Compares in-scattering on a device with the f64 integral at every pixel; the greatest relative error.
fn greatest_error(conditions: &Conditions) -> f64 {
    error_against(&by_gpu(conditions), conditions)
}

/// The greatest relative error of a picture's in-scattering, if `conditions` are what it shows.
fn error_against(frame: &Frame, conditions: &Conditions) -> f64 {
    let found = layer(frame, Field::InscatterSun);
    let points = conditions.sun.beams(1);
    let (mut worst, mut seen) = (0.0f64, 0);
    for (i, got) in found.iter().enumerate() {
        let (x, y) = (i as u32 % frame.width, i as u32 / frame.width);
        let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let ray = conditions.view.camera.ray(at, conditions.view.size);
        let air = &conditions.air;
        let end = air
            .end(ray.origin, ray.direction)
            .min(f64::from(frame.depth[i]));
        let truth = Scattering::new(air, ray.origin, ray.direction, end, &points[0]);
        let truth = points[0].strength() * truth.integrate(0.0, end);
        if truth.min_element() > 1e-20 {
            worst = worst.max((*got / truth - 1.0).abs().max_element());
            seen += 1;
        } else {
            assert!(got.max_element() <= 1e-20, "{got} {truth}");
        }
    }
    assert!(seen > 0, "nothing is seen");
    worst
}

fn speck_in(media: Vec<Medium>, elevation_deg: f64) -> Scene {
    let mut scene = open_air(elevation_deg);
    scene.air = None;
    scene.sky.model = None;
    scene.media = media;
    if let Some(sun) = &mut scene.sun {
        (sun.illuminance, sun.diameter_deg) = (Some(1e5), Some(0.0));
    }
    scene
}

#[test]
fn every_phase_function_is_the_same_on_a_device() {
    if !common::gpu("every_phase_function_is_the_same_on_a_device") {
        return;
    }
    let phases = [
        Phase::Rayleigh,
        Phase::CornetteShanks { g: 0.8 },
        Phase::NishitaHazy,
        Phase::NishitaMurky,
        Phase::Draine { g: 0.0, a: 1.0 },
        Phase::Draine { g: 0.6, a: 0.0 },
        Phase::Draine { g: -0.4, a: 7.0 },
        Phase::Draine { g: 0.97, a: 250.0 },
        Phase::Fog { droplet: 0.05e-6 },
        Phase::Fog { droplet: 0.7e-6 },
        Phase::Fog { droplet: 4.81e-6 },
        Phase::Fog { droplet: 8e-6 },
        Phase::Fog { droplet: 50e-6 },
    ];
    for phase in phases {
        let haze = fog(Shape::Haze { top: 40.0 }, 0.011, 0.004, phase);
        let scene = speck_in(vec![haze], 25.0);
        let sun = toward(30.0 * DEG, 25.0 * DEG, 0.0);
        // Into the sun, exactly, and away from it.
        for forward in [sun, -sun, DVec3::Y.cross(sun)] {
            let camera = Camera::look_at(DVec3::Y * 2.0, DVec3::Y * 2.0 + forward, 70.0 * DEG);
            let error = greatest_error(&conditions(scene.clone(), camera, [33, 25]));
            assert!(error < 1e-4, "{phase:?}: {error}");
        }
    }
    // One that is off is noticed.
    let view = |droplet: f64| {
        let haze = Shape::Haze { top: 40.0 };
        let media = vec![fog(haze, 0.011, 0.004, Phase::Fog { droplet })];
        let camera = Camera::look_at(DVec3::Y, DVec3::Y + DVec3::X, 70.0 * DEG);
        conditions(speck_in(media, 25.0), camera, [33, 25])
    };
    let error = error_against(&by_gpu(&view(8e-6)), &view(8.1e-6));
    assert!(error > 1e-3, "{error}");
}

#[test]
fn height_air_keeps_its_digits_on_a_device_along_every_slope() {
    if !common::gpu("height_air_keeps_its_digits_on_a_device_along_every_slope") {
        return;
    }
    let height = |scale_height: f64, coefficient: f64| {
        let shape = Shape::Height {
            base: 0.0,
            scale_height,
            far: 2e4,
        };
        fog(
            shape,
            0.8 * coefficient,
            0.2 * coefficient,
            Phase::Isotropic,
        )
    };
    // (scale height, coefficient, elevation of the sun, eye's height, where it looks)
    let mut cases = vec![
        // Looking at the sun's own elevation, straight up and down, from 9 km into thin fog, from space.
        (50.0, 0.01, 10.0, 20.0, toward(30.0 * DEG, 10.0 * DEG, 0.0)),
        (50.0, 0.01, 10.0, 20.0, DVec3::Y),
        (50.0, 0.01, 10.0, 20.0, DVec3::NEG_Y),
        (50.0, 0.01, 40.0, 9e3, DVec3::NEG_Y),
        // Nearly homogeneous, a thin layer, nearly opaque, a sun on the horizon.
        (1e6, 1e-7, 30.0, 2.0, DVec3::X),
        (0.5, 0.5, 30.0, 2.0, DVec3::new(1.0, -0.5, 0.0)),
        (50.0, 0.3, 30.0, 60.0, DVec3::new(1.0, -0.1, 0.0)),
        (50.0, 1e-4, 0.5, 60.0, DVec3::new(1.0, 0.1, 0.0)),
    ];
    for exponent in [3, 5, 7, 12] {
        for sign in [1.0, -1.0] {
            let y = sign * 10f64.powi(-exponent);
            cases.push((50.0, 0.005, 20.0, 20.0, DVec3::new(1.0, y, 0.2)));
        }
    }
    cases.push((50.0, 0.005, 20.0, 20.0, DVec3::X));
    for (scale_height, coefficient, elevation, y, forward) in cases {
        let scene = speck_in(vec![height(scale_height, coefficient)], elevation);
        let eye = DVec3::Y * y;
        // A narrow view: all of its rays are nearly the one that is meant.
        let camera = Camera::look_at(eye, eye + forward, 0.2 * DEG);
        let error = greatest_error(&conditions(scene, camera, [9, 9]));
        eprintln!("{scale_height} {coefficient} {elevation} {y} {forward}: {error:.1e}");
        assert!(
            error < 1e-4,
            "{scale_height} {coefficient} {elevation} {y} {forward}: {error}"
        );
    }
}

#[test]
fn boxes_of_any_density_keep_their_digits_on_a_device() {
    if !common::gpu("boxes_of_any_density_keep_their_digits_on_a_device") {
        return;
    }
    let cube = |min: DVec3, max: DVec3, sigma: f64| {
        vec![fog(
            Shape::Box { min, max },
            0.8 * sigma,
            0.2 * sigma,
            Phase::Isotropic,
        )]
    };
    let two = DVec3::splat(2.0);
    for (media, eye, forward) in [
        // The eye inside; dense; from outside; a sheet.
        (
            cube(DVec3::ZERO, two, 0.05),
            DVec3::ONE,
            DVec3::new(1.0, 0.2, 0.3),
        ),
        (
            cube(DVec3::ZERO, two, 1e5),
            DVec3::new(0.3, 3.0, 1.0),
            DVec3::NEG_Y,
        ),
        (
            cube(DVec3::ZERO, two, 5.0),
            DVec3::new(-3.0, 1.0, 1.0),
            DVec3::new(1.0, 0.1, 0.05),
        ),
        (
            cube(DVec3::ZERO, DVec3::new(2.0, 1e-3, 2.0), 5.0),
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(0.2, -1.0, 0.1),
        ),
    ] {
        let scene = speck_in(media, 50.0);
        let camera = Camera::look_at(eye, eye + forward, 4.0 * DEG);
        let error = greatest_error(&conditions(scene, camera, [9, 9]));
        eprintln!("{eye} {forward}: {error:.1e}");
        // A sheet of a millimetre a metre away has four digits of its thickness left.
        assert!(error < 2e-4, "{eye} {forward}: {error}");
    }
}
