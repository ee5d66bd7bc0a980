//! Which edges of triangles lie on each other: those between the same two places, to the bit.

use glam::DVec3;
use rayon::prelude::*;

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
