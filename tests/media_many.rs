//! Many boxes of haze: what they make is what one box does, and a thousand cost what a thousand do.

mod common;

use common::{build, shafts, views};
use glam::DVec3;
use std::path::Path;
use std::time::{Duration, Instant};
use tyndall::beam::Beam;
use tyndall::effect::Method;
use tyndall::medium::{Air, Medium, Phase, Scattering, Shape};
use tyndall::plan::Quality;

fn medium(min: DVec3, max: DVec3) -> Medium {
    Medium {
        shape: Shape::Box { min, max },
        scattering: DVec3::new(0.01, 0.012, 0.015),
        absorption: DVec3::splat(0.002),
        phase: Phase::HenyeyGreenstein { g: 0.6 },
    }
}

fn air(media: Vec<Medium>) -> Air {
    Air { media, ground: 0.0 }
}

/// A box cut into as many slices along an axis, in an order that is not that of space.
fn slices(count: usize, axis: usize) -> Air {
    let side = 100.0 / count as f64;
    let slice = |i: usize| {
        let (mut min, mut max) = (DVec3::new(0.0, 0.0, -5.0), DVec3::new(100.0, 10.0, 5.0));
        let (low, high) = (min[axis], max[axis]);
        let step = (high - low) / 100.0 * side;
        min[axis] = low + step * i as f64;
        max[axis] = low + step * (i + 1) as f64;
        medium(min, max)
    };
    // 7 has no divisor in common with the counts: every slice comes once.
    air((0..count).map(|i| slice(7 * i % count)).collect())
}

fn beam() -> Beam {
    Beam::Parallel {
        toward: DVec3::new(0.6, 0.7, 0.2).normalize(),
        illuminance: DVec3::ONE,
        angular_radius: 0.0,
    }
}

fn rays() -> Vec<(DVec3, DVec3)> {
    let mut rays = Vec::new();
    for i in 0..60 {
        let turn = f64::from(i) * 2.4;
        let origin = DVec3::new(
            -3.0 + 1.7 * f64::from(i),
            4.0 * turn.sin().abs() + 0.5,
            8.0 * turn.cos(),
        );
        let target = DVec3::new(
            50.0 + 40.0 * turn.cos(),
            5.0 + 4.0 * turn.sin(),
            3.0 * turn.sin(),
        );
        rays.push((origin, (target - origin).normalize()));
    }
    // Along the row, with the sun's rays, across faces, and through edges.
    rays.push((DVec3::new(-10.0, 5.03, 0.01), DVec3::X));
    rays.push((
        DVec3::new(10.0, 1.0, 0.0),
        DVec3::new(0.6, 0.7, 0.2).normalize(),
    ));
    rays.push((DVec3::new(50.3, -10.0, 0.0), DVec3::Y));
    rays.push((DVec3::new(-10.0, 0.0, -5.0), DVec3::X));
    rays
}

fn light(air: &Air, (origin, direction): (DVec3, DVec3)) -> DVec3 {
    let scattering = Scattering::new(air, origin, direction, 1e5, &beam());
    [[0.0, 300.0], [12.0, 30.0], [41.5, 41.6]]
        .map(|[from, to]| scattering.integrate(from, to))
        .iter()
        .sum()
}

#[test]
fn slices_of_a_box_scatter_as_the_box() {
    let whole = slices(1, 0);
    for (count, axis) in [(2, 0), (10, 1), (97, 2), (1000, 0)] {
        let cut = slices(count, axis);
        for ray in rays() {
            let (one, many) = (light(&whole, ray), light(&cut, ray));
            let off = (one - many).abs().max_element();
            assert!(
                off <= 1e-9 * one.max_element() + 1e-15,
                "{count} {axis} {ray:?}: {one} {many}"
            );
        }
    }
    // Boxes beside the ray and its way to the sun add nothing.
    let mut beside = whole.clone();
    for i in 0..500 {
        let min = DVec3::new(f64::from(i), -50.0, -400.0);
        beside.media.push(medium(min, min + 1.0));
    }
    for ray in rays() {
        let (one, many) = (light(&whole, ray), light(&beside, ray));
        assert!(
            (one - many).abs().max_element() <= 1e-12 * one.max_element(),
            "{ray:?}"
        );
    }
}

/// The least of a few times: the machine may be busy.
fn least(mut work: impl FnMut()) -> Duration {
    let times = (0..3).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed()
    });
    times.min().unwrap_or_default()
}

#[test]
fn sixteen_times_the_boxes_do_not_cost_two_hundred_times_as_much() {
    // Linear is 16, with the square 256.
    let ray = (
        DVec3::new(-10.0, 5.0, 0.0),
        DVec3::new(1.0, 1e-4, 1e-3).normalize(),
    );
    // Of one size each: as many as are between a place and the sun count there, however they are sorted.
    let row = |count: usize| {
        let boxes = (0..count).map(|i| {
            let min = DVec3::new(i as f64, 0.0, -50.0);
            medium(min, min + DVec3::new(1.0, 10.0, 100.0))
        });
        air(boxes.collect())
    };
    let (few, many) = (row(250), row(4000));
    let cost = |air: &Air| {
        least(|| {
            for _ in 0..10 {
                assert!(light(air, ray).min_element() > 0.0);
            }
        })
    };
    let ratio = cost(&many).as_secs_f64() / cost(&few).as_secs_f64();
    assert!(ratio < 80.0, "scattering: {ratio}");

    let folder = tempfile::tempdir().unwrap();
    let file = |count: usize| {
        let mut text = "[sun]\nazimuth = 1\nelevation = 40\n".to_owned();
        for i in 0..count {
            text += &format!(
                "[[medium]]\nshape = \"box\"\nmin = [{i}, 0, 0]\nmax = [{}, 1, 1]\nscattering = 0.01\n",
                i + 1
            );
        }
        let path = folder.path().join(format!("{count}.toml"));
        std::fs::write(&path, text).unwrap();
        path
    };
    let load = |path: &Path| {
        least(|| {
            tyndall::scene::load(path).unwrap();
        })
    };
    let (few, many) = (file(500), file(8000));
    let ratio = load(&many).as_secs_f64() / load(&few).as_secs_f64();
    assert!(ratio < 80.0, "loading: {ratio}");
}

/// One box of haze or as many slices of it: the picture is the same on a GPU too, by passes or, where there are many, by the
/// reference, and the plan says which.
#[test]
fn slices_of_a_box_make_its_picture_on_every_backend() {
    if !common::gpu("slices_of_a_box_make_its_picture_on_every_backend") {
        return;
    }
    let slats = views::slats(1.0);
    let Shape::Box { min, max } = slats.scene.media[0].shape else {
        unreachable!("its fog fills a box");
    };
    let picture = |count: u32| {
        let mut scene = slats.scene.clone();
        let step = (max.z - min.z) / f64::from(count);
        let whole = scene.media.remove(0);
        scene.media.extend((0..count).map(|i| Medium {
            shape: Shape::Box {
                min: DVec3::new(min.x, min.y, min.z + step * f64::from(i)),
                max: DVec3::new(max.x, max.y, min.z + step * f64::from(i + 1)),
            },
            ..whole.clone()
        }));
        let conditions = build::conditions(scene, slats.camera, [32, 24]);
        let plan = shafts::plan(&conditions, Method::Rectified, Quality::Preview, &[]);
        let step = plan.running().find(|step| step.effect.method.is_some());
        let step = step.expect("there is haze");
        let by_reference = step.is_by_reference(&conditions);
        assert_eq!(by_reference, count > 16);
        assert_eq!(by_reference, step.decision.reason.contains("16 media"));
        shafts::render(&plan).frame
    };
    let truth = picture(1);
    for count in [2, 16, 17, 64] {
        let (rmse, _) = shafts::error(&picture(count), &truth);
        eprintln!("{count} slices: {rmse:.1e}");
        assert!(rmse < 2e-3, "{count}: {rmse}");
    }
}
