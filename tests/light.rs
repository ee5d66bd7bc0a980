//! Pictures against closed forms, symmetries and conservation.

mod common;

use common::build::*;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use tyndall::conditions::toward;
use tyndall::effect::Field;
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::plan::Quality;
use tyndall::scene::{Camera, Projection, Scene, SkyEntry};

const DEG: f64 = PI / 180.0;

/// One small triangle far below everything, since a scene must have one.
fn speck() -> Vec<[DVec3; 3]> {
    vec![[
        DVec3::new(0.0, -50.0, 0.0),
        DVec3::new(1e-3, -50.0, 0.0),
        DVec3::new(0.0, -50.0, 1e-3),
    ]]
}

fn fog(shape: Shape, scattering: f64, absorption: f64, phase: Phase) -> Medium {
    Medium {
        shape,
        scattering: DVec3::splat(scattering),
        absorption: DVec3::splat(absorption),
        phase,
    }
}

fn henyey_greenstein(g: f64, mu: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5))
}

/// sigma_s p E times the integral of exp(-a - b t) over t0..t1, written independently of the library.
fn lit(strength: f64, a: f64, b: f64, t0: f64, t1: f64) -> f64 {
    // Series where b (t1 - t0) is small.
    let x = b * (t1 - t0);
    let mean = if x.abs() < 1e-5 {
        1.0 - x / 2.0 + x * x / 6.0
    } else {
        (1.0 - (-x).exp()) / x
    };
    strength * (-a - b * t0).exp() * (t1 - t0) * mean
}

#[test]
fn haze_without_occluder_has_its_closed_form_at_every_pixel_and_at_the_sun() {
    let (top, sigma_s, sigma_a) = (40.0, 0.011, 0.004);
    let sigma = sigma_s + sigma_a;
    for g in [0.0, 0.6, -0.4, 0.9] {
        let mut scene = scene(&speck(), 120.0, 35.0);
        scene.media = vec![fog(
            Shape::Haze { top },
            sigma_s,
            sigma_a,
            Phase::HenyeyGreenstein { g },
        )];
        let sun = toward(120.0 * DEG, 35.0 * DEG, 0.0);
        let eye = DVec3::new(3.0, 2.0, -1.0);
        // The picture's middle pixel looks exactly into the sun.
        let camera = Camera::look_at(eye, eye + sun, 100.0 * DEG);
        let size = [65, 49];
        let conditions = conditions(scene, camera, size);
        let frame = render(&conditions);
        let found = layer(&frame, Field::InscatterSun);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let r = camera.ray(at, size).direction;
                // Rays leave the haze through its top, or at its lower boundary, the ground's height.
                let end = if r.y > 0.0 {
                    (top - eye.y) / r.y
                } else if r.y < 0.0 {
                    -eye.y / r.y
                } else {
                    1e9
                };
                let strength = 1e5 * sigma_s * henyey_greenstein(g, r.dot(sun));
                let expected = lit(
                    strength,
                    sigma * (top - eye.y) / sun.y,
                    sigma * (1.0 - r.y / sun.y),
                    0.0,
                    end,
                );
                let got = found[(y * size[0] + x) as usize].x;
                assert!(
                    (got / expected - 1.0).abs() < 1e-6,
                    "g {g} pixel {x} {y}: {got} instead of {expected}"
                );
            }
        }
    }
}

#[test]
fn a_box_under_a_zenith_sun_has_its_closed_form() {
    let (min, max) = (DVec3::new(-4.0, 0.5, -5.0), DVec3::new(4.0, 4.0, 5.0));
    let (sigma_s, sigma) = (0.05, 0.07);
    let mut scene = scene(&speck(), 0.0, 90.0);
    scene.media = vec![fog(
        Shape::Box { min, max },
        sigma_s,
        sigma - sigma_s,
        Phase::HenyeyGreenstein { g: 0.7 },
    )];
    for eye in [DVec3::new(0.3, 1.5, 12.0), DVec3::new(1.0, 2.0, 1.0)] {
        let camera = Camera::look_at(eye, DVec3::new(0.0, 2.0, -3.0), 50.0 * DEG);
        let size = [48, 32];
        let frame = render(&conditions(scene.clone(), camera, size));
        let found = layer(&frame, Field::InscatterSun);
        let mut inside = 0;
        for (i, got) in found.iter().enumerate() {
            let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
            let r = camera
                .ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), size)
                .direction;
            let (mut t0, mut t1) = (0.0f64, f64::INFINITY);
            for axis in 0..3 {
                let (a, b) = (
                    (min[axis] - eye[axis]) / r[axis],
                    (max[axis] - eye[axis]) / r[axis],
                );
                t0 = t0.max(a.min(b));
                t1 = t1.min(a.max(b));
            }
            if t1 <= t0 {
                assert_eq!(got.x, 0.0);
                continue;
            }
            inside += 1;
            let strength = 1e5 * sigma_s * henyey_greenstein(0.7, r.y);
            // tau = sigma (t - t0) + sigma (top - y(t))
            let a = sigma * (max.y - eye.y - t0);
            let expected = lit(strength, a, sigma * (1.0 - r.y), t0, t1);
            assert!((got.x / expected - 1.0).abs() < 1e-6, "{x} {y}");
        }
        assert!(inside > 400, "{inside}");
    }
}

/// A ceiling with a slit that runs along z, over fog.
fn slit_room(azimuth_deg: f64, elevation_deg: f64, scale: f64) -> Scene {
    let far = 1e3 * scale;
    let ceiling = |from: f64, to: f64| {
        quad(
            DVec3::new(from, 4.0 * scale, -far),
            DVec3::X * (to - from),
            DVec3::Z * 2.0 * far,
        )
    };
    let triangles = [
        ceiling(-far, -0.5 * scale).to_vec(),
        ceiling(0.7 * scale, far).to_vec(),
    ]
    .concat();
    let mut scene = scene(&triangles, azimuth_deg, elevation_deg);
    scene.media = vec![fog(
        Shape::Haze { top: 4.0 * scale },
        0.03 / scale,
        0.01 / scale,
        Phase::Isotropic,
    )];
    scene
}

#[test]
fn a_slit_in_a_ceiling_makes_the_analytic_shaft() {
    let (azimuth, elevation) = (75.0, 40.0);
    let sun = toward(azimuth * DEG, elevation * DEG, 0.0);
    let eye = DVec3::new(-6.0, 1.7, 2.0);
    let camera = Camera::look_at(eye, DVec3::new(0.0, 1.5, -3.0), 60.0 * DEG);
    let size = [60, 45];
    let frame = render(&conditions(
        slit_room(azimuth, elevation, 1.0),
        camera,
        size,
    ));
    let found = layer(&frame, Field::InscatterSun);
    let (mut lit_pixels, mut dark_pixels) = (0, 0);
    for (i, got) in found.iter().enumerate() {
        let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
        let r = camera
            .ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), size)
            .direction;
        let end = if r.y > 0.0 {
            (4.0 - eye.y) / r.y
        } else {
            -eye.y / r.y
        };
        // Light reaches (x, y) through the ceiling at x + (4 - y) w_x / w_y, linear in t.
        let slope = sun.x / sun.y;
        let at = |t: f64| eye.x + t * r.x + (4.0 - eye.y - t * r.y) * slope;
        let (a, b) = (at(0.0), r.x - r.y * slope);
        let (p, q) = ((-0.5 - a) / b, (0.7 - a) / b);
        let (t0, t1) = (p.min(q).max(0.0), p.max(q).min(end));
        let expected = if t1 > t0 {
            lit_pixels += 1;
            let strength = 1e5 * 0.03 / (4.0 * PI);
            lit(
                strength,
                0.04 * (4.0 - eye.y) / sun.y,
                0.04 * (1.0 - r.y / sun.y),
                t0,
                t1,
            )
        } else {
            dark_pixels += 1;
            0.0
        };
        // A lit run that only just begins at the end of the ray has few digits left.
        let allowed = 1e-6 * expected + 1e-7;
        assert!(
            (got.x - expected).abs() < allowed,
            "{x} {y}: {} {expected}",
            got.x
        );
    }
    assert!(
        lit_pixels > 500 && dark_pixels > 50,
        "{lit_pixels} {dark_pixels}"
    );
}

#[test]
fn the_comparison_notices_half_a_degree_and_half_a_pixel() {
    let camera = Camera::look_at(
        DVec3::new(-6.0, 1.7, 2.0),
        DVec3::new(0.0, 1.5, -3.0),
        60.0 * DEG,
    );
    let picture = |azimuth: f64, camera: Camera| {
        layer(
            &render(&conditions(slit_room(azimuth, 40.0, 1.0), camera, [60, 45])),
            Field::InscatterSun,
        )
    };
    let truth = picture(75.0, camera);
    assert_eq!(relative_rmse(&picture(75.0, camera), &truth), 0.0);
    assert!(relative_rmse(&picture(75.5, camera), &truth) > 1e-3);
    let mut shifted = camera;
    shifted.shift = DVec2::new(0.5 / 60.0, 0.0);
    assert!(relative_rmse(&picture(75.0, shifted), &truth) > 1e-3);
}

#[test]
fn the_picture_does_not_depend_on_the_unit_of_length() {
    let eye = DVec3::new(-6.0, 1.7, 2.0);
    let target = DVec3::new(0.0, 1.5, -3.0);
    let picture = |scale: f64| {
        let camera = Camera::look_at(eye * scale, target * scale, 60.0 * DEG);
        layer(
            &render(&conditions(slit_room(75.0, 40.0, scale), camera, [40, 30])),
            Field::InscatterSun,
        )
    };
    let truth = picture(1.0);
    for scale in [2f64.powi(-10), 2f64.powi(13), 1e-3, 1e4] {
        let error = relative_rmse(&picture(scale), &truth);
        // Powers of two change no digit; others round.
        assert!(error < 1e-5, "{scale}: {error}");
    }
}

#[test]
fn the_picture_does_not_depend_on_where_the_origin_is() {
    let shift = DVec3::new(1e6, 0.0, -1e6);
    let eye = DVec3::new(-6.0, 1.7, 2.0);
    let target = DVec3::new(0.0, 1.5, -3.0);
    let near = render(&conditions(
        slit_room(75.0, 40.0, 1.0),
        Camera::look_at(eye, target, 60.0 * DEG),
        [40, 30],
    ));
    let mut scene = slit_room(75.0, 40.0, 1.0);
    for p in &mut scene.mesh.positions {
        *p += shift;
    }
    let camera = Camera::look_at(eye + shift, target + shift, 60.0 * DEG);
    let far = render(&conditions(scene, camera, [40, 30]));
    for field in [Field::InscatterSun, Field::Sun] {
        let (near, far) = (layer(&near, field), layer(&far, field));
        if near.iter().any(|v| v.x > 0.0) {
            let error = relative_rmse(&far, &near);
            assert!(error < 1e-5, "{field:?}: {error}");
        }
    }
}

#[test]
fn scale_and_origin_of_a_scene_file_do_not_change_the_picture() {
    let folder = tempfile::tempdir().expect("a folder for scene files");
    let mesh = "v -500 4 -500\nv -500 4 500\nv -0.5 4 500\nv -0.5 4 -500\n\
                v 0.7 4 -500\nv 0.7 4 500\nv 500 4 500\nv 500 4 -500\n\
                v -500 0 -500\nv -500 0 500\nv 500 0 500\nv 500 0 -500\n\
                f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\n";
    std::fs::write(folder.path().join("slit.obj"), mesh).expect("the mesh is written");
    let picture = |scale: f64, origin: [f64; 3]| {
        let at = |p: [f64; 3]| [0, 1, 2].map(|i| p[i] * scale + origin[i]);
        let text = format!(
            "mesh = \"slit.obj\"\nscale = {scale:?}\norigin = {origin:?}\n\
             [sun]\nazimuth = 75.0\nelevation = 40.0\nilluminance = 1e5\n\
             [ground]\nenabled = false\nheight = {:?}\n\
             [camera]\neye = {:?}\ntarget = {:?}\nfov_y = 60.0\n\
             [[medium]]\nshape = \"box\"\nmin = {:?}\nmax = {:?}\nscattering = {:?}\n",
            origin[1],
            at([-6.0, 1.7, 2.0]),
            at([0.0, 1.5, -3.0]),
            at([-20.0, 0.0, -20.0]),
            at([20.0, 4.0, 20.0]),
            0.03 / scale,
        );
        let path = folder.path().join("slit.toml");
        std::fs::write(&path, text).expect("the scene is written");
        let scene = tyndall::scene::load(&path).expect("the scene is sound");
        let request = tyndall::conditions::Request {
            size: Some([40, 30]),
            ..Default::default()
        };
        let conditions =
            tyndall::conditions::Conditions::new(scene, &request).expect("it has a sun");
        let frame = render(&conditions);
        [Field::InscatterSun, Field::Sun].map(|field| layer(&frame, field))
    };
    let truth = picture(1.0, [0.0; 3]);
    assert!(truth.iter().all(|l| l.iter().any(|v| v.x > 0.0)));
    for (scale, origin) in [
        (2f64.powi(-10), [0.0; 3]),
        (2f64.powi(13), [0.0; 3]),
        (1.0, [1e6, 0.0, -1e6]),
        (1.0, [-1e6, 1e6, 1e6]),
    ] {
        for (found, truth) in picture(scale, origin).iter().zip(&truth) {
            let error = relative_rmse(found, truth);
            assert!(error < 1e-3, "{scale} {origin:?}: {error}");
        }
    }
}

#[test]
fn a_white_convex_body_in_a_white_furnace_neither_gains_nor_loses() {
    // The sky is uniform, the ground white: light of one luminance comes from everywhere.
    let mut scene = scene(
        &cuboid(DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, 3.0, 1.0)),
        0.0,
        -30.0,
    );
    scene.materials = vec![material(1.0)];
    scene.sky = SkyEntry {
        model: Some("uniform:5000".into()),
        ..SkyEntry::default()
    };
    scene.ground.enabled = true;
    scene.ground.height = Some(-200.0);
    scene.ground.albedo = 1.0;
    let camera = Camera::look_at(
        DVec3::new(2.0, 1.2, 5.0),
        DVec3::new(0.0, 2.0, 0.0),
        60.0 * DEG,
    );
    let frame = render(&conditions(scene, camera, [48, 36]));
    let background = layer(&frame, Field::Background);
    let sky_luminance = background.iter().map(|v| v.y).fold(0.0, f64::max);
    let mut on_body = 0;
    let (sky, indirect) = (layer(&frame, Field::Sky), layer(&frame, Field::Indirect));
    let mut worst = 0.0f64;
    for i in 0..frame.pixels() {
        if frame.depth[i] < 50.0 {
            on_body += 1;
            let sent = sky[i] + indirect[i];
            worst = worst.max((sent.y / sky_luminance - 1.0).abs());
        }
    }
    eprintln!("{on_body} pixels, off by {worst:.1e}");
    assert!(worst < 5e-3, "{worst}");
    assert!(on_body > 200, "{on_body}");
}

#[test]
fn hard_cases_stay_finite_and_in_order() {
    let room = || {
        let mut triangles = cuboid(DVec3::new(-3.0, 0.0, -3.0), DVec3::new(3.0, 3.0, 3.0));
        triangles.truncate(10);
        triangles
    };
    let suns = [
        (0.0, 90.0),
        (0.0, 0.0),
        (180.0, 0.2),
        (90.0, -0.1),
        (0.0, -5.0),
        (0.0, 30.0),
        (0.0, 1e-9),
    ];
    let sizes = [[1, 1], [1, 7], [13, 5]];
    let extinctions = [0.0, 1e-300, 1e-9, 0.05, 1e6, 1e12];
    for (azimuth, elevation) in suns {
        let sun = toward(azimuth * DEG, elevation * DEG, 0.0);
        for (k, extinction) in extinctions.into_iter().enumerate() {
            for eye in [
                DVec3::new(0.0, 1.5, 0.0),
                DVec3::new(-3.0, 1.0, 0.0),
                DVec3::new(0.0, 50.0, 40.0),
            ] {
                for forward in [
                    sun,
                    -sun,
                    DVec3::Y,
                    DVec3::NEG_Y,
                    sun.any_orthonormal_vector(),
                ] {
                    let mut scene = scene(&room(), azimuth, elevation);
                    if let Some(entry) = &mut scene.sun {
                        entry.diameter_deg = [Some(0.0), None, Some(5.0)][k % 3];
                    }
                    scene.sky.model = Some("preetham".into());
                    scene.ground.enabled = true;
                    scene.media = vec![
                        fog(
                            Shape::Haze { top: 20.0 },
                            extinction,
                            extinction,
                            Phase::NishitaMurky,
                        ),
                        fog(
                            Shape::Box {
                                min: DVec3::splat(-2.0),
                                max: DVec3::splat(2.0),
                            },
                            extinction,
                            0.0,
                            Phase::CornetteShanks { g: -0.9 },
                        ),
                        fog(
                            Shape::Height {
                                base: 0.0,
                                scale_height: 30.0,
                                far: 1e5,
                            },
                            extinction,
                            0.0,
                            Phase::Rayleigh,
                        ),
                    ];
                    scene.media.truncate(1 + k % 3);
                    let size = sizes[k % sizes.len()];
                    let mut camera = Camera::look_at(eye, eye + forward, 60.0 * DEG);
                    camera.projection = match k % 3 {
                        0 => Projection::Perspective { fov_y: 60.0 * DEG },
                        1 => Projection::Orthographic { height: 3.0 },
                        _ => Projection::Panorama,
                    };
                    // `render_at` checks that everything is finite and nothing negative.
                    let frame = render_at(&conditions(scene, camera, size), Quality::Draft, LEAST);
                    if elevation < -0.5 {
                        assert!(
                            frame.layer("sun").is_none() && frame.layer("inscatter_sun").is_none()
                        );
                    }
                    assert!(frame.transmittance.iter().all(|t| t.max_element() <= 1.0));
                }
            }
        }
    }
}

#[test]
fn the_disc_keeps_its_energy_however_small_it_is() {
    // The sun's illuminance is the sum over pixels of luminance times solid angle, in a picture that holds the disc.
    for (diameter, size, fov) in [
        (0.533, [41u32, 31u32], 20.0),
        (0.533, [640, 480], 1.0),
        (6.0, [80, 60], 12.0),
        (1e-3, [5, 5], 60.0),
    ] {
        for centre in [DVec2::ZERO, DVec2::new(0.21, -0.13)] {
            let mut scene = scene(&speck(), 10.0, 40.0);
            if let Some(entry) = &mut scene.sun {
                entry.diameter_deg = Some(diameter);
            }
            let sun = toward(10.0 * DEG, 40.0 * DEG, 0.0);
            let mut camera = Camera::look_at(DVec3::ZERO, sun, fov * DEG);
            camera.shift = centre / DVec2::new(f64::from(size[0]), f64::from(size[1]));
            let frame = render(&conditions(scene, camera, size));
            let half = (0.5 * fov * DEG).tan();
            let mut sum = 0.0;
            for (i, value) in layer(&frame, Field::Background).iter().enumerate() {
                let at = DVec2::new(
                    f64::from(i as u32 % size[0]) + 0.5,
                    f64::from(i as u32 / size[0]) + 0.5,
                );
                // Solid angle of a pixel on the image plane at distance 1: area cos^3, by 8 x 8 points.
                let side = 2.0 * half / f64::from(size[1]);
                let cells = if size[0] < 50 { 64 } else { 8 };
                let mut solid = 0.0;
                for u in 0..cells {
                    for v in 0..cells {
                        let p = at - 0.5
                            + (DVec2::new(f64::from(u), f64::from(v)) + 0.5) / f64::from(cells);
                        let r = camera.ray(p, size).direction;
                        solid += r.dot(sun).powi(3) * (side / f64::from(cells)).powi(2);
                    }
                }
                sum += value.x * solid;
            }
            assert!((sum / 1e5 - 1.0).abs() < 2e-4, "{diameter} {size:?}: {sum}");
        }
    }
}
