//! Sunlight in the air: every method against the reference.

mod common;

use common::build::layer;
use common::scenes::soup;
use common::shafts::*;
use common::views::*;
use glam::{DVec2, DVec3};
use tyndall::conditions::{CameraChoice, Conditions, Request, toward};
use tyndall::effect::{
    Contribution, Decision, Effect, Field, Method, Over, Pass, Resource, When, rows, sun_beams,
};
use tyndall::frame::Frame;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Quality, Step};
use tyndall::scene::{self as files, Camera, Projection};

/// Pictures in which errors are measured [pixels].
const PICTURE: [u32; 2] = [192, 144];

/// Buildings by others, seen from inside, with fog in them and the sun through their openings.
fn interiors(test: &str) -> Vec<(String, Conditions)> {
    let Some(folder) = common::data(test) else {
        return Vec::new();
    };
    let of = |name: &str, [azimuth, elevation]: [f64; 2]| {
        let mut scene = files::load(&folder.join("scenes").join(name)).expect("the scene is sound");
        scene.sun = Some(point_sun(azimuth, elevation));
        let (min, max) = scene.mesh.bounds().expect("it has triangles");
        let size = (max - min).length();
        let phase = Phase::HenyeyGreenstein { g: 0.6 };
        // A quarter of the way along its longer side.
        let sides = max - min;
        let mut eye = 0.5 * (min + max);
        eye.y = min.y + 1.6f64.min(0.5 * sides.y);
        let ahead = if sides.z >= sides.x {
            DVec3::NEG_Z
        } else {
            DVec3::X
        };
        eye -= 0.25 * ahead * (ahead * sides).length();
        let inside = Camera::look_at(eye, eye + ahead, 60f64.to_radians());
        scene.media = vec![fog(Shape::Box { min, max }, 0.3 / size, 0.03 / size, phase)];
        let request = Request {
            size: Some(PICTURE),
            samples: Some(1),
            camera: CameraChoice::Given(inside),
            ..Request::default()
        };
        let made = Conditions::new(scene, &request).expect("the scene is sound");
        (name.to_owned(), made)
    };
    vec![of("gazebo/gazebo.obj", [140.0, 30.0])]
}

/// The scenes in which errors are measured, those by others where they are available.
fn scenes(test: &str) -> Vec<(String, Conditions)> {
    let made = [
        slit(),
        gates(),
        slats(1.0),
        forest(700),
        colonnade(),
        mountains(),
        antisolar(),
        hills(),
    ];
    let mut all: Vec<(String, Conditions)> = made
        .iter()
        .map(|view| {
            let made = view.conditions(PICTURE).expect("the scene is sound");
            (view.name.to_owned(), made)
        })
        .collect();
    all.extend(interiors(test));
    all
}

#[test]
fn rectified_is_within_one_percent_at_the_default_quality_and_nearer_at_high() {
    let test = "rectified_is_within_one_percent_at_the_default_quality_and_nearer_at_high";
    if !common::gpu(test) {
        return;
    }
    for (name, conditions) in &scenes(test) {
        let truth = by_reference(conditions, &[]);
        for (quality, most, most_bias) in [
            (Quality::Preview, 0.01, 0.002),
            (Quality::High, 0.005, 0.0005),
        ] {
            let plan = plan(conditions, Method::Rectified, quality, &[]);
            let (rmse, bias) = error(&render(&plan).frame, &truth);
            eprintln!("{name:<10} {} {rmse:.5} {bias:+.5}", quality.name());
            assert!(
                rmse < most && bias.abs() < most_bias,
                "{name}: {rmse} {bias}"
            );
        }
    }
}

#[test]
fn the_comparison_notices_a_sun_that_is_off() {
    let test = "the_comparison_notices_a_sun_that_is_off";
    if !common::gpu(test) {
        return;
    }
    for view in [slit(), slats(1.0), forest(700), colonnade(), antisolar()] {
        let truth = by_reference(&view.conditions(PICTURE).expect("sound"), &[]);
        let mut moved = view.clone();
        if let Some(sun) = &mut moved.scene.sun {
            sun.azimuth_deg += 0.5;
        }
        let moved = moved.conditions(PICTURE).expect("sound");
        for method in [Method::Rectified, Method::Epipolar] {
            let (rmse, _) = error(&by_gpu(&moved, method, &[]), &truth);
            eprintln!("{} {method:?} {rmse:.4}", view.name);
            assert!(rmse > 0.012, "{} {method:?}: {rmse}", view.name);
        }
    }
}

/// What the other methods may be off by at the default quality: [`Method::Prefiltered`] is for the outdoors.
#[test]
fn every_method_comes_near_the_reference_where_it_is_meant_to() {
    let test = "every_method_comes_near_the_reference_where_it_is_meant_to";
    if !common::gpu(test) {
        return;
    }
    for (view, epipolar, prefiltered) in [
        (gates(), 0.01, f64::INFINITY),
        (slats(1.0), 0.01, f64::INFINITY),
        (forest(700), 0.01, 0.04),
        (colonnade(), 0.01, 0.015),
        (mountains(), 0.01, 0.04),
        (antisolar(), 0.01, 0.01),
        (hills(), 0.01, 0.025),
    ] {
        let conditions = view.conditions(PICTURE).expect("sound");
        let truth = by_reference(&conditions, &[]);
        for (method, most) in [
            (Method::Epipolar, epipolar),
            (Method::Prefiltered, prefiltered),
        ] {
            let (rmse, bias) = error(&by_gpu(&conditions, method, &[]), &truth);
            eprintln!("{} {method:?} {rmse:.5} {bias:+.5}", view.name);
            assert!(rmse < most, "{} {method:?}: {rmse}", view.name);
        }
    }
}

#[test]
fn the_error_falls_as_rows_columns_and_maps_double() {
    let test = "the_error_falls_as_rows_columns_and_maps_double";
    if !common::gpu(test) {
        return;
    }
    for view in [slats(1.0), colonnade(), forest(700), gates()] {
        let conditions = view.conditions(PICTURE).expect("sound");
        let truth = by_reference(&conditions, &[]);
        let errors: Vec<f64> = [1.0, 2.0, 4.0]
            .iter()
            .map(|finer| {
                let set = [
                    ("shafts.halvings", 0.0),
                    ("shafts.rows", 512.0 * finer),
                    ("shafts.columns", 512.0 * finer),
                    ("shadow.resolution", 1024.0 * finer),
                    ("shadow.density", 1024.0),
                ];
                error(&by_gpu(&conditions, Method::Rectified, &set), &truth).0
            })
            .collect();
        eprintln!("{}: {errors:.5?}", view.name);
        // Over two doublings: one of them alone may be lucky.
        let factor = (errors[2] / errors[0]).sqrt();
        assert!(factor <= 0.6, "{}: {errors:?} {factor}", view.name);
    }
}

#[test]
fn air_without_occluder_is_the_same_by_every_method() {
    let test = "air_without_occluder_is_the_same_by_every_method";
    if !common::gpu(test) {
        return;
    }
    let mut view = colonnade();
    // One small triangle far below, since a scene must have one; the sun's own pixel is in the picture.
    let low = DVec3::new(0.0, -50.0, 0.0);
    view.scene.mesh = scene(
        &[[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]],
        0.0,
        0.0,
    )
    .mesh;
    let conditions = view.conditions([65, 49]).expect("sound");
    let truth = by_reference(&conditions, &[]);
    for method in [
        Method::Rectified,
        Method::Epipolar,
        Method::Prefiltered,
        Method::March,
    ] {
        let found = by_gpu(&conditions, method, &[]);
        for (a, b) in layer(&found, Field::InscatterSun)
            .iter()
            .zip(layer(&truth, Field::InscatterSun))
        {
            assert!(
                (a.x / b.x - 1.0).abs() < 1e-4,
                "{method:?}: {} {}",
                a.x,
                b.x
            );
        }
    }
}

#[test]
fn nothing_leaks_under_a_roof() {
    let test = "nothing_leaks_under_a_roof";
    if !common::gpu(test) {
        return;
    }
    let mut view = slats(1.0);
    let roof = quad(
        DVec3::new(-500.0, 4.5, -500.0),
        DVec3::X * 1000.0,
        DVec3::Z * 1000.0,
    );
    view.scene.mesh = scene(&roof, 0.0, 0.0).mesh;
    let conditions = view.conditions([64, 48]).expect("sound");
    // The prefiltered method interpolates between thresholds and leaks some of the light over the roof.
    for method in [Method::Rectified, Method::Epipolar, Method::March] {
        let found = by_gpu(&conditions, method, &[]);
        let light = layer(&found, Field::InscatterSun);
        assert!(light.iter().all(|v| *v == DVec3::ZERO), "{method:?}");
    }
}

#[test]
fn what_is_alike_on_both_sides_of_the_sun_has_such_a_picture() {
    let test = "what_is_alike_on_both_sides_of_the_sun_has_such_a_picture";
    if !common::gpu(test) {
        return;
    }
    // Slats along the view, the sun above it: left is as right. Rows are few, so that it matters where in one its place is.
    let mut triangles = Vec::new();
    for x in [0.3, 1.3, 2.3, 3.3] {
        for side in [x, -x - 0.5] {
            triangles.extend(cuboid(
                DVec3::new(side, 3.9, -8.0),
                DVec3::new(side + 0.5, 4.0, 8.0),
            ));
        }
    }
    let mut view = slats(1.0);
    view.scene.mesh = scene(&triangles, 0.0, 0.0).mesh;
    view.scene.sun = Some(point_sun(0.0, 50.0));
    let (min, max) = (DVec3::new(-4.0, 0.0, -8.0), DVec3::new(4.0, 3.9, 8.0));
    view.scene.media = vec![fog(Shape::Box { min, max }, 0.06, 0.01, Phase::Isotropic)];
    let eye = DVec3::new(0.0, 1.5, 6.0);
    view.camera = Camera::look_at(eye, eye + DVec3::NEG_Z, 50f64.to_radians());
    let conditions = view.conditions([64, 48]).expect("sound");
    let set = [
        ("shafts.rows", 8.0),
        ("shafts.halvings", 0.0),
        ("shadow.resolution", 4096.0),
        ("shadow.density", 1024.0),
    ];
    let light = layer(
        &by_gpu(&conditions, Method::Rectified, &set),
        Field::InscatterSun,
    );
    let (mut off, mut all) = (0.0, 0.0);
    for row in light.chunks(64) {
        for (left, right) in row.iter().zip(row.iter().rev()) {
            off += (left.x - right.x).abs();
            all += left.x;
        }
    }
    eprintln!("left and right are {:.5} apart", off / all);
    assert!(all > 0.0 && off < 0.01 * all, "{}", off / all);
}

#[test]
fn every_camera_is_the_same_to_rows() {
    let test = "every_camera_is_the_same_to_rows";
    if !common::gpu(test) {
        return;
    }
    for (view, projection, shift, size) in [
        (
            slats(1.0),
            Some(Projection::Orthographic { height: 6.0 }),
            DVec2::new(0.05, -0.1),
            [192, 128],
        ),
        (
            colonnade(),
            Some(Projection::Orthographic { height: 12.0 }),
            DVec2::ZERO,
            [192, 128],
        ),
        (
            slats(1.0),
            Some(Projection::Panorama),
            DVec2::ZERO,
            [512, 128],
        ),
        (
            antisolar(),
            Some(Projection::Panorama),
            DVec2::ZERO,
            [256, 128],
        ),
        (gates(), None, DVec2::new(0.3, 0.4), [192, 128]),
    ] {
        let mut view = view;
        view.camera.projection = projection.unwrap_or(view.camera.projection);
        view.camera.shift = shift;
        let conditions = view.conditions(size).expect("sound");
        let truth = by_reference(&conditions, &[]);
        for method in [Method::Rectified, Method::Epipolar] {
            let (rmse, bias) = error(&by_gpu(&conditions, method, &[]), &truth);
            eprintln!(
                "{} {projection:?} {method:?} {rmse:.5} {bias:+.5}",
                view.name
            );
            assert!(
                rmse < 0.01,
                "{} {projection:?} {method:?}: {rmse}",
                view.name
            );
        }
    }
}

#[test]
fn a_sun_across_the_view_is_no_special_case() {
    let test = "a_sun_across_the_view_is_no_special_case";
    if !common::gpu(test) {
        return;
    }
    let base = slats(1.0);
    let forward = base.camera.axes()[2];
    // The azimuth at which the sun stands exactly across the view, at its own elevation: cos e (s sin A - c cos A) + ...
    let elevation: f64 = 50f64.to_radians();
    let across = |azimuth: f64| toward(azimuth, elevation, 0.0).dot(forward);
    let (mut low, mut high) = (45f64.to_radians(), 135f64.to_radians());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if across(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let errors: Vec<f64> = (-12..=12)
        .map(|step| {
            let mut view = base.clone();
            if let Some(sun) = &mut view.scene.sun {
                sun.azimuth_deg = low.to_degrees() + 0.01 * f64::from(step);
            }
            let conditions = view.conditions([192, 144]).expect("sound");
            let truth = by_reference(&conditions, &[]);
            error(&by_gpu(&conditions, Method::Rectified, &[]), &truth).0
        })
        .collect();
    let mut sorted = errors.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    eprintln!("{errors:.5?}");
    assert!(sorted[24] < 1.2 * sorted[12], "{errors:.5?}");
    assert!(sorted[24] < 0.01);
}

/// Walls that the light runs along have no shadow, though their neighbours over an edge have: all of a building's sides under
/// a sun at the zenith, half of them under one in the south.
#[test]
fn walls_along_the_light_throw_no_shadow() {
    let test = "walls_along_the_light_throw_no_shadow";
    if !common::gpu(test) {
        return;
    }
    for [azimuth_deg, elevation_deg] in [[37.0, 90.0], [180.0, 45.0], [0.0, 30.0], [90.0, 60.0]] {
        for mut view in [gates(), slats(1.0), colonnade()] {
            if let Some(sun) = &mut view.scene.sun {
                (sun.azimuth_deg, sun.elevation_deg) = (azimuth_deg, elevation_deg);
            }
            let conditions = view.conditions([128, 96]).expect("sound");
            let truth = by_reference(&conditions, &[]);
            let (rmse, bias) = error(&by_gpu(&conditions, Method::Rectified, &[]), &truth);
            eprintln!(
                "{} {azimuth_deg} {elevation_deg}: {rmse:.5} {bias:+.5}",
                view.name
            );
            assert!(
                rmse < 0.01 && bias.abs() < 0.002,
                "{}: {rmse} {bias}",
                view.name
            );
        }
    }
}

#[test]
fn the_suns_place_sweeps_over_pixels_corners_and_behind() {
    let test = "the_suns_place_sweeps_over_pixels_corners_and_behind";
    if !common::gpu(test) {
        return;
    }
    let base = colonnade();
    // Exactly into a pixel's centre, toward and away from the sun, and to the picture's corner.
    let size = [65, 49];
    for (x, y, sign) in [
        (32.5, 24.5, 1.0),
        (0.5, 0.5, 1.0),
        (0.0, 0.0, 1.0),
        (65.0, 24.5, 1.0),
        (32.5, 24.5, -1.0),
        (32.5, 0.5, -1.0),
    ] {
        let mut view = base.clone();
        let eye = view.camera.eye;
        let ahead = DVec3::new(0.0, 0.35 * sign, -1.0);
        view.camera = Camera::look_at(eye, eye + ahead, 60f64.to_radians());
        let sun = sign * view.camera.ray(DVec2::new(x, y), size).direction;
        if let Some(entry) = &mut view.scene.sun {
            entry.azimuth_deg = sun.x.atan2(-sun.z).to_degrees();
            entry.elevation_deg = sun.y.asin().to_degrees();
        }
        let conditions = view.conditions(size).expect("sound");
        let truth = by_reference(&conditions, &[]);
        let (rmse, _) = error(&by_gpu(&conditions, Method::Rectified, &[]), &truth);
        eprintln!("{x} {y} {sign}: {rmse:.5}");
        assert!(rmse < 0.01, "{x} {y} {sign}: {rmse}");
    }
}

#[test]
fn pictures_depend_on_neither_units_nor_origin_nor_repetition() {
    let test = "pictures_depend_on_neither_units_nor_origin_nor_repetition";
    if !common::gpu(test) {
        return;
    }
    let picture = |view: &StudyView| {
        by_gpu(
            &view.conditions([128, 96]).expect("sound"),
            Method::Rectified,
            &[],
        )
    };
    let truth = picture(&slats(1.0));
    assert!(
        truth == picture(&slats(1.0)),
        "the same input makes other bytes"
    );
    for scale in [2f64.powi(-10), 2f64.powi(13), 1e-3, 1e4] {
        let (rmse, _) = error(&picture(&slats(scale)), &truth);
        eprintln!("scale {scale}: {rmse:.2e}");
        // Where a place meets a texel's border to f32's last digit, it may fall to either side.
        assert!(rmse < 1e-3, "{scale}: {rmse}");
    }
    for shift in [DVec3::new(1e6, 0.0, -1e6), DVec3::new(6.4e6, 0.0, 0.0)] {
        let mut view = slats(1.0);
        for p in &mut view.scene.mesh.positions {
            *p += shift;
        }
        view.camera.eye += shift;
        if let Shape::Box { min, max } = &mut view.scene.media[0].shape {
            (*min, *max) = (*min + shift, *max + shift);
        }
        let (rmse, _) = error(&picture(&view), &truth);
        eprintln!("origin {shift}: {rmse:.2e}");
        assert!(rmse < 1e-3, "{shift}: {rmse}");
    }
}

#[test]
fn a_far_slit_has_the_edges_of_the_suns_disc() {
    let test = "a_far_slit_has_the_edges_of_the_suns_disc";
    if !common::gpu(test) {
        return;
    }
    let view = far_slit();
    let size = [8, 128];
    let conditions = view.conditions(size).expect("sound");
    // The share of a uniform disc's area on one side of a chord at x radii from its middle.
    let share = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / std::f64::consts::PI
    };
    let profile = |frame: &Frame| -> Vec<f64> {
        let light = layer(frame, Field::InscatterSun);
        (0..size[1] as usize)
            .map(|y| light[y * size[0] as usize + 4].x)
            .collect()
    };
    // Without the slit all is lit: what a place would get.
    let mut open = view.clone();
    let low = DVec3::new(0.0, -500.0, 0.0);
    open.scene.mesh = scene(
        &[[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]],
        0.0,
        0.0,
    )
    .mesh;
    let open = profile(&by_gpu(
        &open.conditions(size).expect("sound"),
        Method::Rectified,
        &[("shafts.disc", 0.0), ("shafts.suns", 1.0)],
    ));
    let off = |suns: f64| -> [f64; 2] {
        let set = [
            ("shafts.disc", 0.0),
            ("shafts.suns", suns),
            ("shadow.resolution", 2048.0),
            ("shadow.density", 1024.0),
        ];
        let found = profile(&by_gpu(&conditions, Method::Rectified, &set));
        let off: Vec<f64> = (0..size[1] as usize)
            .map(|y| {
                let at = DVec2::new(4.5, y as f64 + 0.5);
                let ray = conditions.view.camera.ray(at, size);
                // The middle of the fog along the ray: rays run down nearly straight.
                let middle = ray.origin + 60.0 / -ray.direction.y * ray.direction;
                let throw = (500.0 - middle.x) / 5f64.to_radians().cos();
                let radius = throw * (0.5 * 0.533f64).to_radians().tan();
                let expected =
                    share((middle.z + 1.5) / radius) + share((1.5 - middle.z) / radius) - 1.0;
                (found[y] / open[y] - expected).abs()
            })
            .collect();
        let square: f64 = off.iter().map(|e| e * e).sum();
        let worst = off.iter().copied().fold(0.0, f64::max);
        [(square / off.len() as f64).sqrt(), worst]
    };
    let [many, high, few, point] = [128.0, 16.0, 4.0, 1.0].map(off);
    eprintln!(
        "RMS and worst: 128 suns {many:.4?}, 16 {high:.4?}, 4 {few:.4?}, a point {point:.4?}"
    );
    assert!(many[1] < 0.02, "{many:?}");
    assert!(point[0] > 0.04 && point[1] > 0.2, "{point:?}");
}

#[test]
fn a_slow_sun_does_not_shimmer() {
    let test = "a_slow_sun_does_not_shimmer";
    if !common::gpu(test) {
        return;
    }
    // A degree in 60 frames; a third of them tell as much.
    for (diameter, view) in [(0.0, slats(1.0)), (0.533, slats(1.0)), (0.0, gates())] {
        let frames: Vec<(Vec<DVec3>, Vec<DVec3>)> = (0..20)
            .map(|i| {
                let mut view = view.clone();
                if let Some(sun) = &mut view.scene.sun {
                    sun.azimuth_deg += f64::from(i) / 60.0;
                    sun.diameter_deg = Some(diameter);
                }
                let conditions = view.conditions([128, 96]).expect("sound");
                let found = by_gpu(&conditions, Method::Rectified, &[]);
                let truth = by_reference(&conditions, &[("shafts.disc", 0.0)]);
                (
                    layer(&found, Field::InscatterSun),
                    layer(&truth, Field::InscatterSun),
                )
            })
            .collect();
        let n = frames[0].0.len();
        let off = |i: usize, p: usize| frames[i].0[p].x - frames[i].1[p].x;
        let mean: f64 = frames[0].1.iter().map(|v| v.x).sum::<f64>() / n as f64;
        let (mut own, mut second) = (0.0, 0.0);
        for i in 1..frames.len() - 1 {
            for p in 0..n {
                own += off(i, p).powi(2);
                second += (off(i - 1, p) - 2.0 * off(i, p) + off(i + 1, p)).powi(2);
            }
        }
        let count = (n * (frames.len() - 2)) as f64;
        let (own, second) = ((own / count).sqrt() / mean, (second / count).sqrt() / mean);
        // Errors are few pixels' whose row just misses a beam or a gap, so that they come and go; they are no more than this.
        let most = if diameter > 0.0 { 0.001 } else { 0.0015 };
        assert!(second < most, "{} {diameter}: {second}", view.name);
        eprintln!(
            "{} {diameter}: error {own:.5}, second difference {second:.5}, ratio {:.2}",
            view.name,
            second / own
        );
    }
}

/// Goes through every column of a pixel's row, and looks at every node of it: red is the relative difference between what tree
/// and columns give, green the number of nodes that do not enclose their leaves, blue whether there is light.
const BRUTE: Effect = Effect {
    name: "brute",
    summary: "rows without their trees",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1e9)),
    passes: &[
        rows::BEGIN,
        rows::MEASURE,
        rows::BUILD,
        Pass {
            shader: concat!(
                include_str!("../shaders/common/rows.wgsl"),
                "
fn threshold_of(row: u32, column: u32, blocks: u32) -> u32 {
    let pair = tree[tree_row(row, blocks) + column / 8u][(column / 2u) % 4u];
    return select(pair & 0xffffu, pair >> 16u, (column & 1u) != 0u);
}

fn strays(row: u32, blocks: u32) -> u32 {
    var found = 0u;
    var first = tree_row(row, blocks) + blocks;
    for (var level = 0u; level < 3u; level++) {
        let width = 8u << (2u * level);
        let count = blocks >> (2u * level + 2u);
        for (var node = 0u; node < count; node++) {
            for (var child = 0u; child < 4u; child++) {
                let bounds = tree[first + node][child];
                var least = 65535u;
                var greatest = 0u;
                for (var k = 0u; k < width; k++) {
                    let d = threshold_of(row, (4u * node + child) * width + k, blocks);
                    least = min(least, d);
                    greatest = max(greatest, d);
                }
                found += u32(bounds != (least | (greatest << 16u)));
            }
        }
        first += count;
    }
    return found;
}

@compute @workgroup_size(8, 8)
fn brute(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let span = shaded_span(origin, direction, surfaces[i]);
    let slice = slice_of(origin, direction);
    if span.shaded.y <= span.shaded.x || along_light(slice, span.shaded) {
        return;
    }
    let rows = rows_of(knobs.rows, knobs.columns);
    let blocks = rows.columns / 8u;
    let row = u32(clamp((slice.row - rows.first) / rows.step, 0.0, f32(rows.count - 1u)));
    let by_tree = scattered_in_row(origin, direction, slice, span, rows, row, 0u);
    let crossing = crossing_of(rows, slice, span.shaded);
    begin_runs(origin, direction, span.air, span.sources);
    var column = crossing.first;
    while column < crossing.last {
        while column < crossing.last && !is_full() {
            let t = column_distance(rows, slice, span, f32(column));
            turn(crossing.c >= threshold_of(row, column, blocks), select(t, span.shaded.x, column == crossing.first));
            column++;
        }
        integrate_runs();
    }
    turn(true, span.shaded.y);
    turn(false, span.air.y);
    integrate_runs();
    let off = abs(by_tree - run_sum) / max(run_sum, vec3f(1e-20));
    lights[i] = vec4f(max(off.x, max(off.y, off.z)), f32(strays(row, blocks)), f32(any(run_sum > vec3f(0.0))), 0.0);
}
"
            ),
            entry: "brute",
            over: Over::Pixels,
            when: When::EachBeam(sun_beams),
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Knobs(rows::knobs),
                Resource::Update(Field::Lights),
                Resource::Make(&rows::ASKED),
                Resource::Make(&rows::TREE),
            ],
        },
    ],
    ..Effect::NOTHING
};

#[test]
fn trees_enclose_their_leaves_and_give_what_every_column_gives() {
    let test = "trees_enclose_their_leaves_and_give_what_every_column_gives";
    if !common::gpu(test) {
        return;
    }
    let mut seen = 0;
    for seed in 1..=8 {
        // Triangles at random: rows at random.
        let mut scene = soup(30 * seed as usize, 0.3, seed, [40.0 * seed as f64, 35.0]);
        let (min, max) = (DVec3::splat(-1.2), DVec3::splat(1.2));
        let phase = Phase::HenyeyGreenstein { g: 0.3 };
        scene.media = vec![fog(Shape::Box { min, max }, 0.2, 0.05, phase)];
        let camera = Camera::look_at(DVec3::new(0.3, 0.2, 3.0), DVec3::ZERO, 50f64.to_radians());
        let view = StudyView {
            name: "soup",
            scene,
            camera,
        };
        let conditions = view.conditions([24, 16]).expect("sound");
        let mut plan = plan(&conditions, Method::Rectified, Quality::Preview, &[]);
        let settings = vec![
            ("disc", 0.0),
            ("suns", 1.0),
            ("rows", 64.0),
            ("columns", 1024.0),
        ];
        let compose = plan
            .steps
            .iter()
            .position(|step| step.effect.name == "compose");
        plan.steps.insert(
            compose.expect("there is compose"),
            Step {
                effect: &BRUTE,
                decision: (BRUTE.decide)(&conditions),
                settings,
            },
        );
        for found in layer(&render(&plan).frame, Field::Lights) {
            assert!(found.x < 1e-6, "{seed}: {found}");
            assert!(found.y == 0.0, "{seed}: {found}");
            seen += usize::from(found.z > 0.0);
        }
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn one_point_stands_for_the_sun_where_its_edges_are_narrower_than_a_pixel() {
    let base = gates();
    let at = |distance: f64, size: [u32; 2]| {
        let mut view = base.clone();
        view.scene.sun.as_mut().expect("it has a sun").diameter_deg = Some(0.533);
        let back = view.camera.axes()[2];
        view.camera.eye -= distance * back;
        view.camera.eye.y = view.camera.eye.y.max(1.0);
        view.conditions(size).expect("sound")
    };
    let small = [256, 192];
    let near = at(0.0, small);
    assert!(near.widest_penumbra() > 10.0);
    assert_eq!(near.sun_beams(4).len(), 4);
    // The eye in the shadow of all.
    assert_eq!(at(-16.0, small).widest_penumbra(), f64::INFINITY);
    // Edges of 0.3 m at 300 m are 0.06 degrees wide; a pixel of a small picture has 0.3 degrees, one of a large picture 0.03.
    let far = at(300.0, small);
    let pixels = far.widest_penumbra();
    assert!(pixels > 0.1 && pixels < 1.0, "{pixels}");
    assert_eq!(far.sun_beams(4).len(), 1);
    let large = at(300.0, [2560, 1920]);
    assert!((large.widest_penumbra() / pixels / 10.0 - 1.0).abs() < 0.02);
    assert_eq!(large.sun_beams(4).len(), 4);
}
