//! Dobashi's virtual planes against the reference.

mod common;

use common::build::*;
use common::gpu;
use glam::DVec3;
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Method};
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Projection};
use tyndall::studies::scenes::{StudyView, antisolar, colonnade, fog, gates, slats};
use tyndall::units::DEG;

const SIZE: [u32; 2] = [48, 32];

fn plan<'c>(conditions: &'c Conditions, set: &[(&str, f64)]) -> Plan<'c> {
    let set = set.iter().map(|(knob, v)| (format!("shafts.{knob}"), *v));
    let overrules = Overrules {
        quality: Quality::Preview,
        method: Some(Method::Planes),
        set: [
            ("shafts.disc".to_owned(), 0.0),
            ("shafts.suns".to_owned(), 1.0),
        ]
        .into_iter()
        .chain([
            ("shadow.resolution".to_owned(), 2048.0),
            ("shadow.density".to_owned(), 1024.0),
        ])
        .chain(set)
        .collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

/// Light in the air, and reads a pixel.
fn by_planes(conditions: &Conditions, planes: f64, lattice: f64) -> (Vec<DVec3>, f64) {
    let plan = plan(conditions, &[("planes", planes), ("lattice", lattice)]);
    let rendered = common::shafts::gpu()
        .count(&plan, &Limits::memory(1 << 30), &|_| {})
        .expect("the device works");
    let frame = rendered.frame;
    frame
        .check()
        .expect("every value is finite and not negative");
    let ours = rendered
        .steps
        .iter()
        .filter(|step| step.effect.method == Some(Method::Planes));
    let reads: u64 = ours.filter_map(|p| p.counted).map(|c| c[0]).sum();
    let found = layer(&frame, Field::InscatterSun);
    let pixels = found.len() as f64;
    (found, reads as f64 / pixels)
}

fn by_reference(conditions: &Conditions) -> Vec<DVec3> {
    let plan = plan(conditions, &[]);
    let rendered = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {});
    let frame = rendered.expect("the picture fits into memory").frame;
    layer(&frame, Field::InscatterSun)
}

/// sum(a) / sum(b).
fn ratio(a: &[DVec3], b: &[DVec3]) -> f64 {
    let sum = |v: &[DVec3]| v.iter().map(|v| v.x).sum::<f64>();
    sum(a) / sum(b)
}

/// A box of fog before the eye, seen whole or in part; nothing casts a shadow on it.
fn fog_box(half: f64, phase: Phase) -> StudyView {
    // A post far aside: a scene has something in it.
    let post = cuboid(DVec3::new(60.0, 0.0, 60.0), DVec3::new(60.1, 0.5, 60.1));
    let mut scene = scene(&post, 40.0, 35.0);
    let shape = Shape::Box {
        min: DVec3::new(-half, -half, -22.0),
        max: DVec3::new(half, half, -8.0),
    };
    scene.media = vec![fog(shape, 0.06, 0.02, phase)];
    StudyView {
        name: "fog box",
        scene,
        camera: Camera::look_at(DVec3::ZERO, DVec3::new(0.0, 0.0, -10.0), 50.0 * DEG),
    }
}

fn seen(view: &StudyView, size: [u32; 2]) -> Conditions {
    conditions(view.scene.clone(), view.camera, size)
}

#[test]
fn without_shadows_the_error_falls_with_the_square_of_planes_and_of_lattice() {
    if !gpu("without_shadows_the_error_falls_with_the_square_of_planes_and_of_lattice") {
        return;
    }
    // Wider than the view: no face of the box is seen from the side.
    let view = fog_box(40.0, Phase::HenyeyGreenstein { g: 0.6 });
    let conditions = seen(&view, SIZE);
    let truth = by_reference(&conditions);
    let error = |planes, lattice| relative_rmse(&by_planes(&conditions, planes, lattice).0, &truth);

    let errors = [4.0, 8.0, 16.0, 32.0].map(|planes| error(planes, 512.0));
    for pair in errors.windows(2) {
        assert!((3.0..6.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    // Beyond that only rounding is left.
    assert!(error(512.0, 512.0) < 2e-5);

    let errors = [2.0, 4.0, 8.0].map(|lattice| error(256.0, lattice));
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
    }
}

#[test]
fn the_number_of_planes_does_not_change_the_energy() {
    if !gpu("the_number_of_planes_does_not_change_the_energy") {
        return;
    }
    let ratios = |view: &StudyView, counts: &[f64]| -> Vec<f64> {
        let conditions = seen(view, SIZE);
        let truth = by_reference(&conditions);
        let found = counts
            .iter()
            .map(|planes| by_planes(&conditions, *planes, 64.0).0);
        found.map(|found| ratio(&found, &truth)).collect()
    };
    let within = |ratios: &[f64], most: f64| ratios.iter().all(|r| (r - 1.0).abs() < most);
    // Slabs that the box's faces and the surfaces cut in part.
    for half in [40.0, 3.0] {
        let found = ratios(
            &fog_box(half, Phase::Isotropic),
            &[15.0, 16.0, 40.0, 75.0, 301.0],
        );
        assert!(within(&found, 1e-3), "{half}: {found:?}");
    }
    // Shadows are there or not for a whole slab, which is chance until slabs are thin.
    for view in [slats(1.0), gates(), antisolar()] {
        let found = ratios(&view, &[301.0, 1000.0]);
        assert!(within(&found, 0.01), "{}: {found:?}", view.name);
        assert!(
            !within(&ratios(&view, &[1.0, 2.0, 3.0, 4.0]), 0.01),
            "{}",
            view.name
        );
    }
}

#[test]
fn shadows_come_near_and_a_moved_sun_is_noticed() {
    if !gpu("shadows_come_near_and_a_moved_sun_is_noticed") {
        return;
    }
    for view in [slats(1.0), colonnade(), gates(), antisolar()] {
        let conditions = seen(&view, SIZE);
        let truth = by_reference(&conditions);
        let errors = [15.0, 75.0, 600.0]
            .map(|planes| relative_rmse(&by_planes(&conditions, planes, 64.0).0, &truth));
        assert!(errors[1] < 0.7 * errors[0], "{}: {errors:?}", view.name);
        assert!(errors[2] < 0.2 * errors[1], "{}: {errors:?}", view.name);

        let mut moved = view.clone();
        let sun = moved.scene.sun.as_mut().expect("the scene has a sun");
        sun.azimuth_deg += 10.0;
        let wrong = by_planes(&seen(&moved, SIZE), 600.0, 64.0).0;
        let wrong = relative_rmse(&wrong, &truth);
        assert!(
            wrong > 3.0 * errors[2],
            "{}: {wrong}, {errors:?}",
            view.name
        );
    }
}

#[test]
fn reads_are_four_for_a_lit_plane_and_one_more_where_there_may_be_shadow() {
    if !gpu("reads_are_four_for_a_lit_plane_and_one_more_where_there_may_be_shadow") {
        return;
    }
    // Every ray goes through the whole depth of the box from face to face.
    let view = fog_box(40.0, Phase::Isotropic);
    let (_, reads) = by_planes(&seen(&view, SIZE), 20.0, 10.0);
    assert!((reads - 80.0).abs() < 0.01, "{reads}");
    let (_, reads) = by_planes(&seen(&slats(1.0), SIZE), 20.0, 10.0);
    assert!((20.0..100.0).contains(&reads), "{reads}");
}

#[test]
fn air_with_borders_thinning_air_and_mixtures() {
    if !gpu("air_with_borders_thinning_air_and_mixtures") {
        return;
    }
    let phase = Phase::HenyeyGreenstein { g: 0.5 };
    // Two boxes that overlap in part, of different phase functions, in haze, in air that thins with height, one behind the other
    // and five at once.
    let part = |x: f64, z: f64, scattering: f64, phase| {
        let min = DVec3::new(x, -2.0, z - 6.0);
        let shape = Shape::Box {
            min,
            max: min + DVec3::new(5.0, 4.0, 6.0),
        };
        fog(shape, scattering, 0.01, phase)
    };
    let boxes = [
        part(-4.0, -8.0, 0.08, phase),
        part(-1.5, -11.0, 0.03, Phase::Rayleigh),
    ];
    let haze = fog(Shape::Haze { top: 3.0 }, 0.01, 0.001, Phase::Isotropic);
    let height = |scattering| {
        let shape = Shape::Height {
            base: -2.0,
            scale_height: 4.0,
            far: 60.0,
        };
        fog(shape, scattering, 0.002, phase)
    };
    for (name, media, most) in [
        ("two boxes", boxes.to_vec(), 5e-3),
        ("haze", vec![haze.clone()], 5e-3),
        ("height", vec![height(0.02)], 5e-3),
        (
            "boxes in haze",
            [&boxes[..], std::slice::from_ref(&haze)].concat(),
            5e-3,
        ),
        (
            "five",
            [
                &boxes[..],
                &[haze, height(0.01), part(0.0, -20.0, 0.05, phase)],
            ]
            .concat(),
            5e-3,
        ),
    ] {
        let mut view = fog_box(3.0, phase);
        view.scene.media = media;
        view.scene.ground.enabled = true;
        view.scene.ground.height = Some(-2.0);
        let conditions = seen(&view, SIZE);
        let truth = by_reference(&conditions);
        let found = by_planes(&conditions, 150.0, 64.0).0;
        let error = relative_rmse(&found, &truth);
        assert!(error < most, "{name}: {error}");
        let coarse = relative_rmse(&by_planes(&conditions, 15.0, 64.0).0, &truth);
        assert!(coarse > 2.0 * error, "{name}: {coarse} {error}");
    }
}

#[test]
fn every_camera_and_every_size() {
    if !gpu("every_camera_and_every_size") {
        return;
    }
    let projections = [
        Projection::Perspective { fov_y: 60.0 * DEG },
        Projection::Orthographic { height: 5.0 },
        Projection::Panorama,
    ];
    // Every size meets every camera, and every view; not each of the three each of the others.
    let sizes = [[1, 1], [2, 1], [1, 7], [5, 3], [17, 1], [3, 5]];
    let views = [slats(1.0), colonnade(), fog_box(3.0, Phase::Rayleigh)];
    for (v, view) in views.iter().enumerate() {
        for (p, projection) in projections.into_iter().enumerate() {
            let mut view = view.clone();
            view.camera.projection = projection;
            view.camera.shift = match projection {
                Projection::Panorama => glam::DVec2::ZERO,
                _ => glam::DVec2::new(0.1, -0.05),
            };
            let conditions = seen(&view, [64, 33]);
            let truth = by_reference(&conditions);
            let error = relative_rmse(&by_planes(&conditions, 600.0, 64.0).0, &truth);
            assert!(error < 0.04, "{} {projection:?}: {error}", view.name);
            let third = (v + p) % 3;
            for size in [sizes[third], sizes[third + 3]] {
                let conditions = seen(&view, size);
                let truth = by_reference(&conditions);
                // One plane is a value for all of the ray: no more is asked of it than that it is finite.
                by_planes(&conditions, 1.0, 2.0);
                let found = by_planes(&conditions, 600.0, 20.0).0;
                if truth.iter().all(|v| *v == DVec3::ZERO) {
                    assert!(found.iter().all(|v| *v == DVec3::ZERO));
                    continue;
                }
                let error = relative_rmse(&found, &truth);
                assert!(
                    error < 0.1,
                    "{} {projection:?} {size:?}: {error}",
                    view.name
                );
            }
        }
    }
}

#[test]
fn several_tiles_have_planes_of_their_own() {
    if !gpu("several_tiles_have_planes_of_their_own") {
        return;
    }
    // Wider than a tile.
    let mut view = slats(1.0);
    view.camera.projection = Projection::Perspective { fov_y: 2.0 * DEG };
    let conditions = seen(&view, [530, 12]);
    let truth = by_reference(&conditions);
    let error = relative_rmse(&by_planes(&conditions, 600.0, 80.0).0, &truth);
    assert!(error < 0.02, "{error}");
}
