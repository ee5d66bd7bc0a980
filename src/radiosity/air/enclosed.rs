//! What the air near a scene's surfaces sends toward the eye.
//!
//! J is found at points of the [`Lattice`] and interpolated between those of a cell that the place itself sees, so that no light
//! comes through a wall from the cells behind it. The farther from the eye, the wider the lattice; two levels are blended where
//! one gives way to the next, so that nothing jumps when the eye moves. Close to the eye, where the direction from the eye differs
//! across a cell, what is interpolated is by how much J differs from what the light at the eye itself gives in that direction.

use super::fineness::Fineness;
use super::lattice::{Lattice, PAIRS, Place, level_of, spacing};
use super::source::Lobes;
use super::sphere::{Lit, Sphere};
use crate::conditions::Conditions;
use crate::medium::Air;
use crate::radiosity::arrival::Arrival;
use crate::radiosity::light::Light;
use crate::radiosity::shards::Shards;
use crate::scene::{Projection, Ray};
use crate::sky::sun::fibonacci_sphere;
use glam::{DVec2, DVec3};
use std::sync::{Arc, OnceLock};

/// Corners that are seen from a place must carry this share of the weight, or what comes to the place itself is found too.
const SEEN: f64 = 0.3;

/// No coarser than this share of a mean free path of light: where a box of fog ends, J has a kink.
const OF_FREE_PATH: f64 = 0.1;

/// Where rays come from.
#[derive(Debug, Clone, Copy)]
pub enum Eye {
    /// One place [m].
    At(DVec3),
    /// Everywhere, in one direction; the height of what is seen [m].
    Parallel(DVec3, f64),
}

impl Eye {
    /// The eye of a view.
    pub fn new(conditions: &Conditions) -> Self {
        let camera = &conditions.view.camera;
        match camera.projection {
            Projection::Orthographic { height } => Eye::Parallel(camera.axes()[2], height),
            Projection::Perspective { .. } | Projection::Panorama => Eye::At(camera.eye),
        }
    }
}

/// The least distance that counts for spacings [m]: the harmonic mean of the distances at which directions from the eye meet
/// something; where they meet nothing, `otherwise`.
pub fn surroundings(conditions: &Conditions, eye: Eye, otherwise: f64) -> f64 {
    const DIRECTIONS: usize = 256;
    let Eye::At(origin) = eye else {
        return otherwise;
    };
    let nearness = |i: usize| {
        let direction = fibonacci_sphere(i, DIRECTIONS);
        let hit = conditions
            .geometry
            .closest(&Ray { origin, direction }, 0.0, f64::INFINITY);
        let ground = conditions.ground.filter(|ground| origin.y > ground.height);
        match (hit, ground) {
            (Some(hit), _) => 1.0 / hit.distance,
            (None, Some(ground)) if direction.y < 0.0 => -direction.y / (origin.y - ground.height),
            _ => 0.0,
        }
    };
    let mean = (0..DIRECTIONS).map(nearness).sum::<f64>() / DIRECTIONS as f64;
    (1.0 / mean).min(otherwise)
}

/// J near the scene's surfaces, for one eye and moment.
pub struct Enclosed {
    lattice: Arc<Lattice>,
    light: Arc<Light>,
    lobes: Arc<Lobes>,
    air: Air,
    eye: Eye,
    /// Spacing as a share of the distance from the eye.
    share: f64,
    /// A cell is finer where J differs by so much between its corners, as a share of J and times the share of the distance from
    /// the eye that the cell is.
    uneven: f64,
    /// No finer than this share of the widest spacing.
    finest: f64,
    /// The distance from the eye within which spacings do not shrink [m].
    near: f64,
    sphere: Sphere,
    at_eye: Vec<Lit>,
    /// What J is in the picture, roughly [cd/m2].
    typical: f64,
    points: Shards<Place, Vec<DVec3>>,
    cells: Shards<Place, Cell>,
}

/// A cell of the lattice.
struct Cell {
    pairs: u16,
    /// The rest of J at the corners, kind by kind, where it was asked for.
    corners: [OnceLock<Vec<DVec3>>; 8],
    /// The greatest difference of it between corners that see each other, and its mean over those.
    difference: f64,
    mean: f64,
}

impl Enclosed {
    pub fn new(
        lattice: Arc<Lattice>,
        light: Arc<Light>,
        lobes: Arc<Lobes>,
        conditions: &Conditions,
        fineness: Fineness,
        near: f64,
    ) -> Self {
        let eye = Eye::new(conditions);
        let sphere = Sphere::new(&lattice, conditions.sky.as_deref());
        let mut enclosed = Enclosed {
            typical: 0.0,
            lattice,
            light,
            lobes,
            air: conditions.air.clone(),
            eye,
            share: fineness.spacing,
            uneven: fineness.difference,
            finest: fineness.finest,
            near,
            sphere,
            at_eye: Vec::new(),
            points: Shards::new(),
            cells: Shards::new(),
        };
        if let Eye::At(eye) = eye {
            enclosed.at_eye = enclosed.lit(&enclosed.lattice.around(eye));
        }
        enclosed.typical = enclosed.glance(conditions);
        enclosed
    }

    /// The mean of J at some places that the eye sees [cd/m2].
    fn glance(&self, conditions: &Conditions) -> f64 {
        const PLACES: usize = 32;
        let [width, height] = conditions.view.size.map(f64::from);
        let mut sum = 0.0;
        for i in 0..PLACES {
            // Roberts's R3 sequence.
            let at =
                [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|a| (0.5 + a * i as f64).fract());
            let ray = conditions
                .view
                .ray(DVec2::new(width * at[0], height * at[1]));
            let hit = conditions.geometry.closest(&ray, 0.0, f64::INFINITY);
            let end = hit.map_or(4.0 * self.near, |hit| hit.distance);
            let lit = self.lit(&self.lattice.around(ray.at(at[2] * end)));
            let found = self.lobes.source(&lit, ray.direction);
            sum += found
                .iter()
                .fold(0.0, |most: f64, j| most.max(j.max_element()));
        }
        sum / PLACES as f64
    }

    fn lit(&self, arrivals: &[Arrival]) -> Vec<Lit> {
        let lit = |arrival| self.sphere.lit(arrival, &self.light);
        arrivals.iter().map(lit).collect()
    }

    /// J of each kind of media at a place that the eye sees in this direction [cd/m2].
    pub fn source(&self, place: DVec3, direction: DVec3) -> Vec<DVec3> {
        let [_, reach, widest] = self.scale(place);
        let mut sum = self.of_eye(place, direction);
        let level = level_of(widest);
        let coarser = smooth(2.0 * (level - level.floor()) - 1.0);
        for (level, part) in [
            (level.floor(), 1.0 - coarser),
            (level.floor() + 1.0, coarser),
        ] {
            if part > 0.0 {
                self.add_level(place, direction, level as i32, [reach, part], &mut sum);
            }
        }
        sum.iter_mut().for_each(|j| *j = j.max(DVec3::ZERO));
        sum
    }

    /// The distance of a place from the eye, that of which spacings are a share, and the widest spacing there [m].
    fn scale(&self, place: DVec3) -> [f64; 3] {
        let (distance, reach) = match self.eye {
            Eye::At(eye) => {
                let distance = place.distance(eye);
                (distance, distance.max(self.near))
            }
            Eye::Parallel(_, height) => (f64::INFINITY, 0.5 * height),
        };
        let widest = self.share * reach;
        let free = OF_FREE_PATH / self.air.extinction_at(place).max_element();
        [distance, reach, free.clamp(0.25 * widest, widest)]
    }

    /// What the light at the eye gives for J at a place, fading with the distance.
    fn of_eye(&self, place: DVec3, direction: DVec3) -> Vec<DVec3> {
        let [distance, _, widest] = self.scale(place);
        let part = 1.0 - smooth((distance / widest - 1.0) / 1.5);
        if part <= 0.0 {
            return Vec::new();
        }
        let mut source = self.lobes.source(&self.at_eye, direction);
        source.iter_mut().for_each(|j| *j *= part);
        source
    }

    /// By how much J at a place differs from [`Self::of_eye`].
    fn rest(&self, arrivals: &[Arrival], place: DVec3, direction: DVec3) -> Vec<DVec3> {
        let mut rest = self.lobes.source(&self.lit(arrivals), direction);
        for (rest, eye) in rest.iter_mut().zip(self.of_eye(place, direction)) {
            *rest -= eye;
        }
        rest
    }

    /// Adds the rest of J from a level of the lattice, or from finer ones where it is uneven.
    fn add_level(
        &self,
        place: DVec3,
        direction: DVec3,
        level: i32,
        [reach, part]: [f64; 2],
        sum: &mut Vec<DVec3>,
    ) {
        let (number, at) = Place::around(place, level);
        let slot = self.cells.place(number);
        let cell = slot.get_or_init(|| self.cell(number));
        let wide = spacing(level) / reach;
        let uneven = match cell.difference > 0.0 {
            true => cell.difference * wide / cell.mean.max(self.typical),
            false => 0.0,
        };
        let finer = match wide > 2.0 * self.finest * self.share {
            true => smooth(2.0 * (uneven / self.uneven - 1.0)),
            false => 0.0,
        };
        if finer > 0.0 {
            self.add_level(place, direction, level - 1, [reach, part * finer], sum);
        }
        if finer < 1.0 {
            self.add_cell(
                place,
                direction,
                (number, cell, at),
                part * (1.0 - finer),
                sum,
            );
        }
    }

    fn cell(&self, number: Place) -> Cell {
        let pairs = self.lattice.pairs(number);
        let corners: [OnceLock<Vec<DVec3>>; 8] = Default::default();
        let places = number.corners();
        let value = |corner: usize| corners[corner].get_or_init(|| self.at_point(places[corner]));
        let (mut difference, mut sum, mut count) = (0.0f64, 0.0, 0.0);
        for (i, (a, b)) in PAIRS.into_iter().enumerate() {
            if pairs >> i & 1 == 1 {
                for (a, b) in value(a).iter().zip(value(b)) {
                    difference = difference.max((*a - *b).abs().max_element());
                    sum += 0.5 * (*a + *b).max_element();
                    count += 1.0;
                }
            }
        }
        Cell {
            pairs,
            corners,
            difference,
            mean: sum / f64::max(count, 1.0),
        }
    }

    /// Adds the rest of J from the corners of a cell that the place sees.
    fn add_cell(
        &self,
        place: DVec3,
        direction: DVec3,
        (number, cell, at): (Place, &Cell, DVec3),
        part: f64,
        sum: &mut Vec<DVec3>,
    ) {
        let corners = number.corners();
        let weights: [f64; 8] = std::array::from_fn(|corner| {
            let along = |axis: usize| match corner >> axis & 1 {
                0 => 1.0 - at[axis],
                _ => at[axis],
            };
            let seen =
                cell.pairs == u16::MAX || self.lattice.sees(place, corners[corner].position());
            f64::from(u8::from(seen)) * along(0) * along(1) * along(2)
        });
        let seen: f64 = weights.iter().sum();
        // Where little of the cell is seen, places around it help, and if none of those is seen either, the place itself.
        let other = 1.0 - smooth(2.0 * seen / SEEN - 1.0);
        if other > 0.0 {
            let found = self
                .by_wider(place, number, at)
                .unwrap_or_else(|| self.alone(place, direction));
            add(sum, &found, other * part);
        }
        if other < 1.0 {
            for (corner, weight) in weights.iter().enumerate() {
                if *weight > 0.0 {
                    let found = cell.corners[corner].get_or_init(|| self.at_point(corners[corner]));
                    add(sum, found, (1.0 - other) * part * weight / seen);
                }
            }
        }
    }

    /// The rest of J from the points of the lattice within two spacings of a place that it sees.
    fn by_wider(&self, place: DVec3, cell: Place, at: DVec3) -> Option<Vec<DVec3>> {
        let mut sum = Vec::new();
        let mut seen = 0.0;
        for (point, offset) in cell.surroundings() {
            let apart = (offset - at).abs();
            let weight = (2.0 - apart).max(DVec3::ZERO);
            let weight = weight.x * weight.y * weight.z;
            if weight > 0.0 && self.lattice.sees(place, point.position()) {
                let source = self.at_point(point);
                add(&mut sum, &source, weight);
                seen += weight;
            }
        }
        sum.iter_mut().for_each(|j| *j /= seen);
        (seen > 0.0).then_some(sum)
    }

    /// The rest by what comes to the place itself.
    fn alone(&self, place: DVec3, direction: DVec3) -> Vec<DVec3> {
        self.rest(&self.lattice.around(place), place, direction)
    }

    /// The rest at a point of the lattice.
    fn at_point(&self, point: Place) -> Vec<DVec3> {
        let point = point.coarsest();
        let slot = self.points.place(point);
        slot.get_or_init(|| {
            let position = point.position();
            let direction = match self.eye {
                Eye::At(eye) => (position - eye).normalize_or(DVec3::NEG_Z),
                Eye::Parallel(direction, _) => direction,
            };
            self.rest(&self.lattice.arrivals(point), position, direction)
        })
        .clone()
    }
}

fn add(sum: &mut Vec<DVec3>, values: &[DVec3], weight: f64) {
    sum.resize(values.len(), DVec3::ZERO);
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += weight * *value;
    }
}

/// 0 below 0, 1 above 1, and without a kink between.
pub fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
