//! Lamps of a scene file: the table `[[light]]`, and what is read from it.

use super::NamedNode;
use super::files::{SceneFiles, file_of};
use crate::error::{Error, Result};
use crate::photometry::{self, Distribution, Tilt};
use crate::units::DEG;
use crate::warning::Warning;
use glam::{DAffine3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::Path;

/// A lamp, as the user wrote it.
#[derive(Debug, Clone, PartialEq)]
pub struct LampEntry {
    /// Its name, or `light N`.
    pub name: String,
    /// Where it is, or one end, or one corner [m].
    pub position: DVec3,
    /// Its axis, along which theta is 0; of any length above 0.
    pub toward: DVec3,
    /// Where phi is 0: the part of this across the axis. Absent: +X, or -Z for an axis along X.
    pub around: Option<DVec3>,
    /// Luminous intensity of the whole lamp along its axis [cd], linear Rec. 709; of a table a factor [1].
    pub intensity: DVec3,
    /// How intensity goes by direction.
    pub distribution: Distribution,
    /// A point, or what has an extent.
    pub form: LampForm,
    /// The material that does not shade it.
    pub ignore: Option<String>,
}

/// What a lamp's light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampForm {
    /// A point.
    Point,
    /// A line to another end [m].
    Line {
        /// The other end.
        to: DVec3,
    },
    /// A rectangle or a parallelogram that shines on the side of the axis, with a corner at the lamp's position.
    Rectangle {
        /// From that corner to those beside it [m].
        edges: [DVec3; 2],
    },
    /// A sphere around the lamp's position.
    Sphere {
        /// Its radius [m].
        radius: f64,
    },
    /// Surfaces of the scene that shine, within a ball around the lamp's position: made of materials, not written in a file.
    Faces {
        /// The ball's radius [m].
        radius: f64,
    },
}

/// A lamp: a point, a line, a rectangle or a sphere.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    /// Its name; `light N` when absent.
    name: Option<String>,
    /// Where it is [m]: of a line one end, of a rectangle one corner, of a sphere the middle.
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    position: Option<[f64; 3]>,
    /// Its axis, along which theta is 0; of any length. Straight down when absent.
    toward: Option<[f64; 3]>,
    /// Where phi is 0: the part of this across the axis. +X when absent, -Z for an axis along X.
    around: Option<[f64; 3]>,
    /// Luminous intensity of the whole lamp along its axis [cd], a number or linear Rec. 709; for a file a factor, 1 when absent.
    intensity: Option<Intensity>,
    /// How intensity goes by direction; the same in all directions when absent.
    distribution: Option<DistributionTable>,
    /// The other end of a line [m].
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    to: Option<[f64; 3]>,
    /// From the corner of a rectangle to those beside it [m]; it shines on the side of the axis.
    edges: Option<[[f64; 3]; 2]>,
    /// Of a sphere [m].
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
    radius: Option<f64>,
    /// A material that does not shade this lamp: its own housing.
    ignore: Option<String>,
    /// A node of the mesh that says where the lamp is, instead of `position`, `toward` and `around`: the axis is the node's -Z, phi is 0
    /// at its +X. One with instances, and several of that name, are as many lamps.
    node: Option<String>,
}

/// A luminous intensity [cd], the same for all colours or linear Rec. 709.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(untagged)]
enum Intensity {
    Gray(#[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "cd"))] f64),
    Rgb(#[schemars(inner(range(min = 0.0, max = 1e12)))] [f64; 3]),
}

/// How luminous intensity goes by direction.
#[derive(Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
enum DistributionTable {
    /// The same in all directions.
    Isotropic {},
    /// A spotlight (Nishita et al. 1987, equation 7).
    NishitaSpot {
        /// Half angle of the cone outside which there is nothing [degrees].
        #[schemars(range(min = 0.0, max = 180.0), extend("x-unit" = "degrees"))]
        spread: f64,
        /// Exponent q: small for a beam with a hard edge.
        #[schemars(range(min = 0.0, max = 1e3))]
        sharpness: f64,
    },
    /// A spotlight with petals (equations 8 and 9).
    Daisy {
        /// Half angle of the cone outside which there is nothing [degrees].
        #[schemars(range(min = 0.0, max = 180.0), extend("x-unit" = "degrees"))]
        spread: f64,
        /// Exponent q.
        #[schemars(range(min = 0.0, max = 1e3))]
        sharpness: f64,
        /// How many there are around the axis.
        #[schemars(range(min = 1, max = 1000))]
        petals: u32,
        /// Ratio p of the pattern.
        #[schemars(range(min = -1.0, max = 1.0))]
        ratio: f64,
    },
    /// A spotlight with dots (equation 10).
    PolkaDots {
        /// Half angle of the cone outside which there is nothing [degrees].
        #[schemars(range(min = 0.0, max = 180.0), extend("x-unit" = "degrees"))]
        spread: f64,
        /// Exponent q.
        #[schemars(range(min = 0.0, max = 1e3))]
        sharpness: f64,
        /// Dots around the axis, an even number.
        #[schemars(range(min = 2, max = 1000))]
        petals: u32,
        /// Ratio p of the pattern.
        #[schemars(range(min = -1.0, max = 1.0))]
        ratio: f64,
        /// Rings of dots from the axis to the edge.
        #[schemars(range(min = 1, max = 1000))]
        rings: u32,
    },
    /// A headlight: a spotlight of unlike half angles across.
    Elliptical {
        /// Half angles toward `around` and across it [degrees].
        #[schemars(inner(range(min = 0.0, max = 90.0)), extend("x-unit" = "degrees"))]
        spread: [f64; 2],
        /// Exponent q.
        #[schemars(range(min = 0.0, max = 1e3))]
        sharpness: f64,
    },
    /// An IES (LM-63) or EULUMDAT (LDT) file.
    File {
        /// The file, relative to this one.
        path: String,
        /// Which of its sets of lamps, from 1.
        #[schemars(range(min = 1, max = 20))]
        lamp_set: Option<usize>,
    },
}

/// Where a lamp may be put.
struct Place {
    position: DVec3,
    toward: DVec3,
    around: Option<DVec3>,
}

impl LightTable {
    /// The lamps of the table, the `index`th: one, or as many as there are of the node that it names. `wrong` names a key of it.
    pub(super) fn read(
        self,
        index: usize,
        scene_file: &Path,
        within: Option<SceneFiles>,
        nodes: &[NamedNode],
        wrong: &dyn Fn(&str, String, &str) -> Error,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<LampEntry>> {
        let places = self.places(nodes, wrong)?;
        let form = self.form(wrong)?;
        let is_file = matches!(self.distribution, Some(DistributionTable::File { .. }));
        let (distribution, tilt) = match self.distribution {
            None => (Distribution::Isotropic, None),
            Some(table) => table.read(scene_file, within, wrong, warnings)?,
        };
        // A lamp that burns in another position than it was measured in gives less.
        let burning = |toward: DVec3| {
            let tilted = toward.angle_between(DVec3::NEG_Y).to_degrees();
            tilt.as_ref().map_or(1.0, |tilt| tilt.factor(tilted))
        };
        let intensity = match self.intensity {
            Some(Intensity::Gray(candela)) => DVec3::splat(candela),
            Some(Intensity::Rgb(candela)) => DVec3::from_array(candela),
            None if is_file => DVec3::ONE,
            None => {
                return Err(wrong(
                    "intensity",
                    "the lamp has none".into(),
                    "add intensity = ..., in candela",
                ));
            }
        };
        let name = self.name.unwrap_or(format!("light {}", index + 1));
        let count = places.len();
        let lamp = |(number, place): (usize, Place)| LampEntry {
            name: match count {
                1 => name.clone(),
                _ => format!("{name} {}", number + 1),
            },
            position: place.position,
            toward: place.toward,
            around: place.around,
            intensity: burning(place.toward) * intensity,
            distribution: distribution.clone(),
            form,
            ignore: self.ignore.clone(),
        };
        Ok(places.into_iter().enumerate().map(lamp).collect())
    }

    fn places(
        &self,
        nodes: &[NamedNode],
        wrong: &dyn Fn(&str, String, &str) -> Error,
    ) -> Result<Vec<Place>> {
        let direction = |key: &str, given: [f64; 3]| {
            let given = DVec3::from_array(given);
            match given.length() {
                length if length > 0.0 && length.is_finite() => Ok(given),
                _ => Err(wrong(
                    key,
                    "it has no direction".into(),
                    "leave it out, or give a direction",
                )),
            }
        };
        let toward = self.toward.map(|v| direction("toward", v)).transpose()?;
        let around = self.around.map(|v| direction("around", v)).transpose()?;
        let Some(node) = &self.node else {
            let position = self.position.ok_or_else(|| {
                wrong(
                    "position",
                    "the lamp stands nowhere".into(),
                    "add position = [x, y, z] in metres, or node = \"NAME\"",
                )
            })?;
            return Ok(vec![Place {
                position: DVec3::from_array(position),
                toward: toward.unwrap_or(DVec3::NEG_Y),
                around,
            }]);
        };
        let given = [
            ("position", self.position.is_some()),
            ("toward", toward.is_some()),
            ("around", around.is_some()),
            ("to", self.to.is_some()),
            ("edges", self.edges.is_some()),
        ];
        if let Some((key, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            return Err(wrong(
                key,
                "the lamp has a node, which says where it is".into(),
                "leave one of the two out",
            ));
        }
        let named: Vec<Place> = nodes
            .iter()
            .filter(|found| found.name == *node)
            .map(|found| of_node(found.to_scene))
            .collect();
        if named.is_empty() {
            let near = crate::error::nearest(node, nodes.iter().map(|found| found.name.as_str()));
            let remedy = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => "name a node of the mesh, which must be a glTF or a GLB".into(),
            };
            return Err(wrong(
                "node",
                format!("the mesh has no node `{node}`"),
                &remedy,
            ));
        }
        Ok(named)
    }

    fn form(&self, wrong: &dyn Fn(&str, String, &str) -> Error) -> Result<LampForm> {
        let given = [
            self.to.is_some(),
            self.edges.is_some(),
            self.radius.is_some(),
        ];
        if given.into_iter().filter(|is_given| *is_given).count() > 1 {
            return Err(wrong(
                "position",
                "the lamp has more than one of `to`, `edges` and `radius`".into(),
                "a line has `to`, a rectangle `edges`, a sphere `radius`",
            ));
        }
        let position = DVec3::from_array(self.position.unwrap_or_default());
        if let Some(to) = self.to {
            let to = DVec3::from_array(to);
            if to == position {
                return Err(wrong(
                    "to",
                    "it is where the lamp begins".into(),
                    "leave it out for a point, or give the other end",
                ));
            }
            return Ok(LampForm::Line { to });
        }
        if let Some(edges) = self.edges {
            let edges = edges.map(DVec3::from_array);
            let across = edges[0].cross(edges[1]);
            let longest = edges[0].length() * edges[1].length();
            if !(across.length() > 1e-9 * longest && longest.is_finite()) {
                return Err(wrong(
                    "edges",
                    "the rectangle has no area".into(),
                    "give two edges across each other, in metres",
                ));
            }
            let toward = self.toward.map_or(DVec3::NEG_Y, DVec3::from_array);
            if across.dot(toward).abs() <= 1e-9 * across.length() * toward.length() {
                return Err(wrong(
                    "edges",
                    "the axis lies in the rectangle, which has no side toward it".into(),
                    "let `toward` point out of the rectangle",
                ));
            }
            return Ok(LampForm::Rectangle { edges });
        }
        Ok(match self.radius {
            Some(radius) => LampForm::Sphere { radius },
            None => LampForm::Point,
        })
    }
}

/// Where the axes of a node put a lamp: it shines along -Z, as lamps of glTF do.
fn of_node(to_scene: DAffine3) -> Place {
    let axis = |v: DVec3| to_scene.transform_vector3(v).normalize_or_zero();
    let toward = axis(DVec3::NEG_Z);
    let around = Some(axis(DVec3::X)).filter(|v| *v != DVec3::ZERO);
    Place {
        position: to_scene.translation,
        // A node that is flattened along it has no axis of its own.
        toward: match toward == DVec3::ZERO {
            true => DVec3::NEG_Y,
            false => toward,
        },
        around,
    }
}

impl DistributionTable {
    /// The distribution, and how tilting the lamp changes its light where a file tells.
    fn read(
        self,
        scene_file: &Path,
        within: Option<SceneFiles>,
        wrong: &dyn Fn(&str, String, &str) -> Error,
        warnings: &mut Vec<Warning>,
    ) -> Result<(Distribution, Option<Tilt>)> {
        let distribution = match self {
            DistributionTable::Isotropic {} => Distribution::Isotropic,
            DistributionTable::NishitaSpot { spread, sharpness } => Distribution::NishitaSpot {
                spread: spread * DEG,
                sharpness,
            },
            DistributionTable::Daisy {
                spread,
                sharpness,
                petals,
                ratio,
            } => Distribution::Daisy {
                spread: spread * DEG,
                sharpness,
                petals,
                ratio,
            },
            DistributionTable::PolkaDots {
                spread,
                sharpness,
                petals,
                ratio,
                rings,
            } => Distribution::PolkaDots {
                spread: spread * DEG,
                sharpness,
                petals,
                ratio,
                rings,
            },
            DistributionTable::Elliptical { spread, sharpness } => Distribution::Elliptical {
                spread: spread.map(|angle| angle * DEG),
                sharpness,
            },
            DistributionTable::File { path, lamp_set } => {
                let lamp_set = lamp_set.unwrap_or(1);
                let read = match within.and_then(|files| file_of(files, &path)) {
                    Some(bytes) => photometry::from_bytes(Path::new(&path), bytes, lamp_set),
                    None => photometry::read(&scene_file.with_file_name(path), lamp_set),
                };
                let (photometry, said) = read.map_err(|e| match e {
                    Error::File { path, source, .. } => wrong(
                        "distribution.path",
                        format!("cannot read {}: {source}", path.display()),
                        "the name is relative to the scene file: check its spelling",
                    ),
                    other => other,
                })?;
                warnings.extend(said);
                return Ok((Distribution::Table(photometry.table), photometry.tilt));
            }
        };
        match distribution.check() {
            Ok(()) => Ok((distribution, None)),
            Err(Error::Domain {
                quantity,
                value,
                valid,
                remedy,
            }) => Err(wrong(
                &format!("distribution.{quantity}"),
                format!("it is {value}, outside {valid}"),
                &remedy,
            )),
            Err(other) => Err(other),
        }
    }
}
