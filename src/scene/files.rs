//! The files of a scene, where they are in memory.

/// The files of a scene by name; the first is the scene file.
pub type SceneFiles = &'static [(&'static str, &'static [u8])];

/// The content of a file of a scene.
pub(super) fn file_of(files: SceneFiles, name: &str) -> Option<&'static [u8]> {
    let mut files = files.iter();
    Some(files.find(|(known, _)| *known == name)?.1)
}
