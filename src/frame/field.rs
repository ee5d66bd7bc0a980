//! Every intermediate and final result of a ray: the one table that effects, backends, files and measures go by.

use glam::DVec3;

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// What the ray meets.
    Surface,
    /// A share of light, 1 where nothing is lost.
    Share,
    /// A layer of the picture: light that surfaces reflect to the eye.
    Reflected,
    /// A layer of the picture: light behind everything.
    Behind,
    /// A layer of the picture: light that the air itself sends.
    Air,
}

macro_rules! fields {
    ($($(#[$doc:meta])* $field:ident, $name:literal, $part:ident;)*) => {
        /// A result: one value a ray. A new one is one line of this table.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Field {
            $($(#[$doc])* $field,)*
        }

        impl Field {
            /// All of them, in the order in which layers are listed. `field as usize` is the place in this list.
            pub const ALL: [Field; [$(Field::$field),*].len()] = [$(Field::$field),*];

            /// Its name in files, reports and shaders.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Field::$field => $name,)*
                }
            }

            /// What it holds.
            pub const fn part(self) -> Part {
                match self {
                    $(Field::$field => Part::$part,)*
                }
            }
        }
    };
}

fields! {
    /// The surface that the ray meets.
    Surface, "surface", Surface;
    /// Share of light that comes through from the ray's end to the eye [1], RGB.
    Transmittance, "transmittance", Share;
    /// Light straight from the sun reflected by surfaces [cd/m2].
    Sun, "sun", Reflected;
    /// Light straight from the sky reflected by surfaces [cd/m2].
    Sky, "sky", Reflected;
    /// Light from other surfaces reflected by surfaces [cd/m2], whatever its source.
    Indirect, "indirect", Reflected;
    /// Light straight from lamps reflected by surfaces [cd/m2].
    Lights, "lights", Reflected;
    /// Sky and disc seen directly [cd/m2].
    Background, "background", Behind;
    /// Light straight from the sun scattered by the air [cd/m2], and nothing else.
    InscatterSun, "inscatter_sun", Air;
    /// Light straight from the sky, and all that surfaces send, whatever its source, scattered by the air [cd/m2].
    InscatterSky, "inscatter_sky", Air;
    /// Light straight from lamps scattered by the air [cd/m2].
    InscatterLights, "inscatter_lights", Air;
}

impl Field {
    /// How many there are.
    pub const COUNT: usize = Field::ALL.len();

    /// Whether it is a layer: the picture is the sum of these.
    pub const fn is_layer(self) -> bool {
        matches!(self.part(), Part::Reflected | Part::Behind | Part::Air)
    }

    /// Its value where nobody wrote it: 1 for a share of light, else 0.
    pub const fn unwritten(self) -> DVec3 {
        match self.part() {
            Part::Share => DVec3::ONE,
            _ => DVec3::ZERO,
        }
    }

    /// The layers, in the order in which they are listed.
    pub fn layers() -> impl Iterator<Item = Field> {
        Field::ALL.into_iter().filter(|field| field.is_layer())
    }

    /// The field of that name.
    pub fn named(name: &str) -> Option<Field> {
        Field::ALL.into_iter().find(|field| field.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_consistent() {
        for (place, field) in Field::ALL.into_iter().enumerate() {
            assert_eq!(field as usize, place);
            assert_eq!(Field::named(field.name()), Some(field));
        }
        assert_eq!(Field::layers().count(), Field::COUNT - 2);
        assert_eq!(Field::named("glow"), None);
    }
}
