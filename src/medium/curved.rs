//! A medium of curved borders along a ray, under a sun: its depth toward the sun is no straight line between borders.

use super::body::Body;
use super::layer::cuts;
use super::line::Line;
use super::shape::Medium;
use glam::{DVec2, DVec3};

/// A layer with waves or an ellipsoid along a ray.
#[derive(Debug, Clone)]
pub(super) struct CurvedTerm<'a> {
    body: Body<'a>,
    extinction: DVec3,
    /// Scattering coefficient times phase function [1/(m sr)] where the density is 1.
    pub source: DVec3,
    origin: DVec3,
    direction: DVec3,
    toward_sun: DVec3,
    line: Line,
    /// Outside of this part of the ray the medium is neither on it nor between it and the sun.
    pub reach: [f64; 2],
    /// Where between them it begins or ends, on the ray or before the sun.
    pub borders: Vec<f64>,
    /// How fast its waves go by along the ray, where they are met there or toward the sun [rad/m].
    rate: f64,
}

impl<'a> CurvedTerm<'a> {
    /// The term of a layer with waves or of an ellipsoid on the first `distance` metres of a ray; `None` of one that has nothing to do
    /// with it.
    pub fn new(
        medium: &Medium,
        body: Body<'a>,
        [origin, direction]: [DVec3; 2],
        distance: f64,
        toward_sun: DVec3,
        source: DVec3,
    ) -> Option<Self> {
        let chords = body.chords(origin, direction, distance);
        let mut borders: Vec<f64> = chords.iter().flat_map(|c| [c.from, c.to]).collect();
        let mut rate = 0.0f64;
        let reach = match body {
            Body::Region(_) => return None,
            Body::Layer(layer) => {
                let level = |v: DVec3| DVec2::new(v.x, v.z);
                // Where the sun's ray from the place meets a height that stands still, as the place goes on.
                let along = level(direction);
                let foot = along - direction.y / toward_sun.y * level(toward_sun);
                for wave in layer.waves {
                    rate = rate.max(wave.vector.dot(along).abs());
                    let below = wave.vector.dot(foot).abs();
                    rate = rate.max(if below.is_finite() { below } else { 0.0 });
                }
                let hull = layer.hull();
                let [low, high] = [hull.min.y, hull.max.y];
                // Above the crests the sun is free if it stands above the horizon, below the bottom if it stands below.
                let heights = [
                    if toward_sun.y > 0.0 {
                        f64::NEG_INFINITY
                    } else {
                        low
                    },
                    if toward_sun.y < 0.0 {
                        f64::INFINITY
                    } else {
                        high
                    },
                ];
                between(origin.y, direction.y, heights)
            }
            Body::Ellipsoid(ellipsoid) => {
                let shadow = ellipsoid.in_line_with(origin, direction, toward_sun);
                // Seen along the sun's rays the ellipsoid is before all of that part or behind it, unless the ray goes through it.
                let shadow = shadow.filter(|[from, to]| {
                    let (from, to) = (from.max(0.0), to.min(distance));
                    let middle = origin + 0.5 * (from + to) * direction;
                    !chords.is_empty() || body.depth(middle, toward_sun, DVec3::ONE) > 0.0
                });
                borders.extend(shadow.into_iter().flatten());
                let own = chords.first().map(|chord| [chord.from, chord.to]);
                let both = own.into_iter().chain(shadow);
                both.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [from, to]| {
                    [a.min(from), b.max(to)]
                })
            }
        };
        let reach = [reach[0].max(0.0), reach[1].min(distance)];
        // What lies behind is still before the eye.
        if reach[1] <= reach[0] && chords.is_empty() {
            return None;
        }
        borders.extend(reach);
        borders.retain(|t| (0.0..=distance).contains(t));
        Some(CurvedTerm {
            body,
            extinction: medium.extinction(),
            source,
            origin,
            direction,
            toward_sun,
            line: Line::new(chords),
            reach,
            borders,
            rate,
        })
    }

    /// Density at a distance along the ray.
    pub fn density(&self, t: f64) -> f64 {
        self.line.density(t)
    }

    /// Optical depth from the eye to the point at `t` [1].
    pub fn eye_depth(&self, t: f64) -> DVec3 {
        self.extinction * self.line.length(t)
    }

    /// Whether it is on the ray, or between it and the sun, around `t`.
    pub fn reaches(&self, t: f64) -> bool {
        (self.reach[0]..=self.reach[1]).contains(&t)
    }

    /// Optical depth from the eye to the point at `t` and on to the sun [1].
    pub fn depth(&self, t: f64) -> DVec3 {
        let eye = self.eye_depth(t);
        if !self.reaches(t) {
            return eye;
        }
        let point = self.origin + t * self.direction;
        eye + self.extinction * self.body.depth(point, self.toward_sun, self.extinction)
    }

    /// Places at which a part of the ray is cut, so that none of the waves goes by unseen.
    pub fn cuts(&self, from: f64, to: f64) -> impl Iterator<Item = f64> + use<> {
        cuts(from, to, self.rate)
    }
}

/// The part of a ray from a height, rising so much a metre, that lies between two heights; an empty one ends before its start.
fn between(height: f64, rise: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    if rise == 0.0 {
        let is_between = (low..=high).contains(&height);
        return if is_between {
            [0.0, f64::INFINITY]
        } else {
            [0.0, -1.0]
        };
    }
    let (a, b) = ((low - height) / rise, (high - height) / rise);
    [a.min(b), a.max(b)]
}
