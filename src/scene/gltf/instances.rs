//! EXT_mesh_gpu_instancing: one mesh in many places.

use super::container::{DAMAGED, Gltf};
use super::document::{Instancing, Node};
use super::material::extension;
use super::notes::{Notes, shown};
use crate::error::Result;
use glam::{DAffine3, DQuat, DVec3};

pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

/// Where a node's mesh stands, in the axes of the node: once where the node is, as a rule.
pub(super) fn read(
    gltf: &Gltf,
    node: &Node,
    place: &str,
    notes: &mut Notes,
) -> Result<Vec<DAffine3>> {
    let Some(entry) = extension::<Instancing>(gltf, &node.extensions, NAME, place)? else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let all = &entry.attributes;
    let by = format!("{place}.extensions.{NAME}");
    for name in all.keys() {
        if !matches!(&name[..], "TRANSLATION" | "ROTATION" | "SCALE") && !name.starts_with('_') {
            notes.leave_out(format!("instance attribute {}", shown(name)));
        }
    }
    let translations = gltf.triples(all, "TRANSLATION", &by)?;
    let scales = gltf.triples(all, "SCALE", &by)?;
    let rotations: Option<Vec<DQuat>> = gltf
        .attribute(all, "ROTATION", &[4], &by)?
        .map(|(_, numbers)| numbers.chunks_exact(4).map(DQuat::from_slice).collect());
    let lengths: Vec<usize> = [
        translations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
    ]
    .into_iter()
    .flatten()
    .collect();
    let count = lengths.first().copied().unwrap_or(0);
    if lengths.iter().any(|&length| length != count) {
        return Err(gltf.error(by, "its attributes differ in length", DAMAGED));
    }
    let mut instances = Vec::with_capacity(count);
    for i in 0..count {
        let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |all| all[i]);
        if !(rotation.is_finite() && rotation.length_squared() > 0.0) {
            return Err(gltf.error(by, format!("instance {i} has no rotation"), DAMAGED));
        }
        notes.leave_out_length(rotation);
        instances.push(DAffine3::from_scale_rotation_translation(
            scales.as_ref().map_or(DVec3::ONE, |all| all[i]),
            rotation.normalize(),
            translations.as_ref().map_or(DVec3::ZERO, |all| all[i]),
        ));
    }
    Ok(instances)
}
