//! Scenes from Wavefront OBJ and MTL.
//!
//! Of a material Kd, map_Kd and d count; what else it holds is named in one warning. Colours are taken as linear.
//! Texture coordinates are turned to v down. A missing MTL or picture is a warning: the shape is there without it.

use super::assembly::{Assembly, Piece, decode_image, triangulate};
use super::{AlphaMode, Material, Scene, Wrap, file};
use crate::error::{Error, Result};
use crate::warning::Warning;
use glam::{DAffine3, DVec2, DVec3};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads `bytes`, the content of `path`; materials and pictures are looked for beside it.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let file = path.display().to_string();
    // Names may be in any old encoding; numbers and keywords are ASCII.
    let text = String::from_utf8_lossy(bytes);
    check_lines(&file, &text)?;

    let folder = path.parent().unwrap_or(Path::new(""));
    let mut scene = Scene::default();
    let missing = RefCell::new(Vec::new());
    let load_mtl = |library: &Path| {
        let at = folder.join(library);
        let loaded = file::read(&at, file::LARGEST)
            .map_err(|e| e.problem())
            .and_then(|bytes| {
                let text = String::from_utf8_lossy(&bytes);
                guarded(|| tobj::load_mtl_buf(&mut text.as_bytes()))
                    .map_err(|e| format!("{}: {e}", at.display()))
            });
        loaded.map_err(|problem| {
            missing.borrow_mut().push(problem);
            tobj::LoadError::OpenFileFailed
        })
    };
    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: false,
        ignore_points: true,
        ignore_lines: true,
    };
    let (models, materials) =
        guarded(|| tobj::load_obj_buf(&mut text.as_bytes(), &options, load_mtl)).map_err(
            |problem| Error::input(&file, problem, "the file is damaged: export it again"),
        )?;
    for problem in missing.into_inner() {
        scene.warnings.push(Warning::MissingMaterials {
            file: file.clone(),
            problem,
        });
    }
    read_materials(&file, folder, materials.unwrap_or_default(), &mut scene)?;

    let default = scene.materials.len();
    let mut assembly = Assembly::default();
    for model in &models {
        let mesh = &model.mesh;
        let triples = |numbers: &[f64]| -> Vec<DVec3> {
            numbers.chunks_exact(3).map(DVec3::from_slice).collect()
        };
        let positions = triples(&mesh.positions);
        let or_none = |list: Vec<DVec3>| {
            if list.len() == positions.len() {
                list
            } else {
                Vec::new()
            }
        };
        let mut uvs: Vec<DVec2> = mesh
            .texcoords
            .chunks_exact(2)
            .map(|c| DVec2::new(c[0], 1.0 - c[1]))
            .collect();
        if uvs.len() != positions.len() {
            uvs.clear();
        }
        let mut triangles = Vec::new();
        if mesh.face_arities.is_empty() {
            triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        } else {
            let mut rest = &mesh.indices[..];
            for &arity in &mesh.face_arities {
                let Some((corners, tail)) = rest.split_at_checked(arity as usize) else {
                    break;
                };
                triangles.extend(triangulate(&positions, corners));
                rest = tail;
            }
        }
        let piece = Piece {
            normals: or_none(triples(&mesh.normals)),
            colors: or_none(triples(&mesh.vertex_color))
                .iter()
                .map(|c| c.extend(1.0))
                .collect(),
            uvs,
            triangles,
            material: mesh.material_id.filter(|&m| m < default).unwrap_or(default) as u32,
            positions,
        };
        assembly.add(&piece, DAffine3::IDENTITY, &|| {
            format!("{file}, object {}", model.name)
        })?;
    }
    scene.mesh = assembly.finish(&file, &mut scene.warnings)?;
    if scene
        .mesh
        .triangles
        .iter()
        .any(|t| t.material as usize == default)
    {
        scene.materials.push(Material {
            name: "default".into(),
            base_color: DVec3::splat(0.8),
            alpha: 1.0,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            transmissive: false,
        });
    }
    Ok(scene)
}

/// Runs one of tobj's readers; its errors, and a panic should there be one, become text.
fn guarded<T>(read: impl FnOnce() -> Result<T, tobj::LoadError>) -> Result<T, String> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(read))
        .unwrap_or(Err(tobj::LoadError::GenericFailure))
        .map_err(|e| e.to_string())
}

/// Looks for what would go wrong later, where the line is still known.
fn check_lines(file: &str, text: &str) -> Result<()> {
    let (mut counts, mut known) = ([0usize; 3], false);
    for (number, line) in text.lines().enumerate() {
        let error = |problem: String, remedy: &str| {
            Err(Error::input(
                format!("{file}:{}", number + 1),
                problem,
                remedy,
            ))
        };
        let mut words = line.split_whitespace();
        let keyword = words.next().unwrap_or("");
        let kind = ["v", "vt", "vn"].iter().position(|&k| k == keyword);
        known |= kind.is_some() || ["f", "o", "g", "mtllib", "usemtl"].contains(&keyword);
        if let Some(kind) = kind {
            counts[kind] += 1;
            let least = if kind == 1 { 1 } else { 3 };
            let numbers: Vec<Option<f64>> = words
                .take_while(|w| !w.starts_with('#'))
                .map(|w| w.parse().ok())
                .collect();
            if numbers.len() < least || numbers.iter().any(|n| !n.is_some_and(f64::is_finite)) {
                return error(
                    format!("`{}` needs {least} finite numbers or more", line.trim()),
                    "repair the line, or export the file again",
                );
            }
        } else if keyword == "f" {
            for corner in words.take_while(|w| !w.starts_with('#')) {
                for (kind, index) in corner
                    .split('/')
                    .enumerate()
                    .filter(|(_, index)| !index.is_empty())
                {
                    let count = counts.get(kind).copied().unwrap_or(0) as i64;
                    match index.parse::<i64>() {
                        Ok(i) if (1..=count).contains(&i) || (-count..=-1).contains(&i) => {}
                        Ok(i) => {
                            return error(
                                format!(
                                    "the face names {} {i}, but {count} are defined before it",
                                    ["vertex", "texture coordinate", "normal"][kind.min(2)]
                                ),
                                "the file is damaged: export it again",
                            );
                        }
                        Err(_) => {
                            return error(
                                format!("`{corner}` is no corner of a face"),
                                "write v, v/vt, v//vn or v/vt/vn",
                            );
                        }
                    }
                }
            }
        }
    }
    if known {
        Ok(())
    } else {
        Err(Error::input(
            file,
            "there is nothing of an OBJ file in it",
            "name a glTF, GLB, OBJ or TOML scene file",
        ))
    }
}

fn read_materials(
    file: &str,
    folder: &Path,
    entries: Vec<tobj::Material>,
    scene: &mut Scene,
) -> Result<()> {
    let mut left_out: BTreeMap<String, usize> = BTreeMap::new();
    let mut pictures: BTreeMap<String, Option<usize>> = BTreeMap::new();
    for entry in entries {
        let specular = entry.specular.is_some_and(|s| s.iter().any(|&s| s > 0.0));
        let emissive = entry.emissive.is_some_and(|e| e.iter().any(|&e| e > 0.0));
        for (present, what) in [
            (specular, "Ks"),
            (emissive, "Ke"),
            (entry.ambient_texture.is_some(), "map_Ka"),
            (entry.specular_texture.is_some(), "map_Ks"),
            (entry.normal_texture.is_some(), "map_Bump"),
            (entry.shininess_texture.is_some(), "map_Ns"),
            (entry.dissolve_texture.is_some(), "map_d"),
        ] {
            if present {
                *left_out.entry(what.to_owned()).or_default() += 1;
            }
        }
        for key in entry
            .unknown_param
            .keys()
            .filter(|key| key.as_str() != "Ke" || emissive)
        {
            *left_out.entry(key.clone()).or_default() += 1;
        }

        // Where only a picture is named, it is not dimmed.
        let absent = if entry.diffuse_texture.is_some() {
            1.0
        } else {
            0.8
        };
        let color = entry
            .diffuse
            .map_or(DVec3::splat(absent), DVec3::from_array);
        let alpha = entry.dissolve.unwrap_or(1.0);
        for (key, value) in [
            ("Kd", color.x),
            ("Kd", color.y),
            ("Kd", color.z),
            ("d", alpha),
        ] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::input(
                    format!("{file}, material {}", entry.name),
                    format!("{key} is {value}, outside 0 to 1"),
                    "correct it in the MTL file",
                ));
            }
        }
        let texture = entry.diffuse_texture.as_ref().and_then(|name| {
            *pictures.entry(name.clone()).or_insert_with(|| {
                let at = folder.join(name.replace('\\', "/"));
                let picture = file::read(&at, file::LARGEST)
                    .map_err(|e| e.problem())
                    .and_then(|bytes| decode_image(name, &bytes, [Wrap::Repeat; 2]));
                match picture {
                    Ok(picture) => {
                        scene.textures.push(picture);
                        Some(scene.textures.len() - 1)
                    }
                    Err(problem) => {
                        scene.warnings.push(Warning::MissingTexture {
                            problem: format!("{file}: cannot read {}: {problem}", at.display()),
                            remedy: "put the picture where the MTL file names it, as PNG or JPEG"
                                .into(),
                        });
                        None
                    }
                }
            })
        });
        scene.materials.push(Material {
            name: entry.name,
            base_color: color,
            alpha,
            texture,
            alpha_mode: if alpha < 1.0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            transmissive: false,
        });
    }
    if !left_out.is_empty() {
        scene.warnings.push(Warning::IgnoredMaterialProperties {
            file: file.to_owned(),
            properties: left_out,
        });
    }
    Ok(())
}
