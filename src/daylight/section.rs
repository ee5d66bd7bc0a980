//! Where a model is cut by a plane: the outlines of a plan or a section.

use crate::scene::Scene;
use glam::DVec3;

/// Where a triangle is cut by the plane through a point that is square to a normal; `None` where it is not.
pub fn cut(corners: [DVec3; 3], origin: DVec3, normal: DVec3) -> Option<[DVec3; 2]> {
    let heights = corners.map(|p| normal.dot(p - origin));
    let mut ends = [DVec3::ZERO; 2];
    let mut count = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        if (heights[i] > 0.0) != (heights[j] > 0.0) && count < 2 {
            ends[count] = corners[i].lerp(corners[j], heights[i] / (heights[i] - heights[j]));
            count += 1;
        }
    }
    (count == 2).then_some(ends)
}

/// All cuts of a scene's triangles, and whether each is glass.
pub fn section(scene: &Scene, origin: DVec3, normal: DVec3) -> Vec<([DVec3; 2], bool)> {
    let cuts = scene.mesh.triangles.iter().filter_map(|triangle| {
        let corners = triangle.vertices.map(|v| scene.mesh.positions[v as usize]);
        let ends = cut(corners, origin, normal)?;
        let is_glass = scene.materials[triangle.material as usize].pane.is_some();
        Some((ends, is_glass))
    });
    cuts.collect()
}
