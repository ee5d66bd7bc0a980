//! The distances along eye rays at which the air's source is known.

use crate::medium::FARTHEST;

/// Ascending distances from the eye, the first 0, the same along all rays of a picture.
pub struct Knots(Vec<f64>);

impl Knots {
    /// Knots whose distance from each other is a share of their distance from the eye, of `near` at least [m]. While the
    /// optical depth in air of the coefficient `extinction` [1/m] is less than some mean free paths, they are no farther apart
    /// than one of these.
    pub fn new(share: f64, near: f64, extinction: f64) -> Self {
        const DENSE: f64 = 8.0;
        let near = near.clamp(1e-6, 1e-2 * FARTHEST);
        let mut distances = vec![0.0];
        let mut last = 0.0f64;
        while last < FARTHEST {
            let wide = share * last.max(near);
            let step = match extinction * last < DENSE {
                true => wide.min(0.5 / extinction),
                false => wide,
            };
            last += step;
            distances.push(last);
        }
        Knots(distances)
    }

    /// All of them [m].
    pub fn distances(&self) -> &[f64] {
        &self.0
    }

    /// The last knot that is not farther than a distance.
    pub fn before(&self, distance: f64) -> usize {
        self.0.partition_point(|t| *t <= distance).max(1) - 1
    }

    /// Where between a knot and the next a distance is, 0 to 1.
    pub fn share(&self, knot: usize, distance: f64) -> f64 {
        match self.0.get(knot + 1) {
            Some(next) => ((distance - self.0[knot]) / (next - self.0[knot])).clamp(0.0, 1.0),
            None => 0.0,
        }
    }
}
