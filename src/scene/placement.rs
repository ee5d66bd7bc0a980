//! From the axes and the unit of a mesh to those of the scene: +Y up, metres.

use super::{Projection, Scene, hints};
use glam::{DAffine3, DMat3, DVec3};

/// The unit and the axes of a mesh; what is absent is as the scene's.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Placement {
    /// Metres in a unit of the mesh, above 0 to 1e9 [m]; absent: 1.
    pub scale: Option<f64>,
    /// The mesh's axis that points up; absent: Y.
    pub up: Option<Up>,
}

/// The axis of a mesh that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Up {
    /// As in glTF and in the scene.
    Y,
    /// As in most CAD and GIS: the mesh's Y axis becomes the scene's -Z.
    Z,
}

impl Placement {
    /// This one, and what it leaves open as in `other`.
    pub fn over(self, other: Placement) -> Placement {
        Placement {
            scale: self.scale.or(other.scale),
            up: self.up.or(other.up),
        }
    }
}

/// The greatest coordinate of a vertex [m], where f64 still tells tenths of a millimetre apart; triangles far beyond vanish.
const FARTHEST: f64 = 1e12;

impl Scene {
    /// Moves everything that came with the mesh: scales it, turns Z up into Y up, then adds `origin` [m], in f64.
    ///
    /// A scale or an axis that nobody gave, and that the mesh contradicts, is a warning. The error says what is wrong.
    pub(super) fn place(
        &mut self,
        file: &str,
        placement: Placement,
        origin: DVec3,
    ) -> Result<(), String> {
        let scale = placement.scale.unwrap_or(1.0);
        if !(scale > 0.0 && scale <= 1e9) {
            return Err("it is outside 0 to 1e9".into());
        }
        let turn = match placement.up {
            Some(Up::Z) => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            _ => DMat3::IDENTITY,
        };
        let moved = |p: DVec3| turn * p * scale + origin;
        self.mesh.positions.iter_mut().for_each(|p| *p = moved(*p));
        self.mesh.normals.iter_mut().for_each(|n| *n = turn * *n);
        for named in &mut self.cameras {
            let camera = &mut named.camera;
            camera.eye = moved(camera.eye);
            camera.forward = turn * camera.forward;
            camera.up = turn * camera.up;
            if let Projection::Orthographic { height } = &mut camera.projection {
                *height *= scale;
            }
        }
        for light in &mut self.lights {
            light.position = moved(light.position);
            light.direction = turn * light.direction;
        }
        let all = DAffine3 {
            matrix3: turn * scale,
            translation: origin,
        };
        for node in &mut self.nodes {
            node.to_scene = all * node.to_scene;
        }
        if !self.mesh.positions.iter().all(|p| p.is_finite()) {
            return Err("it makes the mesh larger than numbers can be".into());
        }
        let open = [placement.scale.is_none(), placement.up.is_none()];
        let mut used = self.mesh.triangles.iter().flat_map(|t| t.vertices);
        let farthest = |v: u32| self.mesh.positions[v as usize].abs().max_element();
        if used.any(|v| farthest(v) > FARTHEST) {
            return Err(format!(
                "{file}: with it, vertices would stand more than {FARTHEST:e} m from the origin"
            ));
        }
        let hints = hints::of(self, file, open, origin);
        self.warnings.extend(hints);
        Ok(())
    }
}
