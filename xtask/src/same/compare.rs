//! How far the files of two pictures are apart.

use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
use std::path::Path;

/// What values may be off by where they need not be the same, relative.
const ALLOWED: f64 = 1e-6;

/// How far two pictures are apart, in words; an error if they differ by more than they may.
pub fn difference(a: &Path, b: &Path, exactly: bool) -> Result<String, String> {
    let [a_channels, b_channels] = [channels(a)?, channels(b)?];
    let names = |channels: &[Channel]| channels.iter().map(|c| c.0.clone()).collect::<Vec<_>>();
    if names(&a_channels) != names(&b_channels) {
        return Err("DIFFERENT layers".into());
    }
    let mut worst = (0.0, String::new());
    for ((name, a), (_, b)) in a_channels.iter().zip(&b_channels) {
        let off = greatest(a, b);
        if off > worst.0 {
            worst = (off, name.clone());
        }
    }
    let (off, name) = worst;
    let [a, b] = [a, b].map(|stem| std::fs::read(stem.with_extension("png")).ok());
    match exactly {
        true if off != 0.0 => Err(format!("DIFFERENT by {off:.1e} in {name}")),
        true if a.is_none() || a != b => Err("DIFFERENT bytes of the PNG".into()),
        false if off > ALLOWED => Err(format!("DIFFERENT by {off:.1e} in {name}")),
        _ if off == 0.0 => Ok("the same".into()),
        _ => Ok(format!("the same to {off:.1e}")),
    }
}

/// The name and the values of one channel.
type Channel = (String, Vec<f32>);

fn channels(stem: &Path) -> Result<Vec<Channel>, String> {
    let path = stem.with_extension("exr");
    let image = read_first_flat_layer_from_file(&path)
        .map_err(|e| format!("{} cannot be read: {e}", path.display()))?;
    let channels = image.layer_data.channel_data.list.iter();
    let values = |samples: &FlatSamples| samples.values_as_f32().collect();
    Ok(channels
        .map(|c| (c.name.to_string(), values(&c.sample_data)))
        .collect())
}

/// The greatest difference of two channels, relative to the value or to the mean if that is more; infinite for lists of
/// different lengths, and where only one of two values is a number.
fn greatest(a: &[f32], b: &[f32]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let finite = a.iter().filter(|v| v.is_finite());
    let mean = finite.map(|v| f64::from(v.abs())).sum::<f64>() / a.len().max(1) as f64;
    let apart = |(a, b): (&f32, &f32)| {
        if a.to_bits() == b.to_bits() {
            return 0.0;
        }
        let [a, b] = [a, b].map(|v| f64::from(*v));
        let off = (a - b).abs() / a.abs().max(mean);
        // Zeros of two signs are different bits too.
        if off.is_nan() {
            f64::INFINITY
        } else {
            off.max(f64::MIN_POSITIVE)
        }
    };
    a.iter().zip(b).map(apart).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_relative_to_the_value_or_the_mean() {
        assert_eq!(greatest(&[1.0, f32::INFINITY], &[1.0, f32::INFINITY]), 0.0);
        assert!((greatest(&[4.0, 0.0], &[5.0, 0.0]) - 0.25).abs() < 1e-9);
        assert!((greatest(&[4.0, 0.0], &[4.0, 1.0]) - 0.5).abs() < 1e-9);
        assert!(greatest(&[0.0], &[-0.0]) > 0.0);
        assert_eq!(greatest(&[1.0], &[f32::NAN]), f64::INFINITY);
        assert_eq!(greatest(&[1.0], &[]), f64::INFINITY);
    }
}
