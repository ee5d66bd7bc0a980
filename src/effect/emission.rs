//! Surfaces that shine, as the eye sees them.
//!
//! L is the luminance of the material, texel by texel, on the side on which it shines; what the surface reflects is added by other
//! effects, and air between takes its part as of any surface ([`super::compose`]). Their light on other surfaces and in the air is that of
//! lamps ([`super::surface_lamps`], [`super::air_lamps`]).

use super::{Contribution, Decision, Effect, Field, Source};
use crate::colour::Space;
use crate::conditions::Conditions;
use crate::scene::{Emission, Ray};
use glam::DVec3;
use std::collections::BTreeMap;

/// Surfaces that shine.
pub const EMISSION: Effect = Effect {
    name: "emission",
    summary: "surfaces that shine, seen directly",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |conditions| {
        if conditions.scene.emissions.is_empty() {
            return Decision::nothing("no material shines");
        }
        if conditions.view.points().is_some() {
            return Decision::nothing("points receive light, they see no surface");
        }
        let most = conditions
            .lamps
            .iter()
            .filter_map(|lamp| lamp.glow())
            .fold(0.0, f64::max);
        match (most, shining(conditions).len()) {
            (0.0, _) => Decision::nothing("no surface shines brightly enough to be seen"),
            (_, count) => Decision::run(
                format!("{count} material{}", if count == 1 { "" } else { "s" }),
                Contribution::Bound(most),
            ),
        }
    },
    reference: |conditions, _, _| {
        let to_working = Space::Rec709.to_working();
        let shining = shining(conditions);
        Ok(Box::new(move |fields| {
            fields.update(Field::Lights, |ray, _, surface, present| {
                let Source::Triangle(triangle, weights) = surface.source else {
                    return present;
                };
                let material = conditions.scene.mesh.triangles[triangle as usize].material;
                match shining.get(&material) {
                    Some(emission)
                        if emission.both_sides || is_front(conditions, triangle, ray) =>
                    {
                        let luminance = conditions.scene.emission(triangle, weights);
                        present + (to_working * luminance).max(DVec3::ZERO)
                    }
                    _ => present,
                }
            });
        }))
    },
    ..Effect::NOTHING
};

/// The materials that shine, but for those that sun and sky outshine.
fn shining(conditions: &Conditions) -> BTreeMap<u32, &Emission> {
    let lamps = &conditions.lamps;
    let is_lamp = |material: u32| lamps.iter().any(|lamp| lamp.material() == Some(material));
    let all = conditions.scene.emissions.iter();
    all.filter(|(material, _)| is_lamp(**material))
        .map(|(material, emission)| (*material, emission))
        .collect()
}

/// Whether a ray meets the front of a triangle.
fn is_front(conditions: &Conditions, triangle: u32, ray: &Ray) -> bool {
    let mesh = &conditions.scene.mesh;
    let [a, b, c] = mesh.triangles[triangle as usize]
        .vertices
        .map(|v| mesh.positions[v as usize]);
    (b - a).cross(c - a).dot(ray.direction) < 0.0
}
