//! Lamps that the eye sees: rectangles and spheres. Points and lines have no width; surfaces that shine are [`super::emission`]'s.
//!
//! A sphere of radius r is as bright all over: L = I(direction) / (pi r^2). A rectangle of area A has L = I(direction) / (A cos(theta)) on the
//! side on which it shines; cos(theta) counts as no less than a thousandth, at which it is seen edge on. Air takes of it what lies between
//! lamp and eye. It hides nothing behind it: what shines so is bright beside it.

use super::surface_lamps::NO_LAMPS;
use super::{Contribution, Decision, Effect, Field};
use crate::colour::luminance;
use crate::conditions::Lamp;
use crate::scene::{LampForm, Ray};
use glam::DVec3;
use std::f64::consts::PI;

/// A rectangle that is seen at less than this is seen edge on.
const EDGE_ON: f64 = 1e-3;

/// Lamps that the eye sees.
pub const LAMP_FACES: Effect = Effect {
    name: "lamp_faces",
    summary: "lamps with a face, seen directly",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |conditions| {
        if conditions.lamps.is_empty() {
            return Decision::nothing(NO_LAMPS);
        }
        if conditions.view.points().is_some() {
            return Decision::nothing("points receive light, they see no lamp");
        }
        let faces = conditions.lamps.iter().filter_map(brightest);
        let (count, most) = faces.fold((0, 0.0f64), |(n, most), face| (n + 1, most.max(face)));
        if count == 0 {
            return Decision::nothing("no lamp has a face");
        }
        Decision::run(format!("{count} with a face"), Contribution::Bound(most))
    },
    reference: |conditions, _, _| {
        Ok(Box::new(move |fields| {
            fields.update(Field::Lights, |ray, _, surface, present| {
                let seen = conditions.lamps.iter().filter_map(|lamp| face(lamp, ray));
                let before = seen.filter(|(distance, _)| *distance < surface.distance);
                let Some((distance, light)) = before.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                    return present;
                };
                let depth = conditions
                    .air
                    .optical_depth(ray.origin, ray.direction, distance);
                let sighted = conditions.geometry.sighted(ray, distance);
                present + sighted.from(distance) * light * (-depth).exp()
            });
        }))
    },
    ..Effect::NOTHING
};

/// The greatest luminance of a lamp's face [cd/m2], if it has one.
fn brightest(lamp: &Lamp) -> Option<f64> {
    let intensity = lamp.greatest_intensity();
    match lamp.form {
        LampForm::Point | LampForm::Line { .. } | LampForm::Faces { .. } => None,
        LampForm::Sphere { radius } => Some(intensity / (PI * radius * radius)),
        LampForm::Rectangle { edges: [a, b] } => Some(intensity / (EDGE_ON * a.cross(b).length())),
    }
}

/// Where a ray meets a lamp's face [m], and its light there [cd/m2, RGB].
fn face(lamp: &Lamp, ray: &Ray) -> Option<(f64, DVec3)> {
    let strength = lamp.distribution.intensity(&lamp.pose, -ray.direction) * lamp.intensity;
    if luminance(strength) <= 0.0 {
        return None;
    }
    match lamp.form {
        LampForm::Point | LampForm::Line { .. } | LampForm::Faces { .. } => None,
        LampForm::Sphere { radius } => {
            let foot = (lamp.position - ray.origin).dot(ray.direction);
            let inside = radius * radius - ray.at(foot).distance_squared(lamp.position);
            let distance = foot - inside.max(0.0).sqrt();
            (inside >= 0.0 && distance > 0.0)
                .then_some((distance, strength / (PI * radius * radius)))
        }
        LampForm::Rectangle { edges: [a, b] } => {
            let across = a.cross(b);
            let area = across.length();
            let normal = across / area * across.dot(lamp.pose.toward).signum();
            let cosine = -normal.dot(ray.direction);
            if cosine <= 0.0 {
                return None;
            }
            let distance = (ray.origin - lamp.position).dot(normal) / cosine;
            let at = ray.at(distance) - lamp.position;
            // Coordinates along the edges, which need not be at right angles.
            let square = area * area;
            let u = at.cross(b).dot(across) / square;
            let v = a.cross(at).dot(across) / square;
            let is_met = distance > 0.0 && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
            is_met.then_some((distance, strength / (area * cosine.max(EDGE_ON))))
        }
    }
}
