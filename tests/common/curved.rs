//! Media with borders that are not flat, and rays through them.

use glam::{DQuat, DVec2, DVec3, dvec3};
use tyndall::beam::Beam;
use tyndall::medium::{Edge, Medium, Phase, Shape, Wave};
use tyndall::units::DEG;

pub const HAZY: Phase = Phase::HenyeyGreenstein { g: 0.5 };

/// A medium of grey coefficients [1/m].
pub fn fog(shape: Shape, scattering: f64, absorption: f64, phase: Phase) -> Medium {
    Medium {
        shape,
        scattering: DVec3::splat(scattering),
        absorption: DVec3::splat(absorption),
        phase,
    }
}

pub fn layer_of(top: f64, waves: Vec<Wave>, bottom: Option<f64>) -> Shape {
    Shape::Layer {
        top,
        waves,
        bottom,
        far: 1e5,
    }
}

pub fn waves() -> Vec<Wave> {
    vec![
        Wave::new(0.18, 3.1, 20.0 * DEG, 0.3),
        Wave::new(0.1, 1.7, -65.0 * DEG, 2.0),
        Wave::new(0.05, 0.6, 130.0 * DEG, 4.0),
    ]
}

pub fn turned(edge: Edge) -> Shape {
    Shape::Ellipsoid {
        center: dvec3(0.4, 1.2, -0.3),
        radii: dvec3(2.0, 0.5, 1.1),
        rotation: DQuat::from_rotation_z(0.4)
            * DQuat::from_rotation_y(1.1)
            * DQuat::from_rotation_x(-0.7),
        edge,
    }
}

/// What a shape is said to be.
pub fn density(shape: &Shape, p: DVec3) -> f64 {
    let inside = |is: bool| if is { 1.0 } else { 0.0 };
    match shape {
        Shape::Layer {
            top, waves, bottom, ..
        } => {
            let wave =
                |w: &Wave| w.amplitude * (w.vector.dot(DVec2::new(p.x, p.z)) + w.phase).sin();
            let boundary = top + waves.iter().map(wave).sum::<f64>();
            inside(p.y <= boundary && bottom.is_none_or(|bottom| p.y >= bottom))
        }
        Shape::Ellipsoid {
            center,
            radii,
            rotation,
            edge,
        } => {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| *rotation * axis);
            let own = dvec3(
                (p - *center).dot(axes[0]) / radii.x,
                (p - *center).dot(axes[1]) / radii.y,
                (p - *center).dot(axes[2]) / radii.z,
            );
            match edge {
                Edge::Sharp => inside(own.length() <= 1.0),
                Edge::Soft => (1.0 - own.length_squared()).max(0.0),
            }
        }
        Shape::Box { min, max } => inside(p.cmpge(*min).all() && p.cmple(*max).all()),
        _ => panic!("not among these"),
    }
}

/// Rays all over, among them level ones and steep ones.
pub fn rays() -> Vec<(DVec3, DVec3)> {
    let mut rays: Vec<(DVec3, DVec3)> = (0..60)
        .map(|i| {
            let part = |a: f64| (0.5 + a * f64::from(i + 1)).fract() * 2.0 - 1.0;
            let origin = dvec3(
                4.0 * part(0.819),
                1.1 + 1.5 * part(0.671),
                4.0 * part(0.549),
            );
            let direction = dvec3(part(0.755), 0.4 * part(0.569), part(0.348));
            (origin, direction.normalize())
        })
        .collect();
    for height in [0.8, 0.95, 1.1, 1.3, 1.42] {
        rays.push((dvec3(-6.0, height, 0.3), DVec3::X));
        rays.push((dvec3(-6.0, height, 0.3), dvec3(0.8, 1e-4, 0.6).normalize()));
    }
    rays.push((dvec3(0.2, 3.0, 0.1), DVec3::NEG_Y));
    rays.push((dvec3(0.2, -3.0, 0.1), DVec3::Y));
    rays
}

pub fn sun(elevation_deg: f64) -> Beam {
    let (sin, cos) = (elevation_deg * DEG).sin_cos();
    Beam::parallel(dvec3(0.8 * cos, sin, -0.6 * cos), DVec3::ONE)
}
