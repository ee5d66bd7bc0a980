//! A triangle along a chord of a disc: from where to where it reaches, and which of its places are there.

use super::shade::Run;
use glam::DVec2;

/// A triangle along a part of a chord.
pub(super) struct Across {
    /// From where to where, from the chord's middle [radii of the disc].
    pub run: Run,
    /// Weights of the second and third corner at its ends.
    pub ends: [DVec2; 2],
    /// Half the chord.
    half: f64,
    sums: [f64; 2],
}

impl Across {
    /// By the lines opposite the triangle's corners (value in the middle and slope, positive inside) along a chord of half a length;
    /// `None` where it covers none of it.
    pub fn new(lines: [[f64; 2]; 3], half: f64) -> Option<Self> {
        let run = lines.into_iter().fold([-half, half], cut);
        if run[0] >= run[1] {
            return None;
        }
        // Weights of the corners at both ends, not yet divided by their sums.
        let weights = run.map(|l| lines.map(|[a, b]| (a + b * l).max(0.0)));
        let sums = weights.map(|w| (w[0] + w[1] + w[2]).max(f64::MIN_POSITIVE));
        Some(Across {
            run,
            ends: [0, 1].map(|end| {
                let [_, v, w] = weights[end].map(|weight| weight / sums[end]);
                DVec2::new(v, w)
            }),
            half,
            sums,
        })
    }

    /// The whole chord, from its beginning.
    pub fn span(&self) -> Run {
        [0.0, 2.0 * self.half]
    }

    /// The place, from the chord's middle, of a fraction of the way over the triangle: what is even along the triangle is not along the
    /// chord.
    pub fn place(&self, f: f64) -> f64 {
        let [one, other] = self.sums;
        let share = f * one / (f * one + (1.0 - f) * other);
        self.run[0] + share * (self.run[1] - self.run[0])
    }

    /// The same from the chord's beginning.
    pub fn along(&self, f: f64) -> f64 {
        self.place(f) + self.half
    }
}

/// The part of a run where a line, by its value at 0 and its slope, is not negative.
pub(super) fn cut([from, to]: Run, [middle, slope]: [f64; 2]) -> Run {
    if slope > 0.0 {
        [from.max(-middle / slope), to]
    } else if slope < 0.0 {
        [from, to.min(-middle / slope)]
    } else if middle >= 0.0 {
        [from, to]
    } else {
        [to, to]
    }
}
