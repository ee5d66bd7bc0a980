//! Scenes in which ways of integrating the light of lamps are measured: one lamp each, in a box of fog, at night.

use super::scenes::{Corners, StudyView, cuboid, fog, scene};
use crate::medium::{Phase, Shape};
use crate::photometry::Distribution;
use crate::scene::{Camera, LampEntry, LampForm};
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// The names of the views.
pub const NAMES: [&str; 3] = ["open-lamp", "posts", "grille"];

/// The view of a name; `None` for another than those of [`NAMES`].
pub fn named(name: &str) -> Option<StudyView> {
    Some(match name {
        "open-lamp" => open(),
        "posts" => posts(),
        "grille" => grille(),
        _ => return None,
    })
}

/// A view of triangles in fog around a lamp.
fn view(
    name: &'static str,
    triangles: &[Corners],
    (position, distribution): (DVec3, Distribution),
    phase: Phase,
) -> StudyView {
    let mut scene = scene(triangles, 0.0, 0.0);
    scene.sun = None;
    scene.lamps = vec![LampEntry {
        name: "lamp".into(),
        position,
        toward: DVec3::NEG_Y,
        around: None,
        intensity: DVec3::splat(1000.0),
        distribution,
        form: LampForm::Point,
        ignore: None,
    }];
    let around = Shape::Box {
        min: DVec3::new(-12.0, 0.0, -12.0),
        max: DVec3::new(12.0, 8.0, 12.0),
    };
    scene.media = vec![fog(around, 0.05, 0.01, phase)];
    StudyView {
        name,
        scene,
        camera: Camera::look_at(
            DVec3::new(0.8, 1.7, 8.5),
            DVec3::new(0.0, 1.5, 0.0),
            55.0 * DEG,
        ),
    }
}

fn floor() -> Vec<Corners> {
    cuboid(DVec3::new(-12.0, -0.2, -12.0), DVec3::new(12.0, 0.0, 12.0))
}

/// A lamp that shines alike all around over a floor: all closed forms hold.
pub fn open() -> StudyView {
    let lamp = (DVec3::new(0.2, 2.2, -0.1), Distribution::Isotropic);
    view("open-lamp", &floor(), lamp, Phase::Isotropic)
}

/// The same in a hall of eight posts.
pub fn posts() -> StudyView {
    let mut triangles = floor();
    for i in 0..8 {
        let (z, x) = (f64::from(i) * FRAC_PI_4 + 0.1).sin_cos();
        let (at, half) = (2.0 * DVec3::new(x, 0.0, z), DVec3::new(0.15, 0.0, 0.1));
        triangles.extend(cuboid(at - half, at + half.with_y(3.5)));
    }
    let lamp = (DVec3::new(0.2, 2.2, -0.1), Distribution::Isotropic);
    view("posts", &triangles, lamp, Phase::Isotropic)
}

/// A spot through a grille, in haze that scatters forward.
pub fn grille() -> StudyView {
    let mut triangles = floor();
    for i in 0..13 {
        let at = -1.8 + 0.3 * f64::from(i);
        triangles.extend(cuboid(
            DVec3::new(at - 0.05, 3.2, -2.0),
            DVec3::new(at + 0.05, 3.3, 2.0),
        ));
    }
    let spread = 35.0 * DEG;
    let distribution = Distribution::NishitaSpot {
        spread,
        sharpness: 0.25,
    };
    let lamp = (DVec3::new(0.0, 5.0, 0.0), distribution);
    view(
        "grille",
        &triangles,
        lamp,
        Phase::HenyeyGreenstein { g: 0.6 },
    )
}
