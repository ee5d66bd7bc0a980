//! Sums of periodic terms, of which every tier above `minute` is made.

use super::trigonometry::cosine;

/// Amplitude, phase [rad] and rate [rad per unit of time].
pub(super) type Term = [f64; 3];

/// The polynomial in `t` whose coefficients are sums of a cos(b + c t).
///
/// The phases may reach 3e6 radians; each cosine is good to 2e-12 (of phases known to 1e-10 then).
pub(super) fn periodic(powers: &[&[Term]], t: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, terms| {
        // Four at a time go through vector registers side by side; they are added in their order.
        let (fours, rest) = terms.as_chunks::<4>();
        let mut power = 0.0;
        for four in fours {
            let mut values = [0.0; 4];
            for (value, [a, b, c]) in values.iter_mut().zip(four) {
                *value = a * cosine(b + c * t);
            }
            power = values.iter().fold(power, |sum, value| sum + value);
        }
        for [a, b, c] in rest {
            power += a * cosine(b + c * t);
        }
        sum * t + power
    })
}
