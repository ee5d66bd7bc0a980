//! OBJ files as people have them: each is the same scene as its plain equivalent, or says what it lacks.

mod common;

use common::obj::*;
use glam::{DVec3, DVec4};
use tyndall::scene::{AlphaMode, Scene};

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
    folder.put("m.mtl", format!("{MTL}newmtl bare\nKd 1 1 1\n"));
    let text = format!("{SQUARE}usemtl bare\nf 1 2 3\n");
    let equal = load(&folder, text);
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
    says(&scene, &["a.obj:3: commas in numbers"]);
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
            .contains("a.obj:5: a face that crosses itself")
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
    let expected = "m.mtl: surfaces are Lambertian|Ks (2)|map_Ka (1)|map_Ks (1)|map_Bump (1)|bump (1)|norm (1)|disp (1)|decal (1)|refl (1)|map_Pr (1)|Pm (1)|illum 3 and above (1)|my_key (1)";
    says(&scene, &[expected]);
}

#[test]
fn a_normal_without_a_length_is_said() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nf 1//1 2//1 3//1\n";
    let scene =
        tyndall::scene::from_bytes("x/none.obj".as_ref(), text.as_bytes()).expect("it loads");
    let said = |w: &tyndall::Warning| w.message().contains("a normal without a length");
    assert!(scene.warnings.iter().any(said), "{:?}", scene.warnings);
}

#[test]
fn vertices_beyond_what_numbers_tell_apart_are_refused() {
    let text = |far: f64| format!("v 0 0 0\nv {far} 0 0\nv 0 {far} 0\nf 1 2 3\n");
    let load = |far| tyndall::scene::from_bytes("x/none.obj".as_ref(), text(far).as_bytes());
    assert!(load(1e12).is_ok());
    let error = load(1e20).expect_err("it is too far away").to_string();
    assert!(error.contains("1e12 m from the origin"), "{error}");
    // A vertex that no triangle has stands nowhere.
    let spare = format!("{}v 1e20 0 0\n", text(1.0));
    assert!(tyndall::scene::from_bytes("x/none.obj".as_ref(), spare.as_bytes()).is_ok());
}
