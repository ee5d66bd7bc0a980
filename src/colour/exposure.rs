//! Exposure: which luminance is white.

/// Luminance [cd/m2] that is white at an exposure value for ISO 100.
///
/// Source: saturation-based speed of ISO 12232, L = 78 / (S q) 2^EV with S = 100 and q = 0.65: 1.2 * 2^EV.
pub fn white_luminance(ev100: f64) -> f64 {
    1.2 * ev100.exp2()
}

/// EV100 at which a luminance [cd/m2] > 0 is the meter's reading: L = 0.125 * 2^EV (ISO 2720 with K = 12.5).
pub fn metered_ev100(luminance: f64) -> f64 {
    (luminance / 0.125).log2()
}

/// The range of exposures that [`auto`] gives: from a moonless night to the sun's disc.
pub const AUTO_RANGE: (f64, f64) = (-16.0, 30.0);

const BINS_PER_STOP: f64 = 8.0;
const FIRST_STOP: f64 = -30.0;
const BINS: usize = 70 * BINS_PER_STOP as usize;

/// Share of the pixels, counted from the darkest, that the mean leaves out, and from where on it leaves out the brightest.
const TRIM: (f64, f64) = (0.05, 0.95);

/// EV100 for a picture of these luminances [cd/m2]; `None` when none of them is positive and finite.
///
/// The geometric mean of the luminances between the 5th and the 95th percentile is metered ([`metered_ev100`]), kept inside
/// [`AUTO_RANGE`]. Luminances fall into eight bins per stop, each shared between the two bins around it, and the
/// percentiles cut bins in part: the result is a continuous function of every luminance and a pixel moves it by at most
/// its share, so that a time-lapse does not flicker and a sun's disc, a lamp or black pixels do not move it at all.
pub fn auto(luminances: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut bins = vec![0.0_f64; BINS];
    let mut total = 0.0;
    for l in luminances {
        if !(l > 0.0 && l.is_finite()) {
            continue;
        }
        let at = ((l.log2() - FIRST_STOP) * BINS_PER_STOP).clamp(0.0, (BINS - 1) as f64);
        let below = (at as usize).min(BINS - 2);
        let part = at - below as f64;
        bins[below] += 1.0 - part;
        bins[below + 1] += part;
        total += 1.0;
    }
    if total == 0.0 {
        return None;
    }
    let (low, high) = (TRIM.0 * total, TRIM.1 * total);
    let (mut before, mut weight, mut sum) = (0.0, 0.0, 0.0);
    for (i, count) in bins.iter().enumerate() {
        let inside = (before + count).min(high) - f64::max(before, low);
        if inside > 0.0 {
            weight += inside;
            sum += inside * (FIRST_STOP + i as f64 / BINS_PER_STOP);
        }
        before += count;
    }
    let ev100 = metered_ev100((sum / weight).exp2());
    Some(ev100.clamp(AUTO_RANGE.0, AUTO_RANGE.1))
}
