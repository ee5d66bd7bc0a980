//! Homogeneous air under a flat top, whose light has a closed form, and what is compared with it.

use super::build::layer;
use super::views::*;
use glam::{DVec2, DVec3};
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::scene::{Camera, Ray};

/// The methods that are held to exact shadows.
pub const EXACT: [Method; 2] = [Method::Rectified, Method::Epipolar];

pub const HAZY: Phase = Phase::HenyeyGreenstein { g: 0.4 };

/// A view of air under a sun of azimuth and elevation [deg], with triangles in it or with none that matters.
pub fn view(triangles: &[Corners], sun: [f64; 2], air: Medium, camera: Camera) -> StudyView {
    // A scene has something in it.
    let low = DVec3::new(0.0, -500.0, 0.0);
    let speck = [[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]];
    let triangles = if triangles.is_empty() {
        &speck
    } else {
        triangles
    };
    let mut scene = scene(triangles, sun[0], sun[1]);
    scene.media = vec![air];
    StudyView {
        name: "made in the test",
        scene,
        camera,
    }
}

/// A fence along the view, 24 m of it: pickets every `period` [m] that leave open a share of it.
pub fn fence(period: f64, share: f64) -> StudyView {
    let picket = |i: u32| {
        quad(
            DVec3::new(6.0, -20.0, 2.0 - period * f64::from(i)),
            DVec3::Y * 50.0,
            DVec3::NEG_Z * (period * (1.0 - share)),
        )
    };
    let triangles: Vec<Corners> = (0..(24.0 / period) as u32).flat_map(picket).collect();
    let camera = Camera::look_at(
        DVec3::new(0.0, 2.0, 0.0),
        DVec3::new(0.1, 2.0, -10.0),
        40f64.to_radians(),
    );
    let shape = Shape::Box {
        min: DVec3::new(-4.0, 0.0, -16.0),
        max: DVec3::new(4.0, 4.0, -2.0),
    };
    view(
        &triangles,
        [80.0, 30.0],
        fog(shape, 0.01, 0.0, HAZY),
        camera,
    )
}

/// The same without anything that casts a shadow.
pub fn open(conditions: &Conditions) -> Conditions {
    let sun = [conditions.sun_azimuth_deg(), conditions.sun_elevation_deg()];
    view(
        &[],
        sun,
        conditions.air.media[0].clone(),
        conditions.view.camera,
    )
    .conditions(conditions.view.size)
    .expect("sound")
}

pub fn rays(conditions: &Conditions) -> Vec<Ray> {
    let [w, h] = conditions.view.size;
    (0..h)
        .flat_map(|y| (0..w).map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)))
        .map(|at| conditions.view.camera.ray(at, conditions.view.size))
        .collect()
}

pub fn light(frame: &Frame) -> Vec<f64> {
    let of = |v: &DVec3| v.x;
    layer(frame, Field::InscatterSun).iter().map(of).collect()
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Relative RMSE.
pub fn apart(found: &[f64], truth: &[f64]) -> f64 {
    let square = found.iter().zip(truth).map(|(a, b)| (a - b).powi(2));
    (square.sum::<f64>() / truth.len() as f64).sqrt() / mean(truth)
}

/// The greatest relative difference.
pub fn worst(found: &[f64], truth: &[f64]) -> f64 {
    let off = found.iter().zip(truth).map(|(a, b)| (a / b - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// Homogeneous air whose flat top at `top` is where the sun comes in: light from the runs [a, b] of a ray, in closed form.
/// The depth eye to point to sun is linear along the ray.
pub struct Flat {
    pub top: f64,
    pub scattering: f64,
    pub extinction: f64,
    pub phase: Phase,
}

impl Flat {
    pub fn medium(&self, shape: Shape) -> Medium {
        fog(
            shape,
            self.scattering,
            self.extinction - self.scattering,
            self.phase,
        )
    }

    pub fn light(&self, conditions: &Conditions, ray: &Ray, runs: &[[f64; 2]]) -> f64 {
        let (w, r) = (conditions.sun.toward, ray.direction);
        let start = self.extinction * (self.top - ray.origin.y) / w.y;
        let slope = self.extinction * (1.0 - r.y / w.y);
        let source = self.scattering * self.phase.value(1.0 - r.dot(w));
        let part =
            |[a, b]: &[f64; 2]| (-start - slope * a).exp() * -(-slope * (b - a)).exp_m1() / slope;
        conditions.sun.light.illuminance.x * source * runs.iter().map(part).sum::<f64>()
    }
}
