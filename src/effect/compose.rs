//! What reaches the eye: light from surfaces and from the background passes the air on its way.
//!
//! L = tau (L_sun + L_sky + L_indirect + L_lights + L_background) + L_inscatter. The air's own layers hold their attenuation already.

use super::{Contribution, Decision, Effect, Field, Over, Pass, Resource, When};

const ATTENUATED: &[Field] = &[
    Field::Sun,
    Field::Sky,
    Field::Indirect,
    Field::Lights,
    Field::Background,
];

/// Light through the air to the eye.
pub const COMPOSE: Effect = Effect {
    name: "compose",
    summary: "light of surfaces and background through the air to the eye",
    reads: &[Field::Transmittance],
    alters: ATTENUATED,
    decide: |_| Decision::run("light passes the air", Contribution::Everything),
    reference: |_, _, _| {
        Ok(Box::new(|fields| {
            for layer in ATTENUATED {
                fields.multiply(*layer, Field::Transmittance);
            }
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/compose.wgsl"),
        entry: "attenuate",
        over: Over::Fields(ATTENUATED),
        when: When::Tile,
        uses: &[Resource::Each, Resource::Read(Field::Transmittance)],
    }],
    ..Effect::NOTHING
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Part;

    #[test]
    fn all_that_comes_from_behind_the_air_passes_it() {
        let behind = Field::layers().filter(|field| field.part() != Part::Air);
        assert!(behind.eq(ATTENUATED.iter().copied()));
    }
}
