//! The scenes that are compiled into the library.

use super::files::{SceneFiles, file_of};
use super::placement::Placement;
use super::{Scene, gltf, toml};
use crate::error::{Error, Result, nearest};
use std::path::Path;

macro_rules! files {
    ($folder:literal: $($name:literal),+) => {
        &[$(($name, include_bytes!(concat!("../../data/", $folder, "/", $name)) as &[u8])),+]
    };
}

/// What each is, with its files. The first is what is pictured without a scene.
const EMBEDDED: [(&str, &str, SceneFiles); 7] = [
    (
        "nave",
        "a church nave on an autumn morning",
        files!("nave": "nave.toml", "nave.glb"),
    ),
    (
        "teapot",
        "a spotlight on a teapot in fog",
        files!("scenes/teapot": "teapot.toml", "teapot.glb"),
    ),
    (
        "stage",
        "five lamps of a stage in haze, a daisy and dots among them",
        files!("scenes/stage": "stage.toml", "stage.glb"),
    ),
    (
        "street",
        "street lamps, headlights and a glowing sign on a foggy night",
        files!("scenes/street": "street.toml", "street.glb", "lantern.ies", "wall.ies"),
    ),
    (
        "dry-ice",
        "spotlights over dry ice on a floor",
        files!("scenes/dry-ice": "dry-ice.toml", "dry-ice.glb"),
    ),
    (
        "smoke",
        "clouds of smoke in two beams",
        files!("scenes/smoke": "smoke.toml", "smoke.glb"),
    ),
    (
        "window",
        "sunlight through stained glass into a dark room",
        files!("scenes/window": "window.toml", "window.glb", "window.png"),
    ),
];

/// Names that [`Scene::builtin`] knows.
pub const BUILTIN: [&str; EMBEDDED.len()] = {
    let mut names = [""; EMBEDDED.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = EMBEDDED[i].0;
        i += 1;
    }
    names
};

/// What a scene of [`BUILTIN`] is, in a few words, and its files.
///
/// # Errors
/// [`Error::Input`] for another name.
pub fn builtin_files(name: &str) -> Result<(&'static str, SceneFiles)> {
    let mut all = EMBEDDED.into_iter();
    match all.find(|(known, ..)| *known == name) {
        Some((_, about, files)) => Ok((about, files)),
        None => Err(Error::input(
            format!("built-in scene `{name}`"),
            "there is none of that name",
            match nearest(name, BUILTIN) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("take one of: {}", BUILTIN.join(", ")),
            },
        )),
    }
}

impl Scene {
    /// A scene that is compiled into the library, by one of the names in [`BUILTIN`]. No file is read.
    ///
    /// # Errors
    /// [`Error::Input`] for another name.
    pub fn builtin(name: &str) -> Result<Scene> {
        let (_, files) = builtin_files(name)?;
        let missing = |what: &str| {
            Error::input(
                format!("built-in scene `{name}`"),
                format!("it has no {what}"),
                "take another",
            )
        };
        let (file, text) = files.first().ok_or_else(|| missing("file"))?;
        let text = str::from_utf8(text).map_err(|_| missing("text"))?;
        let asked = Placement::default();
        let mut scene = toml::load(Path::new(file), text, asked, Some(files), |mesh| {
            let bytes = file_of(files, mesh).ok_or_else(|| missing(mesh))?;
            gltf::load(Path::new(mesh), bytes)
        })?;
        scene.name = name.to_owned();
        Ok(scene)
    }
}
