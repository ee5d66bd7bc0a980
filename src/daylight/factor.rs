//! The daylight factor, and what is said of the values of a grid.
//!
//! D = 100 E / E_out [%]: illuminance indoors over that on open level ground at the same moment, under an overcast sky without sun (CIE
//! 1 or 16 of ISO 15469:2004; EN 17037:2018, annex B, which is told from memory). The sky's level cancels, and the overcast types look
//! the same to all sides: place, time and orientation do not count.

use crate::error::{Error, Result};
use crate::scene::{Scene, SunEntry};
use crate::warning::Warning;
use serde::Serialize;

/// The skies under which daylight factors are defined.
pub const SKIES: [&str; 2] = ["cie:16", "cie:1"];

/// A scene under an overcast sky (`cie:16` where `sky` names none) without sun and lamps: for daylight factors.
///
/// # Errors
/// [`Error::Input`] for another sky.
pub fn overcast(mut scene: Scene, sky: Option<&str>) -> Result<Scene> {
    let sky = sky.unwrap_or(SKIES[0]);
    if !SKIES.contains(&sky) {
        return Err(Error::input(
            format!("--sky {sky}"),
            "daylight factors are those of an overcast sky",
            "leave it out for cie:16, or write cie:1",
        ));
    }
    scene.sky = crate::scene::SkyEntry {
        model: Some(sky.to_owned()),
        ..Default::default()
    };
    (scene.site, scene.time) = (None, None);
    // The sun sets the sky's level, which cancels.
    scene.sun = Some(SunEntry {
        azimuth_deg: 180.0,
        elevation_deg: 45.0,
        illuminance: Some(0.0),
        diameter_deg: Some(0.0),
    });
    scene.lamps.clear();
    scene.lights.clear();
    scene.emissions.clear();
    Ok(scene)
}

/// What is to be said where no sensor has any light of a sky that shines.
pub fn no_daylight(values: impl IntoIterator<Item = f64>) -> Option<Warning> {
    let is_dark = values.into_iter().all(|value| value == 0.0);
    is_dark.then_some(Warning::NoDaylight)
}

/// What is said of values on a plane, each with the area that it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Number of sensors.
    pub sensors: usize,
    /// Area [m2].
    pub area: f64,
    /// Mean by area.
    pub mean: f64,
    /// The value that half of the area reaches.
    pub median: f64,
    /// The least.
    pub minimum: f64,
    /// The greatest.
    pub maximum: f64,
    /// Uniformity: the least over the mean, 0 where all is dark.
    pub uniformity: f64,
}

impl Summary {
    /// Of values and their areas [m2]; `None` without any.
    pub fn new(values: &[(f64, f64)]) -> Option<Self> {
        let area: f64 = values.iter().map(|(_, area)| area).sum();
        let mean = values.iter().map(|(value, area)| value * area).sum::<f64>() / area;
        let minimum = values.iter().map(|v| v.0).reduce(f64::min)?;
        let maximum = values.iter().map(|v| v.0).reduce(f64::max)?;
        Some(Summary {
            sensors: values.len(),
            area,
            mean,
            median: reached(values, 0.5)?,
            minimum,
            maximum,
            uniformity: if mean > 0.0 { minimum / mean } else { 0.0 },
        })
    }
}

/// The value that a share of the area, 0 to 1, reaches or exceeds; `None` without values. Where the share ends between two values
/// it is their mean.
pub fn reached(values: &[(f64, f64)], share: f64) -> Option<f64> {
    let mut from_top = values.to_vec();
    from_top.sort_by(|a, b| b.0.total_cmp(&a.0));
    let wanted = share * from_top.iter().map(|(_, area)| area).sum::<f64>();
    let mut sum = 0.0;
    for (i, (value, area)) in from_top.iter().enumerate() {
        sum += area;
        if (sum - wanted).abs() <= 1e-9 * wanted {
            let next = from_top.get(i + 1).map_or(*value, |next| next.0);
            return Some(0.5 * (value + next));
        }
        if sum > wanted {
            return Some(*value);
        }
    }
    from_top.last().map(|last| last.0)
}

/// The share of the area, 0 to 1, on which values are at least `least`.
pub fn share_above(values: &[(f64, f64)], least: f64) -> f64 {
    let sum = |all: &mut dyn Iterator<Item = &(f64, f64)>| all.map(|(_, area)| area).sum::<f64>();
    sum(&mut values.iter().filter(|(value, _)| *value >= least)) / sum(&mut values.iter())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_count() {
        let values = [(1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (10.0, 1.0)];
        let summary = Summary::new(&values).unwrap();
        assert_eq!((summary.mean, summary.median), (4.0, 2.5));
        assert_eq!(
            (summary.minimum, summary.maximum, summary.uniformity),
            (1.0, 10.0, 0.25)
        );
        let uneven = [(1.0, 3.0), (5.0, 1.0)];
        let summary = Summary::new(&uneven).unwrap();
        assert_eq!(
            (summary.mean, summary.median, summary.area),
            (2.0, 1.0, 4.0)
        );
        assert_eq!(share_above(&uneven, 5.0), 0.25);
        assert_eq!(reached(&uneven, 0.1), Some(5.0));
        assert!(Summary::new(&[]).is_none());
    }

    #[test]
    fn only_overcast_skies_have_factors() {
        assert!(overcast(Scene::default(), Some("perez")).is_err_and(|e| e.is_input()));
        let scene = overcast(Scene::default(), None).unwrap();
        assert_eq!(scene.sky.model.as_deref(), Some("cie:16"));
    }
}
