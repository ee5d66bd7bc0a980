//! What a place receives, direction by direction.

use super::tiles::Tile;
use crate::split_mix::SplitMix;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Where light comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// Nowhere: below the horizon of a scene without a ground.
    Nothing,
    /// A patch of the sky, by its number in the [`super::Dome`].
    Sky(u32),
    /// The ground far from everything, which lies open to sky and sun.
    OpenGround,
    /// A patch of a surface, by its number, and where on it.
    Patch(u32, Tile),
}

/// Light that comes to a place from around one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Unit vector toward where it comes from.
    pub toward: Vec3,
    /// The solid angle that it stands for [sr]; of a surface's arrivals, the part of its form factor: cos(theta) dw / pi [1].
    pub share: f32,
    /// What media and see-through surfaces on the way let through [1], RGB.
    pub through: Vec3,
    /// Where it comes from.
    pub source: Source,
}

impl Arrival {
    /// A part of it, where something else has the rest [1]: solid angles stay what they are, since they tell which directions it
    /// stands for.
    pub(super) fn weakened(self, map: &Map, part: f64) -> Self {
        match map {
            Map::Sphere => Arrival {
                through: part as f32 * self.through,
                ..self
            },
            Map::Cosine(_) => Arrival {
                share: part as f32 * self.share,
                ..self
            },
        }
    }
}

/// How closely a place is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Care {
    /// Rays before outlines are refined.
    pub rays: usize,
    /// The share of light that may be uncertain for want of finer outlines [1].
    pub outline: f64,
}

/// What a place sees of each source: its share, and the share of light that comes through.
pub(super) type Row = Vec<(Source, f32, Vec3)>;

/// Sums what is of one source.
pub(super) fn merge(row: &mut Row) {
    row.sort_unstable_by_key(|(source, ..)| *source);
    row.dedup_by(|next, sum| {
        let same = next.0 == sum.0;
        if same {
            sum.1 += next.1;
            sum.2 += next.2;
        }
        same
    });
}

/// A map of the unit square to directions, equal areas for equal weights.
#[derive(Debug, Clone, Copy)]
pub(super) enum Map {
    /// All round a point, by solid angle: the cylinder of Archimedes around the vertical.
    Sphere,
    /// Before a surface, by the cosine law: the concentric map of Shirley & Chiu 1997 onto the disc, raised to the hemisphere around
    /// the third of three axes.
    Cosine([DVec3; 3]),
}

impl Map {
    /// That before a surface of a normal.
    pub fn before(normal: DVec3) -> Self {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Map::Cosine([tangent, bitangent, normal])
    }

    /// The sum of all weights: solid angles [sr], or form factors [1].
    pub fn whole(&self) -> f64 {
        match self {
            Map::Sphere => 4.0 * PI,
            Map::Cosine(_) => 1.0,
        }
    }

    /// How wide a cell of this weight around a direction is, as a square [rad].
    pub fn width(&self, weight: f64, toward: DVec3) -> f64 {
        match self {
            Map::Sphere => weight.sqrt(),
            Map::Cosine([.., normal]) => (PI * weight / toward.dot(*normal).max(1e-9)).sqrt(),
        }
    }

    /// The direction of a point of the square.
    pub fn toward(&self, x: f64, y: f64) -> DVec3 {
        match self {
            Map::Sphere => {
                let height = 2.0 * y - 1.0;
                let level = (1.0 - height * height).max(0.0).sqrt();
                let (sin, cos) = (2.0 * PI * x).sin_cos();
                DVec3::new(level * cos, height, level * sin)
            }
            Map::Cosine([u, v, w]) => {
                let d = cosine_law(x, y);
                *u * d.x + *v * d.y + *w * d.z
            }
        }
    }

    /// The point of the square of a unit direction, if it has one.
    pub fn place(&self, toward: DVec3) -> Option<[f64; 2]> {
        match self {
            Map::Sphere => {
                let turn = toward.z.atan2(toward.x) / (2.0 * PI);
                Some([turn.rem_euclid(1.0), 0.5 + 0.5 * toward.y])
            }
            Map::Cosine([u, v, w]) => {
                if toward.dot(*w) <= 0.0 {
                    return None;
                }
                let (x, y) = (toward.dot(*u), toward.dot(*v));
                let radius = x.hypot(y).min(1.0);
                let (a, b) = if x.abs() > y.abs() {
                    let a = radius.copysign(x);
                    (a, a * (y / x).atan() * 4.0 / PI)
                } else if radius > 0.0 {
                    let b = radius.copysign(y);
                    (b * (x / y).atan() * 4.0 / PI, b)
                } else {
                    (0.0, 0.0)
                };
                Some([0.5 * (a + 1.0), 0.5 * (b + 1.0)])
            }
        }
    }
}

/// The direction around +Z of a point of the unit square by the cosine law.
pub(super) fn cosine_law(x: f64, y: f64) -> DVec3 {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec3::Z;
    }
    let (radius, angle) = if a.abs() > b.abs() {
        (a, PI / 4.0 * (b / a))
    } else {
        (b, PI / 2.0 - PI / 4.0 * (a / b))
    };
    let (sin, cos) = angle.sin_cos();
    DVec3::new(
        radius * cos,
        radius * sin,
        (1.0 - radius * radius).max(0.0).sqrt(),
    )
}

/// Numbers of the additive sequence of the generalised golden ratio in five dimensions (Roberts 2018).
pub(super) fn spread(index: usize, turn: u64) -> [f64; 5] {
    const RATIO: f64 = 1.134_724_138_401_519_4;
    // Every patch has its own turn of the sequence.
    let mut random = SplitMix(turn);
    let mut step = 1.0;
    std::array::from_fn(|_| {
        step /= RATIO;
        (random.unit() + index as f64 * step).fract()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_comes_from_its_place() {
        let normal = DVec3::new(0.3, -0.7, 0.5).normalize();
        for map in [Map::Sphere, Map::before(normal)] {
            for i in 0..31 {
                for j in 0..31 {
                    let at = [i, j].map(|k| (f64::from(k) + 0.4) / 31.0);
                    let found = map.place(map.toward(at[0], at[1]));
                    let [x, y] = found.expect("it is before the surface");
                    assert!(
                        (x - at[0]).abs() + (y - at[1]).abs() < 1e-9,
                        "{at:?} {x} {y}"
                    );
                }
            }
        }
    }
}
