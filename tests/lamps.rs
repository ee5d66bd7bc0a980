//! Lamps: what surfaces get of their light, held to closed forms; both backends; what a scene with lamps needs.

mod common;

use common::build::*;
use common::night::*;
use common::shafts;
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Wanted};
use tyndall::conditions::{CameraChoice, Conditions, Request, Sun};
use tyndall::effect::Field;
use tyndall::medium::{Phase, Shape};
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, LampEntry, LampForm, PunctualKind, PunctualLight};
use tyndall::studies::scenes::fog;

#[test]
fn surfaces_get_what_the_inverse_square_and_the_cosine_say() {
    let lamps = vec![
        lamp(dvec3(0.0, 3.0, 0.0), 100.0, Distribution::Isotropic),
        lamp(dvec3(5.0, 2.0, 0.0), 400.0, spot(60.0, 0.3)),
    ];
    let at = dvec3(1.5, 0.0, 0.7);
    let found = received(
        night(&nothing(), lamps.clone()),
        &[(at, DVec3::Y), (at, DVec3::NEG_Y), (at, DVec3::X)],
        Wanted::Reference,
        Field::Lights,
    );
    let of = |lamp: &LampEntry, normal: DVec3| {
        let way = lamp.position - at;
        let theta = (-way).angle_between(DVec3::NEG_Y);
        let shape = lamp.distribution.relative(theta, 0.0);
        lamp.intensity.y * shape * normal.dot(way.normalize()).max(0.0) / way.length_squared()
    };
    for (found, normal) in found.iter().zip([DVec3::Y, DVec3::NEG_Y, DVec3::X]) {
        let exact: f64 = lamps.iter().map(|lamp| of(lamp, normal)).sum();
        assert!(
            (found - exact).abs() <= 1e-6 * exact,
            "{normal}: {found} {exact}"
        );
    }
    assert_eq!(found[1], 0.0);
}

#[test]
fn lines_rectangles_and_spheres_have_their_closed_forms() {
    let of = |form: LampForm, position: DVec3, points: &[(DVec3, DVec3)]| {
        let lamp = LampEntry {
            form,
            ..lamp(position, 50.0, Distribution::Isotropic)
        };
        let scene = night(&nothing(), vec![lamp]);
        received(scene, points, Wanted::Reference, Field::Lights)
    };
    // A line above and along the x axis: E = I h / l integral dx / (x^2 + h^2)^(3/2).
    let h = 2.0;
    let found = of(
        LampForm::Line {
            to: dvec3(4.0, h, 0.0),
        },
        dvec3(-1.0, h, 0.0),
        &[(DVec3::ZERO, DVec3::Y)],
    )[0];
    let part = |x: f64| x / (h * (x * x + h * h).sqrt());
    let exact = 50.0 / 5.0 * (part(4.0) - part(-1.0));
    assert!((found / exact - 1.0).abs() < 1e-3, "line {found} {exact}");
    // A rectangle of even intensity above a parallel plane: its solid angle times I / A.
    let found = of(
        LampForm::Rectangle {
            edges: [dvec3(2.0, 0.0, 0.0), dvec3(0.0, 0.0, 1.0)],
        },
        dvec3(-1.0, h, -0.5),
        &[
            (DVec3::ZERO, DVec3::Y),
            (dvec3(0.0, 4.0, 0.0), DVec3::NEG_Y),
        ],
    );
    let (a, b) = (1.0f64, 0.5f64);
    let solid = 4.0 * (a * b / (h * (h * h + a * a + b * b).sqrt())).atan();
    let exact = 50.0 / 2.0 * solid;
    assert!(
        (found[0] / exact - 1.0).abs() < 1e-3,
        "rectangle {} {exact}",
        found[0]
    );
    assert_eq!(found[1], 0.0, "it shines on one side");
    // A sphere, however near: I / d^2.
    for distance in [0.51, 0.7, 3.0, 200.0] {
        let at = dvec3(0.0, h - distance, 0.0);
        let form = LampForm::Sphere { radius: 0.5 };
        let found = of(form, dvec3(0.0, h, 0.0), &[(at, DVec3::Y)])[0];
        let exact = 50.0 / (distance * distance);
        assert!(
            (found / exact - 1.0).abs() < 2e-3,
            "sphere {distance}: {found} {exact}"
        );
    }
}

#[test]
fn a_spot_of_a_gltf_shines_as_its_extension_says() {
    let mut scene = night(&nothing(), Vec::new());
    let (inner, outer) = (20.0 * DEG, 35.0 * DEG);
    scene.lights = vec![
        PunctualLight {
            name: "spot".into(),
            color: DVec3::splat(300.0),
            position: dvec3(0.0, 2.0, 0.0),
            direction: DVec3::NEG_Y,
            kind: PunctualKind::Spot { inner, outer },
        },
        PunctualLight {
            name: "sun".into(),
            color: DVec3::splat(1e5),
            position: DVec3::ZERO,
            direction: DVec3::NEG_Y,
            kind: PunctualKind::Directional,
        },
    ];
    let angles = [0.0, 19.0, 25.0, 30.0, 34.0, 36.0].map(|a: f64| a * DEG);
    let points = angles.map(|a| (dvec3(2.0 * a.tan(), 0.0, 0.0), DVec3::Y));
    let found = received(scene.clone(), &points, Wanted::Reference, Field::Lights);
    for (angle, found) in angles.iter().zip(found) {
        let scale = 1.0 / (inner.cos() - outer.cos()).max(1e-3);
        let fall = (angle.cos() * scale - outer.cos() * scale)
            .clamp(0.0, 1.0)
            .powi(2);
        let distance = 2.0 / angle.cos();
        let exact = 300.0 * fall * angle.cos() / (distance * distance);
        assert!(
            (found - exact).abs() <= 1e-6 * exact,
            "{angle}: {found} {exact}"
        );
    }
    // The directional one is named as unused, the spot is not.
    let seen = conditions(
        scene,
        Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0),
        [8, 8],
    );
    let said: Vec<String> = seen.warnings.iter().map(|w| w.to_string()).collect();
    let unused = said.iter().find(|text| text.contains("not used"));
    let unused = unused.expect("there is a warning");
    assert!(
        unused.contains("`sun`") && !unused.contains("`spot`"),
        "{unused}"
    );
}

#[test]
fn a_scene_with_lamps_needs_no_sun() {
    let lamps = vec![lamp(dvec3(0.0, 2.0, 0.0), 10.0, Distribution::Isotropic)];
    let seen = conditions(
        night(&nothing(), lamps),
        Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0),
        [8, 8],
    );
    assert_eq!(seen.sun, Sun::ABSENT);
    assert_eq!(seen.sun.missing(), Some("the scene has no sun"));
    let request = Request {
        camera: CameraChoice::Given(seen.view.camera),
        ..Request::default()
    };
    // Without lamps it does, and a place alone is still a place without a time.
    assert!(Conditions::new(night(&nothing(), Vec::new()), &request).is_err());
    // With lamps, one half of place and time is still not enough to know where the sun is.
    let mut half = night(
        &nothing(),
        vec![lamp(DVec3::Y, 1.0, Distribution::Isotropic)],
    );
    half.time = Some("2026-06-21T10:00:00Z".into());
    assert!(Conditions::new(half, &request).is_err());
}

#[test]
fn a_device_shows_the_same_lamps() {
    if !common::gpu("a_device_shows_the_same_lamps") {
        return;
    }
    let lamps = vec![
        lamp(dvec3(0.2, 2.2, -0.1), 100.0, spot(70.0, 0.25)),
        LampEntry {
            form: LampForm::Sphere { radius: 0.2 },
            ..lamp(dvec3(-1.0, 1.0, 1.0), 30.0, Distribution::Isotropic)
        },
    ];
    let mut scene = night(&posts(), lamps);
    scene.media = vec![box_of_fog(4.0, 0.1, 0.03, Phase::Isotropic)];
    let camera = Camera::look_at(dvec3(0.6, 1.7, 8.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG);
    let seen = conditions(scene, camera, [48, 32]);
    let of = |gpu: bool, field: Field| {
        let plan = Plan::new(&seen, &Overrules::default()).expect("the plan is sound");
        let frame = match gpu {
            true => shafts::gpu().render(&plan, &Limits::default(), &|_| {}),
            false => Reference::new(&plan)
                .expect("it can be prepared")
                .render(&Limits::default(), &|_| {}),
        };
        layer(&frame.expect("it can be rendered").frame, field)
    };
    for field in [Field::Lights, Field::InscatterLights, Field::Indirect] {
        let off = relative_rmse(&of(true, field), &of(false, field));
        eprintln!("{}: {:.4} %", field.name(), 100.0 * off);
        // f32 on the device; and both divide the sphere until its parts differ by 0.5 %, at places of their own.
        assert!(off < 1e-3, "{}: {off}", field.name());
    }
}

#[test]
fn a_closed_sphere_sends_back_what_its_albedo_says() {
    // An isotropic lamp in its middle gives I / R^2 everywhere; all further reflections add r / (1 - r) of that.
    let r: f64 = 2.0;
    let (around, down) = (24, 12);
    let at = |i: usize, j: usize| {
        let (theta, phi) = (
            PI * j as f64 / down as f64,
            2.0 * PI * i as f64 / around as f64,
        );
        r * dvec3(
            theta.sin() * phi.cos(),
            theta.cos(),
            theta.sin() * phi.sin(),
        )
    };
    let mut triangles = Vec::new();
    for j in 0..down {
        for i in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if j > 0 {
                triangles.push([a, b, c]);
            }
            if j + 1 < down {
                triangles.push([a, c, d]);
            }
        }
    }
    let scene = night(
        &triangles,
        vec![lamp(DVec3::ZERO, 80.0, Distribution::Isotropic)],
    );
    // Polygons lie inside the sphere: their mean distance counts, and points near the wall.
    let points: Vec<(DVec3, DVec3)> = (0..6)
        .map(|k| {
            let inward = -at(3 * k + 1, 2 + k).normalize();
            (-1.8 * inward, inward)
        })
        .collect();
    let direct = received(scene.clone(), &points, Wanted::Reference, Field::Lights);
    let indirect = received(scene, &points, Wanted::Reference, Field::Indirect);
    for (direct, indirect) in direct.iter().zip(&indirect) {
        assert!((direct - 80.0 / 3.24).abs() < 1e-3, "{direct}");
        // The walls have an albedo of a half: as much again as they receive, at their distance.
        let walls = 80.0 / (r * r);
        assert!((indirect / walls - 1.0).abs() < 0.03, "{indirect} {walls}");
    }
}

#[test]
fn its_own_housing_does_not_shade_a_lamp_that_ignores_it() {
    let mut triangles = cuboid(dvec3(-5.0, -0.2, -5.0), dvec3(5.0, 0.0, 5.0));
    let floor = triangles.len();
    triangles.extend(cuboid(dvec3(-0.2, 1.9, -0.2), dvec3(0.2, 2.3, 0.2)));
    let at = [(dvec3(1.0, 0.01, 0.3), DVec3::Y)];
    let of = |ignore: Option<&str>| {
        let lamp = LampEntry {
            ignore: ignore.map(str::to_owned),
            ..lamp(dvec3(0.0, 2.1, 0.0), 100.0, Distribution::Isotropic)
        };
        let mut scene = night(&triangles, vec![lamp]);
        scene.materials.push(tyndall::scene::Material {
            name: "housing".into(),
            ..material(0.5)
        });
        for triangle in &mut scene.mesh.triangles[floor..] {
            triangle.material = 1;
        }
        scene
    };
    let lit = received(of(Some("housing")), &at, Wanted::Reference, Field::Lights)[0];
    let dark = received(of(None), &at, Wanted::Reference, Field::Lights)[0];
    assert!(lit > 10.0 && dark == 0.0, "{lit} {dark}");
    let request = Request::default();
    let error = Conditions::new(of(Some("hosing")), &request)
        .err()
        .expect("there is none of that name");
    assert!(
        error.to_string().contains("did you mean `housing`?"),
        "{error}"
    );
}

#[test]
fn a_sphere_is_seen_as_bright_as_it_is_through_the_air() {
    let lamp = LampEntry {
        form: LampForm::Sphere { radius: 0.5 },
        ..lamp(dvec3(0.0, 0.0, -4.0), 100.0, Distribution::Isotropic)
    };
    let mut scene = night(&nothing(), vec![lamp]);
    scene.media = vec![box_of_fog(100.0, 0.0, 0.2, Phase::Isotropic)];
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 40.0 * DEG);
    let frame = rendered(&conditions(scene, camera, [33, 33]), Quality::High, &[]);
    let lights = layer(&frame, Field::Lights);
    let middle = lights[16 * 33 + 16].y;
    let exact = 100.0 / (PI * 0.25) * (-0.2f64 * 3.5).exp();
    assert!((middle / exact - 1.0).abs() < 1e-6, "{middle} {exact}");
    assert_eq!(lights[0].y, 0.0);
}

#[test]
fn what_stands_behind_dark_air_comes_through_it_in_every_layer() {
    // A plate of air that only takes light right before the eye: all layers lose the same.
    let mut triangles = cuboid(dvec3(-3.0, -0.2, -6.0), dvec3(3.0, 0.0, 0.0));
    triangles.extend(cuboid(dvec3(-3.0, 0.0, -6.2), dvec3(3.0, 3.0, -6.0)));
    let lamp = lamp(dvec3(0.0, 2.0, -3.0), 1e5, Distribution::Isotropic);
    let eye = dvec3(0.0, 1.5, 3.0);
    let plate = fog(
        Shape::Box {
            min: eye - dvec3(0.05, 0.05, 0.02),
            max: eye + dvec3(0.05, 0.05, -0.01),
        },
        0.0,
        80.0,
        Phase::Isotropic,
    );
    let mut clear = scene(&triangles, 150.0, 40.0);
    clear.sun = clear.sun.map(|mut sun| {
        sun.illuminance = None;
        sun
    });
    clear.lamps = vec![lamp];
    let mut dark = clear.clone();
    dark.media = vec![plate];
    let camera = Camera::look_at(eye, dvec3(0.0, 1.0, -6.0), 40.0 * DEG);
    let [clear, dark] = [clear, dark]
        .map(|scene| rendered(&conditions(scene, camera, [16, 12]), Quality::Preview, &[]));
    let through: Vec<DVec3> = dark.transmittance.iter().map(|t| t.as_dvec3()).collect();
    for field in [Field::Sun, Field::Sky, Field::Indirect, Field::Lights] {
        let expected: Vec<DVec3> = layer(&clear, field)
            .iter()
            .zip(&through)
            .map(|(l, t)| *l * *t)
            .collect();
        let sum: f64 = expected.iter().map(|v| v.y).sum();
        assert!(sum > 0.0, "{}", field.name());
        let off = relative_rmse(&layer(&dark, field), &expected);
        assert!(off < 0.01, "{}: {off}", field.name());
    }
    assert!(through.iter().all(|t| t.y < 0.6));
}

#[test]
fn the_ground_stops_the_light_of_a_lamp_under_it() {
    let mut scene = night(
        &cuboid(dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 2.0, 1.0)),
        vec![
            lamp(dvec3(0.0, -1.0, 0.0), 1e4, Distribution::Isotropic),
            lamp(dvec3(0.0, 0.0, 3.0), 0.0, Distribution::Isotropic),
        ],
    );
    scene.media = vec![box_of_fog(50.0, 0.05, 0.0, Phase::Isotropic)];
    let of = |ground: bool| {
        let mut scene = scene.clone();
        scene.ground.enabled = ground;
        let camera = Camera::look_at(dvec3(0.0, 0.5, 8.0), dvec3(0.0, 1.0, 0.0), 50.0 * DEG);
        let seen = conditions(scene, camera, [8, 6]);
        let frame = rendered_without(&["air_sky"], &seen, Quality::Preview, &[]);
        let sum = |field| layer(&frame, field).iter().map(|v| v.y).sum::<f64>();
        let said: Vec<String> = seen.warnings.iter().map(|w| w.to_string()).collect();
        let lit = sum(Field::Lights) + sum(Field::InscatterLights) + sum(Field::Indirect);
        (lit, said.join("; "))
    };
    let (open, said) = of(false);
    assert!(open > 0.0 && said.contains("its intensity is 0"), "{said}");
    let (covered, said) = of(true);
    assert_eq!(covered, 0.0);
    assert!(said.contains("it lies under the ground"), "{said}");
}

#[test]
fn a_lamp_that_is_shut_in_is_warned_of() {
    let mut triangles = cuboid(dvec3(-5.0, -0.2, -5.0), dvec3(5.0, 0.0, 5.0));
    triangles.extend(cuboid(dvec3(-0.1, 1.9, -0.1), dvec3(0.1, 2.1, 0.1)));
    let said = |y: f64| {
        let lamps = vec![lamp(dvec3(0.0, y, 0.0), 10.0, spot(40.0, 0.2))];
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
        let seen = conditions(night(&triangles, lamps), camera, [8, 8]);
        let said: Vec<String> = seen.warnings.iter().map(|w| w.to_string()).collect();
        said.join("; ")
    };
    assert!(
        said(2.0).contains("meets a surface right beside it"),
        "{}",
        said(2.0)
    );
    assert!(!said(1.8).contains("little or no light"), "{}", said(1.8));
}

#[test]
fn a_narrow_beam_lights_the_room_that_its_spot_is_in() {
    // A beam of 2 degrees on the floor of a closed room: at first look few points of the floor lie in it.
    let triangles = cuboid(dvec3(-2.0, 0.0, -2.0), dvec3(2.0, 3.0, 2.0));
    let beam = LampEntry {
        toward: dvec3(0.3, -1.0, 0.2),
        ..lamp(dvec3(0.0, 2.9, 0.0), 1e4, spot(2.0, 1.0))
    };
    let points: Vec<(DVec3, DVec3)> = [(1.9, 1.0), (-1.5, 1.5), (0.3, 2.0)]
        .map(|(x, y)| (dvec3(x, y, 0.2), DVec3::NEG_Y))
        .to_vec();
    let found = received(
        night(&triangles, vec![beam]),
        &points,
        Wanted::Reference,
        Field::Indirect,
    );
    // Of an albedo of a half as much again is sent on as the floor gets: its mean over all walls.
    let flux = 1e4 * 2.0 * PI * (1.0 - (2.0 * DEG).cos());
    let mean = flux / (2.0 * (4.0 * 4.0 + 2.0 * 4.0 * 3.0));
    for found in found {
        assert!(found > 0.1 * mean && found < 10.0 * mean, "{found} {mean}");
    }
}
