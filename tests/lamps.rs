//! Lamps: what surfaces and the air get of their light, held to closed forms and to sums over many shadow rays.

mod common;

use common::build::*;
use common::shafts;
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::{CameraChoice, Conditions, Receiver, Request, Sun, View};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::photometry::{Distribution, Pose};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, LampEntry, LampForm, PunctualKind, PunctualLight, Ray, Scene};
use tyndall::studies::scenes::{Corners, fog};

const DEG: f64 = PI / 180.0;

fn lamp(position: DVec3, candela: f64, distribution: Distribution) -> LampEntry {
    LampEntry {
        name: "lamp".into(),
        position,
        toward: DVec3::NEG_Y,
        around: None,
        intensity: DVec3::splat(candela),
        distribution,
        form: LampForm::Point,
        ignore: None,
    }
}

fn spot(spread_deg: f64, sharpness: f64) -> Distribution {
    Distribution::NishitaSpot {
        spread: spread_deg * DEG,
        sharpness,
    }
}

/// Triangles lit by lamps alone.
fn night(triangles: &[Corners], lamps: Vec<LampEntry>) -> Scene {
    let mut scene = scene(triangles, 0.0, 0.0);
    scene.sun = None;
    scene.lamps = lamps;
    scene
}

/// A speck far below, so that there is a mesh.
fn nothing() -> Vec<Corners> {
    cuboid(dvec3(0.0, -1e3, 0.0), dvec3(0.01, -999.99, 0.01))
}

fn box_of_fog(half: f64, scattering: f64, absorption: f64, phase: Phase) -> Medium {
    fog(
        Shape::Box {
            min: DVec3::splat(-half),
            max: DVec3::splat(half),
        },
        scattering,
        absorption,
        phase,
    )
}

fn rendered(conditions: &Conditions, quality: Quality, set: &[(&str, f64)]) -> Frame {
    rendered_without(&[], conditions, quality, set)
}

fn rendered_without(
    effects: &[&str],
    conditions: &Conditions,
    quality: Quality,
    set: &[(&str, f64)],
) -> Frame {
    let overrules = Overrules {
        without: effects.iter().map(|name| name.to_string()).collect(),
        quality,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let reference = Reference::new(&plan).expect("it can be prepared");
    let rendered = reference.render(&Limits::default(), &|_| {});
    let frame = rendered.expect("it fits into memory").frame;
    frame.check().expect("every value is sound");
    frame
}

/// What lamps give to points that face a direction [lx], green.
fn received(scene: Scene, points: &[(DVec3, DVec3)], wanted: Wanted, field: Field) -> Vec<f64> {
    let receivers: Vec<Receiver> = points
        .iter()
        .map(|(p, n)| Receiver::new(*p, *n).expect("they are sound"))
        .collect();
    let seen = conditions(
        scene,
        Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0),
        [8, 8],
    );
    let seen = seen
        .seen_from(View::of_points(receivers))
        .expect("points are sound");
    let overrules = Overrules {
        quality: Quality::High,
        ..Overrules::default()
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    let mut backend = Backend::open(wanted).expect("there is one");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it can be rendered").frame;
    let found = frame.layer(field.name());
    (0..points.len())
        .map(|i| found.map_or(0.0, |layer| f64::from(layer.rgb[i][1])))
        .collect()
}

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

/// A hall of posts around a lamp.
fn posts() -> Vec<Corners> {
    let mut triangles = cuboid(dvec3(-5.0, -0.2, -5.0), dvec3(5.0, 0.0, 5.0));
    for i in 0..8 {
        let (z, x) = (f64::from(i) * PI / 4.0 + 0.1).sin_cos();
        let at = 2.0 * dvec3(x, 0.0, z);
        triangles.extend(cuboid(
            at - dvec3(0.15, 0.0, 0.1),
            at + dvec3(0.15, 2.5, 0.1),
        ));
    }
    triangles
}

/// Whether a triangle lies between two points: Cramer's rule, nothing of the library.
fn is_between(triangles: &[Corners], from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    triangles.iter().any(|[a, b, c]| {
        let (e, f) = (*b - *a, *c - *a);
        let p = way.cross(f);
        let determinant = e.dot(p);
        if determinant.abs() < 1e-14 {
            return false;
        }
        let s = from - *a;
        let u = s.dot(p) / determinant;
        let q = s.cross(e);
        let (v, t) = (way.dot(q) / determinant, f.dot(q) / determinant);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-7 && t < 1.0 - 1e-7
    })
}

/// What the air of a box of fog around the origin sends along a ray, by steps of equal angle and a shadow ray each.
fn stepped(
    triangles: &[Corners],
    lamp: &LampEntry,
    ray: &Ray,
    end: f64,
    half: f64,
    [scattering, extinction]: [f64; 2],
    g: f64,
) -> f64 {
    let chord = |origin: DVec3, direction: DVec3| {
        let inverse = direction.recip();
        let (a, b) = (
            (-DVec3::splat(half) - origin) * inverse,
            (DVec3::splat(half) - origin) * inverse,
        );
        (a.min(b).max_element().max(0.0), a.max(b).min_element())
    };
    let (enter, leave) = chord(ray.origin, ray.direction);
    let end = end.min(leave);
    if end <= enter {
        return 0.0;
    }
    let pose = Pose::new(lamp.toward, lamp.around).expect("it has a direction");
    let foot = (lamp.position - ray.origin).dot(ray.direction);
    let aside = ray.at(foot).distance(lamp.position);
    let angle = |t: f64| ((t - foot) / aside).atan();
    const STEPS: usize = 4000;
    let (first, last) = (angle(enter), angle(end));
    let mut sum = 0.0;
    for i in 0..STEPS {
        let theta = first + (last - first) * (i as f64 + 0.5) / STEPS as f64;
        let t = foot + aside * theta.tan();
        let point = ray.at(t);
        let way = lamp.position - point;
        let shape = lamp.distribution.intensity(&pose, -way);
        if shape == 0.0 || is_between(triangles, point, lamp.position) {
            continue;
        }
        let mu = -ray.direction.dot(way.normalize());
        let mu = -mu;
        let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5));
        let (_, to_face) = chord(point, way.normalize());
        let depth = extinction * ((t - enter) + way.length().min(to_face));
        sum += shape * phase * (-depth).exp();
    }
    lamp.intensity.y * scattering * sum * (last - first) / STEPS as f64 / aside
}

fn patterns() -> Vec<(&'static str, Distribution)> {
    vec![
        ("isotropic", Distribution::Isotropic),
        ("spot", spot(50.0, 0.25)),
        (
            "daisy",
            Distribution::Daisy {
                spread: 70.0 * DEG,
                sharpness: 0.25,
                petals: 9,
                ratio: -0.3,
            },
        ),
        (
            "dots",
            Distribution::PolkaDots {
                spread: 70.0 * DEG,
                sharpness: 0.5,
                petals: 8,
                ratio: -0.2,
                rings: 4,
            },
        ),
        (
            "headlight",
            Distribution::Elliptical {
                spread: [70.0 * DEG, 30.0 * DEG],
                sharpness: 0.2,
            },
        ),
    ]
}

#[test]
fn the_air_among_posts_is_what_many_shadow_rays_say() {
    let triangles = posts();
    let (half, g) = (4.0, 0.5);
    let (scattering, absorption) = (0.1, 0.03);
    let camera = Camera::look_at(dvec3(0.6, 1.7, 8.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG);
    let size = [12, 8];
    for (name, distribution) in patterns() {
        let lamp = LampEntry {
            toward: dvec3(0.3, -1.0, 0.4),
            around: Some(dvec3(0.2, 0.1, 1.0)),
            ..lamp(dvec3(0.2, 2.2, -0.1), 100.0, distribution)
        };
        let mut scene = night(&triangles, vec![lamp.clone()]);
        scene.media = vec![box_of_fog(
            half,
            scattering,
            absorption,
            Phase::HenyeyGreenstein { g },
        )];
        let seen = conditions(scene, camera, size);
        let frame = rendered_without(&["air_sky", "radiosity"], &seen, Quality::High, &[]);
        let found: Vec<f64> = layer(&frame, Field::InscatterLights)
            .iter()
            .map(|v| v.y)
            .collect();
        let truth: Vec<f64> = (0..size[0] * size[1])
            .map(|i| {
                let pixel = DVec2::new(f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
                let ray = seen.view.ray(pixel);
                let hit = seen.geometry.closest(&ray, 0.0, f64::INFINITY);
                let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
                let both = [scattering, scattering + absorption];
                stepped(&triangles, &lamp, &ray, end, half, both, g)
            })
            .collect();
        let mean = truth.iter().sum::<f64>() / truth.len() as f64;
        let square = found
            .iter()
            .zip(&truth)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>();
        let off = (square / truth.len() as f64).sqrt() / mean;
        eprintln!("{name}: {:.3} %", 100.0 * off);
        assert!(mean > 0.0 && off < 0.005, "{name}: {off}");
        // Without the posts it is another picture.
        let mut open = night(&nothing(), vec![lamp]);
        open.media = vec![box_of_fog(
            half,
            scattering,
            absorption,
            Phase::HenyeyGreenstein { g },
        )];
        let open = rendered_without(
            &["air_sky", "radiosity"],
            &conditions(open, camera, size),
            Quality::High,
            &[],
        );
        let open: f64 = layer(&open, Field::InscatterLights)
            .iter()
            .map(|v| v.y)
            .sum();
        assert!(
            (open / truth.iter().sum::<f64>() - 1.0).abs() > 0.02,
            "{name}"
        );
    }
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
        assert!(off < 0.005, "{}: {off}", field.name());
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
fn hard_cases_of_a_ray_and_a_lamp_are_finite_and_continuous() {
    // Through the lamp, behind it, at the eye, far off; thin and thick air; cones that are touched.
    let along = DVec3::NEG_Z;
    for sigma in [0.0, 1e-6, 0.1, 1e5] {
        for (name, distribution) in patterns() {
            let mut last: Option<f64> = None;
            for aside in [0.0, 1e-12, 1e-9, 1e-6, 1e-3] {
                let lamp = lamp(dvec3(aside, 0.0, -3.0), 10.0, distribution.clone());
                let mut scene = night(&nothing(), vec![lamp]);
                scene.media = vec![box_of_fog(100.0, sigma, 0.0, Phase::Isotropic)];
                let camera = Camera::look_at(DVec3::ZERO, along, 1e-3);
                let frame = rendered_without(
                    &["air_sky", "radiosity"],
                    &conditions(scene, camera, [1, 1]),
                    Quality::High,
                    &[],
                );
                let found = frame
                    .layer("inscatter_lights")
                    .map_or(0.0, |l| f64::from(l.rgb[0][1]));
                assert!(
                    found.is_finite() && found >= 0.0,
                    "{name} {sigma} {aside}: {found}"
                );
                // It grows toward the lamp, but not by leaps.
                if let Some(last) = last {
                    assert!(
                        found <= 1.0001 * last,
                        "{name} {sigma} {aside}: {found} {last}"
                    );
                }
                last = Some(found.max(1e-30));
            }
        }
    }
    let seen = |lamp: LampEntry, sigma: f64| {
        let mut scene = night(&nothing(), vec![lamp]);
        scene.media = vec![box_of_fog(100.0, sigma, 0.0, Phase::Isotropic)];
        let camera = Camera::look_at(DVec3::ZERO, along, 0.5);
        let frame = rendered_without(
            &["air_sky", "radiosity"],
            &conditions(scene, camera, [5, 5]),
            Quality::High,
            &[],
        );
        layer(&frame, Field::InscatterLights)
    };
    for at in [
        DVec3::ZERO,
        DVec3::Z,
        dvec3(0.0, 0.0, 1e-9),
        dvec3(0.0, 1e-5, 0.0),
    ] {
        for spread in [0.0, 30.0, 90.0, 180.0] {
            let values = seen(lamp(at, 10.0, spot(spread, 0.3)), 0.1);
            assert!(
                values
                    .iter()
                    .all(|v| v.is_finite() && v.min_element() >= 0.0),
                "{at} {spread}"
            );
        }
    }
    // A beam of 180 degrees and q = 1 is the same in all directions.
    let at = dvec3(0.3, 0.4, -3.0);
    let whole = seen(lamp(at, 10.0, spot(180.0, 1.0)), 0.1);
    let even = seen(lamp(at, 10.0, Distribution::Isotropic), 0.1);
    assert!(relative_rmse(&whole, &even) < 1e-4);
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
