//! Primitives of glTF: triangles with what stands at their vertices, morphed as the file's weights say.

use super::container::{DAMAGED, Gltf};
use super::document::Primitive;
use super::extension;
use super::material::Materials;
use super::notes::{Notes, shown};
use crate::error::Result;
use crate::scene::assembly::Piece;
use glam::{DVec2, DVec3, DVec4};
use serde_json::{Map, Value};

/// A primitive's triangles, with morph targets by their weights; `None` for what has no triangles.
pub(super) fn read(
    gltf: &Gltf,
    primitive: &Primitive,
    weights: &[f64],
    materials: &Materials,
    place: &str,
    notes: &mut Notes,
) -> Result<Option<Piece>> {
    let mode = primitive.mode.unwrap_or(4);
    if mode < 4 {
        notes.leave_out("points or lines");
        return Ok(None);
    }
    if !primitive.attributes.contains_key("POSITION") {
        notes.leave_out("primitive without POSITION");
        return Ok(None);
    }
    refuse_compressed(gltf, primitive, place)?;
    for name in primitive.attributes.keys().filter(|name| !is_known(name)) {
        notes.leave_out(format!("vertex attribute {}", shown(name)));
    }

    let by = format!("{place}.attributes");
    let all = &primitive.attributes;
    let positions = gltf.triples(all, "POSITION", &by)?.unwrap_or_default();
    let normals = gltf.triples(all, "NORMAL", &by)?.unwrap_or_default();
    let colors = colors(gltf, all, &by, 1.0)?.unwrap_or_default();
    let material = match primitive.material {
        Some(index) => {
            gltf.get(&gltf.json.materials, "materials", index, place)?;
            index
        }
        None => materials.list.len() - 1,
    };
    let used = materials.uses[material];
    let set = format!("TEXCOORD_{}", used.map_or(0, |used| used.set));
    let uvs = match used {
        Some(_) => pairs(gltf, all, &set, &by)?.unwrap_or_default(),
        // A scene file may lay a picture by them; what is wrong with them is nothing to say otherwise.
        None => pairs(gltf, all, &set, &by)
            .ok()
            .flatten()
            .filter(|uvs| uvs.len() == positions.len() && uvs.iter().all(|uv| uv.is_finite()))
            .unwrap_or_default(),
    };
    let emission = materials.emissions.get(&(material as u32));
    let shown = &materials.list[material];
    let is_textured = shown.texture.is_some()
        || shown.pane.as_ref().is_some_and(|pane| pane.red.is_some())
        || emission.is_some_and(|e| e.texture.is_some());
    if used.is_some() && uvs.is_empty() && is_textured {
        notes.leave_out(format!(
            "texture on a surface without {set}, which gets its first texel"
        ));
    }
    let count = positions.len();
    let mut piece = Piece {
        positions,
        normals,
        uvs,
        colors,
        triangles: Vec::new(),
        material: material as u32,
    };
    fits(gltf, &piece, count, &set, place)?;

    if weights.len() > primitive.targets.len() {
        notes.leave_out("morph weight without a target");
    }
    for (i, (target, &weight)) in primitive.targets.iter().zip(weights).enumerate() {
        if weight != 0.0 {
            let by = format!("{place}.targets[{i}]");
            let moved = Piece {
                positions: gltf.triples(target, "POSITION", &by)?.unwrap_or_default(),
                normals: gltf.triples(target, "NORMAL", &by)?.unwrap_or_default(),
                uvs: pairs(gltf, target, &set, &by)?.unwrap_or_default(),
                colors: self::colors(gltf, target, &by, 0.0)?.unwrap_or_default(),
                ..Piece::default()
            };
            fits(gltf, &moved, count, &set, &by)?;
            morph(&mut piece, &moved, weight);
        }
    }
    let flat = |n: &&DVec3| n.is_finite() && n.normalize_or_zero() == DVec3::ZERO;
    notes.leave_out_all(
        "NORMAL without a length, for which stands the triangle's own",
        piece.normals.iter().filter(flat).count(),
    );
    if let Some(used) = used {
        piece.uvs.iter_mut().for_each(|uv| *uv = used.apply(*uv));
    }

    let indices = match primitive.indices {
        Some(index) => gltf.indices(index, &format!("{place}.indices"))?,
        None => (0..count as u32).collect(),
    };
    piece.triangles = match mode {
        4 => {
            if !indices.len().is_multiple_of(3) {
                notes.leave_out("vertices that make no whole triangle");
            }
            indices
                .chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]])
                .collect()
        }
        // Every second triangle of a strip is wound the other way (glTF 2.0, 3.7.2.1).
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    [t[0], t[1], t[2]]
                } else {
                    [t[0], t[2], t[1]]
                }
            })
            .collect(),
        6 => indices
            .get(1..)
            .unwrap_or_default()
            .windows(2)
            .map(|t| [t[0], t[1], indices[0]])
            .collect(),
        _ => {
            return Err(gltf.error(
                place,
                format!("there is no primitive mode {mode}"),
                "export the scene again",
            ));
        }
    };
    Ok(Some(piece))
}

/// An error for compressed geometry without a plain copy, which readers that do not know the compression need.
fn refuse_compressed(gltf: &Gltf, primitive: &Primitive, place: &str) -> Result<()> {
    let Some(name) = primitive
        .extensions
        .keys()
        .find(|name| extension::role(name) == extension::Role::Vital)
    else {
        return Ok(());
    };
    let attributes = primitive.attributes.values().filter_map(Value::as_u64);
    let accessors = attributes
        .map(|index| index as usize)
        .chain(primitive.indices);
    let plain = |index: usize| {
        let accessor = gltf.json.accessors.get(index);
        accessor.is_none_or(|a| a.buffer_view.is_some() || a.sparse.is_some())
    };
    if accessors.into_iter().all(plain) {
        return Ok(());
    }
    Err(gltf.error(
        place,
        format!("its geometry is there only as {}", extension::named(name)),
        extension::remedy(name),
    ))
}

/// Whether an attribute is read, or says nothing about the picture: tangents belong to normal textures, further texture
/// coordinates to textures that do not name them, those with an underscore to applications.
fn is_known(name: &str) -> bool {
    let prefixes = ["TEXCOORD_", "JOINTS_", "WEIGHTS_", "_"];
    matches!(name, "POSITION" | "NORMAL" | "TANGENT" | "COLOR_0")
        || prefixes.iter().any(|prefix| name.starts_with(prefix))
}

fn pairs(
    gltf: &Gltf,
    all: &Map<String, Value>,
    name: &str,
    by: &str,
) -> Result<Option<Vec<DVec2>>> {
    let numbers = gltf.attribute(all, name, &[2], by)?;
    Ok(numbers.map(|(_, numbers)| numbers.chunks_exact(2).map(DVec2::from_slice).collect()))
}

/// COLOR_0, where those without alpha get `alpha`.
fn colors(
    gltf: &Gltf,
    all: &Map<String, Value>,
    by: &str,
    alpha: f64,
) -> Result<Option<Vec<DVec4>>> {
    let numbers = gltf.attribute(all, "COLOR_0", &[3, 4], by)?;
    Ok(numbers.map(|(width, numbers)| {
        let color = |c: &[f64]| DVec3::from_slice(c).extend(c.get(3).copied().unwrap_or(alpha));
        numbers.chunks_exact(width).map(color).collect()
    }))
}

/// An error where an attribute has not as many elements as there are vertices.
fn fits(gltf: &Gltf, piece: &Piece, count: usize, set: &str, place: &str) -> Result<()> {
    let lengths = [
        ("POSITION", piece.positions.len()),
        ("NORMAL", piece.normals.len()),
        ("COLOR_0", piece.colors.len()),
        (set, piece.uvs.len()),
    ];
    let odd = lengths.into_iter().find(|&(_, n)| n != 0 && n != count);
    odd.map_or(Ok(()), |(name, n)| {
        let problem = format!("{name} has {n} elements, POSITION {count}");
        Err(gltf.error(place, problem, DAMAGED))
    })
}

/// Adds `weight` times the displacements of a morph target (glTF 2.0, 3.7.2.2).
fn morph(piece: &mut Piece, moved: &Piece, weight: f64) {
    fn add<T: Copy + std::ops::AddAssign + std::ops::Mul<f64, Output = T>>(
        values: &mut [T],
        moved: &[T],
        weight: f64,
    ) {
        for (value, &by) in values.iter_mut().zip(moved) {
            *value += by * weight;
        }
    }
    add(&mut piece.positions, &moved.positions, weight);
    add(&mut piece.normals, &moved.normals, weight);
    add(&mut piece.uvs, &moved.uvs, weight);
    add(&mut piece.colors, &moved.colors, weight);
}
