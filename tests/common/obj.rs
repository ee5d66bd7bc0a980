//! OBJ and MTL files for tests, and what is asked of every scene that is read from one.

use super::files::{Folder, picture};
use tyndall::scene::Scene;

/// A textured square.
pub const SQUARE: &str = "mtllib m.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    usemtl m\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
pub const MTL: &str = "newmtl m\nKd 1 1 1\nmap_Kd tex.png\n";
/// Two triangles without anything else.
pub const PLAIN: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// A folder with an opaque picture (red, blue), a pierced one, and the material `m`.
pub fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("tex.png", png(&[[255, 0, 0, 255], [0, 0, 255, 255]]));
    folder.put("leaf.png", picture());
    folder.put("m.mtl", MTL);
    folder
}

pub fn png(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(texels.len() as u32, 1, texels.concat())
        .expect("the texels")
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a PNG");
    png.into_inner()
}

#[track_caller]
pub fn load(folder: &Folder, text: impl AsRef<[u8]>) -> Scene {
    folder.load("a.obj", text).expect("it loads")
}

/// The scene of the square with another MTL.
#[track_caller]
pub fn with_mtl(folder: &Folder, mtl: impl AsRef<[u8]>) -> Scene {
    folder.put("m.mtl", mtl);
    load(folder, SQUARE)
}

/// Everything that reaches a picture is the same.
#[track_caller]
pub fn same(a: &Scene, b: &Scene) {
    assert_eq!(a.mesh.positions, b.mesh.positions);
    assert_eq!(a.mesh.normals, b.mesh.normals);
    assert_eq!(a.mesh.uvs, b.mesh.uvs);
    assert_eq!(a.mesh.colors, b.mesh.colors);
    assert_eq!(a.mesh.triangles, b.mesh.triangles);
    assert_eq!(a.materials, b.materials);
    let texels = |scene: &Scene| -> Vec<_> {
        let all = scene.textures.iter();
        all.map(|t| (t.width, t.height, t.wrap, t.pixels.clone()))
            .collect()
    };
    assert_eq!(texels(a), texels(b));
}

/// The scene has one warning a text, which holds all the words of that text between the bars.
#[track_caller]
pub fn says(scene: &Scene, expected: &[&str]) {
    let said: Vec<String> = scene.warnings.iter().map(|w| w.message()).collect();
    assert_eq!(said.len(), expected.len(), "{said:#?}");
    for text in expected {
        let all = |message: &&String| text.split('|').all(|word| message.contains(word));
        assert!(said.iter().any(|m| all(&m)), "no `{text}` in {said:#?}");
    }
    for message in said {
        assert!(message.len() < 700, "{message}");
    }
}
