//! Sunlight in the air at sparse places of slices.

mod common;

use common::flat::*;
use common::shafts::*;
use common::views::*;
use glam::{DVec2, DVec3};
use tyndall::conditions::Conditions;
use tyndall::effect::Method;
use tyndall::plan::Quality;
use tyndall::scene::Projection;

/// Some drivers count the turns of all loops of an invocation and end them at 65 535: light is lost where one invocation has to
/// find the borders of several rays. At a tolerance of 0 every sample is integrated.
#[test]
fn no_light_is_lost_among_hundreds_of_borders() {
    let test = "no_light_is_lost_among_hundreds_of_borders";
    if !common::gpu(test) {
        return;
    }
    let (period, share) = (0.05, 0.4);
    let conditions = fence(period, share).conditions([128, 96]).expect("sound");
    let all = light(&by_reference(&open(&conditions), &[]));
    let truth = light(&by_reference(&conditions, &[]));
    let set: Settings = &[("shafts.tolerance", 0.0)];
    let found = light(&by_gpu(&conditions, Method::Epipolar, set));
    let through = mean(&found) / mean(&all);
    let off = apart(&found, &truth);
    eprintln!("{through:.4} of {share}, RMSE {off:.4}");
    assert!((through / share - 1.0).abs() < 0.01, "{through}");
    // About what rows are off by.
    assert!(off < 0.03, "{off}");
}

/// Reads and nodes of a method's passes from the rows on, and nodes alone of those pixels that it integrates themselves.
fn work(conditions: &Conditions, method: Method) -> (u64, u64) {
    let passes = counted(&plan(conditions, method, Quality::Preview, &[]));
    let own = passes.iter().filter(|(pass, _)| *pass != "build");
    let all = own.map(|(_, [reads, nodes])| reads + nodes).sum();
    let pixelwise = passes
        .iter()
        .filter(|(pass, _)| ["integrate", "unwarp"].contains(pass));
    (all, pixelwise.map(|(_, [_, nodes])| nodes).sum())
}

/// A sample that misses its pixel would show in nothing but the work: the pixels around it would be integrated themselves.
/// Tiles, shifts and the seam of a panorama are where that could be.
#[test]
fn every_camera_has_samples() {
    let test = "every_camera_has_samples";
    if !common::gpu(test) {
        return;
    }
    let flat = Projection::Orthographic { height: 6.0 };
    let round = Projection::Panorama;
    for (mut view, projection, shift, size) in [
        (forest(300), flat, DVec2::ZERO, [256, 192]),
        (slats(1.0), flat, DVec2::new(0.1, -0.2), [640, 256]),
        (slats(1.0), round, DVec2::ZERO, [1024, 256]),
        (gates(), round, DVec2::new(0.3, 0.0), [640, 320]),
    ] {
        view.camera.projection = projection;
        view.camera.shift = shift;
        // A panorama is level wherever the camera looks.
        view.camera.forward += 0.1 * DVec3::Y;
        let conditions = view.conditions(size).expect("sound");
        let truth = by_reference(&conditions, &[]);
        let (rmse, bias) = error(&by_gpu(&conditions, Method::Epipolar, &[]), &truth);
        let [(_, all), (_, left)] =
            [Method::Rectified, Method::Epipolar].map(|method| work(&conditions, method));
        let share = left as f64 / all as f64;
        eprintln!(
            "{} {projection:?} {rmse:.5} {bias:+.5}, pixelwise {share:.4}",
            view.name
        );
        assert!(
            rmse < 0.01 && bias.abs() < 0.002,
            "{}: {rmse} {bias}",
            view.name
        );
        assert!(share < 0.05, "{} {projection:?}: {share}", view.name);
    }
}

#[test]
fn sparse_samples_read_less_than_all_pixels() {
    let test = "sparse_samples_read_less_than_all_pixels";
    if !common::gpu(test) {
        return;
    }
    let flat = Projection::Orthographic { height: 12.0 };
    for (mut view, projection, size, most) in [
        (forest(700), flat, [512, 512], 0.8),
        (slats(1.0), Projection::Panorama, [1024, 512], 0.75),
    ] {
        view.camera.projection = projection;
        let conditions = view.conditions(size).expect("sound");
        let (all, _) = work(&conditions, Method::Rectified);
        let (sparse, _) = work(&conditions, Method::Epipolar);
        let share = sparse as f64 / all as f64;
        eprintln!("{} {projection:?} {share:.3}", view.name);
        assert!(share < most, "{} {projection:?}: {share}", view.name);
    }
}
