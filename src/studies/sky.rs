//! What the sky's knobs cost: patches of the dome, size of a map, bands of the sun's spectrum.
//!
//! Each is compared with the sky itself. What a room gets is measured by the illuminance of planes: level, and upright
//! toward twelve azimuths. What an eye sees is measured direction by direction.

use std::f64::consts::PI;
use std::time::Instant as Clock;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::colour::luminance;
use crate::error::Result;
use crate::sky::map::{Map, Projection};
use crate::sky::patches::{Patch, Subdivision, dome, radiances};
use crate::sky::sun::in_bands;
use crate::sky::{DEFAULT_TURBIDITY, Model, Sky, SunAt, SunPath};
use crate::units::DEG;

/// What one setting of a knob costs and gives.
#[derive(Clone, Debug)]
pub struct Price {
    /// What is set: `patches`, `map` or `bands`.
    pub knob: &'static str,
    /// To what, in words.
    pub setting: String,
    /// How many patches, texels or bands that is.
    pub count: usize,
    /// Median time of making it, on all cores for a map and on one otherwise [s].
    pub seconds: f64,
    /// The worst relative error of a plane's illuminance; of bands, of the sun's [1].
    pub illuminance_error: f64,
    /// The RMS relative error of the luminance of a direction; of bands, the worst distance in CIE 1976 u', v' [1].
    pub detail_error: f64,
}

/// The sun's height that patches and maps are measured with [degrees].
pub const SUN_ELEVATION_DEG: f64 = 30.0;

/// Directions that detail is measured at.
const DIRECTIONS: usize = 20_000;

/// The prices of the clear default sky, and of two other models' largest map. Takes some seconds.
///
/// # Errors
/// None that a caller could cause.
pub fn prices() -> Result<Vec<Price>> {
    let model = Model::Perez {
        turbidity: DEFAULT_TURBIDITY,
        irradiance: None,
    };
    let elevation = SUN_ELEVATION_DEG * DEG;
    // No texel or patch lies evenly about this azimuth.
    let toward_sun = at_height(1.234, elevation.sin());
    let study = Study::new(Sky::new(model, SunAt::unrefracted(toward_sun))?);
    let mut prices = Vec::new();
    for (setting, subdivision) in [
        ("Tregenza", Subdivision::Tregenza),
        ("Reinhart 2", Subdivision::Reinhart(2)),
        ("Reinhart 4", Subdivision::Reinhart(4)),
        ("triangles", Subdivision::Triangles),
        ("Reinhart 8", Subdivision::Reinhart(8)),
    ] {
        prices.push(study.patches(setting, &dome(subdivision)?));
    }
    for height in [64, 128, 256, 512, 1024, 2048] {
        let map = Map::new(Projection::Equirectangular, 2 * height, height)?;
        prices.push(study.map(String::new(), map)?);
    }
    // The other models cost otherwise; the largest map shows it.
    for model in [
        Model::Hosek {
            turbidity: DEFAULT_TURBIDITY,
            albedo: 0.2,
        },
        Model::Preetham {
            turbidity: DEFAULT_TURBIDITY,
        },
    ] {
        let other = Study::new(Sky::new(model, SunAt::unrefracted(toward_sun))?);
        let map = Map::new(Projection::Equirectangular, 4096, 2048)?;
        prices.push(other.map(format!(" {}", model.name()), map)?);
    }
    for merged in [32, 16, 8, 4, 2, 1] {
        prices.push(bands(merged)?);
    }
    Ok(prices)
}

struct Study {
    sky: Sky,
    /// Illuminance of the planes [lx], by half a million directions.
    planes: Vec<f64>,
    /// Directions evenly over the dome, and the luminance there [cd/m2].
    directions: Vec<(DVec3, f64)>,
}

impl Study {
    fn new(sky: Sky) -> Self {
        let (rings, steps) = (1024, 512);
        let planes = (0..rings)
            .into_par_iter()
            .map(|i| {
                // Crowded at the horizon, where upright planes look: y = u^2.
                let u = (f64::from(i) + 0.5) / f64::from(rings);
                let size = 2.0 * u / f64::from(rings) * 2.0 * PI / f64::from(steps);
                (0..steps).fold(vec![0.0; NORMALS], |mut sums, j| {
                    let azimuth = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps);
                    let w = at_height(azimuth, u * u);
                    light(&mut sums, w, luminance(sky.radiance(w)) * size);
                    sums
                })
            })
            .reduce(
                || vec![0.0; NORMALS],
                |a, b| a.iter().zip(b).map(|(a, b)| a + b).collect(),
            );
        let directions = (0..DIRECTIONS)
            .map(|i| {
                // The golden ratio's turns spread evenly.
                let azimuth = 2.0 * PI * (i as f64 * 0.618_033_988_749_895).fract();
                let w = at_height(azimuth, (i as f64 + 0.5) / DIRECTIONS as f64);
                (w, luminance(sky.radiance(w)))
            })
            .collect();
        Study {
            sky,
            planes,
            directions,
        }
    }

    fn patches(&self, setting: &str, patches: &[Patch]) -> Price {
        let (seconds, means) = timed(|| radiances(&self.sky, patches));
        let mut planes = vec![0.0; NORMALS];
        for (mean, patch) in means.iter().zip(patches) {
            light(
                &mut planes,
                patch.direction,
                luminance(*mean) * patch.solid_angle,
            );
        }
        Price {
            knob: "patches",
            setting: setting.to_owned(),
            count: patches.len(),
            seconds,
            illuminance_error: self.worst_plane(&planes),
            detail_error: self.rms(|w| {
                let nearest = patches
                    .iter()
                    .zip(&means)
                    .max_by(|a, b| a.0.direction.dot(w).total_cmp(&b.0.direction.dot(w)));
                nearest.map_or(0.0, |(_, mean)| luminance(*mean))
            }),
        }
    }

    fn map(&self, model: String, map: Map) -> Result<Price> {
        let width = map.width as usize;
        let (seconds, texels) = timed(|| map.paint(&self.sky, DVec3::ZERO));
        let texels = texels?;
        let luminances: Vec<f64> = texels.iter().map(|v| luminance(v.as_dvec3())).collect();
        let mut planes = vec![0.0; NORMALS];
        for (i, l) in luminances.iter().enumerate() {
            let (x, y) = ((i % width) as u32, (i / width) as u32);
            if let Some(w) = map.direction(f64::from(x) + 0.5, f64::from(y) + 0.5)
                && w.y > 0.0
            {
                light(&mut planes, w, l * map.solid_angle(x, y));
            }
        }
        Ok(Price {
            knob: "map",
            setting: format!("{}x{}{model}", map.width, map.height),
            count: luminances.len(),
            seconds,
            illuminance_error: self.worst_plane(&planes),
            detail_error: self.rms(|w| bilinear(&map, &luminances, w)),
        })
    }

    fn worst_plane(&self, planes: &[f64]) -> f64 {
        let errors = planes
            .iter()
            .zip(&self.planes)
            .map(|(a, b)| (a / b - 1.0).abs());
        errors.fold(0.0, f64::max)
    }

    fn rms(&self, found: impl Fn(DVec3) -> f64 + Sync) -> f64 {
        let sum: f64 = self
            .directions
            .par_iter()
            .map(|(w, l)| (found(*w) / l - 1.0).powi(2))
            .sum();
        (sum / DIRECTIONS as f64).sqrt()
    }
}

/// What a renderer reads between the middles of four texels; at the horizon the last row of the sky goes on.
fn bilinear(map: &Map, luminances: &[f64], w: DVec3) -> f64 {
    let point = map.point(w).unwrap_or(DVec2::ZERO) - 0.5;
    let (x, y) = (point.x.floor(), point.y.floor());
    let (u, v) = (point.x - x, point.y - y);
    let at = |dx: f64, dy: f64| {
        let column = (x + dx).rem_euclid(f64::from(map.width)) as usize;
        let row = (y + dy).clamp(0.0, f64::from(map.height / 2) - 1.0) as usize;
        luminances[row * map.width as usize + column]
    };
    (at(0.0, 0.0) * (1.0 - u) + at(1.0, 0.0) * u) * (1.0 - v)
        + (at(0.0, 1.0) * (1.0 - u) + at(1.0, 1.0) * u) * v
}

/// Sunlight in bands of `merged` cells of 5 nm, against bands of one, over the heights of a day.
fn bands(merged: usize) -> Result<Price> {
    let heights: Vec<f64> = (0..=88).map(|i| (2.0 + f64::from(i)) * DEG).collect();
    let path = |height: &f64| SunPath::standard(*height, DEFAULT_TURBIDITY);
    let suns = |merged: usize| -> Result<Vec<DVec3>> {
        heights.iter().map(|h| in_bands(&path(h), merged)).collect()
    };
    let truth = suns(1)?;
    let (seconds, found) = timed(|| suns(merged));
    let (mut illuminance, mut colour) = (0.0_f64, 0.0_f64);
    for (a, b) in found?.iter().zip(&truth) {
        illuminance = illuminance.max((a.y / b.y - 1.0).abs());
        colour = colour.max(uv(*a).distance(uv(*b)));
    }
    Ok(Price {
        knob: "bands",
        setting: format!("{} nm", 5 * merged),
        // 380 to 780 nm is what the eye sees.
        count: 400 / (5 * merged),
        seconds: seconds / heights.len() as f64,
        illuminance_error: illuminance,
        detail_error: colour,
    })
}

/// CIE 1976 u', v'.
fn uv(xyz: DVec3) -> DVec2 {
    DVec2::new(4.0 * xyz.x, 9.0 * xyz.y) / (xyz.x + 15.0 * xyz.y + 3.0 * xyz.z)
}

/// Planes: level, and upright toward twelve azimuths.
const NORMALS: usize = 13;

/// Adds light from a direction [cd/m2 sr] to the planes' illuminances.
fn light(planes: &mut [f64], w: DVec3, amount: f64) {
    planes[0] += w.y * amount;
    for (i, plane) in planes[1..].iter_mut().enumerate() {
        let (s, c) = (i as f64 * 30.0 * DEG).sin_cos();
        *plane += (w.x * s - w.z * c).max(0.0) * amount;
    }
}

/// The unit vector at an azimuth [rad] from -Z toward +X and of a height `y`.
fn at_height(azimuth: f64, y: f64) -> DVec3 {
    let (s, c) = azimuth.sin_cos();
    let r = (1.0 - y * y).max(0.0).sqrt();
    DVec3::new(r * s, y, -r * c)
}

/// The median time of five runs [s], and what the last gave.
fn timed<T>(run: impl Fn() -> T) -> (f64, T) {
    let mut times = [0.0; 5];
    let mut last = None;
    for time in &mut times {
        let clock = Clock::now();
        last = Some(run());
        *time = clock.elapsed().as_secs_f64();
    }
    times.sort_by(f64::total_cmp);
    (times[2], last.expect("it ran"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_is_better_and_the_finest_is_good() {
        let prices = prices().unwrap();
        for knob in ["patches", "map", "bands"] {
            let of: Vec<&Price> = prices.iter().filter(|p| p.knob == knob).collect();
            assert!(of.len() >= 5);
            let (first, last) = (of[0], of[of.len() - 1]);
            assert!(
                last.illuminance_error < 0.25 * first.illuminance_error,
                "{knob}"
            );
            assert!(last.detail_error < 0.25 * first.detail_error, "{knob}");
            assert!(last.illuminance_error < 2e-3, "{knob}: {last:?}");
            assert!(of.windows(2).all(|pair| pair[0].count <= pair[1].count));
        }
        // D65.
        assert!(
            uv(crate::colour::xyz_from_working(DVec3::ONE)).distance(DVec2::new(0.1978, 0.4683))
                < 1e-3
        );
    }
}
