//! How wide the edges of shadows are in the picture.

use super::{Conditions, Input, Snapshot, spread};
use crate::beam::Beam;
use crate::scene::Projection;
use crate::scene::edges::Edges;
use crate::scene::penumbra::SoftShade;
use glam::DVec2;
use std::ops::RangeInclusive;
use std::sync::{Arc, PoisonError};

/// Above so many of its radii the sun's disc counts as one direction for what the air takes of its light.
const LOW: f64 = 8.0;

/// The angular radii of discs whose edges are told [rad]: a smaller one is a point to f32, a larger one is not flat.
const TOLD: RangeInclusive<f64> = 1e-6..=0.01;

/// With more penumbrae than this on the way of a ray, on average, to tell them apart takes many times as long as points of the disc.
const FEW: usize = 40;

/// The sun's disc as the air sees it.
pub struct DiscInAir {
    /// Where surfaces end that stand in its way.
    pub edges: Edges,
    /// The beam that stands for its light as a whole.
    pub beam: Beam,
    /// On which rays the edges of its shadows can be told apart.
    pub told: Told,
}

/// On which rays of a picture the edges of shadows can be told apart: not where holes of surfaces or too many edges lie on their way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// On all that were tried.
    Everywhere,
    /// On most.
    Mostly,
    /// On few, or too slowly.
    Not,
}

/// What was found of a disc last, and of which inputs.
struct Found {
    made_of: Snapshot,
    disc: Arc<DiscInAir>,
}

/// What a disc in the air depends on.
const INPUTS: &[Input] = &[Input::Geometry, Input::Sun, Input::View, Input::Media];

impl Conditions {
    /// The sun's disc as the air sees it, found when it is first asked for; `None` where [`Conditions::whole_sun`] is.
    pub fn disc_in_air(&self) -> Option<Arc<DiscInAir>> {
        let beam = self.whole_sun()?;
        let last = || self.disc.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last().clone();
        let found = known
            .as_ref()
            .and_then(|found| found.downcast_ref::<Found>());
        if let Some(found) = found
            && found.made_of.still_holds(self, INPUTS)
        {
            return Some(found.disc.clone());
        }
        // Not while it is locked: this works on all cores.
        let edges = Edges::new(&self.geometry, self.sun.disc()?);
        let told = self.told(&edges);
        let disc = Arc::new(DiscInAir { edges, beam, told });
        *last() = Some(Arc::new(Found {
            made_of: self.snapshot(INPUTS),
            disc: disc.clone(),
        }));
        Some(disc)
    }

    /// On which rays of the picture the edges of shadows can be told apart, judged by some of them.
    fn told(&self, edges: &Edges) -> Told {
        const RAYS: usize = 64;
        let pixels = spread(self.view.size, RAYS);
        let mut shade = SoftShade::default();
        let (mut told, mut penumbrae) = (0, 0);
        for pixel in &pixels {
            let ray = self.view.ray(pixel.as_dvec2() + 0.5);
            let hit = self.geometry.closest(&ray, 0.0, f64::INFINITY);
            let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
            let end = end.min(self.air.end(ray.origin, ray.direction));
            let borders = std::iter::empty();
            let is_told = self
                .geometry
                .soft_shade(&ray, end, edges, borders, &mut shade);
            told += usize::from(is_told);
            penumbrae += shade.penumbrae();
        }
        if 2 * told <= pixels.len() || penumbrae > FEW * pixels.len() {
            Told::Not
        } else if told < pixels.len() {
            Told::Mostly
        } else {
            Told::Everywhere
        }
    }

    /// The beams of the sun's disc that shadows are made for: `count` of them, or one where no penumbra is as wide as a pixel.
    pub fn sun_beams(&self, count: usize) -> Vec<Beam> {
        let one = self.view.points().is_none() && self.widest_penumbra() < 1.0;
        self.sun.beams(if one { 1 } else { count })
    }

    /// The beam that stands for the light of the sun's whole disc; `None` where one point or several have to do: no penumbra is as wide as a
    /// pixel, the disc is wider than 1.1 degrees, or the sun is so low that its light comes through other air from its lower edge than from
    /// its upper one.
    pub fn whole_sun(&self) -> Option<Beam> {
        let radius = self.sun.angular_radius();
        let elevation = self.sun.toward.y.clamp(-1.0, 1.0).asin();
        let is_told = TOLD.contains(&radius) && elevation >= LOW * radius;
        let is_narrow = self.view.points().is_none() && self.widest_penumbra() < 1.0;
        (is_told && !is_narrow).then_some(Beam::Parallel {
            toward: self.sun.toward,
            illuminance: self.sun.light.illuminance,
            angular_radius: radius,
        })
    }

    /// No penumbra in the air or on the ground is wider in the picture than this [pixels]; infinite where that cannot be said.
    ///
    /// The edge of a shadow is as wide as the sun's disc looks from behind it, s 2 tan(r): r the disc's angular radius, s the
    /// distance from the edge; on the ground longer by 1 / sin(elevation). All shadow lies in the sphere around the casters,
    /// drawn out along the light as far as there is ground or air to fall on; the distance to that from the eye says how large
    /// it can look. On faces of casters that the sun grazes it may be longer.
    pub fn widest_penumbra(&self) -> f64 {
        let (low, high) = self.geometry.bounds();
        let middle = 0.5 * (low + high);
        let radius = 0.5 * (high - low).length();
        let down = -self.sun.toward;
        // The lower edge of the disc throws the longest shadows.
        let lowest = (self.sun.toward.y.clamp(-1.0, 1.0).asin() - self.sun.angular_radius()).sin();
        if lowest <= 0.0 {
            return f64::INFINITY;
        }
        let to_ground = self
            .ground
            .map(|ground| (middle.y + radius - ground.height).max(0.0) / lowest);
        // Without ground, shadows end where bounded air does, and are without end in other air.
        let to_air = self.air.media.iter().map(|medium| match medium.bounds() {
            Some([min, max]) => {
                let far =
                    |i: usize| (down[i] * (min[i] - middle[i])).max(down[i] * (max[i] - middle[i]));
                far(0) + far(1) + far(2)
            }
            None => f64::INFINITY,
        });
        let length = to_ground
            .unwrap_or_else(|| to_air.fold(0.0, f64::max))
            .max(0.0);
        if !length.is_finite() {
            return f64::INFINITY;
        }
        let stretch = if self.ground.is_some() {
            1.0 / lowest
        } else {
            1.0
        };
        let width = (length + radius) * 2.0 * self.sun.angular_radius().tan() * stretch;
        let along = (self.view.camera.eye - middle).dot(down).clamp(0.0, length);
        let nearest = self.view.camera.eye.distance(middle + along * down) - radius;
        let pixel = self.smallest_pixel();
        match self.view.camera.projection {
            Projection::Orthographic { .. } => width / pixel,
            _ if nearest <= 0.0 => f64::INFINITY,
            _ => width / nearest / pixel,
        }
    }

    /// The width of a pixel at a metre from the eye where it is least [m]: toward a perspective's corners it shrinks by cos2. A
    /// panorama's is that of its rows; in an orthographic view all are alike, anywhere.
    fn smallest_pixel(&self) -> f64 {
        let at = |x: f64, y: f64| self.view.camera.ray(DVec2::new(x, y), self.view.size);
        let [w, h] = self.view.size.map(f64::from);
        let (x, y) = (0.5 * w, 0.5 * h);
        let (middle, below) = (at(x, y), at(x, y + 1.0));
        match self.view.camera.projection {
            Projection::Orthographic { .. } => middle.origin.distance(below.origin),
            Projection::Panorama => middle.direction.distance(below.direction),
            Projection::Perspective { fov_y } => {
                let [_, _, forward] = self.view.camera.axes();
                let cosine = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)]
                    .map(|(x, y)| at(x, y).direction.dot(forward))
                    .into_iter()
                    .fold(1.0, f64::min);
                2.0 * (0.5 * fov_y).tan() / h * cosine * cosine
            }
        }
    }
}
