//! The edges of surfaces that throw penumbrae into the air, as `shaders/soft_edges.wgsl` reads them.

use super::shared::SHARES;
use crate::scene::Geometry;
use crate::scene::edges::Edges;
use crate::scene::ends::{End, in_order};
use glam::{DVec3, Vec4};

/// Added to the number of an edge that may not hide all that lies on its side of it.
const MIXED: u32 = 0x8000_0000;

/// Two texels an entry of the tree, like those of the tree of casters; the first tells how many there are, and where the next two
/// lists begin. Then two an edge: the point of it nearest to the anchor and how far it goes back from there, its direction and how
/// far it goes on [m]. Then what a line across the disc leaves of its light, by how deep the middle lies behind the line, from -1
/// to 1.
pub fn texels(edges: &Edges, geometry: &Geometry, anchor: DVec3) -> Vec<[u32; 4]> {
    let ends = edges.ends(geometry);
    let order = in_order(&ends);
    let first = 2 * (order.len() as u32 + 1);
    let mut texels = Vec::with_capacity(first as usize + 2 * ends.len() + SHARES as usize);
    texels.push([
        order.len() as u32 + 1,
        first,
        first + 2 * ends.len() as u32,
        0,
    ]);
    texels.push([0; 4]);
    for bound in &order {
        // Rounded to the outside.
        let (min, max) = (bound.min - anchor, bound.max - anchor);
        let slack = 4.0 * f64::from(f32::EPSILON) * min.abs().max(max.abs());
        let bits = |p: DVec3| p.as_vec3().to_array().map(f32::to_bits);
        let ([ax, ay, az], [bx, by, bz]) = (bits(min - slack), bits(max + slack));
        let number = bound
            .end
            .map_or(0, |end| match ends[end as usize].is_plain {
                true => end + 1,
                false => (end | MIXED) + 1,
            });
        texels.extend([[ax, ay, az, bound.skip + 1], [bx, by, bz, number]]);
    }
    let bits = |v: Vec4| v.to_array().map(f32::to_bits);
    for End { ends: [a, b], .. } in &ends {
        let length = a.distance(*b);
        let along = (*b - *a) / length.max(f64::MIN_POSITIVE);
        let nearest = (anchor - *a).dot(along).clamp(0.0, length);
        let point = (*a + nearest * along - anchor).as_vec3();
        texels.push(bits(point.extend(-nearest as f32)));
        texels.push(bits(along.as_vec3().extend((length - nearest) as f32)));
    }
    texels.extend((0..SHARES).map(|i| {
        let depth = 2.0 * f64::from(i) / f64::from(SHARES - 1) - 1.0;
        bits(edges.disc().beyond(depth).as_vec3().extend(0.0))
    }));
    texels
}
