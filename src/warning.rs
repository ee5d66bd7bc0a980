//! What is said about a result that is there all the same: what was left out, is doubtful or approximate.
//!
//! A warning is a value like an [`Error`](crate::Error): the library collects them and prints none.

use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// What was left out, is doubtful or approximate, and what to do about it.
///
/// [`Display`](fmt::Display) gives the message, one sentence without the advice; so does serialization.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Properties of materials that the renderer has no use for, with how often each occurs.
    IgnoredMaterialProperties {
        /// The scene file.
        file: String,
        /// Names of the properties, and the number of materials that have them.
        properties: BTreeMap<String, usize>,
    },
    /// A file of materials that cannot be read; its materials are left out.
    MissingMaterials {
        /// The file that names it.
        file: String,
        /// Which file it is and why it cannot be read.
        problem: String,
    },
    /// A texture that cannot be read; the material is left with its plain colour.
    MissingTexture {
        /// The file that names it and where, which picture it is, and why it cannot be read.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// A texture whose picture is in formats that are not read; the material is left with its plain colour.
    UnsupportedTextureFormat {
        /// The file that names it, and where.
        place: String,
        /// The glTF extensions that hold its picture; none where it names no picture at all.
        extensions: Vec<String>,
    },
    /// Triangles without an area, which are left out.
    DegenerateTriangles {
        /// The scene file.
        file: String,
        /// How many.
        count: usize,
    },
    /// Materials of opacity 0 everywhere, whose triangles are not there.
    WhollySeeThrough {
        /// The materials, and how many triangles have each.
        materials: Vec<(String, usize)>,
    },
    /// Materials that let a part of the light through.
    PartlySeeThrough {
        /// The materials.
        materials: Vec<String>,
    },
    /// Materials that fade from there to not there: an edge at half takes the place of the gradient.
    GradualAlpha {
        /// The materials.
        materials: Vec<String>,
    },
    /// Normals, texture coordinates and colours of vertices that are not finite or out of range.
    InvalidVertexAttributes {
        /// The scene file.
        file: String,
        /// How many.
        count: usize,
    },
    /// Lights of the scene file, which the renderer does not use.
    UnusedLights {
        /// The lights, in the file's order.
        lights: Vec<UnusedLight>,
    },
    /// A clock more than three hours from the sun's at the site.
    ClockFarFromSun {
        /// The clock's offset from UTC, say `+02:00`.
        offset: String,
        /// How far it is from mean solar time [h], positive.
        hours: f64,
        /// The site's longitude [degrees], east positive.
        longitude_deg: f64,
    },
    /// The Preetham model, whose luminance is known to be wrong.
    PreethamLuminance,
    /// Irradiances outside the data to which the Perez model was fitted; the nearest that are inside are taken.
    OutsidePerezData {
        /// Sky clearness that is taken [1].
        clearness: f64,
        /// Sky brightness that is taken [1].
        brightness: f64,
    },
    /// A clearness and brightness at which the Perez model's gradation or luminance has the wrong sign.
    PerezFitBreaks,
}

/// A light of a scene file that is not used.
#[derive(Debug, Clone, PartialEq)]
pub struct UnusedLight {
    /// Its name.
    pub name: String,
    /// `directional`, `point` or `spot`.
    pub kind: &'static str,
    /// The greatest of its colour's channels, in `unit`.
    pub intensity: f64,
    /// `lx` for a directional light, `cd` for the others.
    pub unit: &'static str,
}

impl Warning {
    /// What was left out, is doubtful or approximate: one sentence, without the advice.
    pub fn message(&self) -> String {
        self.to_string()
    }

    /// What the user can do about it, if there is anything to do.
    pub fn advice(&self) -> Option<&str> {
        match self {
            Warning::MissingMaterials { .. } => {
                Some("put the MTL file where the OBJ file names it")
            }
            Warning::MissingTexture { remedy, .. } => (!remedy.is_empty()).then_some(remedy),
            Warning::UnsupportedTextureFormat { .. } => {
                Some("export the scene with PNG or JPEG textures")
            }
            Warning::InvalidVertexAttributes { .. } => {
                Some("export the file again, or leave out the attribute")
            }
            Warning::UnusedLights { .. } => {
                Some("only sun and sky give light: write a directional light as --sun AZ,EL")
            }
            Warning::ClockFarFromSun { .. } => {
                Some("check the sign of the longitude, and the offset from UTC or the zone")
            }
            Warning::PreethamLuminance => Some("use perez or hosek where luminance matters"),
            Warning::OutsidePerezData { .. } => Some(
                "check both irradiances: W/m2, the direct one on a plane that faces the sun, the diffuse one on the horizontal",
            ),
            Warning::PerezFitBreaks => Some("compare with another model, such as hosek or cie:N"),
            Warning::WhollySeeThrough { .. } => {
                Some("give the material an alpha above 0 if it should be seen")
            }
            Warning::PartlySeeThrough { .. } => {
                Some("take more samples: one shows a pane, or what is behind it")
            }
            Warning::GradualAlpha { .. } => {
                Some("give the material one alpha, or alphaMode MASK with the cutoff that is meant")
            }
            Warning::IgnoredMaterialProperties { .. } | Warning::DegenerateTriangles { .. } => None,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::IgnoredMaterialProperties { file, properties } => {
                let list: Vec<String> = properties
                    .iter()
                    .map(|(what, n)| format!("{what} ({n})"))
                    .collect();
                write!(
                    f,
                    "{file}: surfaces are Lambertian with their base colour; left out, with how often: {}",
                    list.join(", ")
                )
            }
            Warning::MissingMaterials { file, problem } => {
                write!(f, "{file}: {problem}; its materials left out")
            }
            Warning::MissingTexture { problem, .. } => write!(f, "{problem}; texture left out"),
            Warning::UnsupportedTextureFormat { place, extensions } => write!(
                f,
                "{place}: left out, its picture is in a format that is not read ({})",
                if extensions.is_empty() {
                    "no source".to_owned()
                } else {
                    extensions.join(", ")
                }
            ),
            Warning::DegenerateTriangles { file, count } => write!(
                f,
                "{file}: {} without an area left out",
                counted(*count, "triangle")
            ),
            Warning::WhollySeeThrough { materials } => {
                let list: Vec<String> = materials
                    .iter()
                    .map(|(name, count)| {
                        let (count, are) = (counted(*count, "triangle"), are(*count));
                        format!("`{name}` (its {count} {are} not there)")
                    })
                    .collect();
                write!(f, "wholly see-through: {}", listed(&list))
            }
            Warning::PartlySeeThrough { materials } => write!(
                f,
                "these let a part of the light through, straight on and uncoloured, and a GPU leaves sunlight to the CPU for them (exact, and slower): {}",
                quoted(materials)
            ),
            Warning::GradualAlpha { materials } => write!(
                f,
                "alpha that fades is cut at half of its greatest: {}",
                quoted(materials)
            ),
            Warning::InvalidVertexAttributes { file, count } => write!(
                f,
                "{file}: {} (normal, texture coordinate or colour) not finite or out of range; taken as absent, or colours as the nearest valid one",
                counted(*count, "vertex attribute")
            ),
            Warning::UnusedLights { lights } => {
                let list: Vec<String> = lights
                    .iter()
                    .map(|l| format!("`{}` ({}, {:.0} {})", l.name, l.kind, l.intensity, l.unit))
                    .collect();
                write!(
                    f,
                    "lights of the file that are not used: {}",
                    list.join(", ")
                )
            }
            Warning::ClockFarFromSun {
                offset,
                hours,
                longitude_deg,
            } => write!(
                f,
                "the clock ({offset}) is {hours:.1} hours off the sun's at longitude {longitude_deg:.3}"
            ),
            Warning::PreethamLuminance => f.write_str(
                "the Preetham sky's luminance is 1.5 to 2.8 times too high by day; its colours are usable",
            ),
            Warning::OutsidePerezData {
                clearness,
                brightness,
            } => write!(
                f,
                "these irradiances are outside the Perez model's data: held at clearness {clearness:.3}, brightness {brightness:.3}"
            ),
            Warning::PerezFitBreaks => f.write_str(
                "the Perez fit breaks at this clearness and brightness (b > 0 or negative luminance): b is held at 0, luminance at 0 and above",
            ),
        }
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The first of a list, and how many more there are.
fn listed(items: &[String]) -> String {
    const MOST: usize = 8;
    let shown = items[..items.len().min(MOST)].join(", ");
    match items.len().saturating_sub(MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Names in backquotes.
fn quoted(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    listed(&quoted)
}

/// What many or one do.
fn are(n: usize) -> &'static str {
    if n == 1 { "is" } else { "are" }
}

/// `1 triangle`, `2 triangles`.
fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_and_advice_are_sentences_of_their_own() {
        let one = Warning::DegenerateTriangles {
            file: "a.obj".into(),
            count: 1,
        };
        assert_eq!(one.message(), "a.obj: 1 triangle without an area left out");
        assert_eq!(one.advice(), None);
        let json = serde_json::to_value(&one).expect("it is a string");
        assert_eq!(json, one.message());
        let gone = |remedy: &str| Warning::MissingTexture {
            problem: "a.obj: cannot read b.png: no such file".into(),
            remedy: remedy.into(),
        };
        assert_eq!(
            gone("").message(),
            "a.obj: cannot read b.png: no such file; texture left out"
        );
        assert_eq!(gone("").advice(), None);
        assert_eq!(gone("put it there").advice(), Some("put it there"));
    }
}
