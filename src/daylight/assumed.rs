//! Reflectances where the mesh has none: floors 0.2, walls 0.5, ceilings 0.7 (EN 17037:2018, annex B, told from memory).
//!
//! A face is a wall if it is steeper than 45 degrees. Of two others that face each other the lower is a floor and the upper a ceiling:
//! what has something within reach on one side only shows that side, whatever its normal says; otherwise its normal tells.

use crate::scene::{Geometry, Material, Ray, Scene};
use crate::warning::Warning;
use glam::DVec3;

/// Reflectances of floors, walls and ceilings [1].
pub const REFLECTANCES: [f64; 3] = [0.2, 0.5, 0.7];

/// Gives faces without a material reflectances by their slope, with a warning that says so. Scenes whose vertices have colours stay as they
/// are.
pub fn reflectances(scene: &mut Scene) {
    let Some(none) = scene.no_material else {
        return;
    };
    let bare = |t: &crate::scene::Triangle| t.material == none;
    if !scene.mesh.colors.is_empty() || !scene.mesh.triangles.iter().any(bare) {
        return;
    }
    let geometry = Geometry::new(scene);
    let first = scene.materials.len() as u32;
    let kinds: Vec<usize> = (scene.mesh.triangles.iter().filter(|t| bare(t)))
        .map(|triangle| {
            let [a, b, c] = triangle.vertices.map(|v| scene.mesh.positions[v as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            kind(&geometry, (a + b + c) / 3.0, normal)
        })
        .collect();
    let of_none = scene.mesh.triangles.iter_mut().filter(|t| bare(t));
    for (triangle, kind) in of_none.zip(&kinds) {
        triangle.material = first + *kind as u32;
    }
    let names = ["floor", "wall", "ceiling"].map(|kind| format!("{kind} (assumed)"));
    let made = names.iter().zip(REFLECTANCES);
    (scene.materials).extend(made.map(|(name, r)| Material::of(name, DVec3::splat(r))));
    let count = |kind: usize| kinds.iter().filter(|k| **k == kind).count();
    scene.warnings.push(Warning::AssumedReflectances {
        file: scene.name.clone(),
        triangles: [0, 1, 2].map(count),
    });
}

/// 0 for a floor, 1 for a wall, 2 for a ceiling.
fn kind(geometry: &Geometry, middle: DVec3, normal: DVec3) -> usize {
    if normal.y.abs() < std::f64::consts::FRAC_1_SQRT_2 {
        return 1;
    }
    let meets = |direction: DVec3| {
        let ray = Ray {
            origin: middle,
            direction,
        };
        geometry
            .closest(&ray, 1e-6 * geometry.extent(), f64::INFINITY)
            .is_some()
    };
    match (meets(DVec3::Y), meets(DVec3::NEG_Y)) {
        (true, false) => 0,
        (false, true) => 2,
        _ if normal.y > 0.0 => 0,
        _ => 2,
    }
}
