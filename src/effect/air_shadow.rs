//! What geometry shadows in the clear air is missing from the sky behind it.
//!
//! The sky's radiance holds the sunlight that the clear air scatters along the whole of a ray. Where mountains or clouds of
//! leaves keep the sun from a part of it, that part sends nothing: on rays that meet nothing
//!
//! L = T B (1 - S / max(T B, W)), channel by channel,
//!
//! B the background (sky and disc), T what the other media let through of it ([`super::compose`] multiplies by it), S the integral
//! of the clear air's scattering over the dark runs, W that over the whole ray, both up to the air's `far` and as they reach the
//! eye. S never exceeds W, so L is never negative, and it is continuous in all of them. Where the sky is at least as bright as
//! single scattering makes the air (T B >= W), exactly S is taken; where it is darker, the same share S / W of it. Sunlight that
//! is scattered more than once gets into shadows all the same: it is part of T B - W.

use super::{
    Contribution, Decision, Effect, Field, Knob, Number, Over, Pass, Product, Resource, When,
    sun_beams,
};
use crate::colour::luminance;
use crate::conditions::Input;
use crate::medium::{Air, Medium, Scattering};
use glam::DVec3;
use std::f64::consts::PI;

/// Shadows in the clear air before the sky.
pub const AIR_SHADOW: Effect = Effect {
    name: "air_shadow",
    summary: "light that the sky lacks where geometry shadows the clear air",
    reads: &[Field::Surface, Field::Background],
    alters: &[Field::Background],
    knobs: &[
        Knob {
            name: "suns",
            meaning: "points of the sun's disc (one where no penumbra is as wide as a pixel), dark runs for each",
            values: [1.0, 1.0, 4.0, 16.0],
            range: [1.0, 4096.0],
        },
        Knob {
            name: "steps",
            meaning: "steps along each ray on a GPU (the reference knows none)",
            values: [32.0, 96.0, 256.0, 1024.0],
            range: [1.0, 65536.0],
        },
    ],
    decide: |conditions| {
        let media = &conditions.air.media;
        if !media.iter().any(Medium::is_clear_air) {
            return Decision::nothing("the scene has no air of its own");
        }
        let Some(sky) = &conditions.sky else {
            return Decision::nothing("there is no sky from which anything could be missing");
        };
        if let Some(reason) = conditions.sun.missing() {
            return Decision::nothing(reason);
        }
        Decision::run(
            "the scene stands in the clear air and shadows some of it",
            Contribution::Estimate(0.1 * luminance(sky.horizontal_illuminance()) / PI),
        )
    },
    reference: |conditions, settings, _| {
        let beams = sun_beams(conditions, settings);
        let air = conditions.air.with_sources(Medium::is_clear_air);
        let before_sky = conditions.air.before_sky();
        let far = far(&air);
        Ok(Box::new(move |fields| {
            let mut shades = Vec::new();
            fields.update(Field::Background, |ray, _, surface, present| {
                if surface.is_met() || present == DVec3::ZERO {
                    return present;
                }
                conditions.geometry.shades(ray, far, &beams, &mut shades);
                let (mut shadow, mut whole) = (DVec3::ZERO, DVec3::ZERO);
                for (beam, shade) in beams.iter().zip(&shades) {
                    let (origin, direction) = (ray.origin, ray.direction);
                    let scattering = Scattering::new(&air, origin, direction, far, beam);
                    whole += beam.strength() * scattering.integrate(0.0, far);
                    for ([from, to], missing) in shade.missing(far) {
                        shadow += missing * beam.strength() * scattering.integrate(from, to);
                    }
                }
                let end = before_sky.end(ray.origin, ray.direction);
                let depth = before_sky.optical_depth(ray.origin, ray.direction, end);
                present * left((-depth).exp() * present, shadow, whole)
            });
        }))
    },
    passes: &[
        Pass {
            shader: SHADER,
            entry: "gather",
            over: Over::Pixels,
            when: When::EachBeam(sun_beams),
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Make(&SHADOWED),
                Resource::Make(&WHOLE),
                Resource::Read(Field::Background),
                Resource::Knobs(|conditions, settings| {
                    vec![
                        ("steps", Number::Count(settings.get("steps") as u32)),
                        ("far", Number::float(far(&conditions.air))),
                    ]
                }),
            ],
        },
        Pass {
            shader: SHADER,
            entry: "take",
            over: Over::Pixels,
            when: When::Tile,
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Use(&SHADOWED),
                Resource::Use(&WHOLE),
                Resource::Update(Field::Background),
            ],
        },
    ],
    ..Effect::NOTHING
};

const SHADER: &str = include_str!("../../shaders/air_shadow.wgsl");

/// A sum over beams, one value a pixel.
const fn sum(name: &'static str) -> Product {
    Product {
        name,
        wgsl: "array<vec4f>",
        bytes: |extent| 16 * extent.pixels,
        reads: &[
            Input::Geometry,
            Input::Media,
            Input::Sun,
            Input::View,
            Input::Tile,
        ],
        zeroed: true,
    }
}

/// Sunlight that the clear air before the sky would scatter where geometry shadows it [cd/m2].
const SHADOWED: Product = sum("shadowed");

/// Sunlight that the clear air before the sky would scatter without shadows [cd/m2].
const WHOLE: Product = sum("whole");

/// Distance up to which shadows in the clear air are seen before the sky [m].
fn far(air: &Air) -> f64 {
    let clear = air.media.iter().filter(|medium| medium.is_clear_air());
    let clear = Air {
        media: clear.cloned().collect(),
        ground: air.ground,
    };
    clear.end(DVec3::ZERO, DVec3::X)
}

/// The share of the sky's light that is left, 0 to 1: of `seen` from the sky, without `shadow`, of which `whole` would be there
/// if nothing stood in the sun.
fn left(seen: DVec3, shadow: DVec3, whole: DVec3) -> DVec3 {
    let channel = |i: usize| match seen[i].max(whole[i]) {
        0.0 => 1.0,
        // Rounding may leave a sum of dark runs a digit above the whole.
        most => 1.0 - shadow[i].min(whole[i]) / most,
    };
    DVec3::new(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_bounded_and_continuous() {
        let one =
            |b: f64, s: f64, w: f64| b * left(DVec3::splat(b), DVec3::splat(s), DVec3::splat(w)).x;
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(one(10.0, 2.0, 5.0), 8.0));
        assert!(close(one(10.0, 0.0, 50.0), 10.0));
        assert!(close(one(10.0, 50.0, 50.0), 0.0));
        assert!(close(one(10.0, 25.0, 50.0), 5.0));
        assert_eq!(one(0.0, 1.0, 2.0), 0.0);
        assert_eq!(one(3.0, 0.0, 0.0), 3.0);
        let mut last = one(0.0, 3.0, 4.0);
        for i in 1..=1000 {
            let next = one(0.01 * f64::from(i), 3.0, 4.0);
            assert!(next >= 0.0 && (next - last).abs() < 0.0101, "{i}");
            last = next;
        }
    }
}
