//! Surfaces that shine: what they look like, what they light, and what files say of them.

mod common;

use common::build::*;
use common::files::Folder;
use common::gltf::Gltf;
use common::night::*;
use glam::{DAffine2, DVec3, dvec3};
use serde_json::json;
use std::f64::consts::PI;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::{Conditions, Receiver, View};
use tyndall::effect::Field;
use tyndall::medium::Phase;
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Emission, LampEntry, LampForm, Scene, SiteEntry, Texture, Wrap};
use tyndall::studies::scenes::Corners;

/// Triangles of a parallelogram, whose front is where `u` turns to `v` counter-clockwise.
fn panel(corner: DVec3, u: DVec3, v: DVec3) -> Vec<Corners> {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    vec![[a, b, c], [a, c, d]]
}

/// Dark triangles, and others that shine.
fn glowing(dark: &[Corners], shining: &[Corners], luminance: DVec3) -> Scene {
    let all: Vec<Corners> = dark.iter().chain(shining).copied().collect();
    let mut scene = night(&all, Vec::new());
    let shines = tyndall::scene::Material {
        name: "sign".into(),
        ..material(0.5)
    };
    scene.materials.push(shines);
    for triangle in &mut scene.mesh.triangles[dark.len()..] {
        triangle.material = 1;
    }
    scene.emissions.insert(1, Emission::plain(luminance));
    scene
}

fn seen(scene: Scene) -> Conditions {
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
    conditions(scene, camera, [8, 8])
}

/// What points that face a direction receive in a layer [lx, RGB].
fn received(scene: &Scene, points: &[(DVec3, DVec3)], wanted: Wanted, field: Field) -> Vec<DVec3> {
    let receivers = points
        .iter()
        .map(|(p, n)| Receiver::new(*p, *n).expect("it is sound"));
    let view = View::of_points(receivers.collect::<Vec<_>>());
    let seen = seen(scene.clone())
        .seen_from(view)
        .expect("points are sound");
    let overrules = match field {
        Field::Lights => Overrules {
            quality: Quality::High,
            without: vec!["radiosity".into()],
            ..Overrules::default()
        },
        _ => Overrules {
            set: LEAST
                .iter()
                .filter(|(k, _)| k.starts_with("radiosity"))
                .map(|(k, v)| (k.to_string(), *v))
                .collect(),
            ..Overrules::default()
        },
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    let mut backend = Backend::open(wanted).expect("there is one");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it can be rendered").frame;
    let found = frame.layer(field.name());
    let at = |i: usize| found.map_or(DVec3::ZERO, |layer| layer.rgb[i].as_dvec3());
    (0..points.len()).map(at).collect()
}

/// Lambert's formula: E = L / 2 sum of theta_i (Gamma_i . n), for a polygon wholly above the plane.
fn lambert(polygon: &[DVec3], luminance: f64, at: DVec3, normal: DVec3) -> f64 {
    let ways: Vec<DVec3> = polygon.iter().map(|p| (*p - at).normalize()).collect();
    let sum: f64 = (0..ways.len())
        .map(|i| {
            let (a, b) = (ways[i], ways[(i + 1) % ways.len()]);
            a.angle_between(b) * a.cross(b).normalize().dot(normal)
        })
        .sum();
    (0.5 * luminance * sum).abs()
}

fn assert_near(found: f64, expected: f64, share: f64, what: &str) {
    let off = (found / expected - 1.0).abs();
    assert!(
        off <= share,
        "{what}: {found} instead of {expected} ({off:.5})"
    );
}

#[test]
fn a_panel_lights_planes_as_lamberts_formula_says() {
    // 2 m x 1 m at a height of 3 m, looking down.
    let (corner, u, v) = (
        dvec3(-1.0, 3.0, 0.5),
        dvec3(0.0, 0.0, -1.0),
        dvec3(2.0, 0.0, 0.0),
    );
    let polygon = [corner, corner + u, corner + u + v, corner + v];
    let fine: Vec<Corners> = (0..12 * 6)
        .flat_map(|k| {
            let (i, j) = (f64::from(k % 12), f64::from(k / 12));
            panel(corner + j / 6.0 * u + i / 12.0 * v, u / 6.0, v / 12.0)
        })
        .collect();
    let places = [
        (dvec3(0.0, 0.0, 0.0), DVec3::Y),
        (dvec3(1.7, 1.0, -0.8), DVec3::Y),
        (dvec3(0.3, 2.9, 0.1), DVec3::Y),
        (dvec3(2.0, 1.5, 0.2), DVec3::NEG_X),
        (dvec3(40.0, 1.0, 3.0), DVec3::NEG_X),
        (dvec3(-1.5, 0.4, 2.0), dvec3(1.0, 2.0, -1.0).normalize()),
    ];
    for (what, triangles) in [
        ("two triangles", panel(corner, u, v)),
        ("one triangle", vec![[polygon[0], polygon[1], polygon[2]]]),
        ("144 triangles", fine),
    ] {
        let polygon = &polygon[..if triangles.len() == 1 { 3 } else { 4 }];
        let scene = glowing(&nothing(), &triangles, DVec3::splat(1000.0));
        let found = received(&scene, &places, Wanted::Reference, Field::Lights);
        for ((at, normal), found) in places.iter().zip(found) {
            let expected = lambert(polygon, 1000.0, *at, *normal);
            assert_near(found.y, expected, 2e-3, &format!("{what} at {at}"));
        }
        // Behind it there is nothing.
        let behind = received(
            &scene,
            &[(dvec3(0.0, 4.0, 0.0), DVec3::NEG_Y)],
            Wanted::Reference,
            Field::Lights,
        );
        assert_eq!(behind[0], DVec3::ZERO);
    }
}

#[test]
fn a_panel_is_a_rectangle_whose_intensity_goes_with_the_cosine() {
    let triangles = posts();
    let (corner, u, v) = (
        dvec3(-0.5, 2.4, 0.4),
        dvec3(0.0, 0.0, -0.8),
        dvec3(1.0, 0.0, 0.0),
    );
    let sign = glowing(
        &triangles,
        &panel(corner, u, v),
        DVec3::new(500.0, 400.0, 100.0),
    );
    let cosine = spot(90.0, 0.0);
    let lamp = LampEntry {
        intensity: DVec3::new(500.0, 400.0, 100.0) * 0.8,
        form: LampForm::Rectangle { edges: [u, v] },
        ..lamp(corner - dvec3(0.0, 1e-6, 0.0), 1.0, cosine)
    };
    let mut plain = sign.clone();
    plain.emissions.clear();
    plain.lamps = vec![lamp];
    let points: Vec<(DVec3, DVec3)> = (0..60)
        .map(|k| {
            let (z, x) = (2.4 * f64::from(k)).sin_cos();
            (
                0.06 * f64::from(k + 10) * dvec3(x, 0.0, z) + 1e-3 * DVec3::Y,
                DVec3::Y,
            )
        })
        .collect();
    for field in [Field::Lights, Field::Indirect] {
        let [a, b] =
            [&sign, &plain].map(|scene| received(scene, &points, Wanted::Reference, field));
        let most = b.iter().map(|b| b.y).fold(0.0, f64::max);
        let off = a
            .iter()
            .zip(&b)
            .map(|(a, b)| (a.y - b.y).powi(2))
            .sum::<f64>()
            / points.len() as f64;
        assert!(
            most > 0.0 && off.sqrt() < 5e-3 * most,
            "{}: {} of {most}",
            field.name(),
            off.sqrt()
        );
    }
}

/// A texture of 4 x 2 texels, each of another colour.
fn picture() -> Texture {
    let texel = |k: u8| {
        [
            20 * k + 60,
            255 - 25 * k,
            if k.is_multiple_of(2) { 255 } else { 0 },
            255,
        ]
    };
    Texture {
        name: "sign".into(),
        width: 4,
        height: 2,
        pixels: (0..8).map(texel).collect(),
        wrap: [Wrap::Clamp; 2],
    }
}

fn linear(texel: [u8; 4]) -> DVec3 {
    let decode = |c: u8| {
        let v = f64::from(c) / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    dvec3(decode(texel[0]), decode(texel[1]), decode(texel[2]))
}

#[test]
fn a_picture_shines_texel_by_texel_and_lights_by_its_mean() {
    // 4 m x 2 m, facing +Z.
    let mut scene = glowing(
        &nothing(),
        &panel(
            dvec3(-2.0, -1.0, 0.0),
            dvec3(4.0, 0.0, 0.0),
            dvec3(0.0, 2.0, 0.0),
        ),
        DVec3::splat(300.0),
    );
    let first = scene.mesh.positions.len() - 6;
    for (position, uv) in scene.mesh.positions[first..]
        .iter()
        .zip(&mut scene.mesh.uvs[first..])
    {
        *uv = glam::dvec2(0.25 * (position.x + 2.0), 0.5 * (1.0 - position.y));
    }
    scene.textures.push(picture());
    scene.emissions.insert(
        1,
        Emission {
            texture: Some(0),
            uvs: DAffine2::IDENTITY,
            ..Emission::plain(DVec3::splat(300.0))
        },
    );
    // The materials of the texels are those of Rec. 709; the picture's space is the working one.
    let to_working = tyndall::colour::Space::Rec709.to_working();
    let mut camera = Camera::look_at(dvec3(0.0, 0.0, 10.0), DVec3::ZERO, 1.0);
    camera.projection = tyndall::scene::Projection::Orthographic { height: 2.0 };
    let frame = rendered(
        &conditions(scene.clone(), camera, [16, 8]),
        Quality::High,
        &[],
    );
    let lights = layer(&frame, Field::Lights);
    let texels = picture().pixels;
    for (i, found) in lights.iter().enumerate() {
        let (x, y) = (i % 16 / 4, i / 16 / 4);
        let expected = 300.0 * (to_working * linear(texels[4 * y + x]));
        assert!(
            (*found - expected).abs().max_element() < 1e-3 * 300.0,
            "{i}: {found} {expected}"
        );
    }
    let mean = texels.iter().map(|t| linear(*t)).sum::<DVec3>() / 8.0;
    let far = [(dvec3(0.0, 0.0, 60.0), DVec3::NEG_Z)];
    let found = received(&scene, &far, Wanted::Reference, Field::Lights)[0];
    let polygon = [
        dvec3(-2.0, -1.0, 0.0),
        dvec3(2.0, -1.0, 0.0),
        dvec3(2.0, 1.0, 0.0),
        dvec3(-2.0, 1.0, 0.0),
    ];
    let unit = lambert(&polygon, 300.0, far[0].0, far[0].1);
    let expected = unit * (to_working * mean);
    for k in 0..3 {
        assert_near(found[k], expected[k], 2e-3, "the mean");
    }
}

#[test]
fn inside_a_box_that_shines_all_over_every_place_gets_pi_times_its_luminance() {
    // Cuboids look outward: mirrored, they look inward.
    let inward: Vec<Corners> = cuboid(dvec3(-1.0, 0.0, -2.0), dvec3(1.5, 2.0, 1.0))
        .into_iter()
        .map(|[a, b, c]| [a, c, b])
        .collect();
    let scene = glowing(&[], &inward, DVec3::splat(100.0));
    let scene = Scene {
        materials: vec![material(0.5), material(0.5)],
        ..scene
    };
    let points = [
        (dvec3(0.2, 1.0, 0.1), DVec3::Y),
        (dvec3(1.4, 0.1, -1.9), DVec3::X),
        (dvec3(0.0, 1e-3, 0.0), dvec3(0.6, 0.8, 0.0)),
    ];
    let direct = received(&scene, &points, Wanted::Reference, Field::Lights);
    let indirect = received(&scene, &points, Wanted::Reference, Field::Indirect);
    for (direct, indirect) in direct.iter().zip(indirect) {
        assert_near(direct.y, 100.0 * PI, 5e-3, "direct");
        // Of an albedo of a half as much is sent back, of all orders together.
        assert_near(indirect.y, 100.0 * PI, 2e-2, "indirect");
    }
}

#[test]
fn a_lit_box_takes_up_what_its_ceiling_sends_out() {
    let inward: Vec<Corners> = cuboid(dvec3(0.0, 0.0, 0.0), dvec3(2.0, 2.0, 2.0))
        .into_iter()
        .map(|[a, b, c]| [a, c, b])
        .collect();
    let sign = panel(
        dvec3(0.5, 1.9, 0.5),
        dvec3(1.0, 0.0, 0.0),
        dvec3(0.0, 0.0, 1.0),
    );
    let scene = glowing(&inward, &sign, DVec3::splat(100.0));
    let mut points = Vec::new();
    const N: usize = 6;
    for (axis, side) in [(0, 0.0), (0, 2.0), (1, 0.0), (1, 2.0), (2, 0.0), (2, 2.0)] {
        for k in 0..N * N {
            let at = |i: usize| 2.0 * (i as f64 + 0.5) / N as f64;
            let mut p = [0.0; 3];
            p[axis] = side + if side > 0.0 { -1e-4 } else { 1e-4 };
            p[(axis + 1) % 3] = at(k % N);
            p[(axis + 2) % 3] = at(k / N);
            let mut n = [0.0; 3];
            n[axis] = if side > 0.0 { -1.0 } else { 1.0 };
            points.push((DVec3::from_array(p), DVec3::from_array(n)));
        }
    }
    let sum = |field| {
        received(&scene, &points, Wanted::Reference, field)
            .iter()
            .map(|v| v.y)
            .sum::<f64>()
    };
    let area = 4.0 / (N * N) as f64;
    let direct = area * sum(Field::Lights);
    // All of pi L A but what the back of the sign would get.
    assert_near(direct, 100.0 * PI, 1e-2, "direct");
}

#[test]
fn air_glows_beside_a_sign_as_a_sum_over_its_points_says() {
    let (corner, u, v) = (
        dvec3(-1.0, 0.5, 0.0),
        dvec3(2.0, 0.0, 0.0),
        dvec3(0.0, 1.0, 0.0),
    );
    let mut scene = glowing(&nothing(), &panel(corner, u, v), DVec3::splat(1000.0));
    let (half, scattering, absorption) = (5.0, 0.1, 0.05);
    scene.media = vec![box_of_fog(half, scattering, absorption, Phase::Isotropic)];
    let camera = Camera::look_at(dvec3(4.5, 1.5, 3.0), dvec3(-1.5, 0.8, 0.9), 50.0 * DEG);
    let seen = conditions(scene, camera, [8, 6]);
    for (quality, set, least) in [
        (Quality::High, &[][..], 0.01),
        (Quality::Preview, &[][..], 0.05),
    ] {
        let frame = rendered_without(&["air_sky", "radiosity"], &seen, quality, set);
        let found = layer(&frame, Field::InscatterLights);
        let view = &seen.view;
        let mut pairs = Vec::new();
        for (i, found) in found.iter().enumerate() {
            let ray = view.ray(glam::dvec2((i % 8) as f64 + 0.5, (i / 8) as f64 + 0.5));
            let hit = seen.geometry.closest(&ray, 0.0, f64::INFINITY);
            let end = hit.map_or(12.0, |hit| hit.distance.min(12.0));
            let inside = |p: DVec3| p.abs().max_element() < half;
            const STEPS: usize = 400;
            let mut sum = 0.0;
            for k in 0..STEPS {
                let t = end * (k as f64 + 0.5) / STEPS as f64;
                let p = ray.at(t);
                if !inside(p) || p.z <= 0.0 {
                    continue;
                }
                for j in 0..1600 {
                    let q = corner
                        + (f64::from(j % 40) + 0.5) / 40.0 * u
                        + (f64::from(j / 40) + 0.5) / 40.0 * v;
                    let d2 = p.distance_squared(q);
                    let cosine = p.z / d2.sqrt();
                    let tau = (scattering + absorption) * (t + d2.sqrt());
                    sum += 1000.0 * cosine / d2 * (2.0 / 1600.0) * scattering / (4.0 * PI)
                        * (-tau).exp()
                        * end
                        / STEPS as f64;
                }
            }
            pairs.push((found.y, sum));
        }
        let mean = pairs.iter().map(|(_, t)| t).sum::<f64>() / pairs.len() as f64;
        let square = pairs.iter().map(|(f, t)| (f - t).powi(2)).sum::<f64>() / pairs.len() as f64;
        eprintln!("{}: {:.4} RMSE", quality.name(), square.sqrt() / mean);
        assert!(
            mean > 0.0 && square.sqrt() < least * mean,
            "{} {mean}",
            square.sqrt()
        );
    }
}

#[test]
fn both_backends_agree() {
    if !common::gpu("both_backends_agree") {
        return;
    }
    let sign = panel(
        dvec3(-0.5, 1.0, -1.0),
        dvec3(1.0, 0.0, 0.0),
        dvec3(0.0, 1.0, 0.0),
    );
    let mut scene = glowing(&posts(), &sign, dvec3(800.0, 300.0, 50.0));
    scene.media = vec![box_of_fog(6.0, 0.05, 0.0, Phase::Isotropic)];
    let camera = Camera::look_at(dvec3(0.6, 1.7, 6.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG);
    let seen = conditions(scene, camera, [32, 20]);
    let overrules = Overrules {
        without: vec!["radiosity".into(), "air_sky".into()],
        ..Overrules::default()
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    let [a, b] = [Wanted::Reference, Wanted::Gpu].map(|wanted| {
        let mut backend = Backend::open(wanted).expect("there is one");
        let rendered = backend.render(&plan, &Limits::default(), &|_| {});
        rendered.expect("it can be rendered").frame
    });
    for field in [Field::Lights, Field::InscatterLights] {
        let off = relative_rmse(&layer(&b, field), &layer(&a, field));
        assert!(off < 1e-3, "{}: {off}", field.name());
    }
}

/// A glTF sheet of 1 m x 2 m with a material.
fn sheet(material: serde_json::Value) -> Gltf {
    let mut file = Gltf::quad();
    file.json["materials"][0] = material;
    file
}

#[test]
fn gltf_says_how_bright_a_material_is() {
    let strong = json!({"emissiveFactor": [1, 0.5, 0], "doubleSided": true,
        "pbrMetallicRoughness": {"metallicFactor": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 250}}});
    let scene = sheet(strong.clone()).load().expect("it loads");
    let emission = &scene.emissions[&0];
    assert_eq!(emission.luminance, dvec3(250.0, 125.0, 0.0));
    assert!(emission.both_sides && emission.texture.is_none());
    assert!(
        !scene
            .warnings
            .iter()
            .any(|w| w.to_string().contains("emiss")),
        "{:?}",
        scene.warnings
    );
    let plain = sheet(json!({"emissiveFactor": [1, 1, 1]}))
        .load()
        .expect("it loads");
    assert_eq!(plain.emissions[&0], Emission::plain(DVec3::ONE));
    let none = sheet(json!({"emissiveFactor": [0, 0, 0]}))
        .load()
        .expect("it loads");
    assert!(none.emissions.is_empty());

    // A node of twice the size sends out four times as much.
    let flux = |scale: f64| {
        let mut file = sheet(strong.clone());
        file.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
        let seen = seen(file.load().expect("it loads"));
        seen.lamps.iter().map(|lamp| lamp.flux()).sum::<f64>()
    };
    assert_near(flux(2.0), 4.0 * flux(1.0), 1e-9, "flux of a scaled node");

    let odd = |strength: f64| {
        let mut material = strong.clone();
        material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] =
            json!(strength);
        let scene = sheet(material).load().expect("it loads");
        scene
            .warnings
            .iter()
            .map(|w| w.to_string())
            .collect::<Vec<_>>()
            .join("; ")
    };
    assert!(
        odd(-2.0).contains("emissiveStrength is -2; held at 0 cd/m2"),
        "{}",
        odd(-2.0)
    );
    assert!(odd(1e12).contains("held at 1e9 cd/m2"), "{}", odd(1e12));
}

#[test]
fn a_doublesided_material_shines_on_both_sides_and_another_on_its_front() {
    let sign = panel(
        dvec3(-0.5, -0.5, 0.0),
        dvec3(1.0, 0.0, 0.0),
        dvec3(0.0, 1.0, 0.0),
    );
    let mut scene = glowing(&nothing(), &sign, DVec3::splat(100.0));
    let before = |scene: &Scene, z: f64| {
        let camera = Camera::look_at(dvec3(0.0, 0.0, z), DVec3::ZERO, 0.1);
        let frame = rendered(
            &conditions(scene.clone(), camera, [2, 2]),
            Quality::High,
            &[],
        );
        layer(&frame, Field::Lights)[0].y
    };
    assert_near(before(&scene, 3.0), 100.0, 1e-6, "front");
    assert_eq!(before(&scene, -3.0), 0.0);
    scene.emissions.insert(
        1,
        Emission {
            both_sides: true,
            ..Emission::plain(DVec3::splat(100.0))
        },
    );
    assert_near(before(&scene, -3.0), 100.0, 1e-6, "back");
    let points = [
        (dvec3(0.3, 0.0, 2.0), DVec3::NEG_Z),
        (dvec3(0.3, 0.0, -2.0), DVec3::Z),
    ];
    let found = received(&scene, &points, Wanted::Reference, Field::Lights);
    assert_near(found[0].y, found[1].y, 1e-6, "both sides");
}

#[test]
fn ke_is_in_candela_per_square_metre() {
    let folder = Folder::new();
    folder.put(
        "sign.mtl",
        "newmtl red\nKd 0.2 0.2 0.2\nKe 300 20 10\nnewmtl grey\nKd 0.5 0.5 0.5\nKe 0 0 0\n",
    );
    let text = "mtllib sign.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 9 -9 -9\nusemtl red\nf 1 2 3 4\nusemtl grey\nf 1 2 5\n";
    let scene = folder.load("sign.obj", text).expect("it loads");
    assert_eq!(scene.emissions.len(), 1);
    assert_eq!(scene.emissions[&0].luminance, dvec3(300.0, 20.0, 10.0));
    assert!(
        !scene.warnings.iter().any(|w| w.to_string().contains("Ke")),
        "{:?}",
        scene.warnings
    );
    assert!(scene.has_lamps());
    let points = [(dvec3(1.0, 0.5, 8.0), DVec3::NEG_Z)];
    let polygon = [
        dvec3(0.0, 0.0, 0.0),
        dvec3(2.0, 0.0, 0.0),
        dvec3(2.0, 1.0, 0.0),
        dvec3(0.0, 1.0, 0.0),
    ];
    let found = received(&scene, &points, Wanted::Reference, Field::Lights)[0];
    let to_working = tyndall::colour::Space::Rec709.to_working();
    let luminance = (to_working * dvec3(300.0, 20.0, 10.0)).y;
    assert_near(
        found.y,
        lambert(&polygon, luminance, points[0].0, DVec3::NEG_Z),
        2e-3,
        "Ke",
    );
}

#[test]
fn a_faint_surface_costs_nothing_by_day_and_shines_at_night() {
    let sign = panel(
        dvec3(-0.5, -0.5, 0.0),
        dvec3(1.0, 0.0, 0.0),
        dvec3(0.0, 1.0, 0.0),
    );
    let night = glowing(&nothing(), &sign, DVec3::ONE);
    let mut day = night.clone();
    day.sun = scene(&nothing(), 150.0, 40.0).sun;
    let day = seen(day);
    assert!(day.lamps.is_empty());
    let said: Vec<String> = day.warnings.iter().map(|w| w.to_string()).collect();
    assert!(
        said.iter()
            .any(|w| w.contains("emission of at most 1 cd/m2 is little beside")),
        "{said:?}"
    );
    let plan = Plan::new(&day, &Overrules::default()).expect("the plan is sound");
    for name in ["emission", "surface_lamps", "air_lamps"] {
        assert!(
            !plan.running().any(|step| step.effect.name == name),
            "{name}"
        );
    }
    let dark = seen(night);
    assert_eq!(dark.lamps.len(), 1);
    assert!(
        !dark
            .warnings
            .iter()
            .any(|w| w.to_string().contains("emission"))
    );
}

#[test]
fn a_ball_of_thousands_of_triangles_lights_as_a_ball() {
    // E = pi L (r / d)^2 facing it; of N sides around its projected area is less by about (2 pi / N)^2 / 6.
    let (n, r) = (64, 0.5);
    let at = |i: usize, j: usize| {
        let (sin, cos) = (PI * i as f64 / n as f64).sin_cos();
        let (s, c) = (2.0 * PI * j as f64 / (2 * n) as f64).sin_cos();
        r * dvec3(sin * c, cos, -sin * s)
    };
    let mut ball = Vec::new();
    for i in 0..n {
        for j in 0..2 * n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            ball.extend(
                [[a, b, c], [a, c, d]]
                    .into_iter()
                    .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 1e-9),
            );
        }
    }
    let scene = glowing(&nothing(), &ball, DVec3::splat(1000.0));
    for d in [0.6, 1.0, 3.0, 30.0] {
        let way = dvec3(0.3, 0.5, 0.8).normalize();
        let found = received(&scene, &[(d * way, -way)], Wanted::Reference, Field::Lights)[0];
        assert_near(
            found.y,
            1000.0 * PI * (r / d).powi(2),
            5e-3,
            &format!("at {d} m"),
        );
    }
    assert_near(
        seen(scene).lamps[0].flux(),
        1000.0 * PI * 4.0 * PI * r * r,
        2e-3,
        "flux",
    );
}

/// A room with a sign in it in a place where the sun shines, seen at noon; its wall of +Z is there or not.
fn room_with_a_sign(is_shut: bool, luminance: f64) -> Conditions {
    let mut room = cuboid(dvec3(-2.0, 0.0, -2.0), dvec3(2.0, 3.0, 2.0));
    room.retain(|corners| is_shut || !corners.iter().all(|corner| corner.z == 2.0));
    let sign = panel(dvec3(-0.5, 1.2, -1.9), DVec3::X, DVec3::Y);
    let mut scene = glowing(&room, &sign, DVec3::splat(luminance));
    scene.site = Some(SiteEntry {
        latitude_deg: 47.0,
        longitude_deg: 4.0,
        elevation: 0.0,
        timezone: Some("UTC".into()),
    });
    scene.time = Some("2026-06-21T12:00".into());
    let camera = Camera::look_at(dvec3(0.0, 1.5, 1.5), dvec3(0.0, 1.5, 0.0), 1.0);
    conditions(scene, camera, [8, 8])
}

/// What a backend shows of a field.
fn shown(backend: &mut Backend, seen: &Conditions, field: Field) -> Vec<DVec3> {
    let overrules = Overrules {
        set: LEAST.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(seen, &overrules).expect("the plan is sound");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it can be rendered").frame;
    layer(&frame, field)
}

#[test]
fn a_sign_that_was_lost_by_day_lights_its_room_by_night() {
    let noon = room_with_a_sign(false, 0.5);
    let is_said = |w: &tyndall::Warning| w.message().contains("is little beside");
    assert!(noon.lamps.is_empty() && noon.warnings.iter().any(is_said));
    let night = noon.at("2026-06-21T23:59").expect("the time is sound");
    assert_eq!(night.lamps.len(), 1);
    let mut kept = Backend::open(Wanted::Reference).expect("there is one");
    shown(&mut kept, &noon, Field::Indirect);
    let mut fresh = Backend::open(Wanted::Reference).expect("there is one");
    let found = shown(&mut kept, &night, Field::Indirect);
    assert!(found.iter().any(|v| v.y > 0.0));
    assert_eq!(found, shown(&mut fresh, &night, Field::Indirect));
}

/// Without a window noon is as dark as midnight, and the faintest sign is all there is to see by.
#[test]
fn a_faint_sign_in_a_room_without_windows_is_the_same_at_noon() {
    let noon = room_with_a_sign(true, 1e-3);
    assert_eq!(noon.lamps.len(), 1);
    assert_near(noon.least_luminance(), 1e-6, 1e-9, "beside itself");
    let night = noon.at("2026-06-21T23:59").expect("the time is sound");
    let mut backend = Backend::open(Wanted::Reference).expect("there is one");
    let mut of = |seen: &Conditions| shown(&mut backend, seen, Field::Lights);
    let (by_day, by_night) = (of(&noon), of(&night));
    assert_eq!(by_day, by_night);
    // The sign itself, and walls before it that it lights.
    let brightest = by_day.iter().map(|v| v.y).fold(0.0, f64::max);
    assert_near(brightest, 1e-3, 1e-4, "the sign");
    let is_lit = |v: &&DVec3| v.y > 0.0 && v.y < 0.5 * brightest;
    assert!(by_day.iter().filter(is_lit).count() > 8, "{by_day:?}");
}

#[test]
fn glass_that_shines_is_named_and_gives_no_light() {
    let sign = panel(dvec3(-0.5, 1.2, -1.9), DVec3::X, DVec3::Y);
    let mut scene = glowing(&nothing(), &sign, DVec3::splat(500.0));
    assert!(scene.has_lamps());
    scene.materials[1].pane = Some(tyndall::scene::Pane::CLEAR);
    assert!(!scene.has_lamps());
    let lamp = lamp(dvec3(0.0, 3.0, 0.0), 10.0, Distribution::Isotropic);
    scene.lamps = vec![lamp];
    let seen = seen(scene);
    assert_eq!(seen.lamps.len(), 1);
    let is_said = |w: &tyndall::Warning| w.message().contains("lets light through and shines");
    assert!(seen.warnings.iter().any(is_said), "{:?}", seen.warnings);
}

#[test]
fn many_faces_that_look_all_ways_are_told_by_few() {
    // 20 000 leaves turned all ways within a ball, far away and near by: as much light as each by itself, without a part for each.
    let golden = |i: u32, k: f64| (f64::from(i) * k).fract();
    let leaf = |i: u32| {
        let at = dvec3(golden(i, 0.618), golden(i, 0.7549), golden(i, 0.5698)) - 0.5;
        let u = dvec3(golden(i, 0.414), golden(i, 0.732), golden(i, 0.236)) - 0.5;
        let v = u.any_orthonormal_vector();
        [at, at + 0.01 * u.normalize(), at + 0.01 * v]
    };
    let leaves: Vec<Corners> = (0..20_000).map(leaf).collect();
    let luminance = 1e4;
    let scene = glowing(&nothing(), &leaves, DVec3::splat(luminance));
    let points = [
        (dvec3(0.0, -40.0, 0.0), DVec3::Y),
        (dvec3(2.0, 0.3, 0.0), DVec3::NEG_X),
    ];
    let of = |[a, b, c]: &Corners, (point, normal): (DVec3, DVec3)| {
        let across = 0.5 * (*b - *a).cross(*c - *a);
        let way = (*a + *b + *c) / 3.0 - point;
        let toward = way.normalize();
        luminance * (-across.dot(toward)).max(0.0) * normal.dot(toward).max(0.0)
            / way.length_squared()
    };
    let found = received(&scene, &points, Wanted::Reference, Field::Lights);
    for (found, point) in found.iter().zip(points) {
        // Nothing in the way: leaves cover a few percent of each other.
        let all: f64 = leaves.iter().map(|leaf| of(leaf, point)).sum();
        println!("{:?}: {found} {all}", point.0);
        assert!(found.y < 1.02 * all && found.y > 0.6 * all, "{found} {all}");
    }
}
