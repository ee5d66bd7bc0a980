//! Skins of glTF in the pose in which the file leaves their joints (glTF 2.0, 3.7.3.3).

use super::container::{DAMAGED, Gltf};
use super::document::Primitive;
use super::tree::Tree;
use crate::error::Result;
use crate::scene::assembly::{Piece, cofactors};
use glam::{DAffine3, DMat3, DVec3};

/// Where each joint carries what is bound to it: from the axes of the mesh to those of the scene.
pub(super) struct Skin(Vec<DAffine3>);

/// The joints and weights of a primitive: four of each a vertex and set.
struct Bindings {
    joints: Vec<f64>,
    weights: Vec<f64>,
}

impl Skin {
    /// The joint's own transform times its inverse bind matrix. The node that has mesh and skin plays no part.
    pub fn read(gltf: &Gltf, tree: &Tree, index: usize, by: &str) -> Result<Skin> {
        let entry = gltf.get(&gltf.json.skins, "skins", index, by)?;
        let place = format!("skins[{index}].inverseBindMatrices");
        let matrices = match entry.inverse_bind_matrices {
            Some(accessor) => gltf.numbers(accessor, &[16], &place)?.1,
            None => Vec::new(),
        };
        let given = matrices.len() / 16;
        if entry.inverse_bind_matrices.is_some() && given < entry.joints.len() {
            let problem = format!("there are {given} for {} joints", entry.joints.len());
            return Err(gltf.error(&place, problem, DAMAGED));
        }
        let mut matrices = matrices.chunks_exact(16);
        let mut joints = Vec::with_capacity(entry.joints.len());
        for (i, &joint) in entry.joints.iter().enumerate() {
            let inverse = match matrices.next() {
                Some(m) => affine(m).ok_or_else(|| {
                    let problem = format!("matrix {i} is not affine, or not finite");
                    gltf.error(&place, problem, DAMAGED)
                })?,
                None => DAffine3::IDENTITY,
            };
            let by = format!("skins[{index}].joints[{i}]");
            joints.push(tree.to_scene(gltf, joint, &by)? * inverse);
        }
        Ok(Skin(joints))
    }

    /// Puts a piece where its joints carry it. Returns how many of its vertices have no valid weight, and go with the first
    /// of their joints; `None` for a piece that is not bound to joints.
    pub fn pose(
        &self,
        gltf: &Gltf,
        primitive: &Primitive,
        piece: &mut Piece,
        place: &str,
    ) -> Result<Option<usize>> {
        let count = piece.positions.len();
        let mut sets = Vec::new();
        for set in 0.. {
            let of = |name: &str| {
                let name = format!("{name}_{set}");
                gltf.attribute(
                    &primitive.attributes,
                    &name,
                    &[4],
                    &format!("{place}.attributes"),
                )
            };
            let (Some((_, joints)), Some((_, weights))) = (of("JOINTS")?, of("WEIGHTS")?) else {
                break;
            };
            if joints.len() != 4 * count || weights.len() != 4 * count {
                let problem = format!("JOINTS_{set} or WEIGHTS_{set} is not as long as POSITION");
                return Err(gltf.error(place, problem, DAMAGED));
            }
            sets.push(Bindings { joints, weights });
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let mut unbound = 0;
        let mut mirrored = vec![false; count];
        for (v, mirrored) in mirrored.iter_mut().enumerate() {
            let bound: Vec<(f64, f64)> = sets
                .iter()
                .flat_map(|set| {
                    let of = 4 * v..4 * v + 4;
                    set.joints[of.clone()]
                        .iter()
                        .copied()
                        .zip(set.weights[of].iter().copied())
                })
                .filter(|&(_, weight)| weight != 0.0)
                .collect();
            let sum: f64 = bound.iter().map(|(_, weight)| weight).sum();
            let (bound, total) = if sum > 0.0 && sum.is_finite() {
                (bound, sum)
            } else {
                unbound += 1;
                (vec![(sets[0].joints[4 * v], 1.0)], 1.0)
            };
            let (mut linear, mut shift) = (DMat3::ZERO, DVec3::ZERO);
            for (joint, weight) in bound {
                let Some(carried) = self.0.get(joint as usize) else {
                    let problem = format!(
                        "vertex {v} names joint {joint}, but there are {}",
                        self.0.len()
                    );
                    return Err(gltf.error(place, problem, DAMAGED));
                };
                linear += carried.matrix3 * (weight / total);
                shift += carried.translation * (weight / total);
            }
            *mirrored = linear.determinant() < 0.0;
            piece.positions[v] = linear * piece.positions[v] + shift;
            if let Some(normal) = piece.normals.get_mut(v) {
                *normal = cofactors(linear) * *normal;
            }
        }
        // A mirroring pose turns the winding, as a mirroring node does.
        for triangle in &mut piece.triangles {
            let turned = triangle
                .iter()
                .filter(|&&v| mirrored.get(v as usize) == Some(&true));
            if turned.count() > 1 {
                triangle.swap(1, 2);
            }
        }
        Ok(Some(unbound))
    }
}

/// A matrix of sixteen numbers, column by column, if it is affine.
fn affine(m: &[f64]) -> Option<DAffine3> {
    let column = |i: usize| DVec3::from_slice(&m[4 * i..]);
    let bottom = [m[3], m[7], m[11], m[15] - 1.0];
    let matrix = DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    };
    (matrix.is_finite() && bottom.iter().all(|x| x.abs() < 1e-3)).then_some(matrix)
}
