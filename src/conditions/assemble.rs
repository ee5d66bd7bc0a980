//! From a scene and what is asked of it to conditions.

use super::received::Lit;
use super::request::{CameraChoice, DEFAULT_SIZE, Request};
use super::{
    Conditions, GroundPlane, Lamp, Receivers, Sun, TOO_FAINT, View, checks, toward,
    typical_luminance, unused,
};
use crate::ephemeris::civil::{self, Moment, Reading};
use crate::ephemeris::{Site, SunPosition, Tier, Weather, sun_position};
use crate::error::{Error, Result, nearest};
use crate::medium::{Air, clear};
use crate::memory;
use crate::scene::indoors::indoors;
use crate::scene::{Camera, Geometry, PunctualKind, Scene, SkyEntry, SunEntry};
use crate::sky::sun::{SunPath, visible_part};
use crate::sky::{DEFAULT_TURBIDITY, Irradiance, Model, Sky, SunAt, SunLight};
use crate::units::{DEG, SUN_DIAMETER};
use crate::warning::Warning;
use glam::DVec3;
use std::sync::Arc;

/// Place, time, and where that puts the sun.
#[derive(Debug, Clone)]
pub struct SolarGeometry {
    /// The place.
    pub site: Site,
    /// The time and how it was read.
    pub moment: Moment,
    /// Where the sun is.
    pub position: SunPosition,
    /// How that was found.
    pub tier: Tier,
}

/// What depends on the moment alone.
struct AtMoment {
    sun: Sun,
    sky: Option<Arc<Sky>>,
    instant: Option<SolarGeometry>,
    air: Air,
}

impl Conditions {
    /// Checks everything that a scene says and prepares it for the effects.
    ///
    /// # Errors
    /// [`Error::Domain`] for a number outside the range in which its equations hold, [`Error::Input`] for what is missing or
    /// contradicts itself, [`Error::Failed`] where there is not enough memory for the scene's tree.
    pub fn new(scene: impl Into<Arc<Scene>>, request: &Request) -> Result<Self> {
        let scene: Arc<Scene> = scene.into();
        let size = request.size.or(scene.picture.size).unwrap_or(DEFAULT_SIZE);
        let samples = request.samples.or(scene.picture.samples).unwrap_or(1);
        checks::picture(size, samples)?;
        // Corners, bounding volumes of both trees, and what building them takes for a while.
        let texels: usize = scene.textures.iter().map(|t| t.pixels.len()).sum();
        let bytes = 700 * scene.mesh.triangles.len() as u64 + 8 * texels as u64;
        memory::check("the tree of the scene's triangles", bytes)?;
        let geometry = Arc::new(Geometry::new(&scene));
        let height = ground_height(&scene, &geometry);
        let (camera, chosen) = camera(&scene, (&geometry, height), &request.camera, size)?;
        checks::ground(&scene.ground, height)?;
        for (index, medium) in scene.media.iter().enumerate() {
            checks::medium(index, medium, height)?;
        }
        scene.air.as_ref().map_or(Ok(()), checks::air)?;
        checks::north(scene.north_deg)?;
        let moment = moment(&scene, request, scene.time.as_deref(), height)?;
        let ground = scene.ground.enabled.then_some(GroundPlane {
            height,
            albedo: DVec3::splat(scene.ground.albedo),
        });
        let lamps = Lamp::all(&scene)?;
        let dark: Vec<(String, &'static str)> = lamps
            .iter()
            .filter_map(|lamp| {
                let why = lamp.is_dark(&geometry, ground.map(|ground| ground.height))?;
                Some((lamp.name.clone(), why))
            })
            .collect();
        let mut warnings = warnings(&scene, request, &geometry, &moment);
        if !dark.is_empty() {
            warnings.push(Warning::DarkLamps { lamps: dark });
        }
        let glowing = Lamp::glowing(&scene, &geometry, ground)?;
        let all_lamps: Arc<[Lamp]> = lamps
            .into_iter()
            .filter(Lamp::shines)
            .chain(glowing)
            .collect();
        let lamps = seen_beside(&moment, &all_lamps, &mut warnings);
        Ok(Conditions {
            lit: Lit::new(&lamps, &geometry, ground).into(),
            lamps,
            all_lamps,
            warnings,
            geometry,
            view: View {
                camera,
                chosen,
                size,
                samples,
                receivers: Receivers::Pixels,
            },
            sun: moment.sun,
            sky: moment.sky,
            instant: moment.instant,
            ground,
            air: moment.air,
            request: request.clone(),
            disc: Arc::default(),
            scene,
        })
    }

    /// The same scene from the same view at another time, as people write it (RFC 3339, local, or `JD...`). Sun, sky and the
    /// clear air are made anew; scene and geometry are shared.
    ///
    /// # Errors
    /// Those of [`Conditions::new`] that concern place and time; [`Error::Input`] for a scene whose sun stands in for them.
    pub fn at(&self, time: &str) -> Result<Self> {
        if self.scene.sun.is_some() {
            return Err(Error::input(
                format!("time {time}"),
                "the scene's sun stands in for place and time",
                "leave the scene's [sun] and --sun out",
            ));
        }
        let moment = moment(&self.scene, &self.request, Some(time), self.air.ground)?;
        let mut warnings = warnings(&self.scene, &self.request, &self.geometry, &moment);
        let of_lamps = |warning: &&Warning| matches!(warning, Warning::DarkLamps { .. });
        warnings.extend(self.warnings.iter().filter(of_lamps).cloned());
        let lamps = seen_beside(&moment, &self.all_lamps, &mut warnings);
        Ok(Conditions {
            lit: Lit::new(&lamps, &self.geometry, self.ground).into(),
            lamps,
            warnings,
            sun: moment.sun,
            sky: moment.sky,
            instant: moment.instant,
            air: moment.air,
            ..self.clone()
        })
    }

    /// The same scene at the same moment from another view. Everything else is shared.
    ///
    /// # Errors
    /// [`Error::Domain`] for a camera or a picture outside its range, and for points that are not finite or have no normal;
    /// [`Error::Input`] for no points, and for a picture that has not a pixel for each.
    pub fn seen_from(&self, view: View) -> Result<Self> {
        checks::picture(view.size, view.samples)?;
        // Before the camera, which stands in the middle of the points.
        view.check_points()?;
        checks::camera(&view.camera)?;
        Ok(Conditions {
            view,
            ..self.clone()
        })
    }
}

fn ground_height(scene: &Scene, geometry: &Geometry) -> f64 {
    scene.ground.height.unwrap_or(geometry.bounds().0.y)
}

/// Sun, sky and air of a scene at a time, or under the sun that stands in for place and time.
fn moment(scene: &Scene, request: &Request, time: Option<&str>, height: f64) -> Result<AtMoment> {
    let north = scene.north_deg * DEG;
    let ground_albedo = if scene.ground.enabled {
        scene.ground.albedo
    } else {
        0.2
    };
    let (sun, sky, path, instant) = match &scene.sun {
        Some(entry) => {
            let path = SunPath::standard(entry.elevation_deg * DEG, turbidity(&scene.sky));
            let (sun, sky) = given_sun(scene, entry, &path, north, ground_albedo)?;
            (sun, sky, path, None)
        }
        None if scene.site.is_none() && time.is_none() && scene.has_lamps() => (
            Sun::ABSENT,
            None,
            SunPath::standard(0.0, turbidity(&scene.sky)),
            None,
        ),
        None => {
            let instant = instant(scene, time, request)?;
            let path = sun_path(scene, &instant);
            let (sun, sky) = real_sun(scene, &instant, &path, north, ground_albedo)?;
            (sun, Some(sky), path, Some(instant))
        }
    };
    let mut media = scene.media.clone();
    if let Some(air) = &scene.air {
        media.extend(clear::media(air, &path, height)?);
    }
    Ok(AtMoment {
        sun,
        sky: sky.map(Arc::new),
        instant,
        air: Air {
            media,
            ground: height,
        },
    })
}

/// The lamps of all that are not lost beside sun and sky. What a surface shines with bounds what it adds anywhere: no other surface
/// and no air gets brighter by its light than it is itself.
fn seen_beside(moment: &AtMoment, all: &Arc<[Lamp]>, warnings: &mut Vec<Warning>) -> Arc<[Lamp]> {
    let typical = typical_luminance(&moment.sun, moment.sky.as_deref());
    let is_lost = |lamp: &&Lamp| match (lamp.glow(), lamp.seen_beside(typical)) {
        (Some(glow), Some(beside)) => glow < TOO_FAINT * beside,
        _ => false,
    };
    let lost: Vec<&Lamp> = all.iter().filter(is_lost).collect();
    if lost.is_empty() {
        return all.clone();
    }
    let brightest = lost
        .iter()
        .filter_map(|lamp| lamp.glow())
        .fold(0.0, f64::max);
    let mut materials: Vec<String> = lost.iter().map(|lamp| lamp.name.clone()).collect();
    materials.dedup();
    warnings.push(Warning::FaintEmission {
        materials,
        brightest,
        beside: typical,
    });
    all.iter().filter(|lamp| !is_lost(lamp)).cloned().collect()
}

/// What is said of the scene, the time and the sky.
fn warnings(
    scene: &Scene,
    request: &Request,
    geometry: &Geometry,
    moment: &AtMoment,
) -> Vec<Warning> {
    let mut warnings = scene.warnings.clone();
    for material in scene.emissions.keys() {
        let material = &scene.materials[*material as usize];
        if material.pane.is_some() {
            warnings.push(Warning::Mended {
                problem: format!("material `{}` lets light through and shines", material.name),
                instead: "what it shines with is left out".to_owned(),
            });
        }
    }
    warnings.extend(geometry.warnings().iter().cloned());
    if let Some(instant) = &moment.instant {
        warnings.extend(instant.moment.warnings.iter().cloned());
    }
    if let Some(sky) = &moment.sky {
        warnings.extend(sky.warnings().iter().cloned());
    }
    warnings.extend(unused::of(
        scene,
        request,
        moment.sky.is_some(),
        moment.air.ground,
    ));
    warnings
}

/// The sun that the user put somewhere, and the sky if there is to be one.
fn given_sun(
    scene: &Scene,
    entry: &SunEntry,
    path: &SunPath,
    north: f64,
    albedo: f64,
) -> Result<(Sun, Option<Sky>)> {
    checks::sun(entry)?;
    let elevation = entry.elevation_deg * DEG;
    let toward = toward(entry.azimuth_deg * DEG, elevation, north);
    let angular_radius = 0.5 * entry.diameter_deg.map_or(SUN_DIAMETER, |d| d * DEG);
    let at = SunAt {
        elevation_true: elevation,
        ..SunAt::unrefracted(toward)
    };
    let wants_sky = entry.illuminance.is_none() || scene.sky.model.is_some();
    let sky = wants_sky
        .then(|| Sky::new(model(&scene.sky, albedo)?, at))
        .transpose()?;
    let light = match (entry.illuminance, &sky) {
        (Some(illuminance), _) => {
            let share = if angular_radius > 0.0 {
                visible_part(elevation, angular_radius).0
            } else {
                f64::from(u8::from(elevation > 0.0))
            };
            let full = DVec3::splat(illuminance);
            SunLight {
                illuminance: share * full,
                visible_share: share,
                ..SunLight::of_illuminance(full, angular_radius, elevation)
            }
        }
        // The disc is as large as the user says, whatever the path's distance.
        (None, Some(sky)) => SunLight {
            angular_radius,
            ..sky.sunlight(path)?
        },
        (None, None) => unreachable!("a sun without illuminance has a sky"),
    };
    let sun = Sun {
        toward,
        light,
        limb_darkening: entry.diameter_deg.is_none(),
    };
    Ok((sun, sky))
}

/// The sun of a place and a time, and its sky.
fn real_sun(
    scene: &Scene,
    instant: &SolarGeometry,
    path: &SunPath,
    north: f64,
    albedo: f64,
) -> Result<(Sun, Sky)> {
    let position = &instant.position;
    let toward = toward(position.azimuth, position.elevation_apparent, north);
    let sky = Sky::new(
        model(&scene.sky, albedo)?,
        SunAt {
            toward_sun: toward,
            elevation_true: position.elevation_true,
            distance_au: position.distance_au,
            site_elevation: instant.site.elevation(),
        },
    )?;
    let sun = Sun {
        toward,
        light: SunLight {
            // The ephemeris has it already; of the path it would be the same but for the last bit.
            angular_radius: position.angular_radius,
            ..sky.sunlight(path)?
        },
        limb_darkening: true,
    };
    Ok((sun, sky))
}

/// What the sunlight of a place and a time comes through.
fn sun_path(scene: &Scene, instant: &SolarGeometry) -> SunPath {
    let position = &instant.position;
    SunPath {
        distance_au: position.distance_au,
        pressure_hpa: Weather::standard(&instant.site).pressure_hpa(),
        ..SunPath::standard(position.elevation_apparent, turbidity(&scene.sky))
    }
}

/// The scene's place and time, and where the sun stands then.
fn instant(scene: &Scene, time: Option<&str>, request: &Request) -> Result<SolarGeometry> {
    let missing = match (&scene.site, time) {
        (Some(entry), Some(time)) => return read_instant(entry, time, request),
        (None, Some(_)) => "it has a time but no place",
        (Some(_), None) => "it has a place but no time",
        (None, None) => "it has neither place and time nor a sun of its own",
    };
    let mut remedy = "give --at LAT,LON and --time T, or --sun AZ,EL".to_owned();
    let light = scene
        .lights
        .iter()
        .find(|light| light.kind == PunctualKind::Directional);
    if let Some(light) = light {
        let from = -light.direction;
        let azimuth = from.x.atan2(-from.z) / DEG + scene.north_deg;
        let elevation = from.y.atan2(from.x.hypot(from.z)) / DEG;
        remedy += &format!(
            "; its directional light `{}` would be --sun {:.1},{:.1}",
            light.name,
            azimuth.rem_euclid(360.0),
            elevation
        );
    }
    Err(Error::input(
        &scene.name,
        format!("the scene has no sun: {missing}"),
        remedy,
    ))
}

fn read_instant(
    entry: &crate::scene::SiteEntry,
    time: &str,
    request: &Request,
) -> Result<SolarGeometry> {
    let site = Site::new(entry.latitude_deg, entry.longitude_deg, entry.elevation)?;
    let moment = civil::resolve_with(
        time,
        &Reading {
            zone: request.timezone.as_deref().or(entry.timezone.as_deref()),
            site: Some(&site),
            fold: request.fold,
            scale: request.time_scale,
            delta_t: request.delta_t,
        },
    )?;
    let standard = Weather::standard(&site);
    let weather = Weather::new(
        request.pressure_hpa.unwrap_or(standard.pressure_hpa()),
        request.temperature_c.unwrap_or(standard.temperature_c()),
    )?;
    Ok(SolarGeometry {
        position: sun_position(request.tier, &moment.instant, &site, &weather),
        site,
        moment,
        tier: request.tier,
    })
}

fn turbidity(entry: &SkyEntry) -> f64 {
    entry.turbidity.unwrap_or(DEFAULT_TURBIDITY)
}

/// The sky model that an entry names.
fn model(entry: &SkyEntry, albedo: f64) -> Result<Model> {
    let turbidity = turbidity(entry);
    let irradiance = match (entry.direct_normal, entry.diffuse_horizontal) {
        (Some(direct_normal), Some(diffuse_horizontal)) => Some(Irradiance {
            direct_normal,
            diffuse_horizontal,
        }),
        (None, None) => None,
        _ => {
            return Err(Error::input(
                "the sky's direct_normal and diffuse_horizontal",
                "only one of the two is given",
                "give both in W/m2, or neither",
            ));
        }
    };
    Model::named(
        entry.model.as_deref().unwrap_or("perez"),
        turbidity,
        irradiance,
        albedo,
    )
}

/// The camera, and where it comes from.
fn camera(
    scene: &Scene,
    (geometry, ground): (&Geometry, f64),
    choice: &CameraChoice,
    size: [u32; 2],
) -> Result<(Camera, String)> {
    let bounds = || {
        scene.mesh.bounds().ok_or_else(|| {
            Error::input(
                &scene.name,
                "there is no mesh to frame",
                "give [camera], or --eye and --target",
            )
        })
    };
    let (camera, origin) = match choice {
        CameraChoice::Given(camera) => (*camera, "given".to_owned()),
        CameraChoice::Inside => {
            bounds()?;
            let ground = scene.ground.enabled.then_some(ground);
            let found = indoors(scene, geometry, ground).ok_or_else(|| {
                Error::input(
                    "--camera inside",
                    "no floor of the scene has room for a person and light in sight",
                    "give --eye and --target",
                )
            })?;
            let place = match found.is_under_a_roof {
                true => "found inside, on a floor",
                false => "found in the open: no floor under a roof has light in sight",
            };
            (found.camera, place.to_owned())
        }
        CameraChoice::Named(name) => {
            let names = scene.cameras.iter().map(|c| c.name.as_str());
            match scene.cameras.iter().find(|c| c.name == *name) {
                Some(found) => (found.camera, format!("`{name}` of the file")),
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
            (Some(camera), _) => (*camera, "the scene file's".into()),
            (None, Some(first)) => (first.camera, format!("`{}` of the file", first.name)),
            (None, None) => {
                let aspect = f64::from(size[0]) / f64::from(size[1]);
                (Camera::around(bounds()?, aspect), String::new())
            }
        },
    };
    checks::camera(&camera)?;
    Ok((camera, origin))
}
