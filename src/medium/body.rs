//! Media with borders as bodies in space: what of a ray is inside, and how much of one.

use super::Air;
use super::ellipsoid::Ellipsoid;
use super::layer::Layer;
use super::line::Chord;
use super::region::Region;
use super::shape::{FARTHEST, Medium, Shape};
use glam::DVec3;

/// An optical depth beyond which nothing is counted with care: no light comes through a tenth of it.
const FULL: f64 = 200.0;

/// The body of a medium that has borders.
#[derive(Debug, Clone, Copy)]
pub(super) enum Body<'a> {
    Region(Region),
    Layer(Layer<'a>),
    Ellipsoid(Ellipsoid),
}

impl Air {
    /// The body of a medium; `None` of one that thins with height. A layer without waves is a region.
    pub(super) fn body<'a>(&self, medium: &'a Medium) -> Option<Body<'a>> {
        match &medium.shape {
            Shape::Box { min, max } => Some(Body::Region(Region {
                min: *min,
                max: *max,
            })),
            Shape::Haze { top } => Some(Body::Region(Region {
                min: DVec3::new(f64::NEG_INFINITY, self.ground, f64::NEG_INFINITY),
                max: DVec3::new(f64::INFINITY, *top, f64::INFINITY),
            })),
            Shape::Layer {
                top, waves, bottom, ..
            } => {
                let layer = Layer {
                    top: *top,
                    bottom: bottom.unwrap_or(f64::NEG_INFINITY),
                    waves,
                };
                Some(match layer.reach() > 0.0 {
                    true => Body::Layer(layer),
                    false => Body::Region(layer.flat()),
                })
            }
            Shape::Ellipsoid {
                center,
                radii,
                rotation,
                edge,
            } => Some(Body::Ellipsoid(Ellipsoid {
                center: *center,
                radii: *radii,
                rotation: *rotation,
                edge: *edge,
            })),
            Shape::Height { .. } | Shape::Air { .. } => None,
        }
    }
}

impl Body<'_> {
    /// Density at a point, relative to where the coefficients are those given.
    pub fn density(&self, point: DVec3) -> f64 {
        let of = |is_inside: bool| f64::from(u8::from(is_inside));
        match self {
            Body::Region(region) => of(region.holds(point)),
            Body::Layer(layer) => of(layer.holds(point)),
            Body::Ellipsoid(ellipsoid) => ellipsoid.density(point),
        }
    }

    /// The parts of a ray's first `distance` metres inside, in their order.
    pub fn chords(&self, origin: DVec3, direction: DVec3, distance: f64) -> Vec<Chord> {
        match self {
            Body::Region(region) => {
                let (enter, leave) = region.chord(origin, direction);
                let leave = leave.min(distance);
                (leave > enter)
                    .then(|| Chord::even(enter, leave))
                    .into_iter()
                    .collect()
            }
            Body::Layer(layer) => layer.chords(origin, direction, distance),
            Body::Ellipsoid(ellipsoid) => ellipsoid
                .chord(origin, direction, distance)
                .into_iter()
                .collect(),
        }
    }

    /// A distance beyond which a ray is outside for good [m].
    pub fn end(&self, origin: DVec3, direction: DVec3) -> f64 {
        let (enter, leave) = match self {
            Body::Region(region) => region.chord(origin, direction),
            Body::Layer(layer) => layer.hull().chord(origin, direction),
            Body::Ellipsoid(ellipsoid) => ellipsoid
                .chord(origin, direction, f64::INFINITY)
                .map_or((0.0, 0.0), |chord| (chord.from, chord.to)),
        };
        if leave > enter { leave } else { 0.0 }
    }

    /// Integral of the density over a ray's first `distance` metres [m].
    pub fn length(&self, origin: DVec3, direction: DVec3, distance: f64) -> f64 {
        match self {
            Body::Region(region) => {
                let (enter, leave) = region.chord(origin, direction);
                (leave.min(distance) - enter).max(0.0)
            }
            Body::Layer(layer) => layer.length(origin, direction, distance, f64::INFINITY),
            Body::Ellipsoid(ellipsoid) => ellipsoid
                .chord(origin, direction, distance)
                .map_or(0.0, |chord| chord.length(chord.from, chord.to)),
        }
    }

    /// Integral of the density over the half-line from a point toward the sun [m], of a medium of that extinction.
    pub fn depth(&self, point: DVec3, toward_sun: DVec3, extinction: DVec3) -> f64 {
        match self {
            Body::Region(region) => region.depth(point, toward_sun),
            Body::Layer(layer) => {
                let weakest = extinction
                    .to_array()
                    .into_iter()
                    .filter(|e| *e > 0.0)
                    .fold(f64::INFINITY, f64::min);
                layer.length(point, toward_sun, FARTHEST, FULL / weakest)
            }
            Body::Ellipsoid(_) => self.length(point, toward_sun, f64::INFINITY),
        }
    }
}
