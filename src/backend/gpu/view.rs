//! What a tile's shaders know of the camera and the ground.

use super::job::Job;
use super::shared;
use crate::colour::Space;
use crate::scene::Projection;
use glam::{DVec2, UVec2, Vec4};

/// The near plane is a millionth of the scene's diagonal away, of this at most [m].
const NEAR_OF: f64 = 1e3;

impl Job<'_> {
    /// What shaders know of a tile.
    pub(super) fn tile_view_of(
        &self,
        corner: UVec2,
        extent: UVec2,
        offset: DVec2,
    ) -> shared::TileView {
        let conditions = self.plan.conditions;
        let camera = &conditions.view.camera;
        let [right, up, forward] = match camera.projection {
            Projection::Panorama => camera.level_axes(),
            _ => camera.axes(),
        };
        let size = UVec2::from(conditions.view.size).as_dvec2();
        let tile = self.tile.as_dvec2();
        // A position P of the picture is at P - shifted in the tile, whose pixels have their centres at halves.
        let shifted = corner.as_dvec2() + offset - 0.5;
        let middle = 0.5 * size + DVec2::new(-camera.shift.x, camera.shift.y) * size - shifted;
        let scale = match camera.projection {
            Projection::Perspective { fov_y } => size.y / (0.5 * fov_y).tan() / tile,
            Projection::Orthographic { height } => size.y / (0.5 * height) / tile,
            Projection::Panorama => size / tile,
        };
        let place = 2.0 * middle / tile;
        let origin = |at: DVec2| {
            let at = corner.as_dvec2() + offset + at;
            camera.ray(at, conditions.view.size).origin - camera.eye
        };
        let extent_m = conditions.geometry.extent();
        let ground = conditions.ground.map_or(Vec4::ZERO, |ground| {
            let height = camera.eye.y - ground.height;
            ground.albedo.as_vec3().extend(height as f32)
        });
        shared::TileView {
            corner,
            extent,
            whole: tile.as_vec2(),
            right: right.as_vec3(),
            projection: match camera.projection {
                Projection::Perspective { .. } => shared::PERSPECTIVE,
                Projection::Orthographic { .. } => shared::ORTHOGRAPHIC,
                Projection::Panorama => shared::PANORAMA,
            },
            up: up.as_vec3(),
            media: conditions.air.media.len() as u32,
            forward: forward.as_vec3(),
            grounded: u32::from(conditions.ground.is_some()),
            project: Vec4::new(
                scale.x as f32,
                (place.x - 1.0) as f32,
                scale.y as f32,
                (1.0 - place.y) as f32,
            ),
            ground,
            depth: match camera.projection {
                Projection::Orthographic { .. } => (0.999 / self.deepest) as f32,
                // A far end of the scene does not push the near plane away from the eye.
                _ => (1e-6 * extent_m.min(NEAR_OF)).max(f64::from(f32::MIN_POSITIVE)) as f32,
            },
            origin: origin(DVec2::ZERO).as_vec3(),
            origin_right: (origin(DVec2::X) - origin(DVec2::ZERO)).as_vec3(),
            origin_down: (origin(DVec2::Y) - origin(DVec2::ZERO)).as_vec3(),
            eye: (camera.eye - self.anchor).as_vec3(),
            working_from_rec709: Space::Rec709.to_working().as_mat3(),
        }
    }
}
