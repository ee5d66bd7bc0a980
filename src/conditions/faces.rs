//! Surfaces that shine, as one lamp: triangles of even luminance below a tree of clusters.
//!
//! A face sends L A cos(theta) in each direction before it (Lambert 1760). Seen from far away a cluster of faces that look the same
//! way is one point of light on one of them; from nearby its parts are, and at last parts of a triangle (Walter et al. 2005,
//! Lightcuts). So a sign costs by how near it is and by the shadows that fall on its light, not by its number of triangles.

use super::GroundPlane;
use super::openness::openness;
use super::spot::Spot;
use crate::colour::{Space, luminance};
use crate::scene::{Geometry, Ray, Scene};
use glam::DVec3;
use std::collections::VecDeque;

/// Places of light lie so far before their face, as a share of the size of the scene: a face does not shade itself.
const LIFT: f64 = 1e-8;

/// Parts of triangles of a textured material, all together.
const MOST_PARTS: usize = 1 << 16;
/// A triangle is divided by its texture so often at most: into 4^this parts.
const MOST_LEVELS: u32 = 4;
/// Places at which textures are looked up, all together.
const LOOKUPS: usize = 1 << 22;
/// Parts whose luminances differ by no more than this share of the brightest are one.
const ALIKE: f64 = 0.02;

/// At so many of them it is looked how much daylight meets them.
const PLACES: usize = 32;

/// A ray has no more parts of a surface that shines: of thousands of faces that look all ways, clusters stand for the rest.
const MOST_ALONG: usize = 1024;

/// Faces that shine.
#[derive(Clone)]
pub struct Faces {
    /// Their material, by its number in the scene.
    pub material: u32,
    all: Vec<Face>,
    /// The first is the root.
    nodes: Vec<Node>,
    /// How far before its face a place of light lies [m].
    lift: f64,
    /// The intensity of all along their normals, added up [cd, luminance].
    pub candela: f64,
    /// The greatest luminance [cd/m2].
    pub brightest: f64,
    /// The most daylight that meets one of them, against what there is in the open ([`openness`]) [1].
    pub openness: f64,
}

/// A triangle of even luminance.
#[derive(Clone, Copy)]
struct Face {
    corners: [DVec3; 3],
    /// Unit, on the side on which it shines.
    normal: DVec3,
    /// Intensity along the normal [cd, RGB].
    light: DVec3,
}

impl Face {
    fn middle(&self) -> DVec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }
}

/// Faces that lie together.
#[derive(Clone, Copy)]
struct Node {
    /// Of a ball around all of them [m].
    middle: DVec3,
    radius: f64,
    /// Their mean normal, and the cosine of the greatest angle that one of them makes with it.
    normal: DVec3,
    spread: f64,
    /// How far one of them reaches behind the middle, against the mean normal [m].
    depth: f64,
    /// A place on one of them, or between them where they lie in one plane [m].
    place: DVec3,
    /// Intensity along the mean normal [cd, RGB].
    light: DVec3,
    /// Two nodes, or one face.
    below: Below,
}

#[derive(Clone, Copy)]
enum Below {
    Nodes([u32; 2]),
    Face(u32),
}

/// A part of the faces: a cluster, or a part of one of them.
#[derive(Clone, Copy)]
pub enum Part {
    /// A cluster, by its number.
    Cluster(u32),
    /// A part of a triangle.
    Piece {
        /// Which face.
        face: u32,
        /// Its corners [m].
        corners: [DVec3; 3],
        /// As a share of the face.
        share: f64,
    },
}

impl Faces {
    /// The faces of a material of a scene, on their front or on their back; `None` where nothing shines.
    pub fn new(
        scene: &Scene,
        geometry: &Geometry,
        ground: Option<GroundPlane>,
        material: u32,
        back: bool,
    ) -> Option<Faces> {
        let to_working = Space::Rec709.to_working();
        let shines: Vec<_> = geometry
            .casters()
            .filter(|(t, _)| scene.mesh.triangles[*t as usize].material == material)
            .collect();
        let most = (MOST_PARTS / shines.len().max(1))
            .checked_ilog(4)
            .unwrap_or(0);
        let levels = most.min(MOST_LEVELS);
        let lookups = LOOKUPS / (shines.len().max(1) << (2 * levels));
        let mut all = Vec::new();
        for (triangle, opacity) in shines {
            let light = |weights: [f64; 2]| {
                let is_there = opacity
                    .least
                    .is_none_or(|l| scene.is_solid(triangle, weights, l));
                let there = if is_there { opacity.share } else { 0.0 };
                there * (to_working * scene.emission(triangle, weights)).max(DVec3::ZERO)
            };
            let vertices = scene.mesh.triangles[triangle as usize].vertices;
            let mut corners = vertices.map(|v| scene.mesh.positions[v as usize]);
            let mut weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            if back {
                corners.swap(1, 2);
                weights.swap(1, 2);
            }
            let texels = scene.emissive_texels(triangle);
            let levels = match texels {
                0.0 => 0,
                texels => levels.min(texels.log2().ceil().max(0.0) as u32),
            };
            let rows = match texels {
                0.0 => 1,
                texels => {
                    let most = (lookups as f64).sqrt().clamp(2.0, 64.0);
                    (2.0 * texels / f64::from(1u32 << levels)).clamp(2.0, most) as u32
                }
            };
            divide(corners, weights, levels, rows, &light, &mut all);
        }
        all.retain(|face| luminance(face.light) > 0.0);
        if all.is_empty() {
            return None;
        }
        let area = |f: &Face| {
            (f.corners[1] - f.corners[0])
                .cross(f.corners[2] - f.corners[0])
                .length()
                / 2.0
        };
        let brightest = all
            .iter()
            .map(|f| luminance(f.light) / area(f))
            .fold(0.0, f64::max);
        let (low, high) = geometry.bounds();
        let mut faces = Faces {
            material,
            candela: all.iter().map(|face| luminance(face.light)).sum(),
            all,
            nodes: Vec::new(),
            lift: LIFT * low.abs().max(high.abs()).max(high - low).max_element(),
            brightest,
            openness: 0.0,
        };
        // Some of many.
        let step = faces.all.len().div_ceil(PLACES);
        let open = |face: &Face| {
            let place = face.middle() + faces.lift * face.normal;
            openness(place, face.normal, geometry, ground)
        };
        let some = faces.all.iter().step_by(step);
        faces.openness = some.map(open).fold(0.0, f64::max);
        let mut order: Vec<u32> = (0..faces.all.len() as u32).collect();
        faces.cluster(&mut order);
        Some(faces)
    }

    /// Makes the node of some faces and those below it.
    fn cluster(&mut self, order: &mut [u32]) -> u32 {
        let index = self.nodes.len() as u32;
        let node = self.node(order);
        self.nodes.push(node);
        if order.len() > 1 {
            // By place, or by where they look: whatever differs most.
            let key = |face: &Face, axis: usize| match axis {
                0..3 => face.middle()[axis],
                _ => node.radius * face.normal[axis - 3],
            };
            let extent = |axis: usize| {
                let values = order.iter().map(|i| key(&self.all[*i as usize], axis));
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                    (l.min(v), h.max(v))
                });
                high - low
            };
            let axis = (0..6)
                .map(|axis| (extent(axis), axis))
                .fold((-1.0, 0), |most, at| if at.0 > most.0 { at } else { most })
                .1;
            let middle = order.len() / 2;
            let all = &self.all;
            order.select_nth_unstable_by(middle, |a, b| {
                let [at, bt] = [a, b].map(|i| key(&all[*i as usize], axis));
                at.total_cmp(&bt).then(a.cmp(b))
            });
            let (left, right) = order.split_at_mut(middle);
            let below = [self.cluster(left), self.cluster(right)];
            self.nodes[index as usize].below = Below::Nodes(below);
        }
        index
    }

    /// What stands for some faces.
    fn node(&self, order: &[u32]) -> Node {
        let faces = || order.iter().map(|i| &self.all[*i as usize]);
        let corners = || faces().flat_map(|face| face.corners);
        let start = self.all[order[0] as usize].corners[0];
        let (low, high) = corners().fold((start, start), |(l, h), p| (l.min(p), h.max(p)));
        let middle = 0.5 * (low + high);
        let radius = corners().map(|p| p.distance(middle)).fold(0.0, f64::max);
        let sum: f64 = faces().map(|f| luminance(f.light)).sum();
        let looks: DVec3 = faces().map(|f| luminance(f.light) * f.normal).sum();
        let normal = looks.normalize_or(self.all[order[0] as usize].normal);
        let spread = faces().map(|f| f.normal.dot(normal)).fold(1.0, f64::min);
        let heart = faces()
            .map(|f| luminance(f.light) * (f.middle() - middle))
            .sum::<DVec3>()
            / sum
            + middle;
        let flat = corners().all(|p| (p - heart).dot(normal).abs() <= self.lift);
        let place = if flat {
            heart
        } else {
            let middles = faces().map(Face::middle);
            middles
                .min_by(|a, b| {
                    a.distance_squared(heart)
                        .total_cmp(&b.distance_squared(heart))
                })
                .unwrap_or(heart)
        };
        Node {
            middle,
            radius,
            normal,
            spread,
            depth: corners()
                .map(|p| normal.dot(middle - p))
                .fold(0.0, f64::max),
            place: place + self.lift * normal,
            light: faces()
                .map(|f| f.normal.dot(normal).max(0.0) * f.light)
                .sum(),
            below: Below::Face(order[0]),
        }
    }

    /// A ball around all of them: its middle and radius [m].
    pub fn ball(&self) -> (DVec3, f64) {
        (self.nodes[0].middle, self.nodes[0].radius)
    }

    /// All of them.
    pub fn whole(&self) -> Part {
        self.part(0)
    }

    fn part(&self, node: u32) -> Part {
        match self.nodes[node as usize].below {
            Below::Nodes(_) => Part::Cluster(node),
            Below::Face(face) => Part::Piece {
                face,
                corners: self.all[face as usize].corners,
                share: 1.0,
            },
        }
    }

    /// What a part is divided into.
    pub fn divided(&self, part: &Part, mut found: impl FnMut(Part)) {
        match *part {
            Part::Cluster(node) => {
                if let Below::Nodes(below) = self.nodes[node as usize].below {
                    below.into_iter().for_each(|node| found(self.part(node)));
                }
            }
            Part::Piece {
                face,
                corners,
                share,
            } => {
                for corners in quarters(corners, |a, b| 0.5 * (a + b)) {
                    found(Part::Piece {
                        face,
                        corners,
                        share: 0.25 * share,
                    });
                }
            }
        }
    }

    /// Whether a part is small as seen from a place: no more than `reach` of its distance, and the cosine by which a face of it is
    /// turned from their mean is no less than `same_way`.
    pub fn is_small(&self, part: &Part, from: DVec3, reach: f64, same_way: f64) -> bool {
        let (middle, radius) = self.around(part);
        let looks_one_way = match part {
            Part::Cluster(node) => self.nodes[*node as usize].spread >= same_way,
            Part::Piece { .. } => true,
        };
        looks_one_way && radius <= reach * middle.distance(from)
    }

    /// Whether nothing of a part shines toward a place.
    pub fn looks_away(&self, part: &Part, from: DVec3) -> bool {
        match part {
            Part::Cluster(node) => {
                let node = &self.nodes[*node as usize];
                let way = from - node.middle;
                let sin = (1.0 - node.spread * node.spread).max(0.0).sqrt();
                let before = node.normal.dot(way) + node.depth + sin * (way.length() + node.radius);
                node.spread > 0.0 && before <= self.lift
            }
            Part::Piece { face, corners, .. } => {
                self.all[*face as usize].normal.dot(from - corners[0]) <= self.lift
            }
        }
    }

    /// Whether all of a part lies behind a plane, or in it.
    pub fn is_behind(&self, part: &Part, point: DVec3, normal: DVec3) -> bool {
        match part {
            Part::Cluster(node) => {
                let node = &self.nodes[*node as usize];
                normal.dot(node.middle - point) <= -node.radius
            }
            Part::Piece { corners, .. } => {
                corners.iter().all(|p| normal.dot(*p - point) <= self.lift)
            }
        }
    }

    /// A ball around a part: its middle and radius [m].
    pub fn around(&self, part: &Part) -> (DVec3, f64) {
        match part {
            Part::Cluster(node) => {
                let node = &self.nodes[*node as usize];
                (node.middle, node.radius)
            }
            Part::Piece { corners, .. } => {
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                (
                    middle,
                    corners
                        .map(|p| p.distance(middle))
                        .into_iter()
                        .fold(0.0, f64::max),
                )
            }
        }
    }

    /// Places that stand for a part: of a cluster those of up to four below it, of a piece of a triangle three, which are exact for
    /// polynomials of the second degree (Strang & Fix 1973).
    pub fn spots(&self, part: &Part, mut found: impl FnMut(Spot)) {
        match part {
            Part::Cluster(node) => {
                let Below::Nodes(below) = self.nodes[*node as usize].below else {
                    return;
                };
                for child in below {
                    match self.nodes[child as usize].below {
                        Below::Nodes(two) => {
                            two.into_iter().for_each(|node| found(self.of_node(node)))
                        }
                        Below::Face(_) => found(self.of_node(child)),
                    }
                }
            }
            Part::Piece {
                face,
                corners: [a, b, c],
                share,
            } => {
                let face = &self.all[*face as usize];
                for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
                    let place = (4.0 * *p + *q + *r) / 6.0;
                    let radius = 0.25 * p.distance(*q).min(p.distance(*r));
                    found(self.spot(
                        place + self.lift * face.normal,
                        face.normal,
                        share / 3.0 * face.light,
                        radius,
                    ));
                }
            }
        }
    }

    fn of_node(&self, node: u32) -> Spot {
        let node = &self.nodes[node as usize];
        self.spot(node.place, node.normal, node.light, 0.5 * node.radius)
    }

    fn spot(&self, position: DVec3, side: DVec3, light: DVec3, radius: f64) -> Spot {
        let strength = luminance(light);
        Spot {
            position,
            side: Some((side, true)),
            share: strength / self.candela,
            radius,
            tint: light / strength,
        }
    }

    /// Places that stand for all of them on a ray from its origin to a distance [m]: parts no larger than 1 / `count` of how far they
    /// are from it, and no smaller than 1 / `count`^2 of all, whose faces are turned from their mean by no more than the angle whose cosine
    /// is 1 - 1 / `count`^2.
    pub fn along(&self, ray: &Ray, end: f64, count: u32, mut found: impl FnMut(Spot)) {
        let count = f64::from(count);
        let same_way = 1.0 - 1.0 / (count * count);
        let (_, whole) = self.ball();
        let mut open = VecDeque::from([self.whole()]);
        let mut count_found = 0;
        while let Some(part) = open.pop_front() {
            let (middle, radius) = self.around(&part);
            let is_full = count_found + open.len() >= MOST_ALONG;
            let foot = (middle - ray.origin).dot(ray.direction).clamp(0.0, end);
            let is_least = radius * count * count <= whole;
            let reach = if is_least { f64::INFINITY } else { 1.0 / count };
            if is_full || self.is_small(&part, ray.at(foot), reach, same_way) {
                count_found += 1;
                found(self.one(&part));
            } else {
                self.divided(&part, |part| open.push_back(part));
            }
        }
    }

    /// A place that stands for a part.
    fn one(&self, part: &Part) -> Spot {
        match part {
            Part::Cluster(node) => self.of_node(*node),
            Part::Piece {
                face,
                corners,
                share,
            } => {
                let face = &self.all[*face as usize];
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                let radius = 0.5 * self.around(part).1;
                self.spot(
                    middle + self.lift * face.normal,
                    face.normal,
                    *share * face.light,
                    radius,
                )
            }
        }
    }

    /// Places that stand for all of them wherever they are seen from, about `count` each way on a flat sign.
    pub fn beams(&self, count: u32) -> Vec<Spot> {
        let count = count as usize;
        let worth = |part: &Part| {
            let (_, radius) = self.around(part);
            let light = match part {
                Part::Cluster(node) => self.nodes[*node as usize].light,
                Part::Piece { face, share, .. } => *share * self.all[*face as usize].light,
            };
            radius * luminance(light)
        };
        let same_way = |part: &Part| match part {
            Part::Cluster(node) => self.nodes[*node as usize].spread >= 0.5,
            Part::Piece { .. } => true,
        };
        let (_, radius) = self.ball();
        let least = radius * self.candela / (count * count * count) as f64;
        let (most, mut open, mut done) = (16 * count * count, vec![self.whole()], Vec::new());
        // The widest first, as far as there may be more.
        while let Some(at) =
            (0..open.len()).max_by(|a, b| worth(&open[*a]).total_cmp(&worth(&open[*b])))
        {
            let part = open.swap_remove(at);
            let full = open.len() + done.len() + 1 >= most;
            if full || worth(&part) <= least && same_way(&part) {
                done.push(part);
            } else {
                self.divided(&part, |part| open.push(part));
            }
        }
        done.iter().map(|part| self.one(part)).collect()
    }
}

/// The four triangles that the middles of its sides divide one into.
fn quarters<T: Copy>([a, b, c]: [T; 3], middle: impl Fn(T, T) -> T) -> [[T; 3]; 4] {
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

/// Divides a triangle by its luminance, which `light` gives at the weights of two vertices; what is alike stays together.
fn divide(
    corners: [DVec3; 3],
    weights: [[f64; 2]; 3],
    levels: u32,
    rows: u32,
    light: &dyn Fn([f64; 2]) -> DVec3,
    found: &mut Vec<Face>,
) -> DVec3 {
    let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let (area, normal) = (0.5 * across.length(), across.normalize_or_zero());
    if levels == 0 {
        let mean = mean(weights, rows, light);
        found.push(Face {
            corners,
            normal,
            light: area * mean,
        });
        return mean;
    }
    let start = found.len();
    let half = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let places = quarters(corners, |a, b| 0.5 * (a + b));
    let parts = places.into_iter().zip(quarters(weights, half));
    let means: Vec<DVec3> = parts
        .map(|(c, w)| divide(c, w, levels - 1, rows, light, found))
        .collect();
    let mean = means.iter().sum::<DVec3>() / 4.0;
    let whole = found.len() == start + 4;
    let brightest = means.iter().fold(DVec3::ZERO, |most, m| most.max(*m));
    let alike = means
        .iter()
        .all(|m| (*m - mean).abs().max_element() <= ALIKE * brightest.max_element());
    if whole && alike {
        found.truncate(start);
        found.push(Face {
            corners,
            normal,
            light: area * mean,
        });
    }
    mean
}

/// The mean of `light` over a triangle of weights, by the middles of rows x rows triangles.
fn mean([a, b, c]: [[f64; 2]; 3], rows: u32, light: &dyn Fn([f64; 2]) -> DVec3) -> DVec3 {
    let n = f64::from(rows);
    let mut sum = DVec3::ZERO;
    for i in 0..rows {
        for j in 0..rows - i {
            let mut add = |third: f64| {
                let (v, w) = ((f64::from(i) + third) / n, (f64::from(j) + third) / n);
                let at = |k: usize| a[k] + v * (b[k] - a[k]) + w * (c[k] - a[k]);
                sum += light([at(0), at(1)]);
            };
            add(1.0 / 3.0);
            if i + j + 1 < rows {
                add(2.0 / 3.0);
            }
        }
    }
    sum / (n * n)
}
