//! Scenes under the sun's disc whose shadows have wide soft edges in thin fog, and how far pictures of them are off.
#![allow(dead_code)]

use super::views::*;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use tyndall::medium::{Phase, Shape};
use tyndall::scene::{Camera, Ray};

/// As many points as are held to be the truth.
pub const MANY: f64 = 2048.0;

/// The sun's diameter [deg].
pub const DIAMETER: f64 = 0.533;

/// A scene in clear fog between x = -10 and 10 under a uniform disc.
pub fn view(triangles: &[Corners], [azimuth, elevation]: [f64; 2], camera: Camera) -> StudyView {
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

/// The same with nothing but a speck far below.
pub fn without_casters(view: &StudyView) -> StudyView {
    let mut open = view.clone();
    let low = DVec3::new(0.0, -500.0, 0.0);
    open.scene.mesh = scene(
        &[[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]],
        0.0,
        0.0,
    )
    .mesh;
    open
}

/// Seen from above, or along the fog, or aslant.
pub fn cameras() -> [Camera; 3] {
    let at = |eye: DVec3, target: DVec3| Camera::look_at(eye, target, 24f64.to_radians());
    [
        at(DVec3::new(0.0, 60.0, 0.0), DVec3::new(0.1, 0.0, 0.0)),
        at(DVec3::new(0.5, 0.3, 40.0), DVec3::new(0.0, 0.0, 0.0)),
        at(DVec3::new(-3.0, 1.0, 6.0), DVec3::new(8.0, 2.0, -6.0)),
    ]
}

/// A plate at right angles to the x axis, `distance` sunward, between two places along z, turned about the x axis.
pub fn plate(distance: f64, z: [f64; 2], turn_deg: f64) -> Vec<Corners> {
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

pub fn slit(distance: f64, width: f64, turn_deg: f64) -> Vec<Corners> {
    let half = 0.5 * width;
    let mut plates = plate(distance, [-200.0, -half], turn_deg);
    plates.extend(plate(distance, [half, 200.0], turn_deg));
    plates
}

/// A column of 32 sides.
pub fn column(foot: DVec3, radius: f64, height: f64) -> Vec<Corners> {
    let at = |i: u32| {
        let angle = TAU * f64::from(i) / 32.0;
        foot + radius * DVec3::new(angle.cos(), 0.0, angle.sin())
    };
    (0..32)
        .flat_map(|i| quad(at(i), at(i + 1) - at(i), DVec3::Y * height))
        .collect()
}

/// A quad's triangles for a fence of upright pickets.
pub fn pickets(distance: f64, period: f64, share: f64) -> Vec<Corners> {
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

/// Casters by name, and the sun's azimuth and elevation [deg].
pub fn casters() -> Vec<(String, Vec<Corners>, [f64; 2])> {
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
    scenes
}

/// Root mean square and greatest difference over the greatest light.
pub fn off(found: &[f64], truth: &[f64]) -> [f64; 2] {
    let most = truth.iter().copied().fold(1e-30, f64::max);
    let off = || found.iter().zip(truth).map(|(a, b)| (a - b).abs() / most);
    let square: f64 = off().map(|e| e * e).sum();
    [
        (square / found.len() as f64).sqrt(),
        off().fold(0.0, f64::max),
    ]
}

/// The share of a uniform disc on one side of a chord at x radii from its middle.
fn share(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

/// The mean share of the disc's light on a ray down through the fog behind the far slit.
pub fn slit_share(ray: &Ray) -> f64 {
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
}
