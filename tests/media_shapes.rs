//! Pictures of layers with waves and ellipsoids: held to sums over many small steps, and to haze of equal shape. Their integrals along
//! rays are in `air.rs`.

mod common;

use common::build::*;
use common::curved::{HAZY, density, fog, layer_of, rays, sun, turned, waves};
use common::files::Folder;
use common::shafts;
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::beam::Beam;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::medium::{Air, Edge, Medium, Scattering, Shape, Wave};
use tyndall::photometry::{Distribution, Pose};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, LampEntry, LampForm, Scene};
use tyndall::units::DEG;

fn lamp(position: DVec3) -> LampEntry {
    LampEntry {
        name: "lamp".into(),
        position,
        toward: dvec3(0.2, -1.0, 0.1),
        around: None,
        intensity: DVec3::splat(100.0),
        distribution: Distribution::NishitaSpot {
            spread: 40.0 * DEG,
            sharpness: 0.3,
        },
        form: LampForm::Point,
        ignore: None,
    }
}

/// A speck far below, so that there is a mesh.
fn nothing() -> Scene {
    let speck = cuboid(dvec3(0.0, -1e3, 0.0), dvec3(0.01, -999.99, 0.01));
    let mut scene = scene(&speck, 0.0, 0.0);
    scene.sun = None;
    scene
}

fn picture(conditions: &Conditions, without: &[&str]) -> tyndall::frame::Frame {
    let overrules = Overrules {
        quality: Quality::High,
        without: without.iter().map(|name| name.to_string()).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let reference = tyndall::backend::reference::Reference::new(&plan).expect("it can be prepared");
    let rendered = reference.render(&tyndall::backend::Limits::default(), &|_| {});
    let frame = rendered.expect("it fits into memory").frame;
    frame.check().expect("every value is sound");
    frame
}

#[test]
fn a_spot_in_waves_and_smoke_is_that_of_many_steps() {
    let position = dvec3(0.3, 2.6, -0.2);
    for shape in [layer_of(1.1, waves(), Some(-1.0)), turned(Edge::Soft)] {
        let mut scene = nothing();
        scene.media = vec![fog(shape.clone(), 0.5, 0.1, HAZY)];
        scene.lamps = vec![lamp(position)];
        let camera = Camera::look_at(dvec3(0.5, 1.9, 5.5), dvec3(0.3, 0.9, 0.0), 45.0 * DEG);
        let seen = conditions(scene, camera, [8, 6]);
        let found = layer(
            &picture(&seen, &["air_sky", "radiosity"]),
            Field::InscatterLights,
        );
        let lamp = lamp(position);
        let pose = Pose::new(lamp.toward, lamp.around).expect("it has a direction");
        let beam = Beam::local(position, DVec3::ONE);
        let air = &seen.air;
        let (mut off, mut all) = (0.0, 0.0);
        for (i, found) in (0..48).zip(&found) {
            let ray = seen
                .view
                .ray(DVec2::new(f64::from(i % 8) + 0.5, f64::from(i / 8) + 0.5));
            const STEPS: usize = 20_000;
            let step = 12.0 / STEPS as f64;
            let mut truth = 0.0;
            for k in 0..STEPS {
                let t = step * (k as f64 + 0.5);
                let point = ray.at(t);
                let way = position - point;
                let intensity = 100.0 * lamp.distribution.intensity(&pose, -way);
                let source = 0.5 * density(&shape, point) * intensity;
                if source > 0.0 {
                    let toward = way.normalize();
                    let phase = HAZY.value(0.5 * (ray.direction - toward).length_squared());
                    let depth = air.optical_depth(ray.origin, ray.direction, t).x
                        + air.beam_optical_depth(point, &beam).x;
                    truth += step * source * phase * (-depth).exp() / way.length_squared();
                }
            }
            off += (found.x - truth).abs();
            all += truth;
        }
        eprintln!("a spot: {:.1e}", off / all);
        assert!(all > 0.0 && off < 1e-3 * all, "{shape:?}: {off} {all}");
    }
}

/// A floor with a wall, under an overcast sky and a sun.
fn court(media: Vec<Medium>) -> Conditions {
    let mut triangles = cuboid(dvec3(-4.0, -0.2, -4.0), dvec3(4.0, 0.0, 4.0));
    triangles.extend(cuboid(dvec3(-1.5, 0.0, -1.0), dvec3(-1.0, 2.5, 1.0)));
    let mut scene = scene(&triangles, 250.0, 30.0);
    scene.sky.model = Some("cie:1".into());
    scene.media = media;
    let camera = Camera::look_at(dvec3(0.5, 1.6, 7.0), dvec3(0.0, 0.8, 0.0), 50.0 * DEG);
    conditions(scene, camera, [16, 12])
}

#[test]
fn a_layer_without_waves_is_haze() {
    let rgb = |shape| Medium {
        scattering: dvec3(0.1, 0.2, 0.3),
        ..fog(shape, 0.0, 0.05, HAZY)
    };
    let haze = court(vec![rgb(Shape::Haze { top: 1.2 })]);
    let still = vec![Wave::new(0.0, 2.0, 0.3, 0.4)];
    let flat = court(vec![rgb(layer_of(1.2, still, Some(haze.air.ground)))]);
    for (origin, direction) in rays() {
        assert_eq!(
            haze.air.optical_depth(origin, direction, 7.0),
            flat.air.optical_depth(origin, direction, 7.0)
        );
        let beam = sun(25.0);
        let of =
            |air: &Air| Scattering::new(air, origin, direction, 7.0, &beam).integrate(0.1, 6.0);
        assert_eq!(of(&haze.air), of(&flat.air));
    }
    let (a, b) = (picture(&haze, &[]), picture(&flat, &[]));
    let apart = |(a, b): (&glam::Vec3, &glam::Vec3)| (*a - *b).abs().max_element() > 1e-6;
    assert!(!a.transmittance.iter().zip(&b.transmittance).any(apart));
    for field in [
        Field::Sun,
        Field::Sky,
        Field::InscatterSun,
        Field::InscatterSky,
    ] {
        let (a, b) = (layer(&a, field), layer(&b, field));
        assert!(relative_rmse(&b, &a) < 1e-6, "{}", field.name());
    }
}

#[test]
fn waves_that_are_small_and_a_fog_bank_change_the_light_of_the_sky_by_little() {
    let of = |shape| picture(&court(vec![fog(shape, 0.3, 0.05, HAZY)]), &[]);
    let flat = of(layer_of(1.2, Vec::new(), None));
    let small = of(layer_of(1.2, vec![Wave::new(0.01, 1.0, 0.5, 0.0)], None));
    for field in [Field::InscatterSun, Field::InscatterSky, Field::Sky] {
        let off = relative_rmse(&layer(&small, field), &layer(&flat, field));
        eprintln!("{}: {off:.1e}", field.name());
        assert!(off > 0.0 && off < 0.02, "{}: {off}", field.name());
    }
    let smoke = of(turned(Edge::Soft));
    let light: f64 = layer(&smoke, Field::InscatterSky).iter().map(|v| v.y).sum();
    assert!(light.is_finite() && light > 0.0, "{light}");
}

#[test]
fn every_backend_makes_the_same_picture() {
    if !common::gpu("every_backend_makes_the_same_picture") {
        return;
    }
    let media = vec![
        fog(layer_of(0.7, waves(), None), 0.3, 0.05, HAZY),
        fog(turned(Edge::Soft), 1.0, 0.1, HAZY),
    ];
    let mut seen = court(media);
    let mut scene = (*seen.scene).clone();
    scene.lamps = vec![lamp(dvec3(1.0, 2.4, 0.5))];
    seen = conditions(scene, seen.view.camera, [36, 24]);
    let overrules = Overrules {
        set: LEAST.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    for name in ["transmittance", "surface_sun", "shafts_rectified"] {
        let step = plan.steps.iter().find(|step| step.effect.name == name);
        let step = step.expect("it is in the plan");
        assert!(step.is_by_reference(&seen), "{name}");
        assert!(step.decision.reason.contains("curved"), "{name}");
    }
    let by_device = shafts::render(&plan).frame;
    let truth = tyndall::backend::reference::Reference::new(&plan).expect("it can be prepared");
    let truth = truth.render(&tyndall::backend::Limits::default(), &|_| {});
    let truth = truth.expect("it fits into memory").frame;
    let apart = by_device.transmittance.iter().zip(&truth.transmittance);
    let apart: f32 = apart.map(|(a, b)| (*a - *b).abs().element_sum()).sum();
    assert!(apart < 1e-3 * truth.pixels() as f32, "{apart}");
    for field in [
        Field::Sun,
        Field::Sky,
        Field::Lights,
        Field::InscatterSun,
        Field::InscatterSky,
        Field::InscatterLights,
    ] {
        let off = relative_rmse(&layer(&by_device, field), &layer(&truth, field));
        eprintln!("{}: {off:.1e}", field.name());
        assert!(off < 2e-3, "{}: {off}", field.name());
    }
}

const TOML: &str = r#"
[sun]
azimuth = 120.0
elevation = 30.0
[[medium]]
shape = "layer"
top = 1.1
waves = [{ amplitude = 0.18, wavelength = 3.1, direction = 90.0, phase = 45.0 }, { amplitude = 0.1, wavelength = 2.0 }]
bottom = 0.2
scattering = 0.25
[[medium]]
shape = "ellipsoid"
center = [0.0, 1.0, 2.0]
radii = [1.0, 2.0, 3.0]
rotation = [90.0, 0.0, 90.0]
edge = "soft"
scattering = [0.1, 0.2, 0.3]
"#;

#[test]
fn a_scene_file_says_layers_and_ellipsoids() {
    let folder = Folder::new();
    let scene = folder.load("fog.toml", TOML).expect("it loads");
    let wave = Wave::new(0.18, 3.1, 0.5 * PI, 0.25 * PI);
    let Shape::Layer {
        top,
        waves,
        bottom,
        far,
    } = &scene.media[0].shape
    else {
        panic!("{:?}", scene.media[0]);
    };
    assert_eq!((*top, *bottom, *far), (1.1, Some(0.2), 1e5));
    assert_eq!((waves.len(), waves[0]), (2, wave));
    // Its phase grows toward +Z.
    assert!((wave.vector.y - 2.0 * PI / 3.1).abs() < 1e-12 && wave.vector.x.abs() < 1e-12);
    let Shape::Ellipsoid { rotation, edge, .. } = scene.media[1].shape else {
        panic!("{:?}", scene.media[1]);
    };
    assert_eq!(edge, Edge::Soft);
    // +Y goes to +Z about X, and stays about Z; +X goes to +Y about Z.
    assert!((rotation * DVec3::Y).distance(DVec3::Z) < 1e-12);
    assert!((rotation * DVec3::X).distance(DVec3::Y) < 1e-12);
    for (from, to, place, word) in [
        ("wavelength = 3.1", "wavelength = 0.0", ":8", "wavelength"),
        ("wavelength = 2.0", "wavelenght = 2.0", ":8", "wavelength"),
        ("bottom = 0.2", "bottom = 2.0", ":9", "crest"),
        ("edge = \"soft\"", "edge = \"softly\"", ":16", "soft"),
        ("radii = [1.0", "radii = [-1.0", ":14", "radii"),
        ("top = 1.1\n", "", ":5", "top"),
    ] {
        let text = TOML.replace(from, to);
        assert_ne!(text, TOML);
        let error = folder.refused("fog.toml", &text);
        assert!(
            error.contains(place) && error.contains(word),
            "{from}: {error}"
        );
    }
}
