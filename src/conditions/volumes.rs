//! Illumination volumes: where lamps may shine and how strongly at most, in a tree.
//!
//! Whoever adds up the light of many lamps goes through them by the most that each could add ([`Volumes::strongest_first`]): groups of
//! them first, each with one bound for all that it holds, and only those groups are opened, and only those lamps looked at, that
//! together could still matter. What is left out is known to be less than was asked for, since every bound holds whatever stands in
//! the way; so how far a lamp's influence reaches follows from the tolerance, for each ray and place anew.

use super::lamps::Lamp;
use crate::scene::Ray;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI};

/// A box with the scene's axes: its least and its greatest corner [m], infinite where nothing bounds it.
pub type Bounds = [DVec3; 2];

/// A box without bounds.
pub const EVERYWHERE: Bounds = [DVec3::NEG_INFINITY, DVec3::INFINITY];

/// Boxes are as much wider than what they hold, by their coordinates: rounding.
const SLACK: f64 = 1e-9;

/// An angle from which on the walls of a cone are taken not to meet a plane [rad].
const GRAZING: f64 = FRAC_PI_2 - 1e-3;

/// Where the light of a lamp, a part of one or a group of lamps comes from, where it goes, and how strong it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// The box of the places that it comes from [m].
    pub places: Bounds,
    /// A box around all of the world that it may shine on [m].
    pub reach: Bounds,
    /// The most luminous intensity that all of it sends into any direction [cd].
    pub power: f64,
}

impl Volume {
    /// Of a lamp, or of a share of its intensity that comes from within `extent` [m] of a place, in a world of some bounds: light
    /// that leaves it never matters.
    pub fn new(lamp: &Lamp, place: DVec3, extent: f64, share: f64, world: &Bounds) -> Self {
        let places = [place - extent, place + extent];
        Volume {
            places,
            reach: reach(places, lamp.pose.toward, lamp.distribution.cone(), world),
            power: lamp.greatest_intensity() * share,
        }
    }

    fn and(&self, other: &Volume) -> Volume {
        Volume {
            places: joined(&self.places, &other.places),
            reach: joined(&self.reach, &other.reach),
            power: self.power + other.power,
        }
    }

    /// How near a place is to where the light comes from, at least [m].
    pub fn distance(&self, point: DVec3) -> f64 {
        let [low, high] = self.places;
        (low - point).max(point - high).max(DVec3::ZERO).length()
    }

    /// How near a part of a ray comes to where the light comes from, at least [m].
    pub fn distance_to_part(&self, ray: &Ray, [from, to]: [f64; 2]) -> f64 {
        let [low, high] = self.places;
        let middle = 0.5 * (low + high);
        let foot = (middle - ray.origin).dot(ray.direction).clamp(from, to);
        let around = ray.at(foot).distance(middle) - 0.5 * low.distance(high);
        let (a, b) = (ray.at(from), ray.at(to));
        let apart = (low - a.max(b)).max(a.min(b) - high).max(DVec3::ZERO);
        around.max(apart.length())
    }

    /// The part of some of a ray on which the light may fall.
    pub fn part(&self, ray: &Ray, span: [f64; 2]) -> Option<[f64; 2]> {
        part(&self.reach, ray, span)
    }
}

/// The part of some of a ray that lies in a box.
pub fn part([low, high]: &Bounds, ray: &Ray, [mut from, mut to]: [f64; 2]) -> Option<[f64; 2]> {
    for axis in 0..3 {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        if d == 0.0 {
            if o < low[axis] || o > high[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[axis] - o) / d, (high[axis] - o) / d);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    (to > from).then_some([from, to])
}

/// Whether a box holds a place.
pub fn holds([low, high]: &Bounds, point: DVec3) -> bool {
    point.cmpge(*low).all() && point.cmple(*high).all()
}

/// The box around two boxes.
pub fn joined(a: &Bounds, b: &Bounds) -> Bounds {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// A box around what a cone of some half angle shines on in a world, whatever place of a box it stands in.
fn reach(places: Bounds, axis: DVec3, half: f64, world: &Bounds) -> Bounds {
    let [mut low, mut high] = *world;
    for k in 0..3 {
        for sign in [-1.0, 1.0] {
            let turn = (sign * axis[k]).clamp(-1.0, 1.0).acos();
            let (near, face) = match sign > 0.0 {
                true => (places[0][k], world[1][k]),
                false => (places[1][k], world[0][k]),
            };
            // No direction of it goes that way.
            if turn - half >= FRAC_PI_2 {
                match sign > 0.0 {
                    true => high[k] = high[k].min(places[1][k]),
                    false => low[k] = low[k].max(places[0][k]),
                }
            }
            // All directions of it go that way, and meet the face of the world there.
            let (depth, widest) = (sign * (face - near), turn + half);
            if depth.is_finite() && widest < GRAZING {
                let aside = depth.max(0.0) * widest.tan();
                for other in (0..3).filter(|other| *other != k) {
                    low[other] = low[other].max(places[0][other] - aside);
                    high[other] = high[other].min(places[1][other] + aside);
                }
            }
        }
    }
    let slack = |corner: DVec3| SLACK * (DVec3::ONE + corner.abs());
    // Of infinite corners the slack is infinite too, to their own side.
    [low - slack(low), high + slack(high)]
}

/// A group of lamps, or a single one.
#[derive(Debug, Clone, Copy)]
struct Node {
    volume: Volume,
    what: What,
}

#[derive(Debug, Clone, Copy)]
enum What {
    /// Two groups.
    Group([u32; 2]),
    /// One, by its number.
    One(u32),
}

/// A tree of volumes.
#[derive(Debug, Clone, Default)]
pub struct Volumes {
    /// The root comes last.
    nodes: Vec<Node>,
}

impl Volumes {
    /// A tree of some volumes, which keep their numbers.
    pub fn new(volumes: &[Volume]) -> Self {
        let mut nodes = Vec::with_capacity(2 * volumes.len());
        let mut order: Vec<u32> = (0..volumes.len() as u32).collect();
        if !order.is_empty() {
            add(volumes, &mut order, &mut nodes);
        }
        Volumes { nodes }
    }

    /// Goes through what matters, by the most that each could add, the strongest first.
    ///
    /// `of_group` bounds what all of a group together add; 0 leaves it out. `of_one` bounds what one adds, with what was found out
    /// about it on the way; `None` leaves it out. `add` adds one and says what matters no more from there on: it ends as soon as
    /// all that is left together could add no more than that, `negligible` at first.
    pub fn strongest_first<T>(
        &self,
        queue: &mut Queue<T>,
        mut negligible: f64,
        of_group: impl Fn(&Volume) -> f64,
        mut of_one: impl FnMut(usize) -> Option<(f64, T)>,
        mut add: impl FnMut(T) -> f64,
    ) {
        queue.clear();
        let look = |queue: &mut Queue<T>, index: u32| {
            let most = of_group(&self.nodes[index as usize].volume);
            if most > 0.0 {
                queue.push(most, index, None);
            }
        };
        if let Some(root) = (self.nodes.len() as u32).checked_sub(1) {
            look(queue, root);
        }
        while !queue.is_below(negligible) {
            let Some(entry) = queue.pop() else {
                return;
            };
            if let Some(found) = entry.found {
                negligible = add(found);
                continue;
            }
            match self.nodes[entry.node as usize].what {
                What::Group(halves) => halves.into_iter().for_each(|half| look(queue, half)),
                What::One(number) => {
                    if let Some((most, found)) = of_one(number as usize)
                        && most > 0.0
                    {
                        queue.push(most, entry.node, Some(found));
                    }
                }
            }
        }
    }
}

/// Adds the tree of some volumes to the nodes; returns its root.
fn add(volumes: &[Volume], order: &mut [u32], nodes: &mut Vec<Node>) -> u32 {
    let node = if let [one] = *order {
        Node {
            volume: volumes[one as usize],
            what: What::One(one),
        }
    } else {
        let middle = |i: u32| {
            let [low, high] = volumes[i as usize].places;
            0.5 * (low + high)
        };
        let (low, high) = order
            .iter()
            .map(|i| middle(*i))
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let size = high - low;
        let axis = if size.max_element() == size.x {
            0
        } else if size.max_element() == size.y {
            1
        } else {
            2
        };
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |a, b| {
            let by_place = middle(*a)[axis].total_cmp(&middle(*b)[axis]);
            by_place.then(a.cmp(b))
        });
        let (first, last) = order.split_at_mut(half);
        let halves = [add(volumes, first, nodes), add(volumes, last, nodes)];
        let [a, b] = halves.map(|i| nodes[i as usize].volume);
        Node {
            volume: a.and(&b),
            what: What::Group(halves),
        }
    };
    nodes.push(node);
    nodes.len() as u32 - 1
}

/// What [`Volumes::strongest_first`] has not looked at yet; kept from one time to the next for its memory.
#[derive(Debug)]
pub struct Queue<T> {
    heap: BinaryHeap<Entry<T>>,
    /// What all of it could add; it may have lost digits to what was large and is gone.
    rest: f64,
}

#[derive(Debug)]
struct Entry<T> {
    most: f64,
    node: u32,
    /// Of one that was looked at already.
    found: Option<T>,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        Queue {
            heap: BinaryHeap::new(),
            rest: 0.0,
        }
    }
}

impl<T> Queue<T> {
    fn clear(&mut self) {
        self.heap.clear();
        self.rest = 0.0;
    }

    fn push(&mut self, most: f64, node: u32, found: Option<T>) {
        self.rest += most;
        self.heap.push(Entry { most, node, found });
    }

    fn pop(&mut self) -> Option<Entry<T>> {
        let entry = self.heap.pop()?;
        match entry.most >= 0.5 * self.rest {
            true => self.add_up(),
            false => self.rest -= entry.most,
        }
        Some(entry)
    }

    fn add_up(&mut self) {
        self.rest = self.heap.iter().map(|entry| entry.most).sum();
    }

    /// Whether all of it could add no more than that.
    fn is_below(&mut self, negligible: f64) -> bool {
        if self.rest > negligible {
            return false;
        }
        self.add_up();
        self.rest <= negligible
    }
}

impl<T> Ord for Entry<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        // Among equals in an order that does not hang on how they came here.
        let by_most = self.most.total_cmp(&other.most);
        by_most.then_with(|| other.node.cmp(&self.node))
    }
}

impl<T> PartialOrd for Entry<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> PartialEq for Entry<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T> Eq for Entry<T> {}

/// The most that the integral of 1 / d^2 over a length of a line is, of which no point is nearer than `distance` [1/m].
pub fn greatest_integral(length: f64, distance: f64) -> f64 {
    match distance > 0.0 {
        // Of no longer a line than the whole of it, past the nearest point.
        true => (PI / distance).min(length / distance / distance),
        false => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(at: DVec3, power: f64) -> Volume {
        Volume {
            places: [at, at],
            reach: EVERYWHERE,
            power,
        }
    }

    /// Many places that look random, with powers over four decades.
    fn many(count: usize) -> Vec<Volume> {
        let golden = |i: usize, k: f64| (i as f64 * k).fract();
        let one = |i| {
            let at = 100.0 * DVec3::new(golden(i, 0.618), golden(i, 0.7549), golden(i, 0.5698));
            volume(at, 10.0f64.powf(4.0 * golden(i, 0.819)))
        };
        (1..=count).map(one).collect()
    }

    #[test]
    fn what_is_left_out_is_less_than_was_asked_for_and_little_is_looked_at() {
        let volumes = many(2000);
        let tree = Volumes::new(&volumes);
        for eye in [
            DVec3::ZERO,
            DVec3::new(50.0, 40.0, 30.0),
            DVec3::splat(-900.0),
        ] {
            let of = |v: &Volume| v.power / v.distance(eye).powi(2);
            let all: f64 = volumes.iter().map(of).sum();
            for share in [0.0, 1e-3, 0.1] {
                let (mut sum, mut looked, mut last) = (0.0, 0, f64::INFINITY);
                tree.strongest_first(
                    &mut Queue::default(),
                    0.0,
                    of,
                    |i| {
                        looked += 1;
                        Some((of(&volumes[i]), i))
                    },
                    |i| {
                        let added = of(&volumes[i]);
                        assert!(added <= last * (1.0 + 1e-12));
                        last = added;
                        sum += added;
                        share * sum
                    },
                );
                assert!(
                    all - sum <= share * sum + 1e-12 * all,
                    "{share}: {all} {sum}"
                );
                assert!(share == 0.0 || sum < all && looked < 2000, "{looked}");
            }
        }
    }

    #[test]
    fn a_huge_bound_does_not_hide_small_ones() {
        let volumes: Vec<Volume> = [1e300, 1e-3, 2e-3, f64::INFINITY]
            .map(|power| volume(DVec3::X * power.min(1e3), power))
            .to_vec();
        let mut found = Vec::new();
        Volumes::new(&volumes).strongest_first(
            &mut Queue::default(),
            0.0,
            |v| v.power,
            |i| Some((volumes[i].power, i)),
            |i| {
                found.push(i);
                0.0015
            },
        );
        assert_eq!(found, [3, 0, 2], "the last one is negligible");
    }

    #[test]
    fn the_reach_of_a_cone_holds_all_that_it_shines_on() {
        let world = [
            DVec3::new(-30.0, 0.0, f64::NEG_INFINITY),
            DVec3::new(30.0, 20.0, f64::INFINITY),
        ];
        for (axis, half) in [
            (DVec3::NEG_Y, 1.0),
            (DVec3::new(0.3, -1.0, 0.2).normalize(), 0.8),
            (DVec3::X, 0.3),
            (DVec3::X, 1.2),
            (DVec3::Z, 2.5),
            (DVec3::NEG_Y, PI),
        ] {
            let apex = DVec3::new(3.0, 5.0, -7.0);
            let [low, high] = reach([apex, apex], axis, half, &world);
            let (u, v) = axis.any_orthonormal_pair();
            for i in 0..200 {
                for j in 1..=20 {
                    let theta = half * f64::from(j) / 20.0;
                    let (y, x) = (0.1 * f64::from(i)).sin_cos();
                    let way = theta.cos() * axis + theta.sin() * (x * u + y * v);
                    let ray = Ray {
                        origin: apex,
                        direction: way,
                    };
                    if let Some([_, to]) = part(&world, &ray, [0.0, 1e4]) {
                        assert!(
                            holds(&[low, high], ray.at(to * (1.0 - 1e-9))),
                            "{axis} {half} {way}"
                        );
                    }
                }
            }
        }
        // A street lamp lights the street below it.
        let [low, high] = reach([DVec3::Y * 5.0; 2], DVec3::NEG_Y, 1.0, &world);
        assert!(high.x < 8.0 && low.z > -8.0 && high.y < 5.1);
    }
}
