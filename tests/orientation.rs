//! Which way things lie, held to a published place of the sun: north, east and up, in the light and in pictures, on both backends.
//!
//! The example of the report on the solar position algorithm (Reda & Andreas 2004, appendix A.5; revised 2008): 17 October 2003,
//! 12:30:30 at UTC - 7 h, 39.742476 N 105.1786 W, 1 830.14 m, 820 hPa, 11 degrees: azimuth 194.34024, zenith angle 50.11162 degrees.

mod common;

use common::build::{cuboid, layer, scene};
use common::receive::at;
use common::shafts;
use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::PI;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Receiver, Request, View};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Projection, Scene, SiteEntry};

const DEG: f64 = PI / 180.0;
const AZIMUTH_DEG: f64 = 194.340_24;
const ZENITH_ANGLE_DEG: f64 = 50.111_62;

/// Height of the gnomon [m].
const HEIGHT: f64 = 2.0;

/// A level direction of an azimuth [degrees] in a scene whose -Z faces the azimuth `north_deg`: the world turned about the vertical,
/// clockwise as seen from above, until what was -Z looks there.
fn level(azimuth_deg: f64, north_deg: f64) -> DVec3 {
    DMat3::from_rotation_y(-(azimuth_deg - north_deg) * DEG) * DVec3::NEG_Z
}

/// A thin post on the ground at the report's place and time.
fn gnomon(north_deg: f64) -> Scene {
    let half = 0.04;
    let post = cuboid(dvec3(-half, 0.0, -half), dvec3(half, HEIGHT, half));
    let mut scene = scene(&post, 0.0, 45.0);
    scene.sun = None;
    scene.north_deg = north_deg;
    scene.time = Some("2003-10-17T12:30:30-07:00".into());
    scene.site = Some(SiteEntry {
        latitude_deg: 39.742_476,
        longitude_deg: -105.178_6,
        elevation: 1830.14,
        timezone: None,
    });
    scene.ground.enabled = true;
    scene
}

fn conditions(scene: Scene, camera: Camera, size: [u32; 2]) -> Conditions {
    let request = Request {
        size: Some(size),
        samples: Some(1),
        camera: CameraChoice::Given(camera),
        pressure_hpa: Some(820.0),
        temperature_c: Some(11.0),
        ..Request::default()
    };
    Conditions::new(scene, &request).expect("the scene is sound")
}

/// What every backend that there is makes of conditions, without the light between surfaces.
fn pictures(test: &str, conditions: &Conditions, without: &[&str]) -> Vec<Frame> {
    let overrules = Overrules {
        quality: Quality::High,
        without: without.iter().map(|name| name.to_string()).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let mut reference = Backend::open(Wanted::Reference).expect("it is always there");
    let rendered = reference.render(&plan, &Limits::default(), &|_| {});
    let mut found = vec![rendered.expect("it works").frame];
    if common::gpu(test) {
        found.push(shafts::render(&plan).frame);
    }
    found
}

#[test]
fn a_gnomon_casts_its_shadow_where_the_report_has_the_sun() {
    let test = "a_gnomon_casts_its_shadow_where_the_report_has_the_sun";
    let length = HEIGHT * (ZENITH_ANGLE_DEG * DEG).tan();
    for north_deg in [0.0, 30.0, 200.0, -90.0] {
        let shadow = |turn_deg: f64, distance: f64| {
            distance * level(AZIMUTH_DEG + 180.0 + turn_deg, north_deg)
        };
        // Across the shadow, 2 m off: 4 degrees are 0.14 m, more than half of the post's diagonal and its penumbra.
        let places = [
            (shadow(0.0, 2.0), false),
            (shadow(0.8, 2.0), false),
            (shadow(-0.8, 2.0), false),
            (shadow(4.0, 2.0), true),
            (shadow(-4.0, 2.0), true),
            (shadow(0.0, length - 0.08), false),
            (shadow(0.0, length + 0.08), true),
            (shadow(180.0, 2.0), true),
        ];
        // The sky is brightest around the sun: meters that look to all sides tell its azimuth.
        let meter = |turn_deg: f64| {
            let normal = level(AZIMUTH_DEG + turn_deg, north_deg);
            at(dvec3(0.0, 30.0, 0.0), normal)
        };
        let meters = [0.0, 45.0, 90.0, 180.0, -90.0, -45.0].map(meter);
        let ground = places.iter().map(|(place, _)| at(*place, DVec3::Y));
        let points: Vec<Receiver> = ground.chain(meters).collect();
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
        let seen = conditions(gnomon(north_deg), camera, [8, 8]);
        let seen = seen
            .seen_from(View::of_points(&points[..]))
            .expect("the points are sound");
        for frame in pictures(test, &seen, &[]) {
            let sun = layer(&frame, Field::Sun);
            for (i, (place, lit)) in places.iter().enumerate() {
                assert_eq!(sun[i].y > 0.0, *lit, "north {north_deg}, {place}");
            }
            let sky = &layer(&frame, Field::Sky)[places.len()..points.len()];
            let [toward, left, side, away, other_side, right] =
                [0, 1, 2, 3, 4, 5].map(|i| luminance(sky[i]));
            let all = [toward, left, side, away];
            assert!(all.is_sorted_by(|a, b| *a > 1.05 * b), "{all:?}");
            assert!((left / right - 1.0).abs() < 0.03, "{left} {right}");
            assert!((side / other_side - 1.0).abs() < 0.03);
        }
    }
}

#[test]
fn a_map_and_a_picture_from_above_have_north_where_it_is() {
    let test = "a_map_and_a_picture_from_above_have_north_where_it_is";
    for north_deg in [0.0, 30.0, 200.0, -90.0] {
        // From above: -Z is up in the picture, +X to the right, so that azimuths turn clockwise. 5 m in 160 pixels.
        let mut camera = Camera::look_at(dvec3(0.0, 30.0, 0.0), DVec3::ZERO, 1.0);
        camera.projection = Projection::Orthographic { height: 5.0 };
        let seen = conditions(gnomon(north_deg), camera, [160, 160]);
        let turn = (AZIMUTH_DEG + 180.0 - north_deg) * DEG;
        let toward = dvec2(turn.sin(), -turn.cos());
        for frame in pictures(test, &seen, &["radiosity", "air_sky"]) {
            let sun = layer(&frame, Field::Sun);
            let pixel = |place: DVec2| {
                let at = 80.0 + 32.0 * place;
                sun[at.y as usize * 160 + at.x as usize].y
            };
            for share in [0.5, 1.0, 1.5, 2.0] {
                assert!(pixel(share * toward) < 0.3 * pixel(-share * toward));
                assert!(pixel(share * toward) < 0.3 * pixel(share * dvec2(-toward.x, toward.y)));
            }
        }
        // A panorama: -Z in the middle, azimuths to the right; the sun is the brightest pixel of the background.
        let mut camera = Camera::look_at(dvec3(0.0, 5.0, 0.0), dvec3(0.0, 5.0, -1.0), 1.0);
        camera.projection = Projection::Panorama;
        let size = [360, 180];
        let seen = conditions(gnomon(north_deg), camera, size);
        for frame in pictures(test, &seen, &["radiosity", "air_sky", "surface_sun"]) {
            let sky = layer(&frame, Field::Background);
            let brightest = (0..sky.len()).max_by(|a, b| sky[*a].y.total_cmp(&sky[*b].y));
            let at = brightest.expect("there are pixels");
            let (x, y) = ((at % 360) as f64 + 0.5, (at / 360) as f64 + 0.5);
            let azimuth = (north_deg + x - 180.0 - AZIMUTH_DEG).rem_euclid(360.0);
            assert!(
                azimuth.min(360.0 - azimuth) <= 1.0,
                "{x}, north {north_deg}"
            );
            assert!((y - ZENITH_ANGLE_DEG).abs() <= 1.0, "{y}");
        }
    }
}

/// A shifted lens sees a part of what a wider one sees from the same eye.
#[test]
fn a_shifted_lens_sees_a_quarter_of_a_wider_picture() {
    let test = "a_shifted_lens_sees_a_quarter_of_a_wider_picture";
    let half = 0.35_f64;
    for orthographic in [false, true] {
        let mut wide = Camera::look_at(dvec3(1.0, 2.0, 6.0), dvec3(0.0, 1.4, 0.0), 2.0 * half);
        wide.projection = match orthographic {
            true => Projection::Orthographic { height: 6.0 },
            false => Projection::Perspective { fov_y: 2.0 * half },
        };
        let mut part = wide;
        part.projection = match orthographic {
            true => Projection::Orthographic { height: 3.0 },
            false => Projection::Perspective {
                fov_y: 2.0 * (0.5 * half.tan()).atan(),
            },
        };
        let without = ["radiosity", "air_sky"];
        let whole = conditions(gnomon(30.0), wide, [64, 48]);
        let whole = pictures(test, &whole, &without);
        // Half a picture to the left or right, and up or down.
        for (shift, [from_x, from_y]) in [
            (dvec2(-0.5, 0.5), [0, 0]),
            (dvec2(0.5, 0.5), [32, 0]),
            (dvec2(-0.5, -0.5), [0, 24]),
            (dvec2(0.5, -0.5), [32, 24]),
        ] {
            part.shift = shift;
            let seen = conditions(gnomon(30.0), part, [32, 24]);
            for (frame, whole) in pictures(test, &seen, &without).iter().zip(&whole) {
                let mean = |frame: &Frame| {
                    let of = |i| luminance(frame.picture(i));
                    (0..frame.pixels()).map(of).sum::<f64>() / frame.pixels() as f64
                };
                let scale = mean(whole);
                let mut off = 0;
                for y in 0..24 {
                    for x in 0..32 {
                        let small = luminance(frame.picture(y * 32 + x));
                        let large = luminance(whole.picture((y + from_y) * 64 + x + from_x));
                        off += usize::from((small - large).abs() > 1e-3 * scale);
                    }
                }
                // A pixel on an edge may fall to either side in f32.
                assert!(off <= 4, "{shift}, {off} pixels differ");
            }
        }
    }
}
