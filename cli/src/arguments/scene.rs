//! The flags that say what is to be seen, shared by every command that takes a scene.

use crate::arguments::hinted::{SKIES, effects, hinted, text};
use crate::arguments::place_time::{PlaceArgs, SunArgs, TimeArgs};
use crate::arguments::size::{SizeFlag, size};
use clap::Args;
use clap::builder::PossibleValuesParser;
use glam::DVec3;
use std::path::PathBuf;
use tyndall::Result;
use tyndall::backend::choose::Goal;
use tyndall::conditions::{CameraChoice, Conditions, DEFAULT_SIZE, Request};
use tyndall::effect::Method;
use tyndall::error::Error;
use tyndall::plan::{Overrules, Quality};
use tyndall::scene::{self, Camera, Placement, Projection, Scene, SiteEntry, SunEntry, Up};
use tyndall::units::DEG;

/// A scene and the camera that sees it.
#[derive(Debug, Args)]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    camera: CameraArgs,
}

/// A scene, and the sun and the sky that light it.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// The scene: TOML, glTF, GLB or OBJ [default: one that is built in]
    pub scene: Option<PathBuf>,
    /// One of the scenes that are built in; `tyndall scene` says what each is
    #[arg(long = "scene", value_name = "NAME", value_parser = PossibleValuesParser::new(scene::BUILTIN), conflicts_with = "scene")]
    pub builtin: Option<String>,
    /// Metres in a unit of the scene's mesh: 0.001 for millimetres; wins over the scene's own `scale`
    #[arg(long, value_name = "F", value_parser = positive, requires = "scene")]
    scale: Option<f64>,
    /// The mesh's axis that points up, y or z; wins over the scene's own `up`
    #[arg(long, value_name = "y|z", value_parser = hinted(up, ["y", "z"]), hide_possible_values = true, requires = "scene")]
    up: Option<Up>,
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    pub time: TimeArgs,
    #[command(flatten)]
    ephemeris: SunArgs,
    /// Put the sun there instead: degrees, azimuth from north through east; no refraction is added
    #[arg(long, value_name = "AZ,EL", value_parser = pair, allow_hyphen_values = true)]
    sun: Option<[f64; 2]>,
    /// The azimuth that the scene's -Z axis faces (0 is north; then +X is east)
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    north: Option<f64>,
    /// The sky: perez, preetham, hosek, cie:1 to cie:16
    #[arg(long, value_name = "MODEL", value_parser = hinted(text, SKIES), hide_possible_values = true)]
    sky: Option<String>,
    /// Turbidity of the clear air: 2 is very clear, 3 ordinary, 6 hazy
    #[arg(long, value_name = "T")]
    turbidity: Option<f64>,
    /// Direct-normal irradiance in W/m2, for the sky perez
    #[arg(long, value_name = "W")]
    direct_normal: Option<f64>,
    /// Diffuse-horizontal irradiance in W/m2, for the sky perez
    #[arg(long, value_name = "W")]
    diffuse_horizontal: Option<f64>,
}

/// What sees a scene.
#[derive(Debug, Args)]
struct CameraArgs {
    /// A camera of the scene by its name, or `inside`
    #[arg(long, value_name = "NAME|inside", value_parser = hinted(text, ["inside"]), hide_possible_values = true, conflicts_with_all = ["eye", "target"])]
    camera: Option<String>,
    /// Where the eye is, in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "target")]
    eye: Option<DVec3>,
    /// Where it looks
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "eye")]
    target: Option<DVec3>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG")]
    fov: Option<f64>,
    /// Width and height of the picture in pixels; a width alone, 1600, or a height, x1000, keeps the scene's shape
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<SizeFlag>,
    /// Rays through each pixel that differs from a neighbour; 1 is one through each centre
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
}

/// The accuracy that is asked for, and where the user overrules the plan.
#[derive(Debug, Args)]
pub struct PlanArgs {
    /// The quality: draft, preview, high or reference
    #[arg(long, value_name = "QUALITY", default_value = "preview", value_parser = hinted(quality, Quality::ALL.map(Quality::name)), hide_possible_values = true)]
    pub quality: Quality,
    /// How a GPU integrates sunlight in the air: auto, rectified, epipolar, prefiltered, march or planes (the reference is exact)
    #[arg(long, value_name = "METHOD", default_value = "auto", value_parser = hinted(method, METHODS), hide_possible_values = true)]
    pub method: MethodFlag,
    /// Use the coarsest quality whose measured relative RMSE is at most this
    #[arg(long, value_name = "X", value_parser = positive, conflicts_with_all = ["quality", "within"])]
    pub max_error: Option<f64>,
    /// Use the finest quality whose time, measured on a GPU and predicted on the CPU, is at most this, in milliseconds
    #[arg(long, value_name = "MS", value_parser = positive, conflicts_with = "quality")]
    pub within: Option<f64>,
    /// Leave out effects that are certain to add less than this share of the picture's mean luminance
    #[arg(long, value_name = "X")]
    tolerance: Option<f64>,
    /// Set a knob of an effect
    #[arg(long, value_name = "EFFECT.KNOB=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Run an effect that the plan would skip
    #[arg(long, value_name = "EFFECT", value_parser = hinted(text, effects()), hide_possible_values = true)]
    force: Vec<String>,
    /// Leave an effect out
    #[arg(long, value_name = "EFFECT", value_parser = hinted(text, effects()), hide_possible_values = true)]
    without: Vec<String>,
}

/// Methods by their names.
pub const METHODS: [&str; 6] = [
    "auto",
    Method::ALL[0].name(),
    Method::ALL[1].name(),
    Method::ALL[2].name(),
    Method::ALL[3].name(),
    Method::ALL[4].name(),
];

/// A method, or `None` for the cheapest that is accurate enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodFlag(pub Option<Method>);

impl PlanArgs {
    /// What these flags mean to a plan.
    pub fn overrules(&self) -> Overrules {
        Overrules {
            quality: self.quality,
            method: self.method.0,
            tolerance: self.tolerance,
            set: self.set.clone(),
            force: self.force.clone(),
            without: self.without.clone(),
        }
    }

    /// What quality and method are chosen by, if it is not the flags themselves.
    pub fn goal(&self) -> Option<Goal> {
        let error = self.max_error.map(Goal::MaxError);
        error.or(self.within.map(Goal::Within))
    }
}

impl ViewArgs {
    /// The conditions that scene and flags describe.
    ///
    /// # Errors
    /// Those of [`scene::load`] and [`Conditions::new`].
    pub fn conditions(&self) -> Result<Conditions> {
        self.conditions_of(self.scene.load()?)
    }

    /// The conditions of the scene that these flags load ([`SceneArgs::load`]), and of what was changed of it.
    ///
    /// # Errors
    /// Those of [`Conditions::new`].
    pub fn conditions_of(&self, mut scene: Scene) -> Result<Conditions> {
        let shape = scene.picture.size.unwrap_or(DEFAULT_SIZE);
        let request = Request {
            size: self.camera.size.map(|size| size.in_shape_of(shape)),
            samples: self.camera.samples,
            camera: self.camera.choice(&mut scene)?,
            ..self.scene.request()
        };
        Conditions::new(scene, &request)
    }
}

impl SceneArgs {
    /// The scene, under the sun and the sky of the flags.
    ///
    /// # Errors
    /// Those of [`scene::load`].
    pub fn load(&self) -> Result<Scene> {
        let mut scene = match &self.scene {
            Some(path) => scene::load_placed(
                path,
                Placement {
                    scale: self.scale,
                    up: self.up,
                },
            )?,
            None => Scene::builtin(self.builtin.as_deref().unwrap_or(scene::BUILTIN[0]))?,
        };
        self.place_and_time(&mut scene);
        if let Some([azimuth_deg, elevation_deg]) = self.sun {
            let light = scene.sun.take();
            scene.sun = Some(SunEntry {
                azimuth_deg,
                elevation_deg,
                illuminance: light.and_then(|sun| sun.illuminance),
                diameter_deg: light.and_then(|sun| sun.diameter_deg),
            });
        }
        if let Some(north) = self.north {
            scene.north_deg = north;
        }
        let sky = &mut scene.sky;
        if self.sky.is_some() {
            sky.model.clone_from(&self.sky);
        }
        sky.turbidity = self.turbidity.or(sky.turbidity);
        sky.direct_normal = self.direct_normal.or(sky.direct_normal);
        sky.diffuse_horizontal = self.diffuse_horizontal.or(sky.diffuse_horizontal);
        Ok(scene)
    }

    /// The sky that a flag asks for.
    pub fn sky(&self) -> Option<&str> {
        self.sky.as_deref()
    }

    /// Whether a flag puts the sun somewhere.
    pub fn has_given_sun(&self) -> bool {
        self.sun.is_some()
    }

    /// How place and time are read.
    pub fn request(&self) -> Request {
        Request {
            tier: self.ephemeris.tier,
            timezone: self.time.tz.clone(),
            fold: self.time.fold,
            time_scale: self.time.time_scale,
            delta_t: self.time.delta_t,
            pressure_hpa: self.ephemeris.pressure,
            temperature_c: self.ephemeris.temperature,
            ..Request::default()
        }
    }

    /// The files that the scene is read from, as far as their names are known, in words for messages.
    pub fn files(&self, scene: &Scene) -> Vec<(PathBuf, &'static str)> {
        let Some(path) = &self.scene else {
            return Vec::new();
        };
        let pictures = scene.textures.iter().map(|texture| {
            let file = path.with_file_name(texture.name.replace('\\', "/"));
            (file, "a picture of the scene")
        });
        std::iter::once((path.clone(), "the scene"))
            .chain(pictures)
            .collect()
    }

    /// Flags win over what the scene file says: a place or a time on the command line over a sun of the file, and a sun on
    /// the command line over the file's place and time.
    fn place_and_time(&self, scene: &mut Scene) {
        if self.sun.is_some() {
            scene.site = None;
            scene.time = None;
        } else if self.place.site().is_some() || self.time.time.is_some() {
            scene.sun = None;
        }
        if let Some(site) = self.place.site() {
            self.place.say();
            scene.site = Some(SiteEntry {
                latitude_deg: site.latitude_deg(),
                longitude_deg: site.longitude_deg(),
                elevation: site.elevation(),
                timezone: None,
            });
        }
        if self.time.time.is_some() {
            scene.time.clone_from(&self.time.time);
        }
    }
}

impl CameraArgs {
    fn choice(&self, scene: &mut Scene) -> Result<CameraChoice> {
        let fov_y = self.fov.map(|fov| fov * DEG);
        let choice = match (&self.camera, self.eye, self.target) {
            (_, Some(eye), Some(target)) => {
                let fov_y = fov_y.unwrap_or(scene::framing::DEFAULT_FOV_Y_DEG * DEG);
                return Ok(CameraChoice::Given(Camera::look_at(eye, target, fov_y)));
            }
            (Some(name), ..) if name == "inside" => CameraChoice::Inside,
            (Some(name), ..) => CameraChoice::Named(name.clone()),
            _ => CameraChoice::Scene,
        };
        // A field of view alone changes the camera that is there.
        let Some(fov_y) = fov_y else {
            return Ok(choice);
        };
        let cameras = scene.cameras.iter_mut().map(|named| &mut named.camera);
        let mut changed = false;
        for camera in cameras.chain(&mut scene.camera) {
            if let Projection::Perspective { fov_y: present } = &mut camera.projection {
                *present = fov_y;
                changed = true;
            }
        }
        if changed {
            Ok(choice)
        } else {
            Err(Error::input(
                "--fov",
                "the scene has no perspective camera whose field of view could change",
                "give --eye and --target too",
            ))
        }
    }
}

fn numbers<const N: usize>(text: &str, form: &str) -> Result<[f64; N], String> {
    let values: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>())
        .collect::<Result<_, _>>()
        .map_err(|_| format!("{form} was expected, in numbers"))?;
    match <[f64; N]>::try_from(values) {
        Ok(values) if values.iter().all(|v| v.is_finite()) => Ok(values),
        _ => Err(format!("{form} was expected, {N} finite numbers")),
    }
}

pub fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers(text, "AZ,EL")
}

fn triple(text: &str) -> Result<DVec3, String> {
    numbers(text, "X,Y,Z").map(DVec3::from_array)
}

fn up(text: &str) -> Result<Up, String> {
    match text {
        "y" | "Y" => Ok(Up::Y),
        "z" | "Z" => Ok(Up::Z),
        _ => Err("write y or z".into()),
    }
}

fn quality(text: &str) -> Result<Quality, String> {
    Quality::ALL
        .into_iter()
        .find(|quality| quality.name() == text)
        .ok_or_else(|| "write draft, preview, high or reference".into())
}

pub fn method(text: &str) -> Result<MethodFlag, String> {
    if text == "auto" {
        return Ok(MethodFlag(None));
    }
    let found = Method::ALL.into_iter().find(|method| method.name() == text);
    found
        .map(|method| MethodFlag(Some(method)))
        .ok_or_else(|| "write auto, rectified, epipolar, prefiltered, march or planes".into())
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err("a number above 0 was expected".into()),
    }
}

pub fn setting(text: &str) -> Result<(String, f64), String> {
    let (target, value) = text
        .split_once('=')
        .ok_or("EFFECT.KNOB=VALUE was expected, as in shafts.suns=16")?;
    let value = value
        .trim()
        .parse()
        .map_err(|_| format!("`{value}` is not a number"))?;
    Ok((target.trim().to_owned(), value))
}
