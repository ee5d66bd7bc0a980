//! Surfaces that are there in part: what alpha means, and how much light a pane lets through.

mod common;

use common::build::*;
use common::files::{Folder, glb};
use common::shafts;
use glam::{DVec2, DVec3, DVec4};
use serde_json::json;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{AlphaMode, Camera, Geometry, Material, Ray, Scene, Texture, Wrap};
use tyndall::studies::scenes::fog;
use tyndall::warning::Warning;

/// A floor at height 0, 4 m wide and half black, and above it a roof at each height, 2 m wide; roofs have the second material.
fn roofs(heights: &[f64], roof: Material) -> Scene {
    let flat = |y: f64, half: f64| {
        quad(
            DVec3::new(-half, y, -half),
            DVec3::Z * 2.0 * half,
            DVec3::X * 2.0 * half,
        )
    };
    let mut triangles = flat(0.0, 2.0).to_vec();
    for height in heights {
        triangles.extend(flat(*height, 1.0));
    }
    let mut scene = scene(&triangles, 150.0, 60.0);
    scene.materials.push(roof);
    for triangle in &mut scene.mesh.triangles[2..] {
        triangle.material = 1;
    }
    let corner = [
        DVec2::ZERO,
        DVec2::Y,
        DVec2::X,
        DVec2::Y,
        DVec2::ONE,
        DVec2::X,
    ];
    let count = scene.mesh.positions.len() / 6;
    scene.mesh.uvs = (0..count).flat_map(|_| corner).collect();
    scene
}

fn blend(alpha: f64) -> Material {
    Material {
        name: "pane".into(),
        alpha,
        alpha_mode: AlphaMode::Blend,
        ..material(0.5)
    }
}

fn opaque() -> Material {
    Material {
        name: "pane".into(),
        ..material(0.5)
    }
}

fn above() -> Camera {
    Camera::look_at(DVec3::new(0.3, 6.0, 4.0), DVec3::ZERO, 0.9)
}

fn foggy(mut scene: Scene) -> Scene {
    scene.media = vec![fog(Shape::Haze { top: 5.0 }, 0.05, 0.0, Phase::Isotropic)];
    scene
}

fn seen(scene: Scene, samples: u32) -> Conditions {
    let request = Request {
        size: Some([48, 36]),
        samples: Some(samples),
        camera: CameraChoice::Given(above()),
        ..Request::default()
    };
    Conditions::new(scene, &request).expect("the scene is sound")
}

fn texture(alpha: impl Fn(u32, u32) -> u8) -> Texture {
    Texture {
        name: "alpha".into(),
        width: 16,
        height: 16,
        pixels: (0..256)
            .map(|i| [255, 255, 255, alpha(i % 16, i / 16)])
            .collect(),
        wrap: [Wrap::Clamp; 2],
    }
}

/// A disc of alpha `greatest` on nothing.
fn disc(greatest: u8) -> Texture {
    texture(|x, y| {
        let (x, y) = (f64::from(x) - 7.5, f64::from(y) - 7.5);
        if x * x + y * y < 36.0 { greatest } else { 0 }
    })
}

fn textured(mut scene: Scene, texture: Texture) -> Scene {
    scene.textures = vec![texture];
    scene.materials[1].texture = Some(0);
    scene
}

/// Pictures of both backends.
fn both(conditions: &Conditions) -> [Frame; 2] {
    let overrules = Overrules {
        quality: Quality::High,
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    [render(conditions), shafts::render(&plan).frame]
}

fn same_pictures(a: &Conditions, b: &Conditions) {
    for (a, b) in both(a).iter().zip(&both(b)) {
        assert_eq!(a.layers.len(), b.layers.len());
        for (a, b) in a.layers.iter().zip(&b.layers) {
            // What of a patch is there is found by 64 points where alpha may cut holes, so that its light by way of surfaces differs.
            let by_surfaces = [Field::Indirect, Field::InscatterSky].map(Field::name);
            let allowed = if by_surfaces.contains(&a.name) {
                1.5e-2
            } else {
                0.0
            };
            let wide = |rgb: &[glam::Vec3]| rgb.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>();
            let off = match a.rgb == b.rgb {
                true => 0.0,
                false => relative_rmse(&wide(&a.rgb), &wide(&b.rgb)),
            };
            assert!(off <= allowed, "{}: {off:.1e}", a.name);
        }
    }
}

/// The same light, but for what rounding and the fit of shadow maps to the bounds of a scene may move.
fn same_light(a: &Conditions, b: &Conditions) {
    let (a, b) = (render(a), render(b));
    for (a, b) in a.layers.iter().zip(&b.layers) {
        if a.name == Field::InscatterSky.name() {
            // Where the air's places lie goes by the bounds, which count what is not there.
            let wide = |rgb: &[glam::Vec3]| rgb.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>();
            let off = relative_rmse(&wide(&a.rgb), &wide(&b.rgb));
            assert!(off < 2e-2, "{}: {off:.1e}", a.name);
            continue;
        }
        let off = |(a, b): &(&glam::Vec3, &glam::Vec3)| a.distance(**b) > 1e-5 * b.length();
        assert_eq!(
            a.rgb.iter().zip(&b.rgb).filter(off).count(),
            0,
            "{}",
            a.name
        );
    }
}

fn warnings(conditions: &Conditions) -> String {
    // The scenes of these tests have a height of a ground that is not there.
    let lines = conditions.warnings.iter();
    let lines = lines.filter(|warning| !matches!(warning, Warning::UnusedGround { .. }));
    let lines: Vec<String> = lines.map(Warning::message).collect();
    lines.join("\n")
}

#[test]
fn a_blended_roof_of_alpha_one_is_an_opaque_roof() {
    let plain = seen(foggy(roofs(&[1.0], opaque())), 1);
    same_pictures(&seen(foggy(roofs(&[1.0], blend(1.0))), 1), &plain);
    let white = || texture(|_, _| 255);
    let textured_blend = seen(foggy(textured(roofs(&[1.0], blend(1.0)), white())), 1);
    let textured_plain = seen(foggy(textured(roofs(&[1.0], opaque()), white())), 1);
    same_pictures(&textured_blend, &textured_plain);
    assert_eq!(warnings(&textured_blend), "");
    // Vertices of alpha 1 change nothing either.
    let mut colored = roofs(&[1.0], blend(1.0));
    colored.mesh.colors = vec![DVec4::ONE; colored.mesh.positions.len()];
    same_pictures(&seen(foggy(colored), 1), &plain);
}

#[test]
fn a_blended_leaf_is_a_masked_leaf() {
    let mask = Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..opaque()
    };
    let masked = seen(foggy(textured(roofs(&[1.0], mask), disc(255))), 1);
    let blended = seen(foggy(textured(roofs(&[1.0], blend(1.0)), disc(255))), 1);
    same_pictures(&blended, &masked);
    assert_eq!(warnings(&blended), "");
    // Half of its greatest alpha cuts, whatever that is: the outline is the same, and the solid part is a pane.
    let faint = Geometry::new(&textured(roofs(&[1.0], blend(1.0)), disc(102)));
    let whole = Geometry::new(&textured(roofs(&[1.0], blend(1.0)), disc(255)));
    for i in 0..1000 {
        let at = DVec3::new(
            f64::from(i % 40) / 20.0 - 0.99,
            2.0,
            f64::from(i / 40) / 13.0 - 0.95,
        );
        let down = Ray {
            origin: at,
            direction: DVec3::NEG_Y,
        };
        let through = |geometry: &Geometry| geometry.transmittance(&down, 0.0, 1.5).y;
        let (faint, whole) = (through(&faint), through(&whole));
        assert!(
            (faint - (0.6 + 0.4 * whole)).abs() < 1e-12,
            "{at}: {faint} {whole}"
        );
    }
}

#[test]
fn the_alpha_of_vertices_counts() {
    let mask = || Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..opaque()
    };
    let with = |alpha: fn(usize) -> f64, material: Material| {
        let mut scene = roofs(&[1.0], material);
        let colors = (0..scene.mesh.positions.len()).map(|i| DVec3::ONE.extend(alpha(i)));
        scene.mesh.colors = colors.collect();
        scene
    };
    // Alpha 0: nothing is there, and it is said.
    let gone = seen(foggy(with(|i| if i < 6 { 1.0 } else { 0.0 }, mask())), 1);
    same_light(&gone, &seen(foggy(roofs(&[], mask())), 1));
    assert!(
        warnings(&gone).contains("`pane` (its 2 triangles are not there)"),
        "{}",
        warnings(&gone)
    );
    // From 1 on one side to 0 on the other the roof ends in the middle: it is a roof of half the size.
    let faded = seen(
        foggy(with(
            |i| {
                if i < 6 || [0, 1, 3].contains(&(i % 6)) {
                    1.0
                } else {
                    0.0
                }
            },
            mask(),
        )),
        1,
    );
    let mut half = roofs(&[1.0], opaque());
    for p in &mut half.mesh.positions[6..] {
        p.x = p.x.min(0.0);
    }
    let half = seen(foggy(half), 1);
    let (faded, half) = (render(&faded), render(&half));
    for field in [Field::Sun, Field::InscatterSun] {
        let (a, b) = (layer(&faded, field), layer(&half, field));
        let off = a
            .iter()
            .zip(&b)
            .filter(|(a, b)| a.distance(**b) > 1e-4 * b.length() + 1e-6);
        // Pixels whose rays pass the edge within rounding.
        assert!(off.count() <= 2, "{field:?}");
    }
    // A pane whose vertices all say 0.5 is half there.
    let half_there = Geometry::new(&with(|_| 0.5, blend(1.0)));
    let down = Ray {
        origin: DVec3::new(0.2, 2.0, 0.1),
        direction: DVec3::NEG_Y,
    };
    assert_eq!(half_there.transmittance(&down, 0.0, 1.5), DVec3::splat(0.5));
}

#[test]
fn panes_let_their_share_of_sunlight_through_to_the_floor() {
    let sun_of = |scene: Scene| layer(&render(&seen(scene, 1)), Field::Sun);
    // Nothing but the floor is in the picture: the roofs are far above the camera, and wide enough to shade all of it.
    let heights = [20.0, 21.0];
    let open = sun_of(roofs(&[], opaque()));
    let wide = |heights: &[f64], material: Material| {
        let mut scene = roofs(heights, material);
        for p in &mut scene.mesh.positions[6..] {
            p.x *= 100.0;
            p.z *= 100.0;
        }
        scene
    };
    for (heights, alpha, share) in [
        (&heights[..1], 0.5, 0.5),
        (&heights[..], 0.5, 0.25),
        (&heights[..1], 0.99, 0.01),
        (&heights[..1], 0.125, 0.875),
    ] {
        let found = sun_of(wide(heights, blend(alpha)));
        for (found, open) in found.iter().zip(&open) {
            assert!(
                (*found - share * *open).length() < 1e-6 * open.length() + 1e-12,
                "{alpha}"
            );
        }
    }
    // Each edge of triangles is met once, also by rays that meet it exactly; a pane drawn twice is one.
    let geometry = Geometry::new(&roofs(&[1.0, 1.0], blend(0.5)));
    for i in -9..=9 {
        let x = f64::from(i) / 10.0;
        let down = Ray {
            origin: DVec3::new(x, 2.0, -x),
            direction: DVec3::NEG_Y,
        };
        assert_eq!(
            geometry.transmittance(&down, 0.0, 1.5),
            DVec3::splat(0.5),
            "{x}"
        );
    }
}

#[test]
fn behind_a_half_pane_the_air_is_half_as_bright() {
    // A roof that shades all that is seen.
    let under = |material: Material| {
        let mut scene = roofs(&[4.9], material);
        for p in &mut scene.mesh.positions[6..] {
            p.x *= 200.0;
            p.z *= 200.0;
        }
        scene
    };
    let below = |scene: Scene| {
        let mut conditions = seen(foggy(scene), 1);
        conditions.view.camera = Camera::look_at(DVec3::new(0.3, 3.0, 4.0), DVec3::ZERO, 0.9);
        layer(&render(&conditions), Field::InscatterSun)
    };
    let lit = below(roofs(&[], opaque()));
    for alpha in [0.5, 0.99] {
        let half = below(under(blend(alpha)));
        for (half, lit) in half.iter().zip(&lit) {
            assert!(
                (*half - (1.0 - alpha) * *lit).length() < 1e-6 * lit.length(),
                "{half} {lit}"
            );
        }
    }
    // Part of the rays in shade: what is missing behind a pane of alpha a is a times what is missing behind a roof.
    let air = |material: Material, heights: &[f64]| {
        let mut conditions = seen(foggy(roofs(heights, material)), 1);
        conditions.view.camera =
            Camera::look_at(DVec3::new(4.0, 0.4, 0.0), DVec3::new(0.0, 0.4, 0.0), 0.3);
        layer(&render(&conditions), Field::InscatterSun)
    };
    let (open, roof, pane) = (
        air(opaque(), &[]),
        air(opaque(), &[1.5]),
        air(blend(0.25), &[1.5]),
    );
    let mut shaded = 0;
    for ((open, roof), pane) in open.iter().zip(&roof).zip(&pane) {
        shaded += usize::from(open.x > 1.01 * roof.x);
        let right = *open - 0.25 * (*open - *roof);
        assert!(
            (*pane - right).length() < 1e-5 * right.length(),
            "{pane} {right}"
        );
    }
    assert!(shaded > 500, "{shaded}");
}

#[test]
fn through_a_pane_the_picture_is_the_mean_of_both() {
    let samples = 64;
    let alpha = 0.3;
    let with = |material: Material, heights: &[f64]| seen(roofs(heights, material), samples);
    let pane = with(blend(alpha), &[0.5]);
    let [reference, gpu] = both(&pane);
    let open = layer(&render(&with(opaque(), &[])), Field::Sun);
    let roof = layer(&render(&with(opaque(), &[0.5])), Field::Sun);
    // In the middle of the picture: the pane's own light, and the floor's through the pane, which is shaded by it.
    let middle = 18 * 48 + 24;
    let right = alpha * roof[middle] + (1.0 - alpha) * (1.0 - alpha) * open[middle];
    for frame in [&reference, &gpu] {
        let found = layer(frame, Field::Sun)[middle];
        assert!(
            (found - right).length() < 3.0 / f64::from(samples) * right.length(),
            "{found} {right}"
        );
    }
    // Both backends choose alike.
    let (a, b) = (layer(&reference, Field::Sun), layer(&gpu, Field::Sun));
    let mean = |values: &[DVec3]| values.iter().map(|v| v.x).sum::<f64>() / values.len() as f64;
    assert!(
        (mean(&a) / mean(&b) - 1.0).abs() < 2e-3,
        "{} {}",
        mean(&a),
        mean(&b)
    );
    let same = a
        .iter()
        .zip(&b)
        .filter(|(a, b)| a.distance(**b) < 1e-3 * a.length() + 1e-6);
    assert!(same.count() * 10 > 9 * a.len());
    assert!(
        warnings(&pane).contains("let a part of the light through"),
        "{}",
        warnings(&pane)
    );
}

#[test]
fn sky_light_comes_through_a_pane_by_its_share() {
    // A closed box of panes around a point: all light passes one of them.
    let inside = |material: Material, walls: bool| {
        let mut triangles =
            quad(DVec3::new(-0.1, 0.0, -0.1), DVec3::Z * 0.2, DVec3::X * 0.2).to_vec();
        if walls {
            triangles.extend(cuboid(
                DVec3::new(-2.0, -1.0, -2.0),
                DVec3::new(2.0, 2.0, 2.0),
            ));
        } else {
            // The same bounds, out of sight.
            triangles.extend(quad(
                DVec3::new(-2.0, -1.0, -2.0),
                DVec3::X * 4.0,
                DVec3::Z * 1e-3,
            ));
            triangles.extend(quad(
                DVec3::new(2.0, -0.9, 2.0),
                DVec3::X * -1e-3,
                DVec3::Z * -1e-3,
            ));
        }
        let mut scene = scene(&triangles, 150.0, 60.0);
        scene.materials.push(material);
        for triangle in &mut scene.mesh.triangles[2..] {
            triangle.material = 1;
        }
        scene.sky.model = Some("cie:5".into());
        let request = Request {
            size: Some([8, 8]),
            camera: CameraChoice::Given(Camera::look_at(
                DVec3::new(0.0, 1.0, 0.01),
                DVec3::ZERO,
                0.1,
            )),
            ..Request::default()
        };
        let conditions = Conditions::new(scene, &request).expect("the scene is sound");
        layer(&render(&conditions), Field::Sky)[27].x
    };
    let (open, half) = (inside(opaque(), false), inside(blend(0.5), true));
    assert!(
        open > 0.0 && (half / open - 0.5).abs() < 1e-3,
        "{half} {open}"
    );
}

#[test]
fn what_is_not_there_or_fades_is_said() {
    let nothing = seen(roofs(&[1.0], blend(0.0)), 1);
    assert!(
        warnings(&nothing).contains("wholly see-through: `pane` (its 2 triangles are not there)")
    );
    same_light(&nothing, &seen(roofs(&[], blend(0.0)), 1));
    let gradient = textured(roofs(&[1.0], blend(1.0)), texture(|x, _| (17 * x) as u8));
    assert!(warnings(&seen(gradient, 1)).contains("cut at half of its greatest: `pane`"));
    // Nor does one go unsaid that is nowhere less than half.
    let faint = textured(
        roofs(&[1.0], blend(1.0)),
        texture(|x, _| 135 + (8 * x) as u8),
    );
    assert!(warnings(&seen(faint, 1)).contains("cut at half of its greatest: `pane`"));
    // A soft outline is no gradient.
    assert_eq!(
        warnings(&seen(textured(roofs(&[1.0], blend(1.0)), disc(255)), 1)),
        ""
    );
    // A list of names ends somewhere.
    let mut many = roofs(&[1.0; 20], blend(0.0));
    many.materials = (0..41).map(|_| blend(0.0)).collect();
    for (i, triangle) in many.mesh.triangles.iter_mut().enumerate() {
        triangle.material = i as u32 % 41;
    }
    many.materials[0] = opaque();
    assert!(warnings(&seen(many, 1)).ends_with("and 32 more"));
    // A material that nothing has is not spoken of.
    let mut unused = roofs(&[], opaque());
    unused.materials.push(blend(0.0));
    unused.materials.push(blend(0.5));
    assert_eq!(warnings(&seen(unused, 1)), "");
}

#[test]
fn a_gpu_leaves_sunlight_through_panes_to_the_reference() {
    let conditions = seen(foggy(roofs(&[1.0], blend(0.5))), 1);
    let plan = Plan::new(&conditions, &Overrules::default()).expect("the plan is sound");
    let step = |plan: &Plan, name: &str| {
        let found = plan.steps.iter().find(|step| step.effect.name == name);
        found.expect("it is in the plan").clone()
    };
    for name in ["surface_sun", "shafts_rectified"] {
        assert!(step(&plan, name).is_by_reference(&conditions), "{name}");
        assert!(
            step(&plan, name)
                .decision
                .reason
                .contains("by the reference")
        );
    }
    let rendered = shafts::render(&plan);
    let sun = rendered
        .steps
        .iter()
        .find(|s| s.effect.name == "surface_sun");
    assert!(sun.is_some_and(|s| s.on_cpu && s.pass == "reference"));
    // What it makes is what the reference makes: the surfaces alone differ, by the rasteriser's rounding.
    let truth = render_at(&conditions, Quality::Preview, &[]);
    let (a, b) = (
        layer(&truth, Field::InscatterSun),
        layer(&rendered.frame, Field::InscatterSun),
    );
    assert!(relative_rmse(&b, &a) < 1e-4, "{}", relative_rmse(&b, &a));
    // Leaves alone stay on the device.
    let leaves = seen(foggy(textured(roofs(&[1.0], blend(1.0)), disc(255))), 1);
    let plan = Plan::new(&leaves, &Overrules::default()).expect("the plan is sound");
    assert!(!step(&plan, "surface_sun").is_by_reference(&leaves));
}

/// What a ray through the middle of a loaded scene's upper quad lets through.
fn through_the_quad(scene: &Scene) -> f64 {
    let ray = Ray {
        origin: DVec3::new(0.3, 0.6, 1.0),
        direction: DVec3::NEG_Z,
    };
    Geometry::new(scene).transmittance(&ray, 0.0, 2.0).y
}

#[test]
fn dissolve_of_an_obj_is_opacity() {
    let folder = Folder::new();
    for (line, through) in [
        ("d 0.99", 0.01),
        ("d 1", 0.0),
        ("d 0.25", 0.75),
        ("d 0", 1.0),
    ] {
        folder.put("pane.mtl", format!("newmtl pane\nKd 0.5 0.5 0.5\n{line}\n"));
        let obj = "mtllib pane.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl pane\nf 1 2 3 4\n";
        let scene = folder.load("pane.obj", obj).expect("it loads");
        let found = through_the_quad(&scene);
        assert!((found - through).abs() < 1e-6, "{line}: {found}");
        let said = Geometry::new(&scene).warnings().len();
        assert_eq!(said, usize::from(through > 0.0), "{line}");
    }
}

#[test]
fn alpha_of_a_gltf_means_what_its_mode_says() {
    let quad = |mode: &str, factor: f64, color: [u8; 4]| {
        let mut bin: Vec<u8> = [
            0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0,
        ]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
        (0..4).for_each(|_| bin.extend(color));
        bin.extend([0u8, 1, 2, 0, 2, 3]);
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true},
                {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": 48},
                {"buffer": 0, "byteOffset": 48, "byteLength": 16},
                {"buffer": 0, "byteOffset": 64, "byteLength": 6},
            ],
            "buffers": [{"byteLength": bin.len()}],
            "materials": [{"name": "pane", "alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, factor]}}],
        });
        let folder = Folder::new();
        let scene = folder.load("quad.glb", glb(&json, &bin)).expect("it loads");
        through_the_quad(&scene)
    };
    let white = [255, 255, 255, 255];
    let clear = [255, 255, 255, 0];
    let half = [255, 255, 255, 102];
    for (mode, factor, color, through) in [
        ("BLEND", 1.0, white, 0.0),
        ("BLEND", 0.5, white, 0.5),
        ("BLEND", 0.5, half, 0.8),
        ("BLEND", 1.0, clear, 1.0),
        ("MASK", 1.0, white, 0.0),
        ("MASK", 1.0, clear, 1.0),
        ("MASK", 1.0, half, 1.0),
        ("MASK", 0.4, white, 1.0),
        ("OPAQUE", 0.1, clear, 0.0),
    ] {
        let found = quad(mode, factor, color);
        assert!(
            (found - through).abs() < 1e-6,
            "{mode} {factor} {color:?}: {found}"
        );
    }
}
