//! From a name to a scene.

use super::placement::Placement;
use super::{Scene, gltf, obj, toml};
use crate::error::{Error, Result};
use crate::file;
use glam::DVec3;
use std::path::Path;

/// Reads a scene: TOML, glTF, GLB or OBJ.
///
/// The extension tells the kind; glTF, GLB and files without a known extension are told apart by content. Files that
/// it names (mesh, buffers, materials, pictures) are looked for beside it.
///
/// # Errors
/// [`Error::File`] when `path` cannot be read; [`Error::Input`] or [`Error::Domain`] with file, place and remedy when it
/// is not a scene, is damaged, has no triangles, or holds a key or a value that is not valid. What can be left out (a
/// texture that cannot be read, triangles without an area) is reported in [`Scene::warnings`] instead.
pub fn load(path: &Path) -> Result<Scene> {
    load_placed(path, Placement::default())
}

/// Reads a scene as [`load`] does, its mesh in the unit and the axes that are `asked` for. They win over the keys of a TOML
/// file.
///
/// # Errors
/// Those of [`load`], and [`Error::Input`] for a scale outside its range.
pub fn load_placed(path: &Path, asked: Placement) -> Result<Scene> {
    placed(path, &file::read(path, file::LARGEST)?, asked)
}

/// Reads a scene that is in memory already: `bytes` are the content of `path`, which need not exist.
///
/// The name tells the kind, and where the files are that the scene names, as for [`load`].
///
/// # Errors
/// Those of [`load`].
pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Scene> {
    placed(path, bytes, Placement::default())
}

fn placed(path: &Path, bytes: &[u8], asked: Placement) -> Result<Scene> {
    let mut scene = match FileKind::of(path, bytes)? {
        FileKind::Toml => {
            let text = str::from_utf8(bytes).map_err(|e| {
                let line = 1 + bytes[..e.valid_up_to()]
                    .iter()
                    .filter(|&&b| b == b'\n')
                    .count();
                Error::input(
                    format!("{}:{line}", path.display()),
                    "it is not UTF-8 text",
                    "save the file as UTF-8",
                )
            })?;
            let folder = path.parent().unwrap_or(Path::new(""));
            toml::load(path, text, asked, None, |mesh| {
                let mesh = folder.join(mesh);
                let bytes = file::read(&mesh, file::LARGEST)?;
                load_mesh(&mesh, &bytes)
            })?
        }
        _ => {
            let mut scene = load_mesh(path, bytes)?;
            let file = path.display().to_string();
            scene.place(&file, asked, DVec3::ZERO).map_err(|problem| {
                Error::input("--scale", problem, "give the metres in a unit of the mesh")
            })?;
            scene
        }
    };
    scene.name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    Ok(scene)
}

/// How a scene file is written.
#[derive(Clone, Copy, PartialEq)]
enum FileKind {
    Toml,
    Gltf,
    Obj,
}

impl FileKind {
    fn of(path: &Path, bytes: &[u8]) -> Result<FileKind> {
        let remedy = "name a glTF, GLB, OBJ or TOML scene file";
        if matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
            return Err(Error::input(
                path.display().to_string(),
                "it is UTF-16 text",
                "save the file as UTF-8",
            ));
        }
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let first = bytes.iter().copied().find(|b| !b.is_ascii_whitespace());
        let Some(first) = first else {
            return Err(Error::input(
                path.display().to_string(),
                "the file is empty",
                remedy,
            ));
        };
        let extension = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .to_ascii_lowercase();
        match extension.as_str() {
            "toml" => Ok(FileKind::Toml),
            "obj" => Ok(FileKind::Obj),
            _ if bytes.starts_with(b"glTF") || first == b'{' => Ok(FileKind::Gltf),
            "gltf" | "glb" => Err(Error::input(
                path.display().to_string(),
                "it is neither GLB nor glTF JSON",
                remedy,
            )),
            _ => Err(Error::input(
                path.display().to_string(),
                format!("`.{extension}` is not a kind of scene that is known"),
                remedy,
            )),
        }
    }
}

fn load_mesh(path: &Path, bytes: &[u8]) -> Result<Scene> {
    match FileKind::of(path, bytes)? {
        FileKind::Gltf => gltf::load(path, bytes),
        FileKind::Obj => obj::load(path, bytes),
        FileKind::Toml => Err(Error::input(
            path.display().to_string(),
            "a scene file cannot be the mesh of another",
            "name a glTF, GLB or OBJ file as the mesh",
        )),
    }
}
