//! The illuminance of sensors in each hour of a year, by daylight coefficients.
//!
//! Who sees whom is found once ([`Transport`]), and from it what sensors receive for each patch of the sky and each patch of a surface
//! ([`Coefficients`]). An hour is then a product: the luminances of the sky's patches times their coefficients, and the light that the sun
//! gives to surfaces at its true place that hour, with its shadows, times theirs. What comes straight from the sun is found by itself:
//! the disc as each sensor sees it.

use super::direct_sun::DirectSun;
use super::epw::WeatherFile;
use super::hours::{Hour, Hours};
use super::table::{Stamp, Table};
use crate::colour::luminance;
use crate::conditions::{CameraChoice, Conditions, Receiver, Request, View};
use crate::effect::Settings;
use crate::effect::radiosity::{RADIOSITY, detail};
use crate::error::{Error, Result};
use crate::memory;
use crate::plan::Quality;
use crate::radiosity::{Coefficients, Detail, Transport};
use crate::scene::disc::DiscWork;
use crate::scene::{Camera, Scene, SiteEntry};
use crate::sky::{Model, Sky, SunAt};
use crate::task::Task;
use crate::warning::Warning;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// A scene and its weather lie at one place, if they are no farther apart each way [degrees].
const NEAR_DEG: f64 = 0.5;

/// How finely a year is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Each of Tregenza's 145 patches of the sky is split so many times each way: 1, 2 or 4.
    pub patches: u32,
    /// The quality's knobs of light from sky and surfaces; the sky's own patches are not used.
    pub detail: Detail,
    /// The share of light that may remain unshot.
    pub unshot: f64,
}

impl Fineness {
    /// The knobs of light from sky and surfaces at a quality, but for those that are set otherwise (`radiosity.rays` and the like); the
    /// sky in 577 patches.
    pub fn new(quality: Quality, set: &[(String, f64)]) -> Self {
        let level = Quality::ALL.iter().position(|q| *q == quality);
        let knobs = RADIOSITY.knobs.iter().map(|knob| {
            let own = format!("{}.{}", RADIOSITY.name, knob.name);
            let given = set.iter().rev().find(|(name, _)| *name == own);
            let value = knob.values[level.unwrap_or(0)];
            (knob.name, given.map_or(value, |(_, value)| *value))
        });
        let values: Vec<(&str, f64)> = knobs.collect();
        let settings = Settings {
            effect: RADIOSITY.name,
            values: &values,
        };
        Fineness {
            patches: 2,
            detail: detail(&settings),
            unshot: settings.get("unshot"),
        }
    }
}

/// A scene's sensors, ready for any hour.
pub struct Year {
    conditions: Conditions,
    transport: Transport,
    coefficients: Coefficients,
    sensors: Arc<[Receiver]>,
    shining: Vec<u32>,
}

/// What is to be said where a weather file is that of another place than the scene's.
pub fn elsewhere(site: Option<&SiteEntry>, file: &WeatherFile) -> Option<Warning> {
    let apart = |a: f64, b: f64| ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs();
    let site = site.filter(|site| {
        apart(site.latitude_deg, file.latitude_deg) > NEAR_DEG
            || apart(site.longitude_deg, file.longitude_deg) > NEAR_DEG
    })?;
    Some(Warning::Weather {
        problem: format!(
            "the scene lies at {:.2}, {:.2} and the weather file {} at {:.2}, {:.2}",
            site.latitude_deg, site.longitude_deg, file.file, file.latitude_deg, file.longitude_deg
        ),
        instead: "the sun is that of the weather file's place".into(),
        remedy: "take a weather file of the scene's place, or correct that (--at, [site])".into(),
    })
}

/// The scene at the place of a weather file, seen by nothing yet: under the sun of a noon of June, which each hour replaces. Where that
/// place is another than the scene's, [`elsewhere`] says so.
///
/// # Errors
/// Those of [`Conditions::new`].
pub fn conditions(mut scene: Scene, request: &Request, file: &WeatherFile) -> Result<Conditions> {
    scene.sun = None;
    scene.site = Some(SiteEntry {
        latitude_deg: file.latitude_deg,
        longitude_deg: file.longitude_deg,
        elevation: file.elevation,
        timezone: None,
    });
    // Noon in the zone of the file: the sun is up, but for the polar night.
    let minutes = (file.zone_h * 60.0).round() as i64;
    let sign = if minutes < 0 { '-' } else { '+' };
    let (hours, minutes) = (minutes.abs() / 60, minutes.abs() % 60);
    scene.time = Some(format!("2021-06-21T12:00:00{sign}{hours:02}:{minutes:02}"));
    let request = Request {
        camera: CameraChoice::Given(Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0)),
        timezone: None,
        ..request.clone()
    };
    Conditions::new(scene, &request)
}

impl Year {
    /// Prepares it.
    ///
    /// # Errors
    /// [`Error::Domain`] for another division of the sky, [`Error::Failed`] when memory does not suffice, [`Error::Stopped`] when the work
    /// was stopped, and those of [`Conditions::seen_from`].
    pub fn new(
        conditions: &Conditions,
        sensors: impl Into<Arc<[Receiver]>>,
        fineness: &Fineness,
        task: Task<'_>,
    ) -> Result<Self> {
        Self::shining(conditions, sensors, 0..0, fineness, task)
    }

    /// The same where some triangles shine by their fronts ([`Year::add_shining`]): behind the sensors stands a receiver on the back of
    /// each patch of them.
    ///
    /// # Errors
    /// Those of [`Year::new`].
    pub fn shining(
        conditions: &Conditions,
        sensors: impl Into<Arc<[Receiver]>>,
        triangles: Range<u32>,
        fineness: &Fineness,
        task: Task<'_>,
    ) -> Result<Self> {
        if ![1, 2, 4].contains(&fineness.patches) {
            return Err(Error::domain(
                "the division of the sky",
                fineness.patches,
                "1, 2 or 4",
                "1 gives 145 patches, 2 gives 577, 4 gives 2305",
            ));
        }
        let mut sensors: Arc<[Receiver]> = sensors.into();
        let mut conditions = conditions.seen_from(View::of_points(sensors.clone()))?;
        // Lamps are no daylight.
        conditions.lamps = Vec::new().into();
        let detail = Detail {
            sky: fineness.patches,
            ..fineness.detail
        };
        let transport = Transport::with_shining(
            &conditions,
            detail,
            None,
            triangles.clone(),
            task.stage("who sees whom"),
        )?;
        let (mut emitters, mut shining) = (Vec::new(), Vec::new());
        if !triangles.is_empty() {
            let mut all = sensors.to_vec();
            for (patch, triangle, back) in transport.fronts(triangles) {
                emitters.push(patch);
                shining.push(triangle);
                all.push(back);
            }
            sensors = all.into();
            conditions = conditions.seen_from(View::of_points(sensors.clone()))?;
        }
        let task = task.stage("daylight coefficients");
        let coefficients =
            Coefficients::new(&transport, &sensors, &emitters, fineness.unshot, task)?;
        Ok(Year {
            conditions,
            transport,
            coefficients,
            sensors,
            shining,
        })
    }

    /// Of each patch that shines a triangle of the scene: they stand in the order of the last receivers.
    pub fn shining_triangles(&self) -> &[u32] {
        &self.shining
    }

    /// Adds what patches that shine give to the illuminance of all receivers [lx], by the exitance of each [lm/m2].
    pub fn add_shining(&self, exitances: &[f64], illuminances: &mut [f64]) {
        self.coefficients.add_emitted(exitances, illuminances);
    }

    /// The coefficients.
    pub fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    /// The conditions of its scene, seen by its sensors.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// The conditions under the sun and the sky of an hour.
    pub fn at(&self, hour: &Hour) -> Conditions {
        let mut now = self.conditions.clone();
        now.sun = hour.sun;
        now.sky = Some(hour.sky.clone());
        now
    }

    /// What the sensors receive in an hour [lx]: in all, and straight from the sun.
    pub fn hour(&self, hour: &Hour) -> [Vec<f64>; 2] {
        let mut total = vec![0.0; self.sensors.len()];
        self.coefficients.add_sky(&hour.sky, &mut total);
        let mut straight = vec![0.0; self.sensors.len()];
        let now = self.at(hour);
        if let Some(sun) = DirectSun::new(&now) {
            self.coefficients
                .add_reflected_sun(&self.transport, &now, &mut total);
            let mut work = DiscWork::default();
            for (sensor, (total, straight)) in
                self.sensors.iter().zip(total.iter_mut().zip(&mut straight))
            {
                *straight = luminance(sun.on(sensor, &mut work));
                *total += *straight;
            }
        }
        [total, straight]
    }

    /// The table of a year's lit hours; `clock` tells the local clock of the middle of an hour [h].
    ///
    /// Memory: 8 bytes an hour and sensor.
    ///
    /// # Errors
    /// [`Error::Failed`] when memory does not suffice, [`Error::Stopped`] when the work was stopped.
    pub fn table(
        &self,
        hours: &Hours,
        clock: impl Fn(&Hour) -> f64,
        task: Task<'_>,
    ) -> Result<Table> {
        let points = self.sensors.len();
        let cells = hours.lit.len().saturating_mul(points);
        memory::check("the table of hours", 16 * cells as u64)?;
        let pieces = task.stage("hours of the year").pieces(hours.lit.len());
        let rows: Result<Vec<[Vec<f32>; 2]>> = hours
            .lit
            .par_iter()
            .map(|hour| {
                pieces.begin()?;
                Ok(self
                    .hour(hour)
                    .map(|row| row.into_iter().map(|e| e as f32).collect()))
            })
            .collect();
        let mut table = Table {
            hours: hours.count,
            points,
            total: Vec::with_capacity(cells),
            sun: Vec::with_capacity(cells),
            stamps: hours
                .lit
                .iter()
                .map(|hour| Stamp {
                    number: hour.number,
                    date: hour.date,
                    hour: hour.hour,
                    clock: clock(hour),
                    diffuse: hour.diffuse(),
                })
                .collect(),
        };
        for [total, sun] in rows? {
            table.total.extend(total);
            table.sun.extend(sun);
        }
        Ok(table)
    }

    /// The daylight factor of each sensor [1] under a CIE sky: 16, the overcast one, or 1.
    ///
    /// # Errors
    /// [`Error::Domain`] for another number than 1 to 16.
    pub fn factors(&self, kind: u8) -> Result<Vec<f64>> {
        let model = Model::Cie {
            kind,
            turbidity: crate::sky::DEFAULT_TURBIDITY,
            irradiance: None,
        };
        let sky = Sky::new(
            model,
            SunAt::unrefracted(DVec3::new(0.6, 0.8, 0.0).normalize()),
        )?;
        let mut received = vec![0.0; self.sensors.len()];
        self.coefficients.add_sky(&sky, &mut received);
        let open = luminance(sky.horizontal_illuminance());
        Ok(received.into_iter().map(|e| e / open).collect())
    }
}
