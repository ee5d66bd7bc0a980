//! From a scene and what is asked of it to conditions.

use super::{Conditions, GroundPlane, Sun, checks, toward};
use crate::colour::{Space, luminance};
use crate::error::{Error, Result, nearest};
use crate::medium::Air;
use crate::scene::{Camera, Geometry, Scene};
use crate::sky::{Model, Sky, SunLight};
use crate::units::{DEG, SUN_DIAMETER};
use glam::DVec3;

/// What is asked of a scene beside what it says itself.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Width and height of the picture [pixels]; absent: the scene's, or 960 x 600.
    pub size: Option<[u32; 2]>,
    /// Samples of pixels that need them; absent: the scene's, or 1.
    pub samples: Option<u32>,
    /// The camera.
    pub camera: CameraChoice,
}

/// Which camera.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum CameraChoice {
    /// The scene file's own, else the mesh's first, else one that frames everything.
    #[default]
    Scene,
    /// One of the mesh's, by name.
    Named(String),
    /// One inside the scene's bounds.
    Inside,
    /// This one.
    Given(Camera),
}

impl Conditions {
    /// Checks everything that a scene says and prepares it for the effects.
    pub fn new(scene: Scene, request: &Request) -> Result<Self> {
        let size = request.size.or(scene.picture.size).unwrap_or([960, 600]);
        let samples = request.samples.or(scene.picture.samples).unwrap_or(1);
        let geometry = Geometry::new(&scene);
        let camera = camera(&scene, &request.camera, size)?;
        let entry = scene
            .sun
            .ok_or_else(|| Error::input("sun", "none", "none"))?;
        let toward = toward(
            entry.azimuth_deg * DEG,
            entry.elevation_deg * DEG,
            scene.north_deg * DEG,
        );
        let angular_radius = entry
            .diameter_deg
            .map_or(0.5 * SUN_DIAMETER, |d| 0.5 * d * DEG);
        let light = SunLight::of_illuminance(
            DVec3::splat(entry.illuminance.unwrap_or(1e5)),
            angular_radius,
            toward.y.asin(),
        );
        let sky = match &scene.sky.model {
            Some(_) => Some(Sky::new(
                &Model::Uniform { luminance: 5000.0 },
                toward,
                toward.y.asin(),
            )?),
            None => None,
        };
        let height = scene.ground.height.unwrap_or(geometry.bounds().0.y);
        for (index, medium) in scene.media.iter().enumerate() {
            checks::medium(index, medium, height)?;
        }
        Ok(Conditions {
            geometry,
            camera,
            size,
            samples,
            sun: Sun {
                toward,
                light,
                angular_radius,
                limb_darkening: entry.diameter_deg.is_none(),
            },
            sky,
            ground: scene.ground.enabled.then(|| GroundPlane {
                height,
                albedo: DVec3::splat(scene.ground.albedo),
            }),
            air: Air {
                media: scene.media.clone(),
                ground: height,
            },
            scene,
        })
    }
}

fn camera(scene: &Scene, choice: &CameraChoice, size: [u32; 2]) -> Result<Camera> {
    let bounds = scene.mesh.bounds().unwrap_or_default();
    let camera = match choice {
        CameraChoice::Given(camera) => *camera,
        CameraChoice::Inside => Camera::inside(bounds),
        CameraChoice::Named(name) => {
            let names = scene.cameras.iter().map(|c| c.name.as_str());
            match scene.cameras.iter().find(|c| c.name == *name) {
                Some(found) => found.camera,
                None => {
                    let remedy = match (nearest(name, names.clone()), names.clone().next()) {
                        (Some(near), _) => format!("did you mean `{near}`?"),
                        (None, Some(_)) => {
                            format!("it has {}", names.collect::<Vec<_>>().join(", "))
                        }
                        (None, None) => {
                            "it has none: use --camera inside, or --eye and --target".into()
                        }
                    };
                    return Err(Error::input(
                        format!("--camera {name}"),
                        "the scene has no camera of that name",
                        remedy,
                    ));
                }
            }
        }
        CameraChoice::Scene => match (&scene.camera, scene.cameras.first()) {
            (Some(camera), _) => *camera,
            (None, Some(first)) => first.camera,
            (None, None) => Camera::around(bounds, f64::from(size[0]) / f64::from(size[1])),
        },
    };
    checks::camera(&camera)?;
    Ok(camera)
}
