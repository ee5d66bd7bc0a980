//! The TOML scene file: a mesh by name, and what the mesh lacks.
//!
//! The structs here are the file's only definition: the JSON Schema of `tyndall schema` is made from them, a file is
//! checked against that schema ([`super::check`]), and then read into them.

use super::camera::{Camera, Projection};
use super::files::SceneFiles;
use super::filling::{Filling, MediumTable, Wrong};
use super::lamp::LightTable;
use super::pane::{self, PaneTable};
use super::placement::{self, Placement};
use super::reflectance::{self, MaterialTable};
use super::window_shade::{self, ShadeTable};
use super::{Ground, PictureEntry, Scene, SiteEntry, SkyEntry, SunEntry, check};
use crate::error::{Error, Result};
use crate::units::DEG;
use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::Path;

/// A tyndall scene file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "tyndall scene")]
struct SceneFile {
    /// The geometry: a glTF, GLB or OBJ file, relative to this one. Absent: nothing but ground, media and sky.
    mesh: Option<String>,
    /// Metres in a unit of the mesh.
    #[schemars(range(max = 1e9), extend("exclusiveMinimum" = 0.0))]
    scale: Option<f64>,
    /// The mesh's axis that points up; with "z", its Y axis becomes the scene's -Z.
    up: Option<Up>,
    /// Where the mesh's origin goes, added after `scale` and `up` [m].
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    origin: Option<[f64; 3]>,
    /// Azimuth that the scene's -Z axis faces, from north through east [degrees]; with 0, +X is east.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "degrees"))]
    north: Option<f64>,
    /// The moment: RFC 3339, without an offset the site's local time, or a Julian date `JD2451545.0`.
    time: Option<String>,
    /// The place on the earth.
    site: Option<SiteTable>,
    /// The camera.
    camera: Option<CameraTable>,
    /// A sun that stands in for place and time.
    sun: Option<SunTable>,
    /// The sky; what is absent takes the default.
    sky: Option<SkyTable>,
    /// An endless plane that rays meet which miss everything else below the horizon; where there is none, nothing comes from there.
    ground: Option<GroundTable>,
    /// What fills the air; where media overlap, their coefficients add.
    #[serde(default)]
    medium: Vec<MediumTable>,
    /// Lamps; those of the mesh take part by themselves.
    #[serde(default)]
    light: Vec<LightTable>,
    /// Reflectances that the mesh lacks, or that others take the place of.
    #[serde(default)]
    material: Vec<MaterialTable>,
    /// Materials of the mesh that are glass.
    #[serde(default)]
    pane: Vec<PaneTable>,
    /// Blinds that hours with too much sun close.
    #[serde(default)]
    shade: Vec<ShadeTable>,
    /// How the scene is pictured when no flag says otherwise.
    picture: Option<PictureTable>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Up {
    Y,
    Z,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SiteTable {
    /// North positive [degrees].
    #[schemars(range(min = -90.0, max = 90.0), extend("x-unit" = "degrees"))]
    latitude: f64,
    /// East positive [degrees].
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "degrees"))]
    longitude: f64,
    /// Above sea level [m]; 0 when absent.
    #[schemars(range(min = -500.0, max = 11_000.0), extend("x-unit" = "m"))]
    elevation: Option<f64>,
    /// IANA zone, such as "Europe/Paris"; looked up from the coordinates when absent.
    timezone: Option<String>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CameraTable {
    /// Where the eye is [m].
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    eye: [f64; 3],
    /// A point that it looks at [m].
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    target: [f64; 3],
    /// What is up in the picture; [0, 1, 0] when absent.
    up: Option<[f64; 3]>,
    /// "perspective" when absent.
    projection: Option<ProjectionName>,
    /// Vertical field of view of a perspective [degrees]; 60 when absent.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 180.0, "x-unit" = "degrees"))]
    fov_y: Option<f64>,
    /// Height of what an orthographic camera sees [m].
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
    height: Option<f64>,
    /// Lens shift, right and up, in picture widths and heights.
    shift: Option<[f64; 2]>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum ProjectionName {
    Perspective,
    Orthographic,
    Panorama,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SunTable {
    /// Where the light comes from, from north through east [degrees].
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "degrees"))]
    azimuth: f64,
    /// Above the horizon [degrees]; no refraction is added.
    #[schemars(range(min = -90.0, max = 90.0), extend("x-unit" = "degrees"))]
    elevation: f64,
    /// On a plane facing the sun, before the scene's own media [lx]; white. With it, there is no sky unless one is asked for.
    #[schemars(range(min = 0.0), extend("x-unit" = "lx"))]
    illuminance: Option<f64>,
    /// Uniform disc [degrees]; 0 is a point sun; absent: the real one.
    #[schemars(range(min = 0.0, max = 30.0), extend("x-unit" = "degrees"))]
    diameter: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SkyTable {
    /// The model.
    #[schemars(extend("enum" = [
        "perez", "preetham", "hosek", "cie:1", "cie:2", "cie:3", "cie:4", "cie:5", "cie:6", "cie:7", "cie:8", "cie:9",
        "cie:10", "cie:11", "cie:12", "cie:13", "cie:14", "cie:15", "cie:16"
    ]))]
    model: Option<String>,
    /// Turbidity [1].
    #[schemars(range(min = 1.0, max = 20.0))]
    turbidity: Option<f64>,
    /// Direct-normal irradiance [W/m2].
    #[schemars(range(min = 0.0, max = 1500.0), extend("x-unit" = "W/m2"))]
    direct_normal: Option<f64>,
    /// Diffuse-horizontal irradiance [W/m2].
    #[schemars(range(min = 0.0, max = 1500.0), extend("x-unit" = "W/m2"))]
    diffuse_horizontal: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct GroundTable {
    /// Whether there is one; true when absent.
    enabled: Option<bool>,
    /// Its height [m]; absent: the scene's lowest point.
    height: Option<f64>,
    /// Reflectance; 0.2 when absent.
    #[schemars(range(min = 0.0, max = 1.0))]
    albedo: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PictureTable {
    /// Width and height [pixels].
    #[schemars(inner(range(min = 1, max = 65_536)))]
    size: Option<[u32; 2]>,
    /// Samples a pixel.
    #[schemars(range(min = 1, max = 65_536))]
    samples: Option<u32>,
    /// EV100; automatic when absent.
    #[schemars(range(min = -30.0, max = 40.0), extend("x-unit" = "EV100"))]
    exposure: Option<f64>,
}

/// The JSON Schema (2020-12) of the TOML scene file.
pub fn schema() -> serde_json::Value {
    let mut schema = schemars::schema_for!(SceneFile).to_value();
    check::without_null(&mut schema);
    schema
}

/// Reads `text`, the content of `path`; `load_mesh` reads the mesh that it names, and other files are those `within`, or beside
/// `path`. What is `asked` wins over its keys.
pub(super) fn load(
    path: &Path,
    text: &str,
    asked: Placement,
    within: Option<SceneFiles>,
    load_mesh: impl FnOnce(&str) -> Result<Scene>,
) -> Result<Scene> {
    let checked = check::read(path, text, &schema())?;
    let wrong = |key: &str, problem: String, remedy: &str| {
        Error::input(checked.place(key), problem, remedy)
    };
    let file: SceneFile = serde_json::from_value(checked.value.clone())
        .map_err(|e| wrong("", e.to_string(), "see `tyndall schema`"))?;

    let mut scene = match &file.mesh {
        Some(mesh) => load_mesh(mesh).map_err(|e| match e {
            _ if mesh.is_empty() || path.with_file_name(mesh).is_dir() => wrong(
                "mesh",
                format!("`{mesh}` is a folder, not a file"),
                "name a glTF, GLB or OBJ file, relative to the scene file",
            ),
            Error::File {
                path,
                source,
                writing: false,
            } => wrong(
                "mesh",
                format!("cannot read {}: {source}", path.display()),
                "the name is relative to the scene file: check its spelling",
            ),
            other => other,
        })?,
        None => Scene::default(),
    };
    let own = Placement {
        scale: file.scale,
        up: file.up.map(|up| match up {
            Up::Y => placement::Up::Y,
            Up::Z => placement::Up::Z,
        }),
    };
    let origin = file.origin.map_or(DVec3::ZERO, DVec3::from_array);
    if file.mesh.is_some() {
        let file = path.with_file_name(file.mesh.as_deref().unwrap_or_default());
        scene
            .place(&file.display().to_string(), asked.over(own), origin)
            .map_err(|problem| wrong("scale", problem, "write another scale"))?;
    } else if asked != Placement::default() {
        return Err(Error::input(
            path.display().to_string(),
            "there is no mesh whose unit or axes could be given",
            "leave out --scale and --up",
        ));
    }

    scene.north_deg = file.north.unwrap_or(0.0);
    scene.time = file.time;
    scene.site = file.site.map(|site| SiteEntry {
        latitude_deg: site.latitude,
        longitude_deg: site.longitude,
        elevation: site.elevation.unwrap_or(0.0),
        timezone: site.timezone,
    });
    scene.camera = file.camera.map(|camera| camera.read(&wrong)).transpose()?;
    scene.sun = file.sun.map(|sun| SunEntry {
        azimuth_deg: sun.azimuth,
        elevation_deg: sun.elevation,
        illuminance: sun.illuminance,
        diameter_deg: sun.diameter,
    });
    if let Some(sky) = file.sky {
        scene.sky = SkyEntry {
            model: sky.model,
            turbidity: sky.turbidity,
            direct_normal: sky.direct_normal,
            diffuse_horizontal: sky.diffuse_horizontal,
        };
    }
    if let Some(ground) = file.ground {
        let default = Ground::default();
        scene.ground = Ground {
            enabled: ground.enabled.unwrap_or(default.enabled),
            height: ground.height,
            albedo: ground.albedo.unwrap_or(default.albedo),
        };
    }
    for (i, medium) in file.medium.into_iter().enumerate() {
        let wrong = |key: &str, problem: String, remedy: &str| {
            wrong(&format!("medium[{i}].{key}"), problem, remedy)
        };
        match medium.read(&wrong)? {
            Filling::Medium(medium) => scene.media.push(medium),
            Filling::Air(_) if scene.air.is_some() => {
                return Err(wrong(
                    "shape",
                    "there is air already".into(),
                    "leave one of the two out: a place has one clear air",
                ));
            }
            Filling::Air(air) => scene.air = Some(air),
        }
    }
    for (i, light) in file.light.into_iter().enumerate() {
        let wrong = |key: &str, problem: String, remedy: &str| {
            wrong(&format!("light[{i}].{key}"), problem, remedy)
        };
        let lamps = light.read(i, path, within, &scene.nodes, &wrong, &mut scene.warnings)?;
        scene.lamps.extend(lamps);
    }
    // What is glass is known before reflectances are given by the names of objects.
    pane::read(file.pane, path, within, &mut scene, &wrong)?;
    reflectance::read(file.material, path, &mut scene, &wrong)?;
    window_shade::read(file.shade, &mut scene, &wrong)?;
    if let Some(picture) = file.picture {
        scene.picture = PictureEntry {
            size: picture.size,
            samples: picture.samples,
            exposure_ev100: picture.exposure,
        };
    }
    Ok(scene)
}

impl CameraTable {
    fn read(&self, wrong: Wrong) -> Result<Camera> {
        let (eye, forward) = (
            DVec3::from_array(self.eye),
            DVec3::from_array(self.target) - DVec3::from_array(self.eye),
        );
        if forward == DVec3::ZERO {
            return Err(wrong(
                "camera.target",
                "it is where the eye is".into(),
                "look at another point",
            ));
        }
        let up = self.up.map_or(DVec3::Y, DVec3::from_array);
        if up == DVec3::ZERO {
            return Err(wrong(
                "camera.up",
                "it has no direction".into(),
                "leave it out, or give a direction",
            ));
        }
        let kind = self.projection.unwrap_or(ProjectionName::Perspective);
        for (key, given, belongs) in [
            (
                "camera.fov_y",
                self.fov_y.is_some(),
                ProjectionName::Perspective,
            ),
            (
                "camera.height",
                self.height.is_some(),
                ProjectionName::Orthographic,
            ),
        ] {
            if given && kind != belongs {
                return Err(wrong(
                    key,
                    "the camera's projection does not use it".into(),
                    "leave it out: fov_y belongs to a perspective, height to an orthographic camera",
                ));
            }
        }
        let projection = match kind {
            ProjectionName::Perspective => Projection::Perspective {
                fov_y: self.fov_y.unwrap_or(60.0) * DEG,
            },
            ProjectionName::Orthographic => Projection::Orthographic {
                height: self.height.ok_or_else(|| {
                    wrong(
                        "camera",
                        "an orthographic camera needs `height`".into(),
                        "add height = ..., in metres",
                    )
                })?,
            },
            ProjectionName::Panorama => Projection::Panorama,
        };
        let shift = self.shift.map_or(DVec2::ZERO, DVec2::from_array);
        Ok(Camera {
            eye,
            forward,
            up,
            projection,
            shift,
        })
    }
}
