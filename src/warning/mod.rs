//! What is said about a result that is there all the same: what was left out, is doubtful or approximate.
//!
//! A warning is a value like an [`Error`](crate::Error): the library collects them and prints none.

mod words;

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
    /// What a scene file holds and the scene does not, or shows as less than it is, with how often.
    LeftOut {
        /// The scene file.
        file: String,
        /// What it is, and how many there are.
        things: BTreeMap<String, usize>,
    },
    /// A part of a scene file that is not valid, and what is there instead.
    Mended {
        /// The file, the part, and what is wrong with it.
        problem: String,
        /// What is there instead: `left out`, `held at 1`.
        instead: String,
    },
    /// What a weather file lacks, or says that does not fit, and what is taken instead.
    Weather {
        /// The file, and what is wrong with it.
        problem: String,
        /// What is taken instead: `they are taken as dark`.
        instead: String,
        /// What the user can do.
        remedy: String,
    },
    /// A file that lies outside the folder of the scene that names it.
    OutsideFolder {
        /// The scene file.
        file: String,
        /// The file that it names.
        named: String,
    },
    /// Several cameras of one name, of which only the first can be chosen by it.
    SameCameraName {
        /// The scene file.
        file: String,
        /// Their name.
        name: String,
        /// How many they are.
        count: usize,
    },
    /// A scene in which some faces or all have no colour, and what is assumed instead.
    AssumedReflectances {
        /// The scene file.
        file: String,
        /// Triangles that are taken for floors, walls and ceilings.
        triangles: [usize; 3],
    },
    /// A scene whose size suggests that its unit is not the metre.
    OddSize {
        /// The scene file.
        file: String,
        /// How wide, high and deep most of it is [m].
        size: [f64; 3],
        /// Metres in a unit of the file, most likely.
        scale: f64,
    },
    /// A scene that looks as if its Z axis pointed up.
    OnItsSide {
        /// The scene file.
        file: String,
        /// Shares of its area that face along X, Y and Z.
        facing: [f64; 3],
    },
    /// Points that lie far from a scene, as if their unit were not the metre.
    FarPoints {
        /// How many of them, and how many there are.
        count: [usize; 2],
        /// Metres in their unit, most likely.
        scale: f64,
    },
    /// A file of materials that cannot be read; its materials are left out.
    MissingMaterials {
        /// The file that names it.
        file: String,
        /// Which file it is and why it cannot be read.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// Materials that faces name and no file of materials defines; the faces are grey.
    UnknownMaterials {
        /// The scene file.
        file: String,
        /// Their names, and the number of faces that name them.
        materials: BTreeMap<String, usize>,
    },
    /// Lines of a text that are left out, or read otherwise than they stand.
    DoubtfulLines {
        /// The file.
        file: String,
        /// Which lines.
        lines: Lines,
        /// What is wrong with all of them, and what was done about it.
        problem: String,
    },
    /// Statements of a text that are not read, with how often each occurs.
    UnreadStatements {
        /// The file.
        file: String,
        /// Their keywords, and the number of lines that begin with them.
        statements: BTreeMap<String, usize>,
    },
    /// Faces of a textured material that have no texture coordinates; they show its plain colour.
    UntexturedFaces {
        /// The scene file.
        file: String,
        /// How many.
        count: usize,
    },
    /// Files that are not where or not quite as they are named, and the ones that were taken for them.
    FoundElsewhere {
        /// The file that names them.
        file: String,
        /// How many.
        count: usize,
        /// The first of them: the name, and the file that was taken.
        first: Vec<(String, String)>,
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
    /// Materials that are glass, of which nothing is simulated but what they let through.
    Panes {
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
    /// What a photometric file says of a lamp that does not go together, or that is read otherwise than it stands.
    Photometry {
        /// The file.
        file: String,
        /// What it is.
        problem: String,
        /// What the user can do.
        remedy: String,
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
    /// A place whose latitude and longitude look swapped.
    PerhapsSwapped {
        /// The place as it is taken.
        place: String,
        /// The zone in which the other one would be.
        zone: String,
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
    /// Irradiance measured under a low sun: it sets the level of a sky whose distribution the model does not give any more.
    IrradianceOfLowSun {
        /// The sun's true elevation [degrees].
        elevation_deg: f64,
    },
    /// Irradiance measured while the sun is down.
    IrradianceWithoutSun {
        /// The sun's true elevation [degrees].
        elevation_deg: f64,
        /// The direct irradiance that is left out [W/m2].
        direct_normal: f64,
        /// Horizontal illuminance that the diffuse irradiance gives to the sky [lx].
        illuminance: f64,
        /// What a clear sky has at this height of the sun [lx].
        clear: f64,
    },
    /// A measured diffuse irradiance of 0 while the sun is low or down: less than an instrument tells apart.
    NoDiffuseIrradiance {
        /// The sun's true elevation [degrees].
        elevation_deg: f64,
    },
    /// Quantities of the sky that nothing uses, because the scene has a sun of given illuminance and no sky.
    UnusedSky {
        /// Their keys.
        keys: Vec<&'static str>,
    },
    /// What says where the sun stands, or how to find that, beside a sun that stands in for it.
    UnusedWithSun {
        /// What is given and has no effect: `time`, `pressure`.
        names: Vec<&'static str>,
    },
    /// What says where the sun stands, or what the sky is, in a scene that lamps alone light.
    UnusedWithoutSun {
        /// What is given and has no effect: `time zone`, `pressure`.
        names: Vec<&'static str>,
    },
    /// Lamps of whose light little or nothing reaches the scene.
    DarkLamps {
        /// Their names, and why.
        lamps: Vec<(String, &'static str)>,
    },
    /// Surfaces that shine too faintly to be seen beside sun and sky, and are taken as dark.
    FaintEmission {
        /// Their materials.
        materials: Vec<String>,
        /// The greatest of their luminances [cd/m2].
        brightest: f64,
        /// A typical luminance under sun and sky [cd/m2].
        beside: f64,
    },
    /// Quantities of a ground that the scene has not.
    UnusedGround {
        /// Their keys.
        keys: Vec<&'static str>,
    },
    /// Media that add nothing to any picture.
    UnusedMedia {
        /// Their numbers in the file's order, from 1 (clear air is not counted), and why.
        media: Vec<(usize, &'static str)>,
    },
    /// A picture that is darker or brighter than pictures are.
    OddExposure {
        /// What it is called: `this picture`.
        picture: String,
        /// Its exposure as it is metered [EV100]; nothing of a black one.
        ev100: Option<f64>,
        /// Whether it is too dark, or else too bright.
        is_dark: bool,
        /// What the cause may be, one at least.
        causes: Vec<String>,
    },
    /// A clearness and brightness at which the Perez model's gradation or luminance has the wrong sign.
    PerezFitBreaks,
    /// No daylight reaches any sensor of a grid.
    NoDaylight,
}

/// Lines of a text that have something in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// How many.
    pub count: usize,
    /// Numbers of the first few, from 1, ascending.
    pub first: Vec<usize>,
    /// What the first of them says, shortened.
    pub example: String,
}

impl fmt::Display for Lines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.first.iter().map(usize::to_string).collect();
        f.write_str(&numbers.join(", "))?;
        match self.count.saturating_sub(numbers.len()) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
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
            Warning::MissingMaterials { remedy, .. }
            | Warning::MissingTexture { remedy, .. }
            | Warning::Weather { remedy, .. }
            | Warning::Photometry { remedy, .. } => (!remedy.is_empty()).then_some(remedy),
            Warning::UnknownMaterials { .. } => {
                Some("define them in an MTL file that a `mtllib` of the OBJ file names")
            }
            Warning::DoubtfulLines { .. } => Some("repair the lines, or export the file again"),
            Warning::UnreadStatements { .. } => Some("export the surfaces as polygons"),
            Warning::UntexturedFaces { .. } => {
                Some("give the faces texture coordinates, or a material without a texture")
            }
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
            Warning::PerhapsSwapped { .. } => Some("write the latitude first, then the longitude"),
            Warning::Mended { .. } => {
                Some("correct it in the program that made the file, and export again")
            }
            Warning::OutsideFolder { .. } => {
                Some("render scenes of strangers only where nothing private can be read")
            }
            Warning::SameCameraName { .. } => {
                Some("give each its own name in the program that made the file")
            }
            Warning::AssumedReflectances { .. } => Some(
                "give each material or object a [[material]] with its reflectance in a scene file",
            ),
            Warning::OddSize { .. } => {
                Some("give --scale with the metres in a unit, or --scale 1 if it is right")
            }
            Warning::OnItsSide { .. } => Some("give --up z, or --up y if it is right"),
            Warning::FarPoints { .. } => Some("give x, y and z in metres, in the scene's axes"),
            Warning::PreethamLuminance => Some("use perez or hosek where luminance matters"),
            Warning::OutsidePerezData { .. } => Some(
                "check both irradiances: W/m2, the direct one on a plane that faces the sun, the diffuse one on the horizontal",
            ),
            Warning::IrradianceOfLowSun { .. } => None,
            Warning::IrradianceWithoutSun { .. } => Some(
                "check place and time, or leave both irradiances out for the twilight's own level",
            ),
            Warning::NoDiffuseIrradiance { .. } => {
                Some("give what was measured, or leave both irradiances out")
            }
            Warning::UnusedSky { .. } => {
                Some("name a sky (--sky perez, or model in [sky]), or leave them out")
            }
            Warning::UnusedWithSun { .. } => Some(
                "leave them out, or leave out the sun ([sun], --sun) for that of place and time",
            ),
            Warning::UnusedWithoutSun { .. } => Some(
                "leave them out, or give the scene a place and a time (--at, --time) or a sun (--sun)",
            ),
            Warning::DarkLamps { .. } => Some(
                "give it an intensity, put it where its light gets out, or name its housing in `ignore`",
            ),
            Warning::FaintEmission { .. } => Some(
                "emission is in cd/m2: give a lamp or a screen its luminance by KHR_materials_emissive_strength or Ke, some hundreds or more",
            ),
            Warning::UnusedGround { .. } => {
                Some("leave them out, or let the ground be there (enabled = true)")
            }
            Warning::UnusedMedia { .. } => {
                Some("leave them out, or give a coefficient above 0 and a place above the ground")
            }
            Warning::OddExposure { is_dark: true, .. } => Some(
                "take another --time, another eye (--camera inside finds one), or a lamp; --exposure EV shows what there is",
            ),
            Warning::OddExposure { .. } => {
                Some("check the unit (lx, cd/m2), or give --exposure EV")
            }
            Warning::PerezFitBreaks => Some("compare with another model, such as hosek or cie:N"),
            Warning::NoDaylight => Some(
                "make the windows' material glass by a [[pane]] in a scene file, or leave holes in the walls",
            ),
            Warning::WhollySeeThrough { .. } => {
                Some("give the material an alpha above 0 if it should be seen")
            }
            Warning::PartlySeeThrough { .. } => {
                Some("take more samples: one shows a pane, or what is behind it")
            }
            Warning::GradualAlpha { .. } => {
                Some("give the material one alpha, or alphaMode MASK with the cutoff that is meant")
            }
            Warning::IgnoredMaterialProperties { .. }
            | Warning::LeftOut { .. }
            | Warning::Panes { .. }
            | Warning::DegenerateTriangles { .. }
            | Warning::FoundElsewhere { .. } => None,
        }
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
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
