//! How far a picture is from the reference: measured on some of its pixels.
//!
//! The measure is relative RMSE = sqrt(mean((L - R)^2)) / mean(R) over luminances; its interval is a bootstrap of the same
//! number. Pixels are drawn at random, one from each cell of an even grid (stratified), always the same ones for a size.

pub mod flip;

use crate::colour::luminance;
use crate::effect::Field;
use crate::error::{Error, Result};
use crate::frame::{Frame, Layer};
use crate::plan::Plan;
use crate::reference::Reference;
use glam::{DVec3, UVec2};
use serde::Serialize;

/// Resamplings of the bootstrap.
const RESAMPLINGS: usize = 1000;

/// The measured error of one layer, or of the whole picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LayerError {
    /// A layer's name, or `picture`.
    pub layer: &'static str,
    /// Mean luminance of the reference over the pixels [cd/m2].
    pub mean: f64,
    /// Relative RMSE [1]; 0 where picture and reference are both black.
    pub relative_rmse: f64,
    /// The ends of its 95 % interval.
    pub interval: [f64; 2],
    /// 99th percentile over pixels of |L - R| / max(R, mean(R) / 100) [1].
    pub percentile_99: f64,
}

/// The measured error of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Pixels that were compared.
    pub pixels: usize,
    /// The layers that the reference makes, in their order, and the picture.
    pub layers: Vec<LayerError>,
}

impl Check {
    /// The error of the whole picture.
    pub fn picture(&self) -> &LayerError {
        let last = self.layers.last();
        last.expect("the picture is always in the list")
    }
}

/// Compares about `count` pixels of a picture with the reference under `yardstick`, a plan for the same conditions.
///
/// # Errors
/// [`Error::Input`] for a count of zero, or a picture of another size.
pub fn check(frame: &Frame, yardstick: &Plan, count: usize) -> Result<Check> {
    let size = yardstick.conditions.size;
    if [frame.width, frame.height] != size {
        return Err(Error::input(
            "the picture to check",
            format!(
                "it has {} x {} pixels, the plan {} x {}",
                frame.width, frame.height, size[0], size[1]
            ),
            "render and check with the same --size",
        ));
    }
    if count == 0 {
        return Err(Error::input(
            "--check 0",
            "no pixel would be compared",
            "give a number of pixels, say 1000",
        ));
    }
    let pixels = stratified(size, count);
    let index = |p: &UVec2| (p.y * size[0] + p.x) as usize;
    let made: Vec<_> = Field::LAYERS
        .iter()
        .map(|field| frame.layer(field.name()))
        .collect();
    let ours: Vec<[DVec3; 7]> = pixels
        .iter()
        .map(|p| {
            let at = |layer: &Option<&Layer>| {
                layer.map_or(DVec3::ZERO, |layer| layer.rgb[index(p)].as_dvec3())
            };
            std::array::from_fn(|slot| at(&made[slot]))
        })
        .collect();
    Ok(judge(&ours, yardstick, &pixels))
}

/// Compares about `count` pixels of what the reference makes of a plan with what it makes of another, without a whole picture.
///
/// # Errors
/// [`Error::Input`] for a count of zero.
pub fn compare(plan: &Plan, yardstick: &Plan, count: usize) -> Result<Check> {
    if count == 0 {
        return Err(Error::input(
            "the pixels to compare",
            "there are none",
            "give a number of pixels, say 1000",
        ));
    }
    let conditions = plan.conditions;
    let pixels = stratified(conditions.size, count);
    let ours: Vec<[DVec3; 7]> = Reference::new(plan)
        .sampled(&pixels, conditions.samples)
        .iter()
        .map(|values| std::array::from_fn(|slot| values[slot]))
        .collect();
    Ok(judge(&ours, yardstick, &pixels))
}

/// The error of the layers and of their sum at some pixels.
fn judge(ours: &[[DVec3; 7]], yardstick: &Plan, pixels: &[UVec2]) -> Check {
    let truth = Reference::new(yardstick).sampled(pixels, yardstick.conditions.samples);
    let written = yardstick.written();
    let mut layers = Vec::new();
    for (slot, field) in Field::LAYERS.iter().enumerate() {
        if written.contains(field) {
            let pairs = ours.iter().zip(&truth);
            let pairs = pairs.map(|(o, t)| [luminance(o[slot]), luminance(t[slot])]);
            layers.push(error(field.name(), &pairs.collect::<Vec<_>>()));
        }
    }
    let pairs = ours.iter().zip(&truth).map(|(o, t)| {
        let (ours, truth): (DVec3, DVec3) = (o.iter().sum(), t[..7].iter().sum());
        [luminance(ours), luminance(truth)]
    });
    layers.push(error("picture", &pairs.collect::<Vec<_>>()));
    Check {
        pixels: pixels.len(),
        layers,
    }
}

/// Deterministic noise.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        // xorshift64* (Vigna 2016); the product's upper half divides evenly.
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let word = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D);
        ((u128::from(word) * u128::from(n)) >> 64) as u64
    }
}

/// One random pixel of each cell of a grid of about `count` cells; all pixels when there are no more.
fn stratified([width, height]: [u32; 2], count: usize) -> Vec<UVec2> {
    let aspect = f64::from(width) / f64::from(height);
    let columns = (count as f64 * aspect)
        .sqrt()
        .round()
        .clamp(1.0, f64::from(width)) as u32;
    let rows = (count as f64 / f64::from(columns))
        .round()
        .clamp(1.0, f64::from(height)) as u32;
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut place = |cell: u32, cells: u32, side: u32| {
        let edge = |i: u32| (u64::from(i) * u64::from(side) / u64::from(cells)) as u32;
        let from = edge(cell);
        from + random.below(u64::from(edge(cell + 1) - from)) as u32
    };
    let mut pixels = Vec::with_capacity((columns * rows) as usize);
    for row in 0..rows {
        for column in 0..columns {
            pixels.push(UVec2::new(
                place(column, columns, width),
                place(row, rows, height),
            ));
        }
    }
    pixels
}

/// sqrt(mean((L - R)^2)) / mean(R) over pairs of L and R; 0 where they are equal.
pub(crate) fn relative_rmse(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut square, mut sum, mut n) = (0.0, 0.0, 0.0);
    for [found, truth] in pairs {
        square += (found - truth) * (found - truth);
        sum += truth;
        n += 1.0;
    }
    if square == 0.0 {
        0.0
    } else {
        (square / n).sqrt() / (sum / n)
    }
}

/// The value below which a share `q` of a sorted list lies; 0 for an empty one.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((q * last as f64).round() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// 99th percentile of |L - R| / max(R, mean(R) / 100) over pairs of L and R.
pub(crate) fn percentile_99(pairs: &[[f64; 2]]) -> f64 {
    let mean = pairs.iter().map(|p| p[1]).sum::<f64>() / pairs.len() as f64;
    let mut single: Vec<f64> = pairs
        .iter()
        .map(|[found, truth]| (found - truth).abs() / truth.max(0.01 * mean))
        .filter(|e| e.is_finite())
        .collect();
    single.sort_unstable_by(f64::total_cmp);
    quantile(&single, 0.99)
}

fn error(layer: &'static str, pairs: &[[f64; 2]]) -> LayerError {
    let mean = pairs.iter().map(|p| p[1]).sum::<f64>() / pairs.len() as f64;
    let mut random = Random(0xD1B5_4A32_D192_ED03);
    let n = pairs.len() as u64;
    let mut resampled: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| relative_rmse((0..n).map(|_| pairs[random.below(n) as usize])))
        .filter(|e| e.is_finite())
        .collect();
    resampled.sort_unstable_by(f64::total_cmp);
    LayerError {
        layer,
        mean,
        relative_rmse: relative_rmse(pairs.iter().copied()),
        interval: [quantile(&resampled, 0.025), quantile(&resampled, 0.975)],
        percentile_99: percentile_99(pairs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_gives_one_pixel() {
        let pixels = stratified([64, 32], 200);
        assert_eq!(pixels.len(), 200);
        for (i, pixel) in pixels.iter().enumerate() {
            let (column, row) = (i as u32 % 20, i as u32 / 20);
            assert!(pixel.x >= column * 64 / 20 && pixel.x < (column + 1) * 64 / 20);
            assert!(pixel.y >= row * 32 / 10 && pixel.y < (row + 1) * 32 / 10);
        }
        let all = stratified([5, 3], 1_000_000);
        assert_eq!(all.len(), 15);
        assert_eq!(stratified([1, 1], 10), [UVec2::ZERO]);
    }

    #[test]
    fn the_interval_holds_the_truth_about_as_often_as_it_says() {
        // Errors of known size: found = truth + noise of variance 1/12 around a truth of 10.
        let exact = (1.0f64 / 12.0).sqrt() / 10.0;
        let mut random = Random(7);
        let mut held = 0;
        for _ in 0..100 {
            let pairs: Vec<[f64; 2]> = (0..300)
                .map(|_| {
                    [
                        9.5 + random.below(1 << 20) as f64 / f64::from(1 << 20),
                        10.0,
                    ]
                })
                .collect();
            let found = error("picture", &pairs);
            let [low, high] = found.interval;
            assert!(low <= found.relative_rmse && found.relative_rmse <= high);
            held += usize::from(low <= exact && exact <= high);
        }
        assert!((88..=100).contains(&held), "{held}");
    }

    #[test]
    fn equal_pictures_have_no_error_and_black_ones_are_finite() {
        let same = error("sun", &[[2.0, 2.0], [0.0, 0.0]]);
        assert_eq!(
            (same.relative_rmse, same.interval, same.percentile_99),
            (0.0, [0.0; 2], 0.0)
        );
        let black = error("sun", &[[0.0, 0.0]; 4]);
        assert_eq!((black.relative_rmse, black.percentile_99), (0.0, 0.0));
    }
}
