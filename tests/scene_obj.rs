//! OBJ and MTL files as people have them: each is the same scene as its plain equivalent, or says what it lacks.

mod common;

use common::files::*;
use glam::{DVec2, DVec3, DVec4};
use proptest::prelude::*;
use std::time::{Duration, Instant};
use tyndall::scene::{AlphaMode, Scene, Wrap, from_bytes};

/// A textured square.
const SQUARE: &str = "mtllib m.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    usemtl m\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
const MTL: &str = "newmtl m\nKd 1 1 1\nmap_Kd tex.png\n";
/// Two triangles without anything else.
const PLAIN: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// A folder with an opaque picture (red, blue), a pierced one, and the material `m`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("tex.png", png(&[[255, 0, 0, 255], [0, 0, 255, 255]]));
    folder.put("leaf.png", picture());
    folder.put("m.mtl", MTL);
    folder
}

fn png(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(texels.len() as u32, 1, texels.concat())
        .expect("the texels")
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a PNG");
    png.into_inner()
}

#[track_caller]
fn load(folder: &Folder, text: impl AsRef<[u8]>) -> Scene {
    folder.load("a.obj", text).expect("it loads")
}

/// The scene of the square with another MTL.
#[track_caller]
fn with_mtl(folder: &Folder, mtl: impl AsRef<[u8]>) -> Scene {
    folder.put("m.mtl", mtl);
    load(folder, SQUARE)
}

/// Everything that reaches a picture is the same.
#[track_caller]
fn same(a: &Scene, b: &Scene) {
    assert_eq!(a.mesh.positions, b.mesh.positions);
    assert_eq!(a.mesh.normals, b.mesh.normals);
    assert_eq!(a.mesh.uvs, b.mesh.uvs);
    assert_eq!(a.mesh.colors, b.mesh.colors);
    assert_eq!(a.mesh.triangles, b.mesh.triangles);
    assert_eq!(a.materials, b.materials);
    assert_eq!(a.textures, b.textures);
}

/// The scene has one warning a text, which holds all the words of that text between the bars.
#[track_caller]
fn says(scene: &Scene, expected: &[&str]) {
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

#[test]
fn line_ends_and_marks_change_nothing() {
    let folder = folder();
    let plain = load(&folder, SQUARE);
    says(&plain, &[]);
    let bom = |text: &str| [b"\xEF\xBB\xBF", text.as_bytes()].concat();
    let variants: [(&str, Vec<u8>); 10] = [
        ("mark", bom(SQUARE)),
        ("CR LF", SQUARE.replace('\n', "\r\n").into()),
        ("CR", SQUARE.replace('\n', "\r").into()),
        ("CR CR LF", SQUARE.replace('\n', "\r\r\n").into()),
        ("NUL after it", [SQUARE.as_bytes(), &[0; 500]].concat()),
        ("no end", SQUARE.trim_end().into()),
        (
            "tabs and spaces",
            SQUARE
                .replace(' ', " \t ")
                .replace('\n', "  \n\n \t\n")
                .into(),
        ),
        (
            "comments",
            SQUARE.replace('\n', " # C:\\models\\\n#\\\n").into(),
        ),
        (
            "continued",
            SQUARE
                .replace(" 3/3/1", "\\\n 3/3/1\\\r\n")
                .replace("vt 0 1", "vt\\\n0 1")
                .into(),
        ),
        ("upper case", {
            let text = SQUARE
                .replace("mtllib", "MTLLIB")
                .replace("usemtl", "UseMtl");
            text.replace("v ", "V ").replace("f ", "F ").into()
        }),
    ];
    for (name, text) in variants {
        eprintln!("{name}");
        let scene = load(&folder, text);
        same(&scene, &plain);
        says(&scene, &[]);
    }
    for mtl in [
        bom(MTL),
        MTL.replace('\n', "\r").into(),
        MTL.replace('\n', " # well\r\n").into(),
        MTL.replace("newmtl", "NEWMTL")
            .replace("Kd", "KD")
            .replace("map_", "MAP_")
            .into(),
        MTL.replace("1 1 1", "\\\n1 1 1").into(),
        b"\xEF\xBB\xBF\nnewmtl other\n\xEF\xBB\xBF"
            .iter()
            .chain(MTL.as_bytes())
            .copied()
            .collect(),
    ] {
        let scene = with_mtl(&folder, mtl);
        assert_eq!(scene.materials.last(), plain.materials.last());
        assert_eq!(scene.textures, plain.textures);
        says(&scene, &[]);
    }
    // The mark before `mtllib`, and before the only `v`.
    folder.put("m.mtl", MTL);
    same(&load(&folder, bom(SQUARE)), &plain);
    same(&load(&folder, bom(PLAIN)), &load(&folder, PLAIN));
}

#[test]
fn utf_16_is_named() {
    let folder = folder();
    for mark in [&b"\xFF\xFE"[..], b"\xFE\xFF", b""] {
        for low in [0, 1] {
            let encode = |text: &str| -> Vec<u8> {
                let bytes = text
                    .bytes()
                    .flat_map(|b| if low == 0 { [b, 0] } else { [0, b] });
                mark.iter().copied().chain(bytes).collect()
            };
            let error = folder.refused("wide.obj", encode(SQUARE));
            assert!(error.contains("UTF-16") && error.contains("save the file as UTF-8"));
            folder.put("m.mtl", encode(MTL));
            let scene = load(&folder, SQUARE);
            says(&scene, &["a.obj|m.mtl|UTF-16", "m (1)"]);
            assert_eq!(scene.warnings[0].advice(), Some("save the file as UTF-8"));
        }
    }
}

#[test]
fn names_in_old_encodings_stay_apart() {
    let folder = folder();
    folder.put(
        "m.mtl",
        b"newmtl gr\xFCn\nKd 0 1 0\nnewmtl gr\xF6n\nKd 1 0 0\n",
    );
    let scene = load(
        &folder,
        [
            b"mtllib m.mtl\n",
            PLAIN.as_bytes(),
            b"usemtl gr\xFCn\nf 1 2 3\n",
        ]
        .concat(),
    );
    says(&scene, &[]);
    assert_eq!(scene.materials[0].name, "grün");
    assert_eq!(scene.mesh.triangles.last().expect("three").material, 0);
}

#[test]
fn colours_as_they_are_written() {
    let folder = folder();
    let kd = |text: &str| with_mtl(&folder, format!("newmtl m\n{text}\n"));
    let plain = kd("Kd 0.8 0.8 0.8");
    for text in [
        "Kd 0.8",
        "Kd 0.8 0.8 0.8 # grey",
        "Ka 0.2\nKd 0.8\nNs 5\nNi 1.5\nillum 2",
    ] {
        let scene = kd(text);
        same(&scene, &plain);
        says(&scene, &[]);
    }
    // What cannot be read costs its line: the grey of a material without Kd.
    for (text, said) in [
        ("Kd spectral f.rfl", "m.mtl: |Kd spectral (1)"),
        ("Kd spectral f.rfl 2", "Kd spectral (1)"),
        ("Kd", "m.mtl:2: a key without a value"),
        ("Kd red", "m.mtl:2: Kd needs|`Kd red`"),
        ("Kd 0.1 0.2", "m.mtl:2: Kd needs"),
        ("Kd nan 0 0", "m.mtl:2: Kd needs"),
        ("Ns", "m.mtl:2: a key without a value"),
        ("map_Kd", "m.mtl:2: a key without a value"),
        ("map_Kd -s 2 2 2", "m.mtl:2: map_Kd names no picture"),
        ("map_Kd # none", "m.mtl:2: a key without a value"),
        ("d half", "m.mtl:2: it needs one number|`d half`"),
        ("Kd 0.8\nKd", "m.mtl:3: a key without a value"),
    ] {
        let scene = kd(text);
        same(&scene, &plain);
        says(&scene, &[said]);
    }
    for (text, taken, said) in [
        (
            "Kd 1.0001 0.5 0.5",
            DVec3::new(1.0, 0.5, 0.5),
            "m.mtl:2: Kd is outside 0 to 1|1.0001",
        ),
        ("Kd 255 -1 0", DVec3::X, "m.mtl:2: Kd is outside 0 to 1"),
        (
            "Kd 0.5 0.25 0.125 1",
            DVec3::new(0.5, 0.25, 0.125),
            "m.mtl:2: Kd has more than three",
        ),
        ("Kd 1 0 0\nKd 0 0 1", DVec3::Z, "m.mtl:3: Kd is there again"),
    ] {
        let scene = kd(text);
        assert_eq!(scene.materials[0].base_color, taken);
        says(&scene, &[said]);
    }
    // XYZ: IEC 61966-2-1 has linear Rec. 709 of the three primaries' own XYZ.
    for (xyz, rgb) in [
        ("0.4124 0.2126 0.0193", DVec3::X),
        ("0.2062 0.1063 0.00965", 0.5 * DVec3::X),
        ("0.3576 0.7152 0.1192", DVec3::Y),
    ] {
        let scene = kd(&format!("Kd xyz {xyz}"));
        let color = scene.materials[0].base_color;
        assert!(color.distance(rgb) < 3e-4, "{color}");
    }
    let one = kd("Kd xyz 0.25").materials[0].base_color;
    assert_eq!(one, kd("Kd xyz 0.25 0.25 0.25").materials[0].base_color);
}

#[test]
fn one_bad_material_leaves_the_others() {
    let folder = folder();
    let good = "newmtl a\nKd 0.1 0.2 0.3\nnewmtl m\nKd 0.5 0.5 0.5\n";
    let plain = with_mtl(&folder, good);
    let scene = with_mtl(
        &folder,
        "Kd 1 1 1\nnewmtl a\nKd 0.1 0.2 0.3\nmap_Kd\nd -\n\0\x01\nnewmtl m\nd -halo\nKd 0.5 0.5 0.5\n",
    );
    same(&scene, &plain);
    says(
        &scene,
        &[
            "m.mtl:1: |before any `newmtl`",
            "m.mtl:4: a key without",
            "m.mtl:5, 8: it needs one number",
            "left out, with how often: |d -halo (1)",
            "m.mtl:6: a key without",
        ][..4]
            .iter()
            .map(|s| {
                if s.contains(":4:") {
                    "m.mtl:4, 6: a key without"
                } else {
                    s
                }
            })
            .collect::<Vec<_>>(),
    );
}

#[test]
fn opacity_arrives() {
    let folder = folder();
    let mtl = |text: &str| with_mtl(&folder, format!("newmtl m\nKd 1 1 1\n{text}\n"));
    for (text, alpha, mode, said) in [
        ("d 0.99", 0.99, AlphaMode::Blend, &[][..]),
        ("d 0.99\nmap_Kd tex.png", 0.99, AlphaMode::Blend, &[]),
        ("d 1", 1.0, AlphaMode::Opaque, &[]),
        ("Tr 0.25", 0.75, AlphaMode::Blend, &[]),
        ("Tr 0\nd 1", 1.0, AlphaMode::Opaque, &[]),
        ("d 0.3\nTr 0.7", 0.3, AlphaMode::Blend, &[]),
        (
            "Tr 1\nd 1",
            1.0,
            AlphaMode::Opaque,
            &[
                "m.mtl:3: a material that nothing",
                "m.mtl:4: d and Tr disagree",
            ],
        ),
        (
            "d 0.4\nTr 0.4",
            0.4,
            AlphaMode::Blend,
            &["m.mtl:4: d and Tr disagree"],
        ),
        (
            "d 1.00001",
            1.0,
            AlphaMode::Opaque,
            &["m.mtl:3: it is outside 0 to 1"],
        ),
        (
            "d 0",
            0.0,
            AlphaMode::Blend,
            &["m.mtl:3: a material that nothing is seen of|`d 0`"],
        ),
        ("d -halo 0.5", 0.5, AlphaMode::Blend, &["d -halo (1)"]),
        ("map_Kd leaf.png", 1.0, AlphaMode::Blend, &[]),
        ("map_Kd tex.png", 1.0, AlphaMode::Opaque, &[]),
        ("d 0.5\nTf 0.5 1 1", 0.5, AlphaMode::Blend, &["Tf (1)"]),
    ] {
        let scene = mtl(text);
        let material = &scene.materials[0];
        assert_eq!(
            (material.alpha, material.alpha_mode),
            (alpha, mode),
            "{text}"
        );
        says(&scene, said);
    }
}

#[test]
fn opacity_from_a_picture() {
    let folder = folder();
    folder.put("grey.png", png(&[[255, 255, 255, 255], [0, 0, 0, 255]]));
    let mtl = |text: &str| with_mtl(&folder, format!("newmtl m\nKd 1 1 1\n{text}\n"));
    // The leaf's own alpha is 255, 0: as the grey picture's.
    folder.put("both.png", png(&[[255, 0, 0, 255], [0, 0, 255, 0]]));
    let texels = |scene: &Scene| scene.textures[0].pixels.clone();
    let plain = mtl("map_Kd both.png");
    for text in [
        "map_Kd tex.png\nmap_d grey.png",
        "map_d grey.png\nmap_Kd tex.png",
        "map_Kd tex.png\nmap_d leaf.png",
        "map_Kd tex.png\nmap_d -imfchan r grey.png",
        "map_Kd tex.png\nmap_d -imfchan m leaf.png",
        "map_Kd both.png\nmap_d both.png",
        "map_Kd both.png\nmap_opacity grey.png",
    ] {
        let scene = mtl(text);
        says(&scene, &[]);
        assert_eq!(texels(&scene), texels(&plain), "{text}");
        assert_eq!(scene.materials, plain.materials);
    }
    // Without map_Kd, Kd shows through the mask.
    let scene = mtl("map_d grey.png");
    assert_eq!(texels(&scene), [[255, 255, 255, 255], [255, 255, 255, 0]]);
    assert_eq!(scene.materials[0].base_color, DVec3::ONE);
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
    let scene = with_mtl(&folder, "newmtl m\nmap_d grey.png\n");
    assert_eq!(scene.materials[0].base_color, DVec3::splat(0.8));
    // A picture without alpha is no mask of itself.
    let scene = mtl("map_Kd tex.png\nmap_d tex.png");
    says(&scene, &["m.mtl:1: map_d is map_Kd's picture|opaque"]);
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Opaque);
    says(
        &mtl("map_Kd tex.png\nmap_d -s 2 2 grey.png"),
        &["m.mtl:1: map_d has other -s, -o or -clamp"],
    );
    let scene = mtl("map_Kd tex.png\nmap_d gone.png");
    says(&scene, &["cannot read|gone.png"]);
    assert_eq!(texels(&scene), texels(&mtl("map_Kd tex.png")));
}

#[test]
fn texture_options() {
    let folder = folder();
    let plain = with_mtl(&folder, MTL);
    let map = |text: &str| with_mtl(&folder, format!("newmtl m\nKd 1 1 1\nmap_Kd {text}\n"));
    for text in [
        "-s 1 1 1 tex.png",
        "-o 0 0 tex.png",
        "-t 0 tex.png",
        "-clamp off tex.png",
        "-mm 0 1 tex.png",
        "-blendu on -blendv on tex.png",
        "\"tex.png\"",
        "tex.png # the wall",
        "./tex.png",
        ".\\tex.png",
        "tex.png -s 1 1 1",
    ] {
        let scene = map(text);
        says(&scene, &[]);
        same(&scene, &plain);
    }
    for (text, said) in [
        ("-mm 0.1 0.9 tex.png", "map_Kd -mm (1)"),
        ("-t 0.5 tex.png", "map_Kd -t (1)"),
        ("-blendu off tex.png", "map_Kd -blendu (1)"),
        ("-bm 0.5 tex.png", "map_Kd -bm (1)"),
        ("-imfchan r tex.png", "map_Kd -imfchan (1)"),
        ("-texres 512 tex.png", "map_Kd -texres (1)"),
        ("-cc on tex.png", "map_Kd -cc (1)"),
        ("-boost 2 tex.png", "map_Kd -boost (1)"),
        ("-type sphere tex.png", "map_Kd -type (1)"),
        ("tex.png -bm 0.5", "map_Kd -bm (1)"),
        (
            "-cc on -boost 2 -texres 512 tex.png",
            "map_Kd -boost (1), map_Kd -cc (1), map_Kd -texres (1)",
        ),
    ] {
        let scene = map(text);
        says(&scene, &[said]);
        same(&scene, &plain);
    }
    let scene = map("-clamp on tex.png");
    says(&scene, &[]);
    assert_eq!(scene.textures[0].wrap, [Wrap::Clamp; 2]);
    // u' = s u + o, v up; the loader's v is down.
    let scene = map("-s 2 3 1 -o 0.25 0.5 tex.png");
    says(&scene, &[]);
    for (uv, plain) in scene.mesh.uvs.iter().zip(&plain.mesh.uvs) {
        let up = DVec2::new(plain.x, 1.0 - plain.y) * DVec2::new(2.0, 3.0) + DVec2::new(0.25, 0.5);
        assert_eq!(*uv, DVec2::new(up.x, 1.0 - up.y));
    }
    assert_eq!(map("-s 2 tex.png").mesh.uvs[1], DVec2::new(2.0, 1.0));
    // A name may look like numbers, and hold spaces.
    folder.put("2", png(&[[1, 2, 3, 255]]));
    folder.put("my old -wall #2.png", png(&[[1, 2, 3, 255]]));
    for text in [
        "-s 1 1 2",
        "-o 0 2",
        "2",
        "my old -wall #2.png",
        "-s 1 1 1 my old -wall #2.png",
    ] {
        let scene = map(text);
        says(&scene, &[]);
        assert_eq!(scene.textures[0].pixels, [[1, 2, 3, 255]], "{text}");
    }
}

#[test]
fn pictures_that_are_not_where_they_are_named() {
    let folder = folder();
    std::fs::create_dir(folder.0.path().join("Maps")).expect("a folder");
    folder.put("Maps/Wall.Png", png(&[[1, 2, 3, 255]]));
    let map = |text: &str| with_mtl(&folder, format!("newmtl m\nKd 1 1 1\nmap_Kd {text}\n"));
    let plain = with_mtl(&folder, MTL);
    for text in [
        "TEX.PNG",
        "Tex.Png",
        "C:\\Users\\me\\My Maps\\tex.png",
        "D:\\TEX.png",
        "\\\\server\\share\\tex.png",
        "/home/me/nowhere/tex.png",
        "textures/tex.png",
    ] {
        let scene = map(text);
        assert_eq!(scene.textures[0].pixels, plain.textures[0].pixels, "{text}");
        assert_eq!(scene.materials, plain.materials);
        says(
            &scene,
            &[&format!(
                "m.mtl: not there as named: 1 file|tex.png taken for {text}"
            )],
        );
    }
    for (text, said) in [
        ("Maps/Wall.Png", &[][..]),
        ("Maps\\Wall.Png", &[]),
        ("maps\\wall.png", &["Wall.Png taken for maps\\wall.png"]),
    ] {
        let scene = map(text);
        assert_eq!(scene.textures[0].pixels, [[1, 2, 3, 255]], "{text}");
        says(&scene, said);
    }
    // One that is nowhere, is a folder, or is no picture: the material without it.
    let bare = with_mtl(&folder, "newmtl m\nKd 1 1 1\n");
    folder.put("no.png", "nothing");
    for text in ["gone.png", "Maps", "no.png", "/dev/zero"] {
        let scene = map(text);
        assert!(scene.textures.is_empty());
        assert_eq!(scene.materials, bare.materials);
        assert!(
            scene.warnings.iter().any(|w| w.message().contains(text)),
            "{text}"
        );
    }
    // Many of them do not fill the screen.
    let many: String = (0..100)
        .map(|i| format!("newmtl m{i}\nmap_Kd {i}.png\n"))
        .collect();
    folder.put("m.mtl", many);
    let faces: String = (0..100)
        .map(|i| format!("usemtl m{i}\nf 1/1 2/2 3/3\n"))
        .collect();
    let scene = load(&folder, format!("{SQUARE}{faces}"));
    assert!(scene.warnings.len() < 12, "{:#?}", scene.warnings);
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.message().contains("92 more"))
    );
}

#[test]
fn files_outside_the_folder_are_named() {
    let folder = folder();
    for name in ["scene", "shared"] {
        std::fs::create_dir(folder.0.path().join(name)).expect("a folder");
    }
    folder.put("shared/t.png", png(&[[1, 2, 3, 255]]));
    folder.put("shared/s.mtl", "newmtl m\nmap_Kd t.png\n");
    folder.put("scene/m.mtl", "newmtl m\nmap_Kd ../shared/t.png\n");
    let scene = folder.load("scene/a.obj", SQUARE).expect("it loads");
    assert_eq!(scene.textures.len(), 1);
    says(
        &scene,
        &["m.mtl names ../shared/t.png, which lies outside its folder"],
    );
    let text = SQUARE.replace("m.mtl", "../shared/s.mtl");
    let scene = folder.load("scene/b.obj", text).expect("it loads");
    assert_eq!(scene.textures.len(), 1);
    says(
        &scene,
        &["b.obj names ../shared/s.mtl, which lies outside its folder"],
    );
    let path = folder.0.path().join("shared/t.png").display().to_string();
    folder.put("scene/m.mtl", format!("newmtl m\nmap_Kd {path}\n"));
    let scene = folder.load("scene/a.obj", SQUARE).expect("it loads");
    says(&scene, &["which lies outside its folder"]);
    // Up and down again is inside.
    folder.put("scene/t.png", png(&[[1, 2, 3, 255]]));
    folder.put("scene/m.mtl", "newmtl m\nmap_Kd ../scene/t.png\n");
    says(&folder.load("scene/a.obj", SQUARE).expect("it loads"), &[]);
    let text = SQUARE.replace("m.mtl", "../../../../../../../../../../etc/passwd");
    let scene = folder.load("scene/c.obj", text).expect("it loads");
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.message().contains("etc/passwd, which lies outside")),
        "{:#?}",
        scene.warnings
    );
}

#[test]
fn materials_are_found_or_named() {
    let folder = folder();
    let plain = load(&folder, SQUARE);
    // Before the library, which resolves late.
    let late = SQUARE
        .replace("mtllib m.mtl\n", "")
        .replace("usemtl m\n", "usemtl m\nmtllib m.mtl\n");
    let end = SQUARE.replace("mtllib m.mtl\n", "") + "mtllib m.mtl\n";
    for text in [late, end] {
        let scene = load(&folder, text);
        same(&scene, &plain);
        says(&scene, &[]);
    }
    let scene = load(&folder, SQUARE.replace("usemtl m", "usemtl nope"));
    says(
        &scene,
        &["a.obj: no file of materials defines these|nope (1)|grey"],
    );
    assert_eq!(scene.materials[1].base_color, DVec3::splat(0.8));
    assert_eq!(scene.mesh.triangles[0].material, 1);
    let scene = load(&folder, SQUARE.replace("mtllib m.mtl\n", ""));
    says(&scene, &["m (1)"]);
    for (text, said) in [
        (
            "usemtl M",
            "a.obj:11: a material by that name is there only without regard to case|`M`",
        ),
        (
            "usemtl m #the wall",
            "a.obj:11: a material by that name|`m #the wall`",
        ),
    ] {
        let scene = load(&folder, SQUARE.replace("usemtl m", text));
        same(&scene, &plain);
        says(&scene, &[said]);
    }
    says(
        &load(&folder, SQUARE.replace("usemtl m", "usemtl m # the wall")),
        &[],
    );
    // Names with spaces and `#`.
    for name in ["old wall", "Material #25", "a # b"] {
        folder.put("m.mtl", MTL.replace("newmtl m", &format!("newmtl {name}")));
        let scene = load(
            &folder,
            SQUARE.replace("usemtl m", &format!("usemtl {name}")),
        );
        says(&scene, &[]);
        assert_eq!(scene.mesh.triangles[0].material, 0);
    }
    folder.put("m.mtl", "newmtl Material #25\n");
    says(
        &load(&folder, SQUARE.replace("usemtl m", "usemtl Material #26")),
        &["Material #26 (1)"],
    );
    // Case tells materials apart where both are there.
    folder.put("m.mtl", "newmtl M\nKd 1 0 0\nnewmtl m\nKd 0 1 0\n");
    let scene = load(&folder, SQUARE);
    assert_eq!(scene.mesh.triangles[0].material, 1);
    says(&scene, &[]);
    // Two of one name: the later, and it is said; unless they are the same.
    let scene = with_mtl(&folder, "newmtl m\nKd 1 0 0\nnewmtl m\nKd 0 1 0\n");
    says(
        &scene,
        &["m.mtl:3: a material of that name is already there|`m`"],
    );
    assert_eq!(scene.materials[0].base_color, DVec3::Y);
    says(
        &with_mtl(&folder, "newmtl m\nKd 1 0 0\nnewmtl m\nKd 1 0 0\n"),
        &[],
    );
    // A face before any `usemtl`, and after an empty one, is grey by right.
    folder.put("m.mtl", MTL);
    says(&load(&folder, SQUARE.replace("usemtl m\n", "")), &[]);
    says(
        &load(&folder, SQUARE.replace("usemtl m\n", "usemtl\n")),
        &[],
    );
}

#[test]
fn several_libraries() {
    let folder = folder();
    let plain = load(&folder, SQUARE);
    folder.put("my m.mtl", MTL);
    folder.put("b.mtl", "newmtl b\nKd 0 0 1\n");
    for text in [
        "mtllib my m.mtl",
        "mtllib \"my m.mtl\"",
        "mtllib m.mtl # all",
        "mtllib m.mtl\nmtllib m.mtl",
        "mtllib m.mtl m.mtl",
    ] {
        let scene = load(&folder, SQUARE.replace("mtllib m.mtl", text));
        same(&scene, &plain);
        says(&scene, &[]);
    }
    for text in [
        "b.mtl m.mtl",
        "b.mtl my m.mtl",
        "b.mtl\tm.mtl",
        "b.mtl\nmtllib m.mtl",
    ] {
        let scene = load(&folder, SQUARE.replace("m.mtl", text));
        says(&scene, &[]);
        assert_eq!(scene.materials.len(), 2);
        assert_eq!(scene.materials[1], plain.materials[0]);
        assert_eq!(scene.mesh.triangles[0].material, 1);
    }
    let scene = load(&folder, SQUARE.replace("m.mtl", "gone.mtl m.mtl"));
    says(
        &scene,
        &["a.obj: cannot read|gone.mtl|its materials left out"],
    );
    same(&scene, &plain);
    let scene = load(&folder, SQUARE.replace("m.mtl", "M.MTL"));
    says(&scene, &["m.mtl taken for M.MTL"]);
    same(&scene, &plain);
    let lines: String = (0..1000).map(|i| format!("mtllib {i}.mtl\n")).collect();
    let scene = load(&folder, lines + SQUARE);
    assert_eq!(scene.warnings.len(), 9);
    assert!(scene.warnings[8].message().contains("992 more files"));
}

#[test]
fn only_the_face_without_texture_coordinates_has_none() {
    let folder = folder();
    let plain = load(&folder, SQUARE);
    let scene = load(&folder, format!("{SQUARE}f 1 2 3\n"));
    says(
        &scene,
        &["a.obj: 1 face of textured materials without texture coordinates"],
    );
    // The square's triangles are as they were.
    assert_eq!(scene.mesh.triangles[..2], plain.mesh.triangles[..]);
    assert_eq!(scene.mesh.uvs[..4], plain.mesh.uvs[..]);
    assert_eq!(scene.materials[0], plain.materials[0]);
    let bare = &scene.materials[scene.mesh.triangles[2].material as usize];
    assert_eq!(
        (bare.texture, bare.base_color, bare.alpha_mode),
        (None, DVec3::ONE, AlphaMode::Opaque)
    );
    // It is the face of the material that names no picture.
    let equal = with_mtl(&folder, format!("{MTL}newmtl bare\nKd 1 1 1\n"));
    let text = format!("{SQUARE}usemtl bare\nf 1 2 3\n");
    let equal = (load(&folder, text), equal).0;
    assert_eq!(scene.mesh.positions, equal.mesh.positions);
    assert_eq!(scene.mesh.normals, equal.mesh.normals);
    assert_eq!(scene.mesh.triangles, equal.mesh.triangles);

    folder.put("m.mtl", MTL);
    for corner in [
        "f 1/1 2 3/3",
        "f 1/1 2/2 3/9",
        "f 1/1 2/0 3/3",
        "f 1/1 2/-9 3/3",
    ] {
        let scene = load(&folder, format!("{SQUARE}{corner}\n"));
        says(
            &scene,
            &[
                "1 face of textured materials",
                &format!(
                    "a.obj:13: a corner without a texture coordinate that is there|`{corner}`"
                ),
            ],
        );
        assert_eq!(scene.mesh.triangles[2].material, 1);
    }
    // Without a picture there is nothing to lack; a pierced one cuts no holes where it is not.
    says(
        &load(&folder, format!("{PLAIN}vt 0 0\nf 1/1 2/1 3/1\n")),
        &[],
    );
    let scene = with_mtl(&folder, "newmtl m\nKd 0.5\nmap_Kd leaf.png\n");
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
    let scene = load(&folder, format!("{SQUARE}f 1 2 3\n"));
    assert_eq!(scene.materials[1].alpha_mode, AlphaMode::Opaque);
    assert_eq!(scene.materials[1].base_color, DVec3::splat(0.5));
}

#[test]
fn only_the_face_without_normals_has_none() {
    let folder = folder();
    let base = format!("{PLAIN}vn 0 0 1\nf 1//1 2//1 3//1\n");
    let scene = load(&folder, &base);
    says(&scene, &[]);
    let normals = |scene: &Scene, triangle: usize| {
        scene.mesh.triangles[triangle]
            .vertices
            .map(|v| scene.mesh.normals[v as usize])
    };
    assert_eq!(normals(&scene, 0), [DVec3::ZERO; 3]);
    assert_eq!(normals(&scene, 2), [DVec3::Z; 3]);
    for corner in ["f 1//1 2 3//1", "f 1//1 2//7 3//1"] {
        let scene = load(&folder, format!("{base}{corner}\n"));
        assert_eq!(normals(&scene, 3), [DVec3::ZERO; 3]);
        assert_eq!(normals(&scene, 2), [DVec3::Z; 3]);
        says(
            &scene,
            &["a.obj:9: a corner without a normal that is there"],
        );
    }
    let scene = load(
        &folder,
        format!("{PLAIN}vn nan nan nan\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//2 2//2 3//2\n"),
    );
    assert_eq!(normals(&scene, 3), [DVec3::Z; 3]);
    says(
        &scene,
        &[
            "a.obj:7: a normal needs three",
            "a.obj:9: a corner without a normal",
        ],
    );
}

#[test]
fn colours_of_vertices() {
    let folder = folder();
    let face = "f 1 2 3\n";
    let colors = |text: &str| load(&folder, format!("{text}{face}"));
    let scene = colors("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\n");
    says(&scene, &[]);
    assert_eq!(
        scene.mesh.colors,
        [
            DVec4::new(1.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 1.0, 0.0, 1.0),
            DVec4::new(0.0, 0.0, 1.0, 1.0)
        ]
    );
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Opaque);
    // Mixed: white where there is none, wherever the first one is.
    for (text, index) in [
        ("v 0 0 0\nv 1 0 0 0 1 0\nv 1 1 0\n", 1),
        ("v 0 0 0 0 1 0\nv 1 0 0\nv 1 1 0\n", 0),
    ] {
        let scene = colors(text);
        says(&scene, &[]);
        let mut expected = [DVec4::ONE; 3];
        expected[index] = DVec4::new(0.0, 1.0, 0.0, 1.0);
        assert_eq!(scene.mesh.colors, expected);
    }
    let scene = colors("v 0 0 0 1 0 0 1\nv 1 0 0 0 1 0 0.5\nv 1 1 0\n");
    says(&scene, &[]);
    assert_eq!(scene.mesh.colors[1], DVec4::new(0.0, 1.0, 0.0, 0.5));
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
    assert!(
        colors("v 0 0 0 1\nv 1 0 0 1.0\nv 1 1 0\n")
            .mesh
            .colors
            .is_empty()
    );
    for (text, said) in [
        (
            "v 0 0 0 2\nv 1 0 0 1.0\nv 1 1 0\n",
            "a.obj:1: the weight of a vertex",
        ),
        (
            "v 0 0 0 1 1\nv 1 0 0\nv 1 1 0\n",
            "a.obj:1: more numbers than are read",
        ),
        (
            "v 0 0 0 1 1 1 1 1\nv 1 0 0\nv 1 1 0\n",
            "a.obj:1: more numbers than are read",
        ),
        (
            "v 0 0 0 255 0 0\nv 1 0 0\nv 1 1 0\n",
            "1 vertex attribute|out of range",
        ),
        (
            "#MRGB ffff0000\nv 0 0 0\nv 1 0 0\nv 1 1 0\n",
            "#MRGB (colours of vertices) (1)",
        ),
    ] {
        let scene = colors(text);
        says(&scene, &[said]);
        assert_eq!(scene.mesh.triangles.len(), 1);
    }
}

#[test]
fn a_bad_line_costs_that_line() {
    let folder = folder();
    let plain = load(&folder, PLAIN);
    for (line, said) in [
        ("f 1 2", "a face needs three corners"),
        ("f", "a face needs three corners"),
        ("f 1 2 x", "a corner of a face is v, v/vt"),
        ("f 1 2 3/1/1/1", "a corner of a face is v, v/vt"),
        ("f 1 2 /3", "a corner of a face is v, v/vt"),
        (
            "f 1 2 99999999999999999999",
            "a corner of a face is v, v/vt",
        ),
        ("f 1 2 1.5", "a corner of a face is v, v/vt"),
        ("f 1 2 5", "a face names a vertex that is not there"),
        (
            "f 1 2 4294967297",
            "a face names a vertex that is not there",
        ),
        ("f 0 1 2", "a face names a vertex that is not there"),
        ("f 1 2 -5", "a face names a vertex that is not there"),
        ("v 1 2", "a vertex needs three"),
        ("v 1 2 nan", "a vertex needs three"),
        ("v 1 2 1e999", "a vertex needs three"),
        ("v 1.#QNAN 0 0", "a vertex needs three"),
        ("vt", "a texture coordinate needs"),
        ("vt inf 0", "a texture coordinate needs"),
        ("vn 0 1", "a normal needs three"),
        ("mtllib", "it names no file"),
    ] {
        for place in [0, PLAIN.len()] {
            // Lines that define vertices stand at the end only: they would count.
            if place == 0 && line.starts_with("v ") {
                continue;
            }
            let number = 1 + PLAIN[..place].matches('\n').count();
            let text = format!("{}{line}\n{}", &PLAIN[..place], &PLAIN[place..]);
            let scene = load(&folder, &text);
            same(&scene, &plain);
            says(
                &scene,
                &[&format!("a.obj:{number}: {said}|left out|`{line}`")],
            );
        }
    }
    // A vertex that is left out keeps its number; faces that name it go with it.
    let scene = load(&folder, PLAIN.replace("v 0 1 0", "v 0 1 x"));
    says(
        &scene,
        &[
            "a.obj:4: a vertex needs three",
            "a.obj:6: a face of a vertex that cannot be read",
        ],
    );
    assert_eq!(scene.mesh.triangles[..], plain.mesh.triangles[..1]);
    // Many of a kind are one warning.
    let scene = load(&folder, format!("{PLAIN}{}", "f 1 2\n".repeat(1000)));
    same(&scene, &plain);
    says(
        &scene,
        &["a.obj:7, 8, 9, 10, 11 and 995 more: a face needs three corners"],
    );
    let long = "9".repeat(100_000);
    says(
        &load(&folder, format!("{PLAIN}f 1 2 {long}\n")),
        &["a.obj:7: a corner"],
    );
    says(
        &load(&folder, format!("{PLAIN}{long}\n")),
        &["statements that are not read"],
    );
    // If nothing is left: no triangles, and why.
    let error = folder.refused("none.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\nf 1 2\n");
    assert!(
        error.contains("none.obj:4") && error.contains("no triangle"),
        "{error}"
    );
    let error = folder.refused("none.obj", "v 0 0 0\nl 1 1\n");
    assert!(error.contains("no triangles"), "{error}");
}

#[test]
fn decimal_commas_are_read_and_said() {
    let folder = folder();
    let plain = load(&folder, PLAIN.replace("1 1 0", "1.5 1.25 0"));
    let scene = load(&folder, PLAIN.replace("1 1 0", "1,5 1,25 0"));
    same(&scene, &plain);
    says(&scene, &["a.obj:3, 3: commas in numbers"]);
}

#[test]
fn numbers_of_vertices() {
    let folder = folder();
    let plain = load(&folder, PLAIN);
    let faces = "f 1 2 3\nf 1 3 4\n";
    for text in [
        PLAIN.replace(faces, "f -4 -3 -2\nf -4 -2 -1\n"),
        PLAIN.replace(faces, "f 1/ 2/ 3/\nf 1// 3// 4//\n"),
        PLAIN.replace(faces, "fo 1 2 3\nf +1 3 4\n"),
        PLAIN.replace(faces, "s 1\ng a b\no c\nf 1 2 3\ns off\nf 1 3 4\n"),
        // Faces before their vertices.
        format!("{faces}{}", PLAIN.replace(faces, "")),
    ] {
        let scene = load(&folder, text);
        same(&scene, &plain);
        says(&scene, &[]);
    }
    // Concave: an L keeps its area.
    let scene = load(
        &folder,
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 2 3 4 5 6 1\n",
    );
    let area: f64 = scene
        .mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.vertices.map(|v| scene.mesh.positions[v as usize]);
            (b - a).cross(c - a).z / 2.0
        })
        .sum();
    assert_eq!(area, 3.0);
    let scene = load(&folder, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 3 2 4\n");
    assert!(
        scene.warnings[0]
            .message()
            .contains("a.obj:5: a face crosses itself")
    );
}

#[test]
fn what_is_not_read_is_named() {
    let folder = folder();
    let plain = load(&folder, PLAIN);
    let rest = "l 1 2 3\nl 1 2\np 1\ncstype bezier\ndeg 3\ncurv 0 1 1 2\ncurv2 1 2\nsurf 0 1 0 1 1 2\nparm u 0 1\nend\n\
        vp 0 0\ncall x.obj\ncsh ls\nusemap x\nlod 3\nbevel off\nnonsense\n";
    let scene = load(&folder, format!("{PLAIN}{rest}"));
    same(&scene, &plain);
    let expected = "a.obj: statements|call (1)|csh (1)|cstype (1)|curv (1)|curv2 (1)|deg (1)|end (1)|l (2)|lod (1)|nonsense (1)|p (1)|parm (1)|surf (1)|usemap (1)|vp (1)";
    says(&scene, &[expected]);
    assert!(!scene.warnings[0].message().contains("bevel"));
    let keys = "Ks 1 1 1\nKe 1 0 0\nmap_Ka a\nmap_Ks a\nmap_Bump -bm 1 a\nbump a\nnorm a\ndisp a\ndecal a\nrefl a\nmap_Pr a\nPm 1\n\
        illum 7\nmy_key 5\n";
    let neutral =
        "Ka 1 1 1\nKs 0 0 0\nKe 0 0 0\nNs 10\nNi 1.5\nTf 1 1 1\nillum 2\nPm 0\nsharpness 60\n";
    let scene = with_mtl(&folder, format!("{MTL}{neutral}"));
    says(&scene, &[]);
    let scene = with_mtl(&folder, format!("{MTL}{keys}newmtl other\nKs 1 1 1\n"));
    let expected = "m.mtl: surfaces are Lambertian|Ks (2)|Ke (1)|map_Ka (1)|map_Ks (1)|map_Bump (1)|bump (1)|norm (1)|disp (1)|decal (1)|refl (1)|map_Pr (1)|Pm (1)|illum 3 and above (1)|my_key (1)";
    says(&scene, &[expected]);
}

#[test]
fn time_and_memory_grow_with_the_file() {
    let seconds = |bytes: &[u8]| {
        let started = Instant::now();
        let _ = from_bytes("x/none.obj".as_ref(), bytes);
        started.elapsed()
    };
    let mib = 1 << 20;
    let fill = |unit: &str| {
        let text = unit.repeat(mib / unit.len());
        format!("{PLAIN}vt 0 0\nvn 0 0 1\n{text}\n")
    };
    for text in [
        format!("{PLAIN}f{}\n", " 1".repeat(mib / 2)),
        format!("{PLAIN}f{}\n", " 1 2 3 4".repeat(mib / 8)),
        fill("f 1 2 3 4\n"),
        fill("f 1/1/1 2/1/1 3/1/1 4/1/1\n"),
        fill("f 9 9 9\n"),
        fill("v 0 0\n"),
        fill("vt x\n"),
        fill("v 0 0 0\\\n"),
        fill("\\\n"),
        fill("\n"),
        fill("\r"),
        fill("x"),
        fill("a b\n"),
        fill("#\n"),
        fill("usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"),
        fill("usemtl a\n"),
        (0..mib / 12)
            .map(|i| format!("usemtl {i}\nf 1 2 3\n"))
            .collect::<String>(),
        (0..mib / 24)
            .map(|i| format!("mtllib {i}.mtl {i}\n"))
            .collect::<String>(),
        (0..mib / 8).map(|i| format!("k{i}\n")).collect::<String>(),
        format!("{PLAIN}mtllib{}\n", " a".repeat(mib / 2)),
        format!("{PLAIN}mtllib{}\n", " a.mtl".repeat(mib / 6)),
        format!("{PLAIN}usemtl{}\n", " #".repeat(mib / 2)),
    ] {
        let took = seconds(text.as_bytes());
        assert!(
            took < Duration::from_secs(2),
            "{took:?}: {}",
            &text[..60.min(text.len())]
        );
    }
    let folder = folder();
    for unit in [
        "newmtl m\n",
        "Kd 1 1 1\n",
        "map_Kd -s 1 1 1 -o 0 0 0 tex.png\n",
        "map_Kd -s ",
        "d 0.5\n",
        "k 1\n",
    ] {
        folder.put(
            "m.mtl",
            format!("newmtl m\n{}", unit.repeat(mib / unit.len())),
        );
        let started = Instant::now();
        load(&folder, SQUARE);
        assert!(started.elapsed() < Duration::from_secs(2), "{unit}");
    }
    let many: String = (0..mib / 24)
        .map(|i| format!("newmtl {i}\nmap_Kd {i}.png\n"))
        .collect();
    folder.put("m.mtl", many);
    let started = Instant::now();
    load(&folder, SQUARE);
    assert!(started.elapsed() < Duration::from_secs(2));
}

/// A file with something of everything.
const GOOD: &str = "# a house\nmtllib m.mtl\no house\nv 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0.5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nvn 0 1 0\ng walls\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1 2 3 4\nf -1//2 -2//2 -3//2\nusemtl n\nf 5 2 3\nl 1 2\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_end(bytes in proptest::collection::vec(any::<u8>(), 0..4000)) {
        let _ = from_bytes("none/a.obj".as_ref(), &bytes);
    }

    #[test]
    fn any_text_of_the_format_ends(text in "((v|vt|vn|f|fo|l|usemtl|mtllib|g|#|\\\\\n| )( ?-?[0-9/]{1,6}){0,7}[ \\\\]?[\n\r]{1,2}){0,60}") {
        let _ = from_bytes("none/a.obj".as_ref(), text.as_bytes());
    }

    #[test]
    fn any_materials_end(text in "(newmtl a\n)?((newmtl|Kd|d|Tr|map_Kd|map_d|Ns|illum|x)( (-s|-o|-clamp|on|xyz|tex.png|[0-9.e-]{1,5})){0,6}\n){0,40}") {
        let folder = folder();
        with_mtl(&folder, &text);
    }

    /// Whatever becomes of the words after a keyword: the other lines stand.
    #[test]
    fn a_mutation_loses_its_line(line in 0usize..23, junk in "[ -~]{0,30}") {
        let lines: Vec<&str> = GOOD.lines().collect();
        let keyword = lines[line].split(' ').next().unwrap_or_default();
        prop_assume!(!junk.ends_with('\\'));
        let mut mutated = lines.clone();
        let changed = format!("{keyword} {junk}");
        mutated[line] = &changed;
        let folder = folder();
        let scene = load(&folder, mutated.join("\n"));
        // Faces of which no number changed are there with their places.
        let lost = |face: &str| {
            let own = lines[line] == face;
            let number = lines[..=line].iter().filter(|l| l.starts_with("v ")).count();
            let names = face.split_whitespace().skip(1).any(|corner| {
                let index: i64 = corner.split('/').next().unwrap_or_default().parse().expect("a number");
                keyword == "v" && (if index < 0 { 6 + index } else { index }) == number as i64
            });
            own || names
        };
        let plain = load(&folder, GOOD);
        let faces: Vec<&str> = lines.iter().copied().filter(|l| l.starts_with("f ")).collect();
        let triangles = |scene: &Scene| -> Vec<[DVec3; 3]> {
            scene.mesh.triangles.iter().map(|t| t.vertices.map(|v| scene.mesh.positions[v as usize])).collect()
        };
        let (before, after) = (triangles(&plain), triangles(&scene));
        let mut at = 0;
        for face in faces {
            let count = face.split_whitespace().count() - 3;
            for triangle in &before[at..at + count] {
                prop_assert!(lost(face) || after.contains(triangle), "{} loses {}", changed, face);
            }
            at += count;
        }
    }
}
