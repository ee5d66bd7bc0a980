//! The bounding volumes of a scene in the order in which a walk without a stack meets them.

use super::Geometry;
use glam::DVec3;

/// A bounding volume, or a triangle in the last of them.
#[derive(Debug, Clone, Copy)]
pub struct Bound {
    /// Least corner [m], scene axes: not above what is inside.
    pub min: DVec3,
    /// Greatest corner [m], scene axes: not below what is inside.
    pub max: DVec3,
    /// The triangle's number in the scene; `None` for a volume, whose content comes next.
    pub triangle: Option<u32>,
    /// Number of the entry at which to go on where the volume is missed, or behind the triangle.
    pub skip: u32,
}

impl Geometry {
    /// All bounding volumes and triangles, each volume before its content.
    ///
    /// A ray goes through them in order and jumps to [`Bound::skip`] where it misses a volume, until it is behind the last.
    pub fn in_order(&self) -> Vec<Bound> {
        let mut order = Vec::with_capacity(self.nodes.len() + self.corners.len());
        if self.corners.is_empty() {
            return order;
        }
        // Nodes to be opened, and those whose content ends.
        enum Step {
            Open(u32),
            Close(usize),
        }
        let mut steps = vec![Step::Open(0)];
        while let Some(step) = steps.pop() {
            let index = match step {
                Step::Open(index) => index,
                Step::Close(entry) => {
                    order_end(&mut order, entry);
                    continue;
                }
            };
            let node = &self.nodes[index as usize];
            let (middle, half) = (node.middle.as_dvec3(), node.half.as_dvec3());
            // The middle and the half are rounded.
            let slack = 1e-6 * half.max_element() + 2e-7 * middle.abs().max_element();
            let volume = order.len();
            order.push(Bound {
                min: self.origin + middle - half - slack,
                max: self.origin + middle + half + slack,
                triangle: None,
                skip: 0,
            });
            if node.count == 0 {
                steps.push(Step::Close(volume));
                steps.push(Step::Open(node.first + 1));
                steps.push(Step::Open(node.first));
                continue;
            }
            for slot in node.first..node.first + node.count {
                let [a, b, c] = self.corners[slot as usize].map(|p| self.origin + p);
                order.push(Bound {
                    min: a.min(b).min(c),
                    max: a.max(b).max(c),
                    triangle: Some(self.scene_triangle[slot as usize]),
                    skip: order.len() as u32 + 1,
                });
            }
            order_end(&mut order, volume);
        }
        order
    }
}

fn order_end(order: &mut [Bound], entry: usize) {
    order[entry].skip = order.len() as u32;
}

#[cfg(test)]
mod tests {
    use crate::scene::{Geometry, Scene};

    #[test]
    fn volumes_hold_what_follows_them_and_every_triangle_comes_once() {
        let scene = Scene::builtin("nave").unwrap();
        let geometry = Geometry::new(&scene);
        let order = geometry.in_order();
        let mut seen = vec![0; scene.mesh.triangles.len()];
        for (i, bound) in order.iter().enumerate() {
            assert!(bound.skip as usize > i && bound.skip as usize <= order.len());
            for inside in &order[i + 1..bound.skip as usize] {
                assert!(inside.skip <= bound.skip);
                assert!(
                    bound.min.cmple(inside.min + 1e-9).all()
                        && bound.max.cmpge(inside.max - 1e-9).all()
                        || inside.triangle.is_none()
                );
            }
            if let Some(triangle) = bound.triangle {
                seen[triangle as usize] += 1;
                assert_eq!(bound.skip as usize, i + 1);
            }
        }
        assert_eq!(seen.iter().sum::<usize>(), geometry.triangle_count());
        assert!(seen.iter().all(|&n| n <= 1));
    }
}
