//! Sums of periodic terms, of which every tier above `minute` is made.

use super::trigonometry::{cosine, cosines};

/// Amplitude, phase [rad] and rate [rad per unit of time].
pub(super) type Term = [f64; 3];

/// So many terms go through vector registers side by side.
const SIDE_BY_SIDE: usize = 8;

/// The polynomial in `t` whose coefficients are sums of a cos(b + c t).
///
/// The phases may reach 3e6 radians; each cosine is good to 2e-12 (of phases known to 1e-10 then).
pub(super) fn periodic(powers: &[&[Term]], t: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, terms| {
        let (groups, rest) = terms.as_chunks::<SIDE_BY_SIDE>();
        let mut sums = [0.0; SIDE_BY_SIDE];
        for group in groups {
            let cosines = cosines(group.map(|[_, b, c]| b + c * t));
            for ((sum, [a, ..]), cosine) in sums.iter_mut().zip(group).zip(cosines) {
                *sum += a * cosine;
            }
        }
        let rest: f64 = rest.iter().map(|[a, b, c]| a * cosine(b + c * t)).sum();
        sum * t + (sums.iter().sum::<f64>() + rest)
    })
}
