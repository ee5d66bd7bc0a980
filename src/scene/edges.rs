//! Where surfaces end: which edges of triangles lie on each other, which of them end what a disc sees, and how far it is to the nearest.
//!
//! Edges lie on each other that go between the same two places, to the bit.

use super::disc::Disc;
use super::geometry::Geometry;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// For each corner, three a triangle, of which one edge begins and leads to the triangle's next corner: where the next edge between the
/// same two places begins, of all of them in turn; itself where there is no other.
pub(crate) fn in_turn(corners: &[DVec3]) -> Vec<u32> {
    let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
    let ends = |edge: u32| {
        let next = if edge % 3 == 2 { edge - 2 } else { edge + 1 };
        let mut ends = [edge, next].map(|i| bits(corners[i as usize]));
        ends.sort_unstable();
        ends
    };
    // Sorted by a number made of both ends, which is quicker than by the ends or a table of them.
    let number = |edge: u32| {
        let all = ends(edge).into_iter().flatten();
        all.fold(0u64, |sum, bits| {
            let mixed = (sum ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed ^ (mixed >> 29)
        })
    };
    let mut edges: Vec<(u64, u32)> = (0..corners.len() as u32)
        .into_par_iter()
        .map(|edge| (number(edge), edge))
        .collect();
    edges.par_sort_unstable();
    let mut next: Vec<u32> = (0..corners.len() as u32).collect();
    for alike in edges.chunk_by(|a, b| a.0 == b.0) {
        // Nearly all are alone or two.
        if let [(_, edge), others @ ..] = alike
            && let Some(other) = match others {
                [] => Some(edge),
                [(_, other)] if ends(*edge) == ends(*other) => Some(other),
                _ => None,
            }
        {
            (next[*edge as usize], next[*other as usize]) = (*other, *edge);
            continue;
        }
        // Two pairs of places may have one number.
        let mut rest: Vec<u32> = alike.iter().map(|(_, edge)| *edge).collect();
        while let [first, ..] = rest[..] {
            let own = ends(first);
            let (same, others): (Vec<u32>, Vec<u32>) =
                rest.iter().partition(|edge| ends(**edge) == own);
            for (i, edge) in same.iter().enumerate() {
                next[*edge as usize] = same[(i + 1) % same.len()];
            }
            rest = others;
        }
    }
    next
}

/// No neighbour.
const NONE: u32 = u32::MAX;

/// The edges of a scene as a disc sees them.
pub struct Edges {
    disc: Disc,
    /// Of each kept triangle: which edges, by the number of the corner that lies opposite, do not go on in another one on their
    /// other side.
    open: Vec<u8>,
    /// Of each kept triangle that was asked for: how far it is from where its surface ends, seen along the light, and how high the
    /// surface reaches up to there [m].
    margins: Vec<AtomicU64>,
    /// Axes across the light.
    across: [DVec3; 2],
}

/// How far it is from a triangle to where its surface ends.
#[derive(Clone, Copy)]
pub(super) struct Margin {
    /// Seen along the light [m]; not more than it is.
    pub width: f32,
    /// How far toward the light the surface reaches within this, from the local origin [m]; not less than it does.
    pub top: f32,
}

/// What no margin is.
const UNKNOWN: u64 = u64::MAX;

/// So many triangles around one are gone through to find its margin.
const AROUND: usize = 48;

impl Edges {
    /// Finds which edges end what a disc sees.
    pub fn new(geometry: &Geometry, disc: Disc) -> Self {
        let toward = disc.toward();
        // Between faces that the disc sees edge-on an edge may end what a part of it sees.
        let is_grazed = |slot: usize| is_grazed(&geometry.corners[slot], &disc);
        let kind = |slot: usize| {
            (
                geometry.veil(slot).map(|veil| veil.0),
                geometry.cut_out(slot).is_some(),
            )
        };
        let neighbours = geometry.neighbours();
        let open = (0..geometry.corners.len())
            .into_par_iter()
            .map(|slot| {
                let corners = &geometry.corners[slot];
                let mut open = 0;
                for (i, neighbour) in neighbours[slot].iter().enumerate() {
                    let goes_on = *neighbour != NONE && {
                        let other = *neighbour as usize / 3;
                        let tip = geometry.corners[other][*neighbour as usize % 3];
                        let (a, b) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                        let side = |p: DVec3| (b - a).cross(p - a).dot(toward);
                        side(corners[i]) * side(tip) < 0.0
                            && !is_grazed(slot)
                            && !is_grazed(other)
                            && kind(slot) == kind(other)
                    };
                    if !goes_on {
                        open |= 1 << i;
                    }
                }
                open
            })
            .collect();
        let (x, y) = toward.any_orthonormal_pair();
        Edges {
            disc,
            open,
            margins: (0..geometry.corners.len())
                .map(|_| AtomicU64::new(UNKNOWN))
                .collect(),
            across: [x, y],
        }
    }

    /// Whether an edge of a kept triangle, by the number of the corner opposite, ends what the disc sees.
    pub(super) fn is_open(&self, slot: usize, edge: usize) -> bool {
        self.open[slot] & (1 << edge) != 0
    }

    /// Whether the disc sees a kept triangle so nearly edge-on that a part of it may see its other side.
    pub(super) fn is_grazed(&self, geometry: &Geometry, slot: usize) -> bool {
        is_grazed(&geometry.corners[slot], &self.disc)
    }

    /// How far it is from a kept triangle to where its surface ends.
    pub(super) fn margin(&self, geometry: &Geometry, slot: usize) -> Margin {
        let margin = &self.margins[slot];
        let bits = margin.load(Ordering::Relaxed);
        if bits != UNKNOWN {
            return Margin {
                width: f32::from_bits(bits as u32),
                top: f32::from_bits((bits >> 32) as u32),
            };
        }
        // Whoever finds it finds the same.
        let found = self.find_margin(geometry, slot);
        let bits = u64::from(found.width.to_bits()) | u64::from(found.top.to_bits()) << 32;
        margin.store(bits, Ordering::Relaxed);
        found
    }

    /// Goes from a triangle over the edges that lie nearest, until one is open.
    fn find_margin(&self, geometry: &Geometry, slot: usize) -> Margin {
        let neighbours = geometry.neighbours();
        let seen = |p: DVec3| DVec2::new(p.dot(self.across[0]), p.dot(self.across[1]));
        let own = geometry.corners[slot].map(seen);
        let mut top = f64::NEG_INFINITY;
        let mut known = vec![slot as u32];
        let mut coming: Vec<(f64, u32)> = Vec::new();
        let mut take = |at: usize, coming: &mut Vec<(f64, u32)>| {
            let corners = geometry.corners[at];
            for p in corners {
                top = top.max(p.dot(self.disc.toward()));
            }
            for i in 0..3 {
                let edge = [corners[(i + 1) % 3], corners[(i + 2) % 3]].map(seen);
                coming.push((apart(&own, edge), 3 * at as u32 + i as u32));
            }
        };
        take(slot, &mut coming);
        let width = loop {
            let nearest = (0..coming.len()).min_by(|a, b| coming[*a].0.total_cmp(&coming[*b].0));
            let Some((distance, edge)) = nearest.map(|i| coming.swap_remove(i)) else {
                // A surface without end.
                break f64::INFINITY;
            };
            let (at, i) = (edge as usize / 3, edge as usize % 3);
            if self.is_open(at, i) || known.len() >= AROUND {
                break distance;
            }
            let other = neighbours[at][i] / 3;
            if !known.contains(&other) {
                known.push(other);
                take(other as usize, &mut coming);
            }
        };
        let slack = 1e-6 * geometry.extent;
        Margin {
            width: ((1.0 - 1e-6) * width - slack) as f32,
            top: (top + slack) as f32,
        }
    }

    /// The disc.
    pub fn disc(&self) -> &Disc {
        &self.disc
    }
}

impl Geometry {
    /// Of each kept triangle, for each edge by the corner opposite: the triangle on its other side, times 3, plus the number of that one's
    /// corner opposite; `NONE` where there is none, or more than one.
    fn neighbours(&self) -> &[[u32; 3]] {
        self.neighbours.get_or_init(|| {
            let next = in_turn(self.corners.as_flattened());
            let of = |slot: usize| {
                [0, 1, 2].map(|corner| {
                    // The edge opposite a corner begins at the one behind it.
                    let edge = 3 * slot + (corner + 1) % 3;
                    let other = next[edge];
                    let is_pair = other as usize != edge && next[other as usize] as usize == edge;
                    match is_pair {
                        true => other / 3 * 3 + (other % 3 + 2) % 3,
                        false => NONE,
                    }
                })
            };
            (0..self.corners.len()).map(of).collect()
        })
    }
}

fn is_grazed([a, b, c]: &[DVec3; 3], disc: &Disc) -> bool {
    let normal = (*b - *a).cross(*c - *a);
    normal.dot(disc.toward()).abs() <= 2.0 * disc.tan_radius() * normal.length()
}

/// The least distance of a triangle from a line between two points.
fn apart(triangle: &[DVec2; 3], [a, b]: [DVec2; 2]) -> f64 {
    let to_line = |p: DVec2, a: DVec2, b: DVec2| {
        let along = b - a;
        let square = along.length_squared();
        let share = if square > 0.0 {
            (p - a).dot(along) / square
        } else {
            0.0
        };
        p.distance(a + share.clamp(0.0, 1.0) * along)
    };
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let mut least = f64::INFINITY;
    for i in 0..3 {
        let (p, q) = (triangle[i], triangle[(i + 1) % 3]);
        least = least
            .min(to_line(p, a, b))
            .min(to_line(a, p, q))
            .min(to_line(b, p, q));
        if side(p, q, a) * side(p, q, b) < 0.0 && side(a, b, p) * side(a, b, q) < 0.0 {
            return 0.0;
        }
    }
    let sides = [0, 1, 2].map(|i| side(triangle[i], triangle[(i + 1) % 3], a));
    let is_inside = sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    if is_inside { 0.0 } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_between_the_same_places_follow_each_other() {
        let [a, b, c, d, e] = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::new(0.0, 0.0, 1.0),
        ];
        // Two on one edge, from either side; a third on another of the first's edges only.
        let next = in_turn(&[a, b, c, b, a, d, a, b, e]);
        // From a to b: corner 0 of the first, of the second 3 (b to a), of the third 6.
        assert_eq!([next[0], next[3], next[6]], [3, 6, 0]);
        for alone in [1, 2, 4, 5, 7, 8] {
            assert_eq!(next[alone], alone as u32);
        }
        // A zero's sign does not count.
        let next = in_turn(&[a, b, c, -a, b, d]);
        assert_eq!([next[0], next[3]], [3, 0]);
    }
}
