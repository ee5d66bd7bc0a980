//! Whether a mesh looks as if its unit were not the metre, or its Z axis pointed up; whether points do not lie in it for their unit.
//!
//! Only what nobody gave is doubted, and only for reasons that right models do not give: large terrains, cities and slabs
//! are flat, towers are few, small props are still centimetres.

use super::{Geometry, Scene, Triangle};
use crate::warning::Warning;
use glam::DVec3;

/// Height of the bulk of a model above which nothing is built [m]. Of cities single towers reach it.
const TOO_HIGH: f64 = 500.0;
/// Width of a whole model below which no scene lies [m].
const TOO_SMALL: f64 = 0.03;
/// Share of triangles that are steep or face the other way than most, below which a high model is a terrain.
const TERRAIN: f64 = 0.1;
/// Height of single steep triangles above which they belong to no tree and to few houses [m].
const TALL: f64 = 100.0;
/// Extents above which nothing stands that is thin [m].
const WALL: f64 = 300.0;
/// Triangles from which on a model has a shape that can be judged.
const LEAST_TRIANGLES: usize = 32;
/// What objects and materials of level faces are called.
const LEVEL_NAMES: [&str; 12] = [
    "floor",
    "floors",
    "ceiling",
    "ceilings",
    "boden",
    "fussboden",
    "fußboden",
    "decke",
    "sol",
    "plafond",
    "suelo",
    "techo",
];
/// Share of a side of a model's box from which on it is closed, and from which on it is there at all [1].
const SIDE: [f64; 2] = [0.98, 0.3];
/// Diagonals of a scene beyond which points have nothing to do with it.
const FAR: f64 = 5.0;

/// What of a mesh tells its unit and its axes.
struct Shape {
    /// The bounds of all triangles [m].
    low: DVec3,
    high: DVec3,
    /// The extent of the bulk: without the outer twentieth of triangles on each side, where backdrops and single towers
    /// are [m].
    bulk: DVec3,
    /// Share of the area that faces along each axis, within 18 degrees.
    facing: DVec3,
    /// Share of triangles that are steeper than 78 degrees or face the other way than most, for each axis as the vertical.
    rugged: DVec3,
    /// Height that a hundredth of the steep triangles exceed, for each axis as the vertical [m].
    tallest: DVec3,
    triangles: usize,
    /// Share of what is called floor or ceiling that faces along each axis; 0 without such names.
    called_level: DVec3,
    /// How much of each side of its box is there, along each axis on the lower and on the upper side [1].
    sides: [[f64; 2]; 3],
}

/// Whether points look as if their unit were not the metre: most of them lie far outside a scene, and would not in a smaller unit.
pub fn of_points(geometry: &Geometry, points: &[DVec3]) -> Option<Warning> {
    if geometry.triangle_count() == 0 {
        return None;
    }
    let (low, high) = geometry.bounds();
    let beyond = |diagonals: f64, point: DVec3| {
        let reach = diagonals * geometry.extent();
        !(point.cmpge(low - reach).all() && point.cmple(high + reach).all())
    };
    let far = points.iter().filter(|p| beyond(FAR, **p));
    let far: Vec<DVec3> = far.copied().collect();
    let fits = |scale: &f64| {
        let near = far.iter().filter(|p| !beyond(0.1, *scale * **p));
        2 * near.count() > far.len()
    };
    // Both fit points in millimetres that all lie near the origin: those are called centimetres, as nothing tells them apart.
    let scale = [0.01, 0.001].into_iter().find(fits)?;
    (2 * far.len() > points.len()).then_some(Warning::FarPoints {
        count: [far.len(), points.len()],
        scale,
    })
}

/// Doubts about a mesh that was just placed: about its unit and its axes, where nobody has given them.
pub(super) fn of(
    scene: &Scene,
    file: &str,
    [unit, axes]: [bool; 2],
    origin: DVec3,
) -> Vec<Warning> {
    let Some(shape) = Shape::of(scene, origin) else {
        return Vec::new();
    };
    let mut hints = Vec::new();
    let on_its_side = axes && shape.lies_on_its_side();
    if on_its_side {
        hints.push(Warning::OnItsSide {
            file: file.to_owned(),
            facing: shape.facing.to_array(),
        });
    }
    let up = if on_its_side { 2 } else { 1 };
    if unit && let Some(scale) = shape.likely_scale(up) {
        hints.push(Warning::OddSize {
            file: file.to_owned(),
            size: (shape.high - shape.low).to_array(),
            scale,
        });
    }
    hints
}

impl Shape {
    fn of(scene: &Scene, origin: DVec3) -> Option<Shape> {
        let mesh = &scene.mesh;
        let (low, high) = mesh.bounds()?;
        let count = mesh.triangles.len();
        let corners = |t: &Triangle| t.vertices.map(|v| mesh.positions[v as usize]);
        let (mut facing, mut up, mut down, mut area) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        let mut steep: [Vec<f64>; 3] = Default::default();
        let (mut called_level, mut all_called_level) = (DVec3::ZERO, 0.0);
        let size = high - low;
        let mut sides = [[0.0; 2]; 3];
        for (number, triangle) in (0..).zip(&mesh.triangles) {
            let [a, b, c] = corners(triangle);
            let cross = (b - a).cross(c - a);
            let doubled = cross.length();
            if !(doubled > 0.0 && doubled.is_finite()) {
                continue;
            }
            let normal = cross / doubled;
            let mark = |yes: glam::BVec3| DVec3::select(yes, DVec3::ONE, DVec3::ZERO);
            area += doubled;
            if is_called_level(scene, number) {
                called_level += doubled * normal.abs();
                all_called_level += doubled;
            }
            for axis in 0..3 {
                for (side, at) in sides[axis].iter_mut().zip([low, high]) {
                    let is_on = |p: &DVec3| (p[axis] - at[axis]).abs() <= 1e-3 * size[axis];
                    if [a, b, c].iter().all(is_on) {
                        let whole = size[(axis + 1) % 3] * size[(axis + 2) % 3];
                        *side += 0.5 * doubled / whole;
                    }
                }
            }
            facing += doubled * mark(normal.abs().cmpgt(DVec3::splat(0.95)));
            up += mark(normal.cmpgt(DVec3::splat(0.2)));
            down += mark(normal.cmplt(DVec3::splat(-0.2)));
            let height = a.max(b).max(c) - a.min(b).min(c);
            for (axis, steep) in steep.iter_mut().enumerate() {
                if normal[axis].abs() <= 0.2 {
                    steep.push(height[axis]);
                }
            }
        }
        let (outer, mut bulk, mut tallest) = (count / 20, DVec3::ZERO, DVec3::ZERO);
        let mut rugged = up.min(down);
        for (axis, steep) in steep.iter_mut().enumerate() {
            let middle = |t: &Triangle| corners(t).iter().map(|p| p[axis]).sum::<f64>() / 3.0;
            let mut along: Vec<f64> = mesh.triangles.iter().map(middle).collect();
            bulk[axis] = ranked(&mut along, count - 1 - outer) - ranked(&mut along, outer);
            rugged[axis] += steep.len() as f64;
            let most = steep.len().saturating_sub(1 + steep.len() / 100);
            tallest[axis] = ranked(steep, most);
        }
        (area > 0.0).then(|| Shape {
            low: low - origin,
            high: high - origin,
            bulk,
            facing: facing / area,
            rugged: rugged / count as f64,
            tallest,
            triangles: count,
            called_level: match all_called_level > 0.0 {
                true => called_level / all_called_level,
                false => DVec3::ZERO,
            },
            sides,
        })
    }

    /// Metres in a unit, where metres would be out of all proportion; `up` is the axis that points up.
    fn likely_scale(&self, up: usize) -> Option<f64> {
        let height = self.bulk[up];
        if height > TOO_HIGH && self.rugged[up] > TERRAIN && self.tallest[up] > TALL {
            return Some(if height < 3.0 * TOO_HIGH { 0.01 } else { 0.001 });
        }
        let widest = (self.high - self.low).max_element();
        (widest < TOO_SMALL).then_some(1000.0)
    }

    /// Whether Z points up, by where the surfaces face and where the model stands.
    fn lies_on_its_side(&self) -> bool {
        let size = self.high - self.low;
        if size.min_element() <= 0.0 {
            return false;
        }
        if self.called_level.z > 0.9 {
            return true;
        }
        // A room has floor and ceiling, and windows in its walls: no floor alone has a hole.
        let [closed, there] = SIDE;
        let [_, [floor, ceiling], [front, back]] = self.sides;
        let closes = |side: f64| side >= closed;
        if floor > there && !closes(floor) && [ceiling, front, back].into_iter().all(closes) {
            return true;
        }
        if self.triangles < LEAST_TRIANGLES {
            return false;
        }
        // Terrains and cities in the axes of a map would be a wall of hundreds of metres.
        if self.bulk.x.min(self.bulk.y) > WALL && self.bulk.z < 0.25 * self.bulk.x.min(self.bulk.y)
        {
            return true;
        }
        // Models stand on the plane of their origin, which is in the middle of the ground that they cover.
        let below = -self.low / size;
        let [_, y, z] = self.facing.to_array();
        let level = z >= 1.5 * y && z >= self.facing.x;
        let exact =
            below.z.abs() < 0.02 && (below.x - 0.5).abs() < 0.05 && (below.y - 0.5).abs() < 0.05;
        let stands = below.z.abs() < 0.3 && below.y > 0.35;
        level && stands || z > y && exact
    }
}

/// Whether its object or its material is called a floor or a ceiling.
fn is_called_level(scene: &Scene, triangle: u32) -> bool {
    let material = scene.mesh.triangles[triangle as usize].material;
    let material = scene.materials.get(material as usize);
    let names = [scene.name_of(triangle), material.map_or("", |m| &m.name)];
    names.iter().any(|name| {
        let mut words = name.split(|c: char| !c.is_alphabetic());
        words.any(|word| LEVEL_NAMES.contains(&word.to_lowercase().as_str()))
    })
}

/// The value of that rank, from the least; the greatest for a rank beyond, 0 without any.
fn ranked(values: &mut [f64], rank: usize) -> f64 {
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    *values
        .select_nth_unstable_by(rank.min(last), f64::total_cmp)
        .1
}
