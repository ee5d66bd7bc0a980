//! The edges at which surfaces end as a disc sees them, in a tree of bounding volumes: what throws penumbrae.

use super::edges::Edges;
use super::geometry::Geometry;
use glam::DVec3;

/// An edge at which a surface ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// From where to where [m], scene axes. Looked at from where the light comes from, the surface lies to the left.
    pub ends: [DVec3; 2],
    /// Whether it hides all that lies on its side of it: not where more than one surface ends at it, or one that the disc sees nearly
    /// edge-on.
    pub is_plain: bool,
}

/// A bounding volume of edges, or one of these, in the order of a walk without a stack.
#[derive(Debug, Clone, Copy)]
pub struct EndBound {
    /// Least corner [m], scene axes.
    pub min: DVec3,
    /// Greatest corner [m], scene axes.
    pub max: DVec3,
    /// The edge's number; `None` for a volume, whose content comes next.
    pub end: Option<u32>,
    /// Number of the entry at which to go on where the volume is missed, or behind the edge.
    pub skip: u32,
}

/// So many edges are not divided further.
const FEW: usize = 2;

impl Edges {
    /// All edges at which surfaces end that neither have holes nor let light through; each once.
    pub fn ends(&self, geometry: &Geometry) -> Vec<End> {
        let toward = self.disc().toward();
        let mut ends = Vec::new();
        for (slot, corners) in geometry.corners.iter().enumerate() {
            if geometry.veil(slot).is_some() || geometry.cut_out(slot).is_some() {
                continue;
            }
            let is_grazed = self.is_grazed(geometry, slot);
            for i in (0..3).filter(|i| self.is_open(slot, *i)) {
                let [a, b] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
                let side = (b - a).cross(corners[i] - a).dot(toward);
                ends.push(End {
                    ends: if side >= 0.0 { [a, b] } else { [b, a] },
                    is_plain: !is_grazed,
                });
            }
        }
        let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
        let place = |end: &End| {
            let mut ends = end.ends.map(bits);
            ends.sort_unstable();
            ends
        };
        ends.sort_by_cached_key(place);
        ends.dedup_by(|other, first| {
            let is_same = place(other) == place(first);
            if is_same {
                first.is_plain &= other.is_plain && other.ends == first.ends;
            }
            is_same
        });
        for end in &mut ends {
            end.ends = end.ends.map(|p| geometry.origin + p);
        }
        ends
    }
}

/// The bounding volumes of edges and the edges, each volume before its content.
pub fn in_order(ends: &[End]) -> Vec<EndBound> {
    let mut numbers: Vec<u32> = (0..ends.len() as u32).collect();
    let mut order = Vec::with_capacity(2 * ends.len());
    if !ends.is_empty() {
        divide(ends, &mut numbers, &mut order);
    }
    order
}

fn divide(ends: &[End], numbers: &mut [u32], order: &mut Vec<EndBound>) {
    let both = |number: &u32| ends[*number as usize].ends;
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for [a, b] in numbers.iter().map(both) {
        (min, max) = (min.min(a.min(b)), max.max(a.max(b)));
        (least, most) = (least.min(a + b), most.max(a + b));
    }
    let volume = order.len();
    order.push(EndBound {
        min,
        max,
        end: None,
        skip: 0,
    });
    if numbers.len() <= FEW {
        for number in numbers.iter() {
            let [a, b] = both(number);
            order.push(EndBound {
                min: a.min(b),
                max: a.max(b),
                end: Some(*number),
                skip: order.len() as u32 + 1,
            });
        }
    } else {
        let axis = (most - least).max_position();
        let at = |number: &u32| (both(number)[0] + both(number)[1])[axis];
        let half = numbers.len() / 2;
        numbers.select_nth_unstable_by(half, |p, q| at(p).total_cmp(&at(q)));
        let (one, other) = numbers.split_at_mut(half);
        divide(ends, one, order);
        divide(ends, other, order);
    }
    order[volume].skip = order.len() as u32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::scene::disc::Disc;

    fn ends(geometry: &Geometry) -> Vec<End> {
        let disc = Disc::new(DVec3::new(0.4, 0.8, 0.3).normalize(), 0.0047, DVec3::ZERO);
        Edges::new(geometry, disc).ends(geometry)
    }

    #[test]
    fn a_cube_ends_where_its_outline_is() {
        let mut text = String::new();
        for i in 0..8 {
            text += &format!("v {} {} {}\n", i & 1, (i >> 1) & 1, i >> 2);
        }
        for face in [
            "1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6",
        ] {
            text += &format!("f {face}\n");
        }
        let path = std::path::Path::new("cube.obj");
        let scene = crate::scene::from_bytes(path, text.as_bytes()).expect("it is sound");
        let found = ends(&Geometry::new(&scene));
        assert_eq!(found.len(), 6);
        let toward = DVec3::new(0.4, 0.8, 0.3).normalize();
        for End {
            ends: [a, b],
            is_plain,
        } in found
        {
            assert!(is_plain);
            // The cube lies to the left.
            assert!((b - a).cross(DVec3::splat(0.5) - a).dot(toward) > 0.0);
        }
    }

    #[test]
    fn volumes_hold_what_follows_them_and_every_edge_comes_once() {
        let scene = Scene::builtin("nave").unwrap();
        let ends = ends(&Geometry::new(&scene));
        assert!(ends.len() > 1000);
        let order = in_order(&ends);
        let mut seen = vec![0; ends.len()];
        for (i, bound) in order.iter().enumerate() {
            for inside in &order[i + 1..bound.skip as usize] {
                assert!(inside.skip <= bound.skip);
                let holds = bound.min.cmple(inside.min).all() && bound.max.cmpge(inside.max).all();
                assert!(holds || bound.end.is_some());
            }
            if let Some(end) = bound.end {
                seen[end as usize] += 1;
                assert_eq!(bound.skip as usize, i + 1);
            }
        }
        assert!(seen.iter().all(|n| *n == 1));
    }
}
