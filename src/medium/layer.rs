//! Fog below a boundary that is a sum of sine waves: where rays cross it.
//!
//! Along a ray the height above the boundary is f(t) = height + rise t - sum a sin(phase + rate t). |f''| is at most the sum of
//! a rate^2, the bend. Hence from any t two steps are safe: one over which f keeps its sign, since |f| shrinks no faster than by
//! |f'| h + bend h^2 / 2; and one of |f'| / bend, over which f' keeps its sign, so that f crosses 0 once or not at all. The longer of
//! both is taken, and no crossing is missed but pairs closer than [`TOUCH`] of a wave, which a ray that touches has.

use super::line::Chord;
use super::region::Region;
use super::shape::{FARTHEST, Wave};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// No step is shorter than this share of the length over which the boundary bends.
const TOUCH: f64 = 1e-8;

/// After so many steps the boundary counts as flat: thousands of waves have been crossed, along a path that is all but level.
const MOST_STEPS: usize = 1 << 16;

/// No part of a ray is cut into more for the sake of waves.
const MOST_CUTS: f64 = 2048.0;

/// A layer with waves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layer<'a> {
    pub top: f64,
    /// -infinity where it is without end.
    pub bottom: f64,
    pub waves: &'a [Wave],
}

/// How far a ray is above the boundary.
struct Above<'a> {
    waves: &'a [Wave],
    from: DVec2,
    along: DVec2,
    height: f64,
    rise: f64,
}

impl Above<'_> {
    /// The height above the boundary, and how fast it grows.
    fn at(&self, t: f64) -> [f64; 2] {
        let (mut f, mut slope) = (self.height + self.rise * t, self.rise);
        for wave in self.waves {
            let rate = wave.vector.dot(self.along);
            let (sin, cos) = (wave.phase + wave.vector.dot(self.from) + rate * t).sin_cos();
            f -= wave.amplitude * sin;
            slope -= wave.amplitude * rate * cos;
        }
        [f, slope]
    }

    /// Whether a height above the boundary that changes so is below it.
    fn is_below([f, slope]: [f64; 2]) -> bool {
        f < 0.0 || (f == 0.0 && slope <= 0.0)
    }

    /// The crossing between two distances at which the ray is not on the same side.
    fn crossing(&self, mut a: f64, mut b: f64, is_below: bool) -> f64 {
        let mut t = 0.5 * (a + b);
        for _ in 0..100 {
            let [f, slope] = self.at(t);
            match Self::is_below([f, slope]) == is_below {
                true => a = t,
                false => b = t,
            }
            let newton = t - f / slope;
            let next = match newton > a && newton < b {
                true => newton,
                false => 0.5 * (a + b),
            };
            if (next - t).abs() <= f64::EPSILON * t.abs() || next == a || next == b {
                return next;
            }
            t = next;
        }
        t
    }
}

impl Layer<'_> {
    /// No wave rises farther above `top` than this [m], or sinks farther below.
    pub fn reach(&self) -> f64 {
        self.waves.iter().map(|wave| wave.amplitude.abs()).sum()
    }

    /// The flat layer of the same mean height.
    pub fn flat(&self) -> Region {
        self.up_to(self.top)
    }

    /// The flat layer that holds it.
    pub fn hull(&self) -> Region {
        self.up_to(self.top + self.reach())
    }

    fn up_to(&self, top: f64) -> Region {
        Region {
            min: DVec3::new(f64::NEG_INFINITY, self.bottom, f64::NEG_INFINITY),
            max: DVec3::new(f64::INFINITY, top, f64::INFINITY),
        }
    }

    pub fn holds(&self, point: DVec3) -> bool {
        let above = self.above(point, DVec3::ZERO).at(0.0);
        point.y >= self.bottom && above[0] <= 0.0
    }

    fn above(&self, origin: DVec3, direction: DVec3) -> Above<'_> {
        Above {
            waves: self.waves,
            from: DVec2::new(origin.x, origin.z),
            along: DVec2::new(direction.x, direction.z),
            height: origin.y - self.top,
            rise: direction.y,
        }
    }

    /// Distances between two of a ray, half of the shortest wave apart, but no more than [`MOST_CUTS`].
    pub fn grid(&self, from: f64, to: f64) -> impl Iterator<Item = f64> + use<> {
        let fastest = self.waves.iter().map(|wave| wave.vector.length());
        cuts(from, to, fastest.fold(0.0, f64::max))
    }

    /// Tells the parts of a half-line's first `distance` metres inside, in their order. Once so many metres are inside as are
    /// `enough`, the boundary counts as flat.
    pub fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        distance: f64,
        enough: f64,
        mut found: impl FnMut(f64, f64),
    ) {
        let (first, last) = self.hull().chord(origin, direction);
        let last = last.min(distance).min(FARTHEST);
        if last <= first {
            return;
        }
        // Above the crests is nothing, and below the troughs there are no waves: between, the boundary is followed.
        let reach = self.reach();
        let trough = (self.top - reach - origin.y) / direction.y;
        let (from, to) = match direction.y {
            0.0 if origin.y < self.top - reach => (last, last),
            0.0 => (first, last),
            down if down < 0.0 => (first, trough.clamp(first, last)),
            _ => (trough.clamp(first, last), last),
        };
        let above = self.above(origin, direction);
        let mut inside = 0.0;
        let mut tell = |from: f64, to: f64| {
            if to > from {
                inside += to - from;
                found(from, to);
            }
            inside
        };
        let (mut steepest, mut bend) = (0.0, 0.0);
        for wave in self.waves {
            let rate = wave.vector.dot(above.along).abs();
            steepest += wave.amplitude.abs() * rate;
            bend += wave.amplitude.abs() * rate * rate;
        }
        let least = TOUCH * (reach / bend).sqrt();
        let mut entered = (from > first).then_some(first);
        let mut at = from;
        let mut value = above.at(at);
        let mut is_below = from < to && Above::is_below(value);
        let mut enough_told = false;
        match entered {
            None if is_below => entered = Some(from),
            Some(start) if !is_below && from < to => {
                enough_told = tell(start, from) >= enough;
                entered = None;
            }
            _ => {}
        }
        let mut steps = 0;
        while at < to && steps < MOST_STEPS && !enough_told {
            steps += 1;
            let next = match steepest <= direction.y.abs() {
                true => to,
                false => (at + step(value, bend).max(least).max(f64::EPSILON * at)).min(to),
            };
            let there = above.at(next);
            if Above::is_below(there) != is_below {
                let crossing = above.crossing(at, next, is_below);
                match entered.take() {
                    Some(start) => enough_told = tell(start, crossing) >= enough,
                    None => entered = Some(crossing),
                }
                is_below = !is_below;
            }
            (at, value) = (next, there);
        }
        if at < to {
            // The rest by the mean height.
            if let Some(start) = entered.take() {
                tell(start, at);
            }
            let (enter, leave) = self.flat().chord(origin, direction);
            tell(enter.max(at), leave.min(last));
            return;
        }
        match entered {
            Some(start) => tell(start, last),
            None => tell(to, last),
        };
    }

    /// The parts of a ray's first `distance` metres inside.
    pub fn chords(&self, origin: DVec3, direction: DVec3, distance: f64) -> Vec<Chord> {
        let mut chords = Vec::new();
        self.walk(origin, direction, distance, f64::INFINITY, |from, to| {
            chords.push(Chord::even(from, to));
        });
        chords
    }

    /// How long a half-line is inside on its first `distance` metres, roughly beyond `enough` [m].
    pub fn length(&self, origin: DVec3, direction: DVec3, distance: f64, enough: f64) -> f64 {
        let mut sum = 0.0;
        self.walk(origin, direction, distance, enough, |from, to| {
            sum += to - from;
        });
        sum
    }
}

/// Distances between two, at least one for each half turn of a phase that grows at a rate [rad/m], but no more than [`MOST_CUTS`].
pub(super) fn cuts(from: f64, to: f64, rate: f64) -> impl Iterator<Item = f64> + use<> {
    let count = ((to - from) * rate / PI).ceil().clamp(1.0, MOST_CUTS) as usize;
    let share = move |i: usize| from + (to - from) * i as f64 / count as f64;
    (1..count).map(share)
}

/// How far f may be followed from a place with one crossing at most.
fn step([f, slope]: [f64; 2], bend: f64) -> f64 {
    // How fast |f| grows.
    let growth = slope * f.signum();
    let root = (growth * growth + 2.0 * bend * f.abs()).sqrt();
    let keeps_sign = match growth > 0.0 {
        true => (growth + root) / bend,
        false => 2.0 * f.abs() / (root - growth),
    };
    // 0 / 0 where f and f' are 0.
    keeps_sign.max(slope.abs() / bend)
}
