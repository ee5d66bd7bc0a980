//! Any bytes as an MTL file, all of whose materials `m` and `n` are used.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use tyndall::scene::from_bytes;

const OBJ: &[u8] = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
    usemtl m\nf 1/1 2/2 3/3\nf 1 2 3\nusemtl n\nf 1/1 2/2 3/3\n";

/// A folder of this process with the pictures; materials come from files alone.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("tyndall-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    for picture in ["tex.png", "leaf.png"] {
        let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/beside");
        std::fs::copy(PathBuf::from(beside).join(picture), folder.join(picture))
            .expect("the picture is copied");
    }
    folder
});

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(FOLDER.join("m.mtl"), bytes).expect("the file is written");
    let _ = from_bytes(&FOLDER.join("a.obj"), OBJ);
});
