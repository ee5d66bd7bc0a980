//! The parts of a ray on which a medium with borders is.

/// A part of a ray on which a medium is, from border to border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chord {
    pub from: f64,
    pub to: f64,
    /// How dense it is there; absent: as its coefficients say.
    pub bulge: Option<Bulge>,
}

/// A density that is a parabola along a ray: rate (square - (t - middle)^2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bulge {
    pub middle: f64,
    pub square: f64,
    pub rate: f64,
}

impl Chord {
    /// One of a homogeneous medium.
    pub fn even(from: f64, to: f64) -> Self {
        Chord {
            from,
            to,
            bulge: None,
        }
    }

    /// Density at a distance along the ray, relative to where the coefficients are those given; within its ends.
    pub fn density(&self, t: f64) -> f64 {
        match self.bulge {
            None => 1.0,
            Some(bulge) => {
                let from_middle = t - bulge.middle;
                (bulge.rate * (bulge.square - from_middle * from_middle)).max(0.0)
            }
        }
    }

    /// Integral of the density over what of [from, to] it holds [m].
    pub fn length(&self, from: f64, to: f64) -> f64 {
        let (from, to) = (from.max(self.from), to.min(self.to));
        let run = (to - from).max(0.0);
        match self.bulge {
            None => run,
            Some(bulge) => {
                let (u, v) = (from - bulge.middle, to - bulge.middle);
                run * bulge.rate * (bulge.square - (u * u + u * v + v * v) / 3.0).max(0.0)
            }
        }
    }
}

/// All chords of a medium along a ray, in their order, none beside another.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    chords: Vec<Chord>,
    /// Integral of the density before each chord [m].
    before: Vec<f64>,
}

impl Line {
    pub fn new(chords: Vec<Chord>) -> Self {
        let mut sum = 0.0;
        let before = chords.iter().map(|chord| {
            let before = sum;
            sum += chord.length(chord.from, chord.to);
            before
        });
        Line {
            before: before.collect(),
            chords,
        }
    }

    fn at(&self, t: f64) -> Option<usize> {
        self.chords.partition_point(|c| c.from <= t).checked_sub(1)
    }

    /// Density at a distance along the ray.
    pub fn density(&self, t: f64) -> f64 {
        self.density_beside(t, t)
    }

    /// Density at a distance in a part of the ray between borders, whose middle says whether the medium is there.
    pub fn density_beside(&self, t: f64, middle: f64) -> f64 {
        let chord = self.at(middle).map(|i| &self.chords[i]);
        chord
            .filter(|chord| middle <= chord.to)
            .map_or(0.0, |chord| chord.density(t))
    }

    /// Integral of the density up to a distance along the ray [m].
    pub fn length(&self, t: f64) -> f64 {
        self.at(t).map_or(0.0, |i| {
            let chord = &self.chords[i];
            self.before[i] + chord.length(chord.from, t)
        })
    }
}
