//! The lit hours of a weather file: where the sun stands in each, and how bright sun and sky are.
//!
//! Irradiance governs: the sky of an hour is the Perez sky of its direct normal and diffuse horizontal irradiance, with the
//! luminous efficacies of Perez et al. 1990; illuminance columns are compared and never used. The sun stands where it does in the
//! middle of the hour, or of that part of it in which it is up, after the shift by which the file's labels are off ([`label_shift`]).

use super::epw::{Date, Row, WeatherFile, written};
use crate::colour::luminance;
use crate::conditions::{Sun, toward};
use crate::ephemeris::{
    Instant, Julian, Site, SunPosition, Tier, TimeScale, Weather, sun_position,
};
use crate::error::{Error, Result};
use crate::sky::{DEFAULT_TURBIDITY, Irradiance, Model, Sky, SunAt, SunLight, SunPath};
use crate::units::{DAY, DEG};
use crate::warning::Warning;
use chrono::NaiveDate;
use glam::DQuat;
use rayon::prelude::*;
use std::sync::Arc;

/// How often it is asked in an hour that sunrise or sunset splits whether the sun is up.
const PARTS: usize = 12;

/// The greatest shift of labels that is one [h]: more is another zone or place.
const GREATEST: f64 = 1.5;

/// The greatest shift that can be given [h].
const GREATEST_GIVEN: f64 = 12.0;

/// The clock goes by the labels where they are off by less than this [h].
const OTHER_HOUR: f64 = 0.5;

/// A shift that is worth a word [h].
const WORTH: f64 = 0.1;

/// Days to either side in which an hour that was not measured is looked for.
const NEAR: usize = 7;

/// What stands for a sky without light beside a sun with it [W/m2].
const LEAST: f64 = 1.0;

/// A lit hour.
#[derive(Debug, Clone)]
pub struct Hour {
    /// Its number in the year, from 0.
    pub number: usize,
    /// Its date, standard time.
    pub date: Date,
    /// 1 to 24: the hour that ends then, standard time.
    pub hour: u32,
    /// The sun.
    pub sun: Sun,
    /// The sky.
    pub sky: Arc<Sky>,
}

impl Hour {
    /// What the sky gives to open level ground [lx].
    pub fn diffuse(&self) -> f64 {
        luminance(self.sky.horizontal_illuminance())
    }

    /// What sun and sky give to it [lx].
    pub fn global(&self) -> f64 {
        self.diffuse() + self.sun.illuminance_lux() * self.sun.toward.y.max(0.0)
    }
}

/// The lit hours of a year.
#[derive(Debug, Clone)]
pub struct Hours {
    /// They, in order.
    pub lit: Vec<Hour>,
    /// All hours of the year: 8 760 or 8 784.
    pub count: usize,
    /// The sun is taken so much later than the labels say [h].
    pub shift_h: f64,
    /// Where that shift comes from.
    pub shift_from: ShiftFrom,
    /// What was doubtful.
    pub warnings: Vec<Warning>,
}

/// Where the shift of labels comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShiftFrom {
    /// The user.
    Given,
    /// The irradiance.
    Found,
    /// Nowhere: there is too little irradiance to find it by.
    NotFound,
}

/// How well labels and sun agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// The sun's time is so much later than the middle of the labelled hour [h].
    pub hours: f64,
    /// What of the irradiance's squares the sun's height does not explain [1].
    pub rest: f64,
    /// How the light of days goes with the sun that they have, -1 to 1.
    pub season: f64,
}

impl Hours {
    /// Finds them, for a scene whose -Z faces an azimuth [degrees]. `shift_h`, -12 to 12, replaces the shift that the file itself tells.
    ///
    /// # Errors
    /// [`Error::Domain`] for a shift out of range, [`Error::Input`] where place or zone cannot be those of the irradiance, and where too much of it is missing.
    pub fn new(
        file: &WeatherFile,
        north_deg: f64,
        turbidity: Option<f64>,
        shift_h: Option<f64>,
    ) -> Result<Self> {
        if let Some(given) = shift_h
            && !(-GREATEST_GIVEN..=GREATEST_GIVEN).contains(&given)
        {
            return Err(Error::domain(
                "the shift of labels",
                format!("{given} h"),
                format!("-{GREATEST_GIVEN} to {GREATEST_GIVEN} h"),
                "leave --label-shift out: the shift is then found from the irradiance",
            ));
        }
        let site = Site::new(file.latitude_deg, file.longitude_deg, file.elevation)?;
        let mut warnings = file.warnings.clone();
        let mend = |problem: String, instead: &str, remedy: &str| Warning::Weather {
            problem: format!("{}: {problem}", file.file),
            instead: instead.into(),
            remedy: remedy.into(),
        };
        let found = label_shift(file)?;
        if let Some(found) = &found {
            check_season(file, found)?;
        }
        let (shift_h, shift_from) = match (shift_h, found) {
            (Some(given), _) => (given, ShiftFrom::Given),
            (None, None) => {
                warnings.push(mend(
                    "too little irradiance to find by it whether the labels are off".into(),
                    "the sun is taken as the labels say",
                    "give --label-shift if the labels are off",
                ));
                (0.0, ShiftFrom::NotFound)
            }
            (None, Some(found)) => {
                check_shift(file, &found)?;
                if found.hours.abs() >= WORTH {
                    warnings.push(mend(
                        format!(
                            "the irradiance fits a sun {:.2} h {} than the labels say",
                            found.hours.abs(),
                            if found.hours > 0.0 {
                                "later"
                            } else {
                                "earlier"
                            }
                        ),
                        "the sun is taken then",
                        "nothing need be done: the shift is applied (--label-shift gives another)",
                    ));
                }
                (found.hours, ShiftFrom::Found)
            }
        };
        let suns: Result<Vec<Option<SunPosition>>> = file
            .rows
            .par_iter()
            .map(|row| position(row, file.zone_h, shift_h, &site))
            .collect();
        let suns = suns?;
        let light = irradiances(file, &suns, &mut warnings)?;
        let north = north_deg * DEG;
        let turbidity = turbidity.unwrap_or(DEFAULT_TURBIDITY);
        let pressure_hpa = Weather::standard(&site).pressure_hpa();
        let lit: Result<Vec<Option<Hour>>> = (0..file.rows.len())
            .into_par_iter()
            .map(|number| {
                let (Some(position), Some(irradiance)) = (&suns[number], light[number]) else {
                    return Ok(None);
                };
                let toward = toward(position.azimuth, position.elevation_apparent, north);
                let sky = Sky::new(
                    Model::Perez {
                        turbidity,
                        irradiance: Some(irradiance),
                    },
                    SunAt {
                        toward_sun: toward,
                        elevation_true: position.elevation_true,
                        distance_au: position.distance_au,
                        site_elevation: site.elevation(),
                    },
                )?;
                let path = SunPath {
                    distance_au: position.distance_au,
                    pressure_hpa,
                    ..SunPath::standard(position.elevation_apparent, turbidity)
                };
                let light = SunLight {
                    angular_radius: position.angular_radius,
                    ..sky.sunlight(&path)?
                };
                let row = &file.rows[number];
                Ok(Some(Hour {
                    number,
                    date: row.date,
                    hour: row.hour,
                    sun: Sun {
                        toward,
                        light,
                        limb_darkening: true,
                    },
                    sky: Arc::new(sky),
                }))
            })
            .collect();
        let lit: Vec<Hour> = lit?.into_iter().flatten().collect();
        let measured = lit.iter().filter_map(|hour| {
            let measured = file.rows[hour.number].global_illuminance?;
            Some((hour.global(), measured))
        });
        let (own, theirs) = measured.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
        if theirs > 0.0 && (own / theirs - 1.0).abs() > 0.1 {
            warnings.push(mend(
                format!(
                    "its own illuminance is {:.2} of what its irradiance gives over the year",
                    theirs / own
                ),
                "irradiance is gone by",
                "nothing need be done: its illuminance is not used",
            ));
        }
        Ok(Hours {
            lit,
            count: file.rows.len(),
            shift_h,
            shift_from,
            warnings,
        })
    }

    /// The same for a scene whose -Z faces farther from north through east [degrees]: suns and skies turn about the vertical.
    pub fn turned(&self, by_deg: f64) -> Self {
        let turn = by_deg * DEG;
        let mut hours = self.clone();
        if by_deg == 0.0 {
            return hours;
        }
        for hour in &mut hours.lit {
            hour.sun.toward = DQuat::from_rotation_y(turn) * hour.sun.toward;
            hour.sky = Arc::new(hour.sky.turned(turn));
        }
        hours
    }

    /// By how much the clock of an hour's middle is later than its label says [h]: labels that are off by less than half an hour are the
    /// clock's hours, others name another hour.
    pub fn clock_shift_h(&self) -> f64 {
        match self.shift_h.abs() < OTHER_HOUR {
            true => 0.0,
            false => self.shift_h,
        }
    }
}

/// The direct normal and diffuse horizontal irradiance of each hour with light: what was not measured follows from the other two, or is
/// taken from the same hour of the nearest day.
fn irradiances(
    file: &WeatherFile,
    suns: &[Option<SunPosition>],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<Irradiance>>> {
    let (mut derived, mut lonely) = (0, 0);
    let (mut sunless, mut lost) = (0, 0.0);
    let mut missing = Vec::new();
    let mut light: Vec<Option<Irradiance>> = Vec::with_capacity(suns.len());
    for (number, (row, sun)) in file.rows.iter().zip(suns).enumerate() {
        light.push(None);
        let Some(sun) = sun else {
            let given = row.global.or(row.diffuse_horizontal).unwrap_or(0.0);
            if given > LEAST {
                sunless += 1;
                lost += given;
            }
            continue;
        };
        let sine = sun.elevation_apparent.sin();
        let pair = match (row.direct_normal, row.diffuse_horizontal, row.global) {
            (Some(direct), Some(diffuse), _) => Some((direct, diffuse)),
            (Some(direct), None, Some(global)) => {
                derived += 1;
                Some((direct, (global - direct * sine).max(0.0)))
            }
            // A low sun would make much of little.
            (None, Some(diffuse), Some(global)) if sine > 0.05 || global <= diffuse => {
                derived += 1;
                let most = crate::sky::perez::SOLAR_CONSTANT;
                Some((((global - diffuse) / sine).clamp(0.0, most), diffuse))
            }
            _ => None,
        };
        match pair {
            None => missing.push(number),
            Some((0.0, 0.0)) => {}
            Some((direct_normal, diffuse)) => {
                lonely += usize::from(diffuse < LEAST && direct_normal > LEAST);
                let diffuse_horizontal = match direct_normal > LEAST {
                    true => diffuse.max(LEAST),
                    false => diffuse,
                };
                if diffuse_horizontal > 0.0 {
                    light[number] = Some(Irradiance {
                        direct_normal,
                        diffuse_horizontal,
                    });
                }
            }
        }
    }
    if sunless > 0 {
        let all: f64 = (file.rows.iter())
            .filter_map(|row| row.global.or(row.diffuse_horizontal))
            .sum();
        warnings.push(Warning::Weather {
            problem: format!(
                "{}: {sunless} hours without sun have irradiance, {lost:.0} Wh/m2 in all, {:.2} % of the year's",
                file.file,
                100.0 * lost / all
            ),
            instead: "they are taken as dark".into(),
            remedy: "check the file's place and zone if that is much".into(),
        });
    }
    let mut mend = |count: usize, problem: &str, instead: &str| {
        if count > 0 {
            warnings.push(Warning::Weather {
                problem: format!("{}: {count} hours by day {problem}", file.file),
                instead: instead.to_owned(),
                remedy: "take a more complete file of the place if they are many".to_owned(),
            });
        }
    };
    mend(
        derived,
        "lack direct or diffuse irradiance",
        "it follows from the other two",
    );
    mend(
        lonely,
        "have a sun and no light of the sky",
        "the sky's is taken as 1 W/m2",
    );
    mend(
        missing.len(),
        "lack irradiance",
        "they have that of the same hour of the nearest day",
    );
    let measured = light.clone();
    let is_missing = |number: usize| missing.binary_search(&number).is_ok();
    for &number in &missing {
        let near = (1..=NEAR).find_map(|days| {
            let before = number.checked_sub(24 * days);
            let after = Some(number + 24 * days).filter(|other| *other < suns.len());
            let mut days = before.into_iter().chain(after);
            days.find(|other| suns[*other].is_some() && !is_missing(*other))
        });
        match near {
            Some(other) => light[number] = measured[other],
            None => {
                let row = &file.rows[number];
                return Err(Error::input(
                    format!("{}, line {}", file.file, row.line),
                    format!(
                        "irradiance is missing here and {NEAR} days around (hour {} of {}; {} hours by day in all)",
                        row.hour,
                        written(row.date),
                        missing.len()
                    ),
                    "columns 14 to 16 are needed, global, direct normal and diffuse horizontal: name another file",
                ));
            }
        }
    }
    Ok(light)
}

/// The instant of a time of a row's day, hours after its midnight in standard time.
fn instant(row: &Row, hours: f64, zone_h: f64) -> Result<Instant> {
    let Date { month, day } = row.date;
    // A 29 February of a year that has none is the day after the 28th.
    let (date, later) = match NaiveDate::from_ymd_opt(row.year, month, day) {
        Some(date) => (Some(date), 0.0),
        None => (NaiveDate::from_ymd_opt(row.year, month, day - 1), 1.0),
    };
    let date = date.ok_or_else(|| {
        Error::input(
            format!("line {}", row.line),
            format!("there is no {}", written(row.date)),
            "correct the date",
        )
    })?;
    let midnight = Julian::from_date(date, 0.0);
    let later = later * DAY + (hours - zone_h) * 3600.0;
    Instant::from_julian(midnight.plus_seconds(later), TimeScale::Utc, None)
}

/// Where the sun stands in the middle of what of an hour it is up; `None` where it is not.
fn position(row: &Row, zone_h: f64, shift_h: f64, site: &Site) -> Result<Option<SunPosition>> {
    let weather = Weather::standard(site);
    let begin = f64::from(row.hour) - 1.0 + shift_h;
    let at = |hours: f64| -> Result<SunPosition> {
        let instant = instant(row, hours, zone_h)?;
        Ok(sun_position(Tier::Spa, &instant, site, &weather))
    };
    let is_up = |sun: &SunPosition| sun.elevation_apparent > 0.0;
    let (first, middle, last) = (at(begin)?, at(begin + 0.5)?, at(begin + 1.0)?);
    match [&first, &middle, &last].map(is_up) {
        [true, true, true] => return Ok(Some(middle)),
        [false, false, false] => return Ok(None),
        _ => {}
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for part in 0..PARTS {
        let hours = begin + (part as f64 + 0.5) / PARTS as f64;
        if is_up(&at(hours)?) {
            sum += hours;
            count += 1.0;
        }
    }
    match count > 0.0 {
        true => Ok(Some(at(sum / count)?).filter(is_up)),
        false => Ok(None),
    }
}

/// By how much the hours' labels are off, by the shape of the days' global irradiance: it follows the sine of the sun's height, whatever
/// the weather does, as clouds favour neither morning nor afternoon over a year. `None` where fewer than 100 days have light.
///
/// On days on which it is missing the sum of direct normal and diffuse horizontal irradiance stands for it. The sum of direct times sine
/// and diffuse would not do: its sine is that of a shift. This one is as even about noon.
///
/// Each day has a factor of its own; the shift leaves the least sum of squares. It is found within some minutes.
///
/// # Errors
/// [`Error::Input`] for rows whose dates do not exist.
pub fn label_shift(file: &WeatherFile) -> Result<Option<Shift>> {
    let site = Site::new(file.latitude_deg, file.longitude_deg, file.elevation)?;
    let weather = Weather::standard(&site);
    let (sin, cos) = (file.latitude_deg * DEG).sin_cos();
    let mut days = Vec::new();
    for rows in file.rows.chunks(24) {
        let global = rows.iter().map(|row| row.global);
        let sum = rows
            .iter()
            .map(|row| Some(row.direct_normal? + row.diffuse_horizontal?));
        let light = global.collect::<Option<Vec<f64>>>();
        let Some(light) = light.or_else(|| sum.collect()) else {
            continue;
        };
        let noon = instant(&rows[0], 12.0, file.zone_h)?;
        let sun = sun_position(Tier::Minute, &noon, &site, &weather);
        days.push((light, sun.declination.sin_cos(), sun.hour_angle));
    }
    let lit = |(light, ..): &&(Vec<f64>, _, _)| light.iter().any(|g| *g > 0.0);
    if days.iter().filter(lit).count() < 100 {
        return Ok(None);
    }
    // The mean sine of the sun's height above the horizon in an hour that begins so long after noon.
    let height = |(sin_d, cos_d): (f64, f64), at_noon: f64, after_noon: f64| -> f64 {
        let part = |i: u32| {
            let angle = at_noon + 15.0 * DEG * (after_noon + (f64::from(i) + 0.5) / 4.0);
            (sin * sin_d + cos * cos_d * angle.cos()).max(0.0)
        };
        (0..4).map(part).sum::<f64>() / 4.0
    };
    let heights = |day: &(Vec<f64>, (f64, f64), f64), shift: f64| -> Vec<f64> {
        let (_, declination, at_noon) = day;
        (0..24)
            .map(|hour| height(*declination, *at_noon, f64::from(hour) - 12.0 + shift))
            .collect()
    };
    let rest = |shift: f64| -> f64 {
        let squares = days.par_iter().map(|day| {
            let suns = heights(day, shift);
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let all = product(&day.0, &day.0);
            let sun = product(&suns, &suns);
            let explained = match sun > 0.0 {
                true => product(&day.0, &suns).powi(2) / sun,
                false => 0.0,
            };
            (all - explained, all)
        });
        let (rest, all) = squares.reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        rest / all
    };
    let coarse = (-24..24).map(|half| 0.5 * f64::from(half));
    let best = coarse
        .min_by(|a, b| rest(*a).total_cmp(&rest(*b)))
        .unwrap_or(0.0);
    // The least is a parabola's: thirds of what is left around it.
    let (mut low, mut high) = (best - 0.5, best + 0.5);
    while high - low > 0.005 {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        match rest(a) < rest(b) {
            true => high = b,
            false => low = a,
        }
    }
    let hours = 0.5 * (low + high);
    let sums = days.iter().map(|day| {
        let sun: f64 = heights(day, hours).iter().sum();
        (sun, day.0.iter().sum::<f64>())
    });
    Ok(Some(Shift {
        hours,
        rest: rest(hours),
        season: correlation(&sums.collect::<Vec<_>>()),
    }))
}

/// Pearson's.
fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (a, b) = (mean(|p| p.0), mean(|p| p.1));
    let sum =
        |of: &dyn Fn(f64, f64) -> f64| -> f64 { pairs.iter().map(|p| of(p.0 - a, p.1 - b)).sum() };
    let spread = (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt();
    if spread > 0.0 {
        sum(&|x, y| x * y) / spread
    } else {
        0.0
    }
}

/// Whether the irradiance can be that of the header's longitude and zone.
fn check_shift(file: &WeatherFile, shift: &Shift) -> Result<()> {
    if shift.hours.abs() > GREATEST {
        let longitude = file.longitude_deg + 15.0 * shift.hours;
        return Err(Error::input(
            format!("{}, line 1", file.file),
            format!(
                "the irradiance is that of a sun {:.1} h {} than place and zone say",
                shift.hours.abs(),
                if shift.hours > 0.0 {
                    "later"
                } else {
                    "earlier"
                }
            ),
            format!(
                "correct the longitude (about {:.0} would fit the zone) or the zone (about {:+.0} would fit the longitude), \
                 or give --label-shift {:.2}",
                (longitude + 180.0).rem_euclid(360.0) - 180.0,
                file.zone_h - shift.hours,
                shift.hours
            ),
        ));
    }
    Ok(())
}

/// Whether the irradiance can be that of the header's latitude.
fn check_season(file: &WeatherFile, shift: &Shift) -> Result<()> {
    // Near the equator the sun's seasons are none.
    if shift.season < -0.2 && file.latitude_deg.abs() > 15.0 {
        return Err(Error::input(
            format!("{}, line 1", file.file),
            format!(
                "most light falls in the winter of latitude {}",
                file.latitude_deg
            ),
            "correct the latitude: it is negative in the south",
        ));
    }
    Ok(())
}
