//! The exposure of a sequence: metered in a few small pictures, and a smooth curve through them.
//!
//! A picture that is exposed for itself flickers: a bright patch comes into it or leaves it, and everything else changes. So it is planned
//! for the whole sequence. Key frames stand where the sun has moved enough since the last for light to have changed, most closely
//! in twilight, where a degree of it is a stop; what they are metered at ([`crate::colour::exposure::auto`]) is interpolated in stops by a
//! monotone cubic: it has a continuous slope and does not swing beyond what was metered.
//!
//! Source: Fritsch & Butland 1984, SIAM Journal on Scientific and Statistical Computing 5 (2), 300, with the weights of Brodlie.

use crate::error::Result;
use crate::units::DEG;
use glam::DVec3;

/// Pixels of a key frame, about.
const PIXELS: f64 = 384.0;

/// The size of key frames of a sequence of this size: of the same shape, and of no more pixels than it takes to meter.
pub fn small([width, height]: [u32; 2]) -> [u32; 2] {
    let pixels = f64::from(width) * f64::from(height);
    let scale = (PIXELS / pixels).sqrt().min(1.0);
    [width, height].map(|side| (f64::from(side) * scale).round().max(1.0) as u32)
}

/// How far the sun moves from a key frame to the next [rad], where it stands at an elevation [rad].
fn spacing(elevation: f64) -> f64 {
    // Elevation and spacing [degrees].
    const TABLE: [(f64, f64); 6] = [
        (-90.0, 15.0),
        (-20.0, 15.0),
        (-14.0, 1.25),
        (5.0, 1.25),
        (20.0, 6.0),
        (90.0, 6.0),
    ];
    let at = elevation / DEG;
    let pairs = TABLE.windows(2).find(|pair| at <= pair[1].0);
    let degrees = pairs.map_or(TABLE[5].1, |pair| {
        let [(low, a), (high, b)] = [pair[0], pair[1]];
        a + (b - a) * ((at - low) / (high - low)).clamp(0.0, 1.0)
    });
    degrees * DEG
}

/// Which frames are key frames, in order: the first, the last, and between them those by which the sun has moved on. `toward_sun` are unit
/// vectors, of all frames in order, one or more.
///
/// # Errors
/// The first among them.
pub fn key_frames(toward_sun: impl IntoIterator<Item = Result<DVec3>>) -> Result<Vec<u64>> {
    // How many spacings the sun has gone by then.
    let mut gone: Vec<f64> = Vec::new();
    let mut before: Option<DVec3> = None;
    for toward in toward_sun {
        let toward = toward?;
        let step = before.map_or(0.0, |before| {
            let middle = (before + toward).normalize_or(toward);
            before.angle_between(toward) / spacing(middle.y.clamp(-1.0, 1.0).asin())
        });
        gone.push(gone.last().unwrap_or(&0.0) + step);
        before = Some(toward);
    }
    let last = gone.len().saturating_sub(1);
    let whole = gone.last().copied().unwrap_or(0.0);
    let parts = whole.ceil().max(1.0);
    let nearest = |target: f64| {
        let after = gone.partition_point(|gone| *gone < target).min(last);
        let before = after.saturating_sub(1);
        match target - gone[before] < gone[after] - target {
            true => before,
            false => after,
        }
    };
    let inner = (1..parts as u64).map(|part| nearest(whole * part as f64 / parts));
    let mut found: Vec<usize> = std::iter::once(0).chain(inner).chain([last]).collect();
    found.dedup();
    Ok(found.into_iter().map(|frame| frame as u64).collect())
}

/// A smooth curve through points, constant beyond the first and the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

impl Curve {
    /// The monotone cubic through points, of increasing abscissae. Without a point it is zero.
    pub fn new(points: Vec<[f64; 2]>) -> Self {
        let chords: Vec<[f64; 2]> = points
            .windows(2)
            .map(|pair| {
                let width = pair[1][0] - pair[0][0];
                [width, (pair[1][1] - pair[0][1]) / width]
            })
            .collect();
        let end = |near: Option<&[f64; 2]>, next: Option<&[f64; 2]>| match (near, next) {
            (Some([h0, d0]), Some([h1, d1])) => {
                // Of the parabola through three points, as far as that keeps the curve monotone.
                let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
                match slope * d0 <= 0.0 {
                    true => 0.0,
                    false => slope.signum() * slope.abs().min(3.0 * d0.abs()),
                }
            }
            (Some([_, d0]), None) => *d0,
            _ => 0.0,
        };
        let inner = chords.windows(2).map(|pair| {
            let [[h0, d0], [h1, d1]] = [pair[0], pair[1]];
            match d0 * d1 <= 0.0 {
                true => 0.0,
                false => {
                    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
                    (w0 + w1) / (w0 / d0 + w1 / d1)
                }
            }
        });
        let mut slopes = Vec::with_capacity(points.len());
        if !points.is_empty() {
            slopes.push(end(chords.first(), chords.get(1)));
            slopes.extend(inner);
            if points.len() > 1 {
                let mut back = chords.iter().rev();
                slopes.push(end(back.next(), back.next()));
            }
        }
        Curve { points, slopes }
    }

    /// Its value at an abscissa.
    pub fn at(&self, x: f64) -> f64 {
        let after = self.points.partition_point(|[at, _]| *at <= x);
        let (Some(before), Some([x1, y1])) = (after.checked_sub(1), self.points.get(after)) else {
            let nearest = self.points.get(after).or(self.points.last());
            return nearest.map_or(0.0, |[_, y]| *y);
        };
        let [x0, y0] = self.points[before];
        let width = x1 - x0;
        let t = (x - x0) / width;
        let [m0, m1] = [self.slopes[before], self.slopes[after]].map(|slope| slope * width);
        let (square, cube) = (t * t, t * t * t);
        (2.0 * cube - 3.0 * square + 1.0) * y0
            + (cube - 2.0 * square + t) * m0
            + (3.0 * square - 2.0 * cube) * y1
            + (cube - square) * m1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn a_curve_passes_its_points_smoothly_and_does_not_swing() {
        let points = vec![
            [0.0, 14.0],
            [10.0, 13.5],
            [17.0, 8.0],
            [40.0, 7.9],
            [41.0, 7.9],
            [60.0, 9.0],
        ];
        let curve = Curve::new(points.clone());
        for [x, y] in &points {
            assert!((curve.at(*x) - y).abs() < 1e-12);
        }
        assert_eq!((curve.at(-5.0), curve.at(99.0)), (14.0, 9.0));
        let step = 1e-4;
        let slope = |x: f64| (curve.at(x + step) - curve.at(x - step)) / (2.0 * step);
        for pair in points.windows(2) {
            let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
            for i in 0..=100 {
                let y = curve.at(x0 + (x1 - x0) * f64::from(i) / 100.0);
                assert!(y >= y0.min(y1) - 1e-12 && y <= y0.max(y1) + 1e-12);
            }
            if x0 > 0.0 {
                let jump = slope(x0 + 2.0 * step) - slope(x0 - 2.0 * step);
                assert!(jump.abs() < 1e-2, "at {x0}: {jump}");
            }
        }
        // Of one that bends evenly it is that within a part of its steps.
        let parabola = Curve::new((0..20).map(f64::from).map(|x| [x, x * x]).collect());
        for x in [3.3, 8.5, 15.9] {
            assert!((parabola.at(x) - x * x).abs() < 0.1);
        }
        assert_eq!(Curve::new(vec![]).at(3.0), 0.0);
        assert_eq!(Curve::new(vec![[2.0, 5.0]]).at(9.0), 5.0);
        assert_eq!(Curve::new(vec![[0.0, 1.0], [2.0, 2.0]]).at(1.0), 1.5);
    }

    #[test]
    fn key_frames_are_close_where_light_changes_fast() {
        let at = |elevation: f64| {
            Ok(DVec3::new(
                (elevation * DEG).cos(),
                (elevation * DEG).sin(),
                0.0,
            ))
        };
        // From 60 degrees to 20 below, a tenth of a degree a frame.
        let frames =
            key_frames((0..=800).map(|i| at(60.0 - 0.1 * f64::from(i)))).expect("no errors");
        assert_eq!((frames[0], frames[frames.len() - 1]), (0, 800));
        assert!(frames.is_sorted_by(|a, b| a < b));
        let between =
            |from: u64, to: u64| frames.iter().filter(|i| (from..to).contains(*i)).count();
        // 50 to 40 degrees; 0 to -10.
        assert!((1..=3).contains(&between(100, 200)), "{frames:?}");
        assert!((7..=9).contains(&between(600, 700)), "{frames:?}");
        // A frame that is far from its neighbours is one; a sun that stands still needs two.
        let hours = key_frames((0..5).map(|i| at(15.0 * f64::from(i)))).expect("no errors");
        assert_eq!(hours, [0, 1, 2, 3, 4]);
        assert_eq!(key_frames((0..9).map(|_| at(3.0))).ok(), Some(vec![0, 8]));
        assert_eq!(key_frames([at(3.0)]).ok(), Some(vec![0]));
        assert!(key_frames([at(3.0), Err(Error::Stopped)]).is_err());
    }

    #[test]
    fn a_small_picture_has_the_same_shape() {
        assert_eq!(small([960, 600]), [25, 15]);
        assert_eq!(small([4096, 1]), [1254, 1]);
        assert_eq!(small([8, 5]), [8, 5]);
    }
}
