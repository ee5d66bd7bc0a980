//! What a scene or a request says in vain is named, numbers out of range are refused wherever they come from, and what is
//! suggested is in range.

use glam::{DVec2, DVec3};
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::ephemeris::{Tier, TimeScale};
use tyndall::medium::{ClearAir, Medium, Phase, Shape};
use tyndall::scene::{Camera, Projection, Scene, SiteEntry, SunEntry};
use tyndall::units::DEG;
use tyndall::warning::Warning;

const SUN: SunEntry = SunEntry {
    azimuth_deg: 180.0,
    elevation_deg: 30.0,
    illuminance: None,
    diameter_deg: None,
};

fn camera() -> Camera {
    Camera::look_at(DVec3::new(0.0, 2.0, 9.0), DVec3::Y, 50.0 * DEG)
}

fn under_a_sun() -> Scene {
    Scene {
        sun: Some(SUN),
        ..Scene::default()
    }
}

fn warnings(scene: Scene, request: Request) -> Vec<Warning> {
    let request = Request {
        camera: CameraChoice::Given(camera()),
        ..request
    };
    let conditions = Conditions::new(scene, &request).expect("the scene is sound");
    conditions.warnings
}

#[test]
fn place_time_and_ephemeris_beside_a_given_sun_are_named() {
    assert_eq!(warnings(under_a_sun(), Request::default()), []);
    let mut scene = under_a_sun();
    scene.site = Some(SiteEntry::default());
    scene.time = Some("2026-06-21T12:00Z".into());
    let request = Request {
        timezone: Some("Europe/Paris".into()),
        time_scale: TimeScale::Tt,
        delta_t: Some(70.0),
        tier: Tier::Day,
        pressure_hpa: Some(900.0),
        temperature_c: Some(-5.0),
        ..Request::default()
    };
    let names = [
        "place",
        "time",
        "time zone",
        "time scale",
        "delta T",
        "tier",
        "pressure",
        "temperature",
    ];
    let names = names.to_vec();
    assert_eq!(
        warnings(scene.clone(), request),
        [Warning::UnusedWithSun { names }]
    );
    scene.sun = None;
    let used = Request {
        pressure_hpa: Some(900.0),
        ..Request::default()
    };
    let said = warnings(scene, used);
    let in_vain = |w: &Warning| matches!(w, Warning::UnusedWithSun { .. });
    assert!(!said.iter().any(in_vain), "{said:?}");
}

#[test]
fn a_zone_that_is_asked_for_wins_over_the_sites() {
    let mut scene = Scene {
        site: Some(SiteEntry {
            timezone: Some("Europe/Paris".into()),
            ..SiteEntry::default()
        }),
        time: Some("2026-06-21T12:00".into()),
        ..Scene::default()
    };
    let elevation = |scene: &Scene, timezone: Option<&str>| {
        let request = Request {
            camera: CameraChoice::Given(camera()),
            timezone: timezone.map(str::to_owned),
            ..Request::default()
        };
        let conditions = Conditions::new(scene.clone(), &request).expect("the scene is sound");
        conditions.sun_elevation_deg()
    };
    let asked = elevation(&scene, Some("+05:00"));
    assert_ne!(asked, elevation(&scene, None));
    scene.site = Some(SiteEntry::default());
    scene.time = Some("2026-06-21T12:00+05:00".into());
    assert_eq!(asked, elevation(&scene, None));
}

#[test]
fn a_ground_that_is_not_there_and_media_that_add_nothing_are_named() {
    let mut scene = under_a_sun();
    scene.ground.enabled = false;
    scene.ground.height = Some(-1.0);
    scene.ground.albedo = 0.5;
    let keys = vec!["height", "albedo"];
    assert_eq!(
        warnings(scene.clone(), Request::default()),
        [Warning::UnusedGround { keys }]
    );
    // Clear air is counted from the ground's height, whether the ground is there or not.
    scene.air = Some(ClearAir::default());
    let keys = vec!["albedo"];
    assert_eq!(
        warnings(scene, Request::default()),
        [Warning::UnusedGround { keys }]
    );

    let medium = |min_y: f64, scattering: f64| Medium {
        shape: Shape::Box {
            min: DVec3::new(0.0, min_y, 0.0),
            max: DVec3::new(1.0, min_y + 1.0, 1.0),
        },
        scattering: DVec3::splat(scattering),
        absorption: DVec3::ZERO,
        phase: Phase::Isotropic,
    };
    let mut scene = under_a_sun();
    scene.ground.height = Some(0.0);
    scene.media = vec![medium(-0.5, 0.1), medium(-1.0, 0.1), medium(0.0, 0.0)];
    let media = vec![
        (2, "it lies under the ground"),
        (3, "it neither scatters nor absorbs"),
    ];
    assert_eq!(
        warnings(scene, Request::default()),
        [Warning::UnusedMedia { media }]
    );
}

#[test]
fn cameras_out_of_range_are_refused_wherever_they_come_from() {
    let taken = |camera: Camera| {
        let request = Request {
            camera: CameraChoice::Given(camera),
            ..Request::default()
        };
        let given = Conditions::new(under_a_sun(), &request).map(drop);
        let mut scene = under_a_sun();
        scene.camera = Some(camera);
        let of_scene = Conditions::new(scene, &Request::default()).map(drop);
        let words = |result: tyndall::Result<()>| result.map_err(|error| error.to_string());
        let (given, of_scene) = (words(given), words(of_scene));
        assert_eq!(given, of_scene);
        given
    };
    let with = |change: &dyn Fn(&mut Camera)| {
        let mut changed = camera();
        change(&mut changed);
        taken(changed)
    };
    let perspective = |degrees: f64| Projection::Perspective {
        fov_y: degrees * DEG,
    };
    let orthographic = |height| Projection::Orthographic { height };
    for (refused, words) in [
        (with(&|c| c.eye.x = 1e300), "eye"),
        (with(&|c| c.eye.x = 1e12), "eye"),
        (with(&|c| c.eye.y = f64::NAN), "eye"),
        (with(&|c| c.forward.z = 1e300), "direction"),
        (with(&|c| c.forward.z = 1e12), "target"),
        (with(&|c| c.up = DVec3::ZERO), "up"),
        (with(&|c| c.up = DVec3::splat(1e300)), "up"),
        (with(&|c| c.shift = DVec2::new(0.0, -101.0)), "-100 to 100"),
        (with(&|c| c.shift.x = f64::NAN), "shift"),
        (with(&|c| c.projection = perspective(1e-5)), "0.0001 to"),
        (with(&|c| c.projection = perspective(180.0)), "below 180"),
        (with(&|c| c.projection = orthographic(1e-7)), "1e-6 to 1e9"),
        (with(&|c| c.projection = orthographic(1e10)), "1e-6 to 1e9"),
    ] {
        let problem = refused.expect_err(words);
        assert!(problem.contains(words), "`{words}` is not in {problem}");
        assert!(!problem.contains("00000000000000"), "{problem}");
    }
    for sound in [
        with(&|c| c.eye.x = -1e9),
        with(&|c| c.shift = DVec2::new(0.0, -100.0)),
        with(&|c| c.projection = perspective(1e-4)),
        with(&|c| c.projection = orthographic(1e-6)),
    ] {
        assert_eq!(sound, Ok(()));
    }
}

#[test]
fn north_is_an_azimuth() {
    for (north, sound) in [
        (-360.0, true),
        (360.0, true),
        (361.0, false),
        (1e300, false),
    ] {
        let mut scene = under_a_sun();
        scene.north_deg = north;
        scene.camera = Some(camera());
        let made = Conditions::new(scene, &Request::default());
        assert_eq!(made.is_ok(), sound, "{north}");
    }
}

#[test]
fn a_suggested_camera_can_be_pasted_at_any_size() {
    for scale in [1e-30, 1e-5, 1.0, 1e5, 1e30] {
        for place in [DVec3::ZERO, scale * DVec3::new(3.0, -70.0, 0.2)] {
            let max = place + scale * DVec3::new(1.0, 2.0, 3.0);
            let camera = Camera::around((place, max), 1.6);
            let text = camera.to_toml();
            assert!(text.len() < 160, "{text}");
            let parsed: toml::Table = text.parse().expect("it is TOML");
            let point = |key: &str| {
                let list = parsed["camera"][key].as_array().expect("a list");
                let number = |i: usize| list[i].as_float().expect("a number");
                DVec3::new(number(0), number(1), number(2))
            };
            let forward = point("target") - point("eye");
            let off = forward.distance(camera.forward) / camera.forward.length();
            assert!(off < 1e-4, "{off}: {text}");
        }
    }
}

#[test]
fn a_sky_of_next_to_no_light_is_described_in_a_line() {
    let mut scene = under_a_sun();
    scene.camera = Some(camera());
    scene.sky.direct_normal = Some(0.0);
    scene.sky.diffuse_horizontal = Some(1e-300);
    let conditions = Conditions::new(scene, &Request::default()).expect("the scene is sound");
    let sky = conditions.sky.expect("a sky").describe();
    assert!(sky.contains("1e-300 W/m2") && sky.len() < 200, "{sky}");
}
