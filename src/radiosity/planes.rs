//! Which triangles lie in one plane, and which are too small to be told apart.
//!
//! A wall is a wall however it was cut into triangles: all triangles of one plane are one [`Plane`], whose patches are cells of that
//! plane. Finely tessellated things (a vase, a vault, leaves) have a plane for each triangle; where these are smaller than
//! the patches that they would be given, patches are what lies in one cell of space and faces the same of six ways.

use super::arrival::{Map, spread};
use crate::conditions::Conditions;
use crate::error::Result;
use crate::scene::Ray;
use crate::scene::tree::Bound;
use crate::task::Task;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Triangles that lie in one plane.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    /// A point of it [m].
    pub origin: DVec3,
    /// Unit vectors along it, and the normal that makes them right-handed.
    pub axes: [DVec3; 2],
    pub normal: DVec3,
    /// The rectangle around the triangles, along the axes [m].
    pub low: DVec2,
    pub high: DVec2,
    /// The triangles, by their number in the scene.
    pub triangles: Vec<u32>,
}

impl Plane {
    /// A plane through a point; its axes follow those of the scene as far as they can, so that walls of one house have cells
    /// along the same lines.
    pub fn new(origin: DVec3, normal: DVec3) -> Self {
        // The horizontal line in the plane; in a level one that along X.
        let level = DVec3::Y.cross(normal);
        let u = match level.length() > 1e-3 {
            true => level.normalize(),
            false => (DVec3::X - normal * normal.x).normalize(),
        };
        Plane {
            origin,
            axes: [u, normal.cross(u)],
            normal,
            low: DVec2::INFINITY,
            high: DVec2::NEG_INFINITY,
            triangles: Vec::new(),
        }
    }

    /// Coordinates along the axes [m].
    pub fn flat(&self, point: DVec3) -> DVec2 {
        let p = point - self.origin;
        DVec2::new(p.dot(self.axes[0]), p.dot(self.axes[1]))
    }

    /// How high a point lies above it, on the side of the normal [m].
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.normal)
    }

    /// The point of coordinates.
    pub fn point(&self, at: DVec2) -> DVec3 {
        self.origin + at.x * self.axes[0] + at.y * self.axes[1]
    }

    /// The least box around a rectangle of it at two heights above it [m].
    pub fn space(&self, rectangle: [DVec2; 2], heights: [f64; 2]) -> (DVec3, DVec3) {
        let [low, high] = rectangle;
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for at in [
            low,
            high,
            DVec2::new(low.x, high.y),
            DVec2::new(high.x, low.y),
        ] {
            for height in heights {
                let p = self.point(at) + height * self.normal;
                bounds = (bounds.0.min(p), bounds.1.max(p));
            }
        }
        bounds
    }

    /// The longer side of the rectangle [m].
    pub fn extent(&self) -> f64 {
        (self.high - self.low).max_element().max(0.0)
    }
}

/// What a triangle belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Home {
    /// It stops no light.
    Absent,
    /// A plane, and whether the triangle's front is the plane's.
    Plane(u32, bool),
    /// A cluster on each side: front and back.
    Cluster([u32; 2]),
}

/// The triangles of a scene in planes and clusters.
pub(super) struct Surfaces {
    pub planes: Vec<Plane>,
    /// By the triangle's number in the scene.
    pub homes: Vec<Home>,
    /// The triangles and sides (0 is the front) of each cluster.
    pub clusters: Vec<Vec<(u32, usize)>>,
    /// The least size of what each triangle is a part of [m]: its plane, or the connected thing that is clustered.
    pub sizes: Vec<f64>,
    /// The scene's bounding volumes.
    pub bounds: Vec<Bound>,
}

impl Surfaces {
    /// Sorts the triangles. Clusters are about `share` as large as the connected thing that they are a part of, and larger
    /// where there would be more than `most`.
    pub fn new(conditions: &Conditions, share: f64, most: usize, task: Task<'_>) -> Result<Self> {
        let geometry = &conditions.geometry;
        let mesh = &conditions.scene.mesh;
        let kept: Vec<u32> = geometry.casters().map(|(triangle, _)| triangle).collect();
        let things = Things::new(conditions, &kept);
        let mut homes = vec![Home::Absent; mesh.triangles.len()];
        let mut sizes = vec![f64::INFINITY; mesh.triangles.len()];
        let (low, high) = geometry.bounds();
        let middle = 0.5 * (low + high);
        // What differs by less than this is one plane [m].
        let thick = 1e-7 * geometry.extent() + 1e-12 * middle.length();
        let mut planes: Vec<Plane> = Vec::new();
        let mut by_place = ByPlace::default();
        let mut sorted = kept.clone();
        sorted.sort_unstable();
        let mut of_triangle = Vec::with_capacity(sorted.len());
        for &triangle in &sorted {
            let [a, b, c] = conditions.scene.mesh.corners(triangle);
            let Some(facet) = (b - a).cross(c - a).try_normalize() else {
                continue;
            };
            // One of the two normals of a plane.
            let first = facet.to_array().into_iter().find(|x| x.abs() > 1e-4);
            let front = first.is_none_or(|x| x > 0.0);
            let normal = if front { facet } else { -facet };
            let places = Places::around(normal, (a - middle).dot(normal), geometry.extent());
            let fits = |plane: &u32| {
                let first = planes[*plane as usize].triangles[0];
                let first = conditions.scene.mesh.corners(first);
                is_flat_with(&planes[*plane as usize], first, [a, b, c], thick)
            };
            let plane = by_place.first(&places, fits).unwrap_or_else(|| {
                planes.push(Plane::new(a, normal));
                by_place.add(&places, planes.len() as u32 - 1);
                planes.len() as u32 - 1
            });
            let place = &mut planes[plane as usize];
            place.triangles.push(triangle);
            for p in [a, b, c] {
                let at = place.flat(p);
                place.low = place.low.min(at);
                place.high = place.high.max(at);
            }
            of_triangle.push((triangle, plane, front));
        }
        // What is smaller than a cluster would be is no plane of its own; clusters are larger where there are many planes.
        let mut share = share;
        let is_plane = |triangle: u32, plane: u32, share: f64| {
            planes[plane as usize].extent() >= 0.75 * share * things.extent_of(triangle)
        };
        loop {
            let kept = of_triangle
                .iter()
                .filter(|(t, p, _)| is_plane(*t, *p, share));
            let mut kept: Vec<u32> = kept.map(|(_, plane, _)| *plane).collect();
            kept.sort_unstable();
            kept.dedup();
            if 4 * kept.len() <= most || share > 1.0 {
                break;
            }
            share *= 1.4;
        }
        let mut small = Vec::new();
        for &(triangle, plane, front) in &of_triangle {
            let thing = things.extent_of(triangle);
            if is_plane(triangle, plane, share) && share <= 1.0 {
                homes[triangle as usize] = Home::Plane(plane, front);
                sizes[triangle as usize] = planes[plane as usize].extent().min(thing);
            } else {
                small.push(triangle);
                sizes[triangle as usize] = thing;
            }
        }
        let clusters = clusters(conditions, &things, &small, share, most, &mut homes, task)?;
        // Planes that were left to clusters are none.
        let mut number = vec![u32::MAX; planes.len()];
        let mut kept: Vec<Plane> = Vec::new();
        for (triangle, plane, _) in &of_triangle {
            let Home::Plane(_, front) = homes[*triangle as usize] else {
                continue;
            };
            let at = *plane as usize;
            if number[at] == u32::MAX {
                number[at] = kept.len() as u32;
                kept.push(Plane {
                    triangles: Vec::new(),
                    ..planes[at].clone()
                });
            }
            kept[number[at] as usize].triangles.push(*triangle);
            homes[*triangle as usize] = Home::Plane(number[at], front);
        }
        let planes = kept;
        Ok(Surfaces {
            planes,
            homes,
            clusters,
            sizes,
            bounds: geometry.in_order(),
        })
    }

    /// Whether something whose size is below `size` may stand in a box.
    pub fn holds_smaller(&self, low: DVec3, high: DVec3, size: f64) -> bool {
        let mut found = false;
        self.within(low, high, |triangle| {
            found |= self.sizes[triangle as usize] < size;
            found
        });
        found
    }

    /// Calls `found` for the triangles whose bounds meet a box, until it returns true.
    pub fn within(&self, low: DVec3, high: DVec3, mut found: impl FnMut(u32) -> bool) {
        let mut at = 0;
        while let Some(bound) = self.bounds.get(at) {
            let meets = bound.min.cmple(high).all() && bound.max.cmpge(low).all();
            match bound.triangle {
                Some(triangle) if meets && found(triangle) => return,
                None if meets => at += 1,
                _ => at = bound.skip as usize,
            }
        }
    }
}

/// Whether a triangle lies in the plane of another, the first one in it, but for the rounding of positions, which turns that one by so much over
/// its least height. `thick` [m].
fn is_flat_with(plane: &Plane, first: [DVec3; 3], corners: [DVec3; 3], thick: f64) -> bool {
    let [a, b, c] = first;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let least = (b - a).cross(c - a).length() / longest;
    corners.iter().all(|p| {
        let away = (p.distance(plane.origin) / least).min(FARTHEST);
        plane.height(*p).abs() <= thick * (1.0 + away)
    })
}

/// A needle's plane is not held to be known farther away than so many of its least heights.
const FARTHEST: f64 = 64.0;

/// Steps in which the components of normals, and distances over the scene's extent, tell planes apart at first [1].
const STEPS: [f64; 4] = [1e-5, 1e-5, 1e-5, 4e-6];

/// Where planes like one are found: the steps of normal and distance, and those beside them that it is nearly in.
struct Places {
    own: [i64; 4],
    beside: [i64; 4],
}

impl Places {
    fn around(normal: DVec3, distance: f64, extent: f64) -> Self {
        let at = [normal.x, normal.y, normal.z, distance / extent];
        let at: [f64; 4] = std::array::from_fn(|i| at[i] / STEPS[i]);
        let own = at.map(|x| x.round() as i64);
        let beside = std::array::from_fn(|i| match at[i] - own[i] as f64 {
            off if off > 0.25 => 1,
            off if off < -0.25 => -1,
            _ => 0,
        });
        Places { own, beside }
    }

    fn all(&self) -> impl Iterator<Item = [i64; 4]> {
        let Places { own, beside } = *self;
        // Without those that are no others.
        let is_other = move |turn: &usize| (0..4).all(|i| turn >> i & 1 == 0 || beside[i] != 0);
        let place = move |turn: usize| {
            std::array::from_fn(|i| match turn >> i & 1 {
                0 => own[i],
                _ => own[i] + beside[i],
            })
        };
        (0..16).filter(is_other).map(place)
    }
}

/// Planes by the place of their first triangle.
#[derive(Default)]
struct ByPlace {
    /// The latest plane of each place.
    latest: HashMap<[i64; 4], u32>,
    /// Of each plane the one before it in its place; itself if there is none.
    before: Vec<u32>,
}

impl ByPlace {
    /// The first plane at some places that fits.
    fn first(&self, places: &Places, fits: impl Fn(&u32) -> bool) -> Option<u32> {
        let of_place = |place: [i64; 4]| {
            let before = move |plane: &u32| {
                let before = self.before[*plane as usize];
                (before != *plane).then_some(before)
            };
            std::iter::successors(self.latest.get(&place).copied(), before)
        };
        places.all().flat_map(of_place).find(fits)
    }

    /// Adds the next plane.
    fn add(&mut self, places: &Places, plane: u32) {
        let before = self.latest.insert(places.own, plane).unwrap_or(plane);
        self.before.push(before);
    }
}

/// Sorts small triangles into cells of space, by the side that they face.
fn clusters(
    conditions: &Conditions,
    things: &Things,
    small: &[u32],
    share: f64,
    most: usize,
    homes: &mut [Home],
    task: Task<'_>,
) -> Result<Vec<Vec<(u32, usize)>>> {
    // What lies open and what does not is not one patch: window reveals are far brighter than the wall beside them.
    let pieces = task.pieces(small.len());
    let open: Result<Vec<[u8; 2]>> = small
        .par_iter()
        .map(|triangle| {
            pieces.begin()?;
            Ok([false, true].map(|back| openness(conditions, *triangle, back)))
        })
        .collect();
    let open = open?;
    let mut least = 1e-4 * conditions.geometry.extent();
    loop {
        task.check()?;
        let mut numbers: HashMap<(i32, [i64; 3], i8, u64, u8), u32> = HashMap::new();
        let mut clusters: Vec<Vec<(u32, usize)>> = Vec::new();
        for (&triangle, open) in small.iter().zip(&open) {
            let [a, b, c] = conditions.scene.mesh.corners(triangle);
            let facet = (b - a).cross(c - a);
            let middle = (a + b + c) / 3.0;
            let thing = things.extent_of(triangle);
            // Cells are powers of two, so that things of nearly one size share them.
            let cell = (share * thing).max(least).log2().round().exp2();
            let place = (middle / cell).floor().to_array().map(|x| x as i64);
            let of = match thing > 2.0 * least {
                true => things.number_of(triangle),
                false => -1,
            };
            let sides = [(facet, open[0]), (-facet, open[1])].map(|(facing, open)| {
                let key = (of, place, way(facing), cell.to_bits(), open);
                *numbers.entry(key).or_insert_with(|| {
                    clusters.push(Vec::new());
                    clusters.len() as u32 - 1
                })
            });
            for (side, cluster) in sides.into_iter().enumerate() {
                clusters[cluster as usize].push((triangle, side));
            }
            homes[triangle as usize] = Home::Cluster(sides);
        }
        if clusters.len() <= most || least > conditions.geometry.extent() {
            return Ok(clusters);
        }
        least *= 1.5;
    }
}

/// How one side of a triangle lies, by a few rays: inside of something, closed in, open in part, or open.
///
/// What is inside of something (the foot of a pillar in the floor, a vault's upper side) is dark, and would dim what it is taken
/// together with.
fn openness(conditions: &Conditions, triangle: u32, back: bool) -> u8 {
    let [a, b, c] = conditions.scene.mesh.corners(triangle);
    let facet = (b - a).cross(c - a).normalize_or_zero();
    let normal = if back { -facet } else { facet };
    let map = Map::before(normal);
    let lift = 1e-9 * conditions.geometry.extent();
    let (mut free, mut inside) = (0, 0);
    for k in 0..4 {
        let [v, w, x, y, _] = spread(k, u64::from(triangle));
        let (v, w) = if v + w > 1.0 {
            (1.0 - v, 1.0 - w)
        } else {
            (v, w)
        };
        let ray = Ray {
            origin: a + v * (b - a) + w * (c - a) + lift * normal,
            direction: map.toward(x, y),
        };
        match conditions.geometry.closest(&ray, 0.0, f64::INFINITY) {
            None => free += 1,
            Some(hit) => {
                let [a, b, c] = conditions.scene.mesh.corners(hit.triangle);
                inside += u8::from((b - a).cross(c - a).dot(ray.direction) > 0.0);
            }
        }
    }
    match (free, inside) {
        (_, 3..) => 0,
        (0, _) => 1,
        (1 | 2, _) => 2,
        _ => 3,
    }
}

/// Which of six ways something faces most.
fn way(facing: DVec3) -> i8 {
    let axis = facing.abs().max_position() as i8;
    if facing[axis as usize] < 0.0 {
        -1 - axis
    } else {
        axis
    }
}

/// What is connected: triangles that share a corner.
struct Things {
    number: Vec<i32>,
    extents: Vec<f64>,
}

impl Things {
    fn new(conditions: &Conditions, kept: &[u32]) -> Self {
        let mesh = &conditions.scene.mesh;
        let mut at: HashMap<[u64; 3], u32> = HashMap::new();
        let mut parent: Vec<u32> = Vec::new();
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        let mut corner = |parent: &mut Vec<u32>, p: DVec3| {
            *at.entry((p + 0.0).to_array().map(f64::to_bits))
                .or_insert_with(|| {
                    parent.push(parent.len() as u32);
                    parent.len() as u32 - 1
                })
        };
        let mut first = vec![0u32; mesh.triangles.len()];
        for &triangle in kept {
            let [a, b, c] = conditions
                .scene
                .mesh
                .corners(triangle)
                .map(|p| corner(&mut parent, p));
            first[triangle as usize] = a;
            for other in [b, c] {
                let (i, j) = (root(&mut parent, a), root(&mut parent, other));
                parent[j.max(i) as usize] = j.min(i);
            }
        }
        let mut numbers: HashMap<u32, i32> = HashMap::new();
        let mut boxes: Vec<(DVec3, DVec3)> = Vec::new();
        let mut number = vec![-1; mesh.triangles.len()];
        for &triangle in kept {
            let root = root(&mut parent, first[triangle as usize]);
            let thing = *numbers.entry(root).or_insert_with(|| {
                boxes.push((DVec3::INFINITY, DVec3::NEG_INFINITY));
                boxes.len() as i32 - 1
            });
            number[triangle as usize] = thing;
            let (low, high) = &mut boxes[thing as usize];
            for p in conditions.scene.mesh.corners(triangle) {
                *low = low.min(p);
                *high = high.max(p);
            }
        }
        let extents = boxes.iter().map(|(a, b)| (*b - *a).max_element()).collect();
        Things { number, extents }
    }

    fn number_of(&self, triangle: u32) -> i32 {
        self.number[triangle as usize]
    }

    fn extent_of(&self, triangle: u32) -> f64 {
        usize::try_from(self.number_of(triangle)).map_or(0.0, |thing| self.extents[thing])
    }
}
