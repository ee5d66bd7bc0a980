//! How far numbers are from the truth.
//!
//! The measure is relative RMSE = sqrt(mean((L - R)^2)) / mean(R) over luminances; its interval is a bootstrap of the same
//! number. Of whole pictures there is FLIP too. What compares a picture with the reference is [`crate::backend::check`].

pub mod flip;

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

/// Deterministic noise.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number from 0 to n - 1.
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        // xorshift64* (Vigna 2016); the product's upper half divides evenly.
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let word = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D);
        ((u128::from(word) * u128::from(n)) >> 64) as u64
    }
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

/// The error of one layer from pairs of L and R.
pub(crate) fn error(layer: &'static str, pairs: &[[f64; 2]]) -> LayerError {
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
