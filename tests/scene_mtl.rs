//! MTL files as people have them: each gives the materials of its plain equivalent, or says what it lacks.

mod common;

use common::obj::*;
use glam::{DVec2, DVec3};
use tyndall::scene::{AlphaMode, Scene, Wrap};

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
        ("map_Kd -s 2 2 2", "cannot read|2: "),
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
        assert!(color.distance(rgb) < 1e-3, "{color}");
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
            "m.mtl:4, 6: a key without a value",
            "m.mtl:5, 8: it needs one number",
            "left out, with how often: |d -halo (1)",
        ],
    );
}

#[test]
fn opacity_arrives() {
    let folder = folder();
    let mtl = |text: &str| with_mtl(&folder, format!("newmtl m\nKd 1 1 1\n{text}\n"));
    let cases: [(&str, f64, AlphaMode, &[&str]); 14] = [
        ("d 0.99", 0.99, AlphaMode::Blend, &[]),
        ("d 0.99\nmap_Kd tex.png", 0.99, AlphaMode::Blend, &[]),
        ("d 1", 1.0, AlphaMode::Opaque, &[]),
        ("Tr 0.25", 0.75, AlphaMode::Blend, &[]),
        ("Tr 0\nd 1", 1.0, AlphaMode::Opaque, &[]),
        ("d 0.3\nTr 0.7", 0.3, AlphaMode::Blend, &[]),
        (
            "Tr 1\nd 1",
            1.0,
            AlphaMode::Opaque,
            &["m.mtl:1: d and Tr disagree|`m`"],
        ),
        (
            "d 0.4\nTr 0.4",
            0.4,
            AlphaMode::Blend,
            &["m.mtl:1: d and Tr disagree"],
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
            &["m.mtl:1: a material that nothing is seen of|`m`"],
        ),
        ("d -halo 0.5", 0.5, AlphaMode::Blend, &["d -halo (1)"]),
        ("map_Kd leaf.png", 1.0, AlphaMode::Blend, &[]),
        ("map_Kd tex.png", 1.0, AlphaMode::Opaque, &[]),
        ("d 0.5\nTf 0.5 1 1", 0.5, AlphaMode::Blend, &["Tf (1)"]),
    ];
    for (text, alpha, mode, said) in cases {
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
        "/data/nowhere/tex.png",
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
