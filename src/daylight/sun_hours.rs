//! Hours of sun on a day: for how long each sensor sees the middle of the sun's disc, by the local clock.
//!
//! The day is cut into steps; the sun of the middle of a step stands for it. A sensor has sun where it faces it, nothing opaque stands
//! between, and the sun stands at least so high. Glass lets it through; clouds are not counted.
//!
//! EN 17037 asks for 1.5 (minimum), 3 (medium) or 4 hours (high) on a day between 1 February and 21 March, at a reference point of
//! an opening, for a sun above a least height that goes by the place.

use super::direct_sun::clearance;
use crate::conditions::{Conditions, Receiver, toward};
use crate::ephemeris::civil::Zone;
use crate::ephemeris::{Instant, Site, Tier, Weather, sun_position};
use crate::error::{Error, Result};
use crate::scene::Ray;
use crate::task::Task;
use crate::units::DEG;
use chrono::{DateTime, FixedOffset, NaiveDate, NaiveTime, TimeDelta};
use glam::DVec3;
use rayon::prelude::*;

/// Hours of the levels minimum, medium and high (EN 17037, table A.6).
pub const LEVELS: [(&str, f64); 3] = [("minimum", 1.5), ("medium", 3.0), ("high", 4.0)];

/// The day and how it is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// The day, by the local clock.
    pub date: NaiveDate,
    /// From this time of the local clock on.
    pub from: NaiveTime,
    /// To this one; `None`: to midnight.
    pub to: Option<NaiveTime>,
    /// How long a step is [s], 1 to 3 600.
    pub step_s: u32,
    /// The sun counts from this elevation on [degrees].
    pub least_elevation_deg: f64,
}

impl Span {
    /// A whole day in steps of five minutes, every sun above the horizon.
    pub fn of_day(date: NaiveDate) -> Self {
        Span {
            date,
            from: NaiveTime::MIN,
            to: None,
            step_s: 300,
            least_elevation_deg: 0.0,
        }
    }
}

/// The sun in a step of the day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The middle of the step, local clock.
    pub local: DateTime<FixedOffset>,
    /// Toward the sun, scene axes.
    pub toward: DVec3,
}

/// Hours of sun.
#[derive(Debug, Clone, PartialEq)]
pub struct SunHours {
    /// Those steps in which the sun is high enough.
    pub steps: Vec<Step>,
    /// The length of a step [h].
    pub step_h: f64,
    /// Hours of sun of each sensor [h].
    pub hours: Vec<f64>,
    /// The middle of the first and the last step with sun of each sensor.
    pub first_last: Vec<Option<Ends>>,
}

/// The first and the last step with sun, by the local clock.
pub type Ends = [DateTime<FixedOffset>; 2];

impl SunHours {
    /// Those of sensors in a scene at a place.
    ///
    /// # Errors
    /// [`Error::Domain`] for steps that are too short or too long and for an elevation beyond the zenith, [`Error::Input`] for a span that
    /// ends before it begins or is shorter than a step, and for a day that the zone does not have, [`Error::Stopped`] when the work was stopped.
    pub fn new(
        conditions: &Conditions,
        sensors: &[Receiver],
        site: &Site,
        zone: &Zone,
        span: &Span,
        task: Task<'_>,
    ) -> Result<Self> {
        let steps = steps(conditions, site, zone, span)?;
        let step_h = f64::from(span.step_s) / 3600.0;
        let pieces = task.stage("hours of sun").pieces(sensors.len());
        let found: Result<Vec<(usize, Option<Ends>)>> = sensors
            .par_iter()
            .map(|sensor| {
                pieces.begin()?;
                let lit = steps
                    .iter()
                    .filter(|step| sees(conditions, sensor, step.toward));
                let lit: Vec<&Step> = lit.collect();
                let ends = lit.first().zip(lit.last());
                Ok((lit.len(), ends.map(|(a, b)| [a.local, b.local])))
            })
            .collect();
        let (counts, first_last): (Vec<usize>, Vec<_>) = found?.into_iter().unzip();
        Ok(SunHours {
            steps,
            step_h,
            hours: counts.iter().map(|count| *count as f64 * step_h).collect(),
            first_last,
        })
    }
}

/// The steps of a day in which the sun is high enough.
fn steps(conditions: &Conditions, site: &Site, zone: &Zone, span: &Span) -> Result<Vec<Step>> {
    if !(1..=3600).contains(&span.step_s) {
        return Err(Error::domain(
            "the step of hours of sun",
            format!("{} s", span.step_s),
            "1 s to 1 h",
            "5min is usual",
        ));
    }
    if !(-1.0..90.0).contains(&span.least_elevation_deg) {
        return Err(Error::domain(
            "the least elevation of the sun",
            format!("{} degrees", span.least_elevation_deg),
            "-1 to 90 degrees",
            "EN 17037 has a value for each place",
        ));
    }
    if span.to.is_some_and(|to| to <= span.from) {
        return Err(Error::input(
            "--from and --to",
            "the span ends before it begins",
            "give times of the local clock, the earlier one first",
        ));
    }
    let end = span.to.map_or(TimeDelta::days(1), |to| to - NaiveTime::MIN);
    if end - (span.from - NaiveTime::MIN) < TimeDelta::seconds(i64::from(span.step_s)) {
        return Err(Error::input(
            "--from and --to",
            "the span is shorter than a step",
            "choose a shorter step (--every) or a longer span",
        ));
    }
    let (begin, end) = zone.day(span.date)?;
    let weather = Weather::standard(site);
    let north = conditions.scene.north_deg * DEG;
    let step = TimeDelta::seconds(i64::from(span.step_s));
    let mut steps = Vec::new();
    let mut middle = begin + step / 2;
    while middle < end {
        let local = zone.local(middle);
        let time = local.time();
        if time >= span.from && span.to.is_none_or(|to| time < to) {
            let sun = sun_position(Tier::Spa, &Instant::from_utc(middle)?, site, &weather);
            if sun.elevation_apparent >= span.least_elevation_deg * DEG {
                steps.push(Step {
                    local,
                    toward: toward(sun.azimuth, sun.elevation_apparent, north),
                });
            }
        }
        middle += step;
    }
    Ok(steps)
}

/// Whether a sensor faces the sun and sees it.
fn sees(conditions: &Conditions, sensor: &Receiver, toward: DVec3) -> bool {
    if sensor.normal.dot(toward) <= 0.0 {
        return false;
    }
    let near = clearance(conditions, sensor.position);
    let ray = Ray {
        origin: sensor.position + near * sensor.normal,
        direction: toward,
    };
    let through = conditions.geometry.transmittance(&ray, near, f64::INFINITY);
    through.max_element() > 0.0
}
