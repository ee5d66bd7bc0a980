//! Panes: what glass lets through by its angle, and where its colours fall, on surfaces, in the air and to the eye.

mod common;

use common::build::*;
use common::night::{DEG, box_of_fog, lamp, night, rendered_without};
use common::panes::*;
use common::receive::{at, received};
use common::{receive, shafts};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::{Conditions, Receiver};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::Phase;
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::radiosity::{Care, Detail, Light, Transport};
use tyndall::scene::glass::{Incidence, MOST_PANES};
use tyndall::scene::{AlphaMode, Camera, Ray, Scene, SunEntry, Texture, Wrap};
use tyndall::sky::Model;
use tyndall::task::Task;

#[test]
fn glass_lets_through_what_all_reflections_add_up_to() {
    let mut worst = 0.0f64;
    for count in 1..=MOST_PANES {
        for normal in [0.01, 0.3, 0.5, 0.72, 0.9, 0.95, 1.0] {
            for degrees in [0.0, 10.0, 30.0, 45.0, 56.7, 60.0, 75.0, 85.0, 89.0] {
                let angle: f64 = degrees * DEG;
                let found = Incidence::new(angle.cos()).transmittance(normal, count);
                let truth = glass(normal, angle, count);
                worst = worst.max((found - truth).abs());
            }
        }
    }
    assert!(worst < 1e-10, "{worst:e}");
    // At 60 degrees the angle is no trifle.
    let clear = |degrees: f64| Incidence::new((degrees * DEG).cos()).transmittance(0.918, 1);
    assert!((clear(60.0) - 0.8435).abs() < 0.001 && clear(0.0) - clear(60.0) > 0.07);
}

/// A sheet at a height, wide enough for all that follows.
fn sheet(height: f64, factor: f64) -> Window {
    Window::plain(
        dvec3(-40.0, height, -40.0),
        [DVec3::X * 80.0, DVec3::Z * 80.0],
        factor,
    )
}

/// A floor at height 0 under the sun of an elevation [degrees] in the south, and panes.
fn floor(windows: &[Window], elevation: f64, diameter: f64) -> Scene {
    let floor = quad(dvec3(-5.0, 0.0, -5.0), DVec3::Z * 10.0, DVec3::X * 10.0);
    let mut scene = scene(&floor, 180.0, elevation);
    scene.sun = Some(SunEntry {
        azimuth_deg: 180.0,
        elevation_deg: elevation,
        illuminance: Some(1e5),
        diameter_deg: Some(diameter),
    });
    windows
        .iter()
        .for_each(|window| window.put_into(&mut scene));
    scene
}

fn backends() -> Vec<Wanted> {
    match common::gpu("panes") {
        true => vec![Wanted::Reference, Wanted::Gpu],
        false => vec![Wanted::Reference],
    }
}

/// How far two colours are apart, as a share of the greatest channel.
fn between(found: DVec3, truth: DVec3) -> f64 {
    (found - truth).abs().max_element() / truth.max_element()
}

fn near(found: DVec3, truth: DVec3, share: f64) -> bool {
    (found - truth).abs().max_element() <= share * truth.max_element()
}

/// Tells the worst of what was compared.
fn told(what: &str, worst: f64) {
    eprintln!("{what}: at most {:.4} % off", 100.0 * worst);
}

/// Sunlight alone on points.
fn sunlight(conditions: &Conditions, wanted: Wanted) -> Vec<DVec3> {
    let overrules = Overrules {
        quality: Quality::High,
        without: vec!["radiosity".into()],
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let rendered = Backend::open(wanted)
        .and_then(|mut backend| backend.render(&plan, &Limits::default(), &|_| {}));
    layer(&rendered.expect("it works").frame, Field::Sun)
}

#[test]
fn a_floor_under_panes_gets_what_they_let_through() {
    let mut worst = 0.0f64;
    let point = [at(dvec3(0.3, 0.0, 0.2), DVec3::Y)];
    let coloured_sheet = Window {
        columns: vec![[230, 90, 30]],
        count: 2,
        ..sheet(2.0, 0.9)
    };
    for wanted in backends() {
        for (elevation, diameter) in [(90.0, 0.0), (35.0, 0.0), (35.0, 0.53), (12.0, 0.53)] {
            for windows in [
                vec![sheet(2.0, 0.72)],
                vec![sheet(2.0, 1.0)],
                vec![Window {
                    count: 2,
                    ..sheet(2.0, 0.6)
                }],
                vec![coloured_sheet.clone()],
                // Two in a row multiply.
                vec![sheet(2.0, 0.72), coloured_sheet.clone()],
            ] {
                let angle = (90.0 - elevation) * DEG;
                let through: DVec3 = windows
                    .iter()
                    .map(|w| coloured(w.colour(0), angle, w.count))
                    .product();
                let scene = floor(&windows, elevation, diameter);
                let conditions = receive::conditions(scene, &point);
                let found = sunlight(&conditions, wanted)[0];
                let truth = 1e5 * (elevation * DEG).sin() * through;
                worst = worst.max(between(found, truth));
                assert!(
                    near(found, truth, 1e-3),
                    "{elevation} {diameter}: {found} {truth}"
                );
                // Neither without the angle nor without the colours.
                if elevation < 20.0 {
                    let plain: DVec3 = windows.iter().map(|w| w.colour(0)).product();
                    assert!(!near(found, 1e5 * (elevation * DEG).sin() * plain, 0.05));
                }
            }
        }
    }
    told("floor", worst);
}

/// Red and blue side by side, upright, 2 m wide, from 0.5 to 2.5 m above the floor, in front of the sun.
fn upright() -> Window {
    Window {
        corner: dvec3(-1.0, 0.5, 2.0),
        edges: [DVec3::X * 2.0, DVec3::Y * 2.0],
        factor: 0.9,
        columns: vec![[250, 60, 40], [40, 80, 240]],
        count: 1,
    }
}

fn pictures(conditions: &Conditions, quality: Quality, without: &[&str]) -> Vec<Frame> {
    let overrules = Overrules {
        quality,
        without: without.iter().map(|name| name.to_string()).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let one = |wanted: Wanted| {
        if wanted == Wanted::Gpu {
            return shafts::render(&plan).frame;
        }
        let rendered = Backend::open(wanted)
            .and_then(|mut backend| backend.render(&plan, &Limits::default(), &|_| {}));
        let frame = rendered.expect("it works").frame;
        frame.check().expect("every value is sound");
        frame
    };
    backends().into_iter().map(one).collect()
}

#[test]
fn patterns_fall_where_geometry_says() {
    let window = upright();
    let scene = floor(std::slice::from_ref(&window), 40.0, 0.0);
    let camera = Camera::look_at(dvec3(1.5, 3.0, -4.5), dvec3(0.0, 0.0, 0.0), 0.8);
    let size = [96, 64];
    let seen = conditions(scene, camera, size);
    let toward = seen.sun.toward;
    let grey = DVec3::splat(0.5 / PI * 1e5 * toward.y);
    let truth: Vec<Option<DVec3>> = (0..size[0] * size[1])
        .map(|i| {
            let pixel = DVec2::new(f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
            let ray = seen.view.ray(pixel);
            let at = ray.at(-ray.origin.y / ray.direction.y);
            if ray.direction.y >= 0.0 || at.abs().max_element() > 5.0 {
                return None;
            }
            let light = Ray {
                origin: at,
                direction: toward,
            };
            let distance = at.distance(ray.origin);
            Some(window.leaves(&light, 1e9) * window.leaves(&ray, distance) * grey)
        })
        .collect();
    let width = size[0] as usize;
    let is_even = |i: usize| {
        let around = (-2i32..=2).flat_map(|y| (-2i32..=2).map(move |x| x + y * width as i32));
        let mut others = around.map(|d| truth.get((i as i32 + d) as usize).copied().flatten());
        others.all(|o| o.is_some_and(|o| near(o, truth[i].unwrap_or_default(), 0.02)))
    };
    for frame in pictures(&seen, Quality::High, &["radiosity", "sky_dome"]) {
        let found = layer(&frame, Field::Sun);
        let (mut colours, mut worst) = ([0; 3], 0.0f64);
        for i in (0..truth.len()).filter(|i| truth[*i].is_some() && is_even(*i)) {
            let truth = truth[i].unwrap_or_default();
            worst = worst.max(between(found[i], truth));
            assert!(near(found[i], truth, 5e-3), "{i}: {} {truth}", found[i]);
            let kind = [truth.x > 2.0 * truth.z, truth.z > 2.0 * truth.x];
            colours[match kind {
                [true, _] => 0,
                [_, true] => 1,
                _ => 2,
            }] += 1;
        }
        told("patterns", worst);
        assert!(colours.iter().all(|count| *count > 50), "{colours:?}");
    }
}

#[test]
fn the_disc_blurs_an_edge_by_its_own_profile() {
    let radius = 0.265 * DEG;
    for height in [2.0, 8.0] {
        let window = Window {
            columns: vec![[255; 3], [128; 3]],
            ..sheet(height, 0.9)
        };
        let [left, right] = [0, 1].map(|column| glass(window.colour(column).x, 0.0, 1));
        let half = height * radius.tan();
        let places: Vec<f64> = (-8..=8).map(|i| f64::from(i) / 6.0).collect();
        let points: Vec<Receiver> = places
            .iter()
            .map(|s| at(dvec3(s * half, 0.0, 0.1), DVec3::Y))
            .collect();
        let scene = floor(&[window], 90.0, 0.53);
        let found = sunlight(&receive::conditions(scene, &points), Wanted::Reference);
        let mut worst = 0.0f64;
        for (s, found) in places.iter().zip(found) {
            // Of a uniform disc, what lies beyond a line.
            let s = s.clamp(-1.0, 1.0);
            let beyond = 0.5 + (s * (1.0 - s * s).sqrt() + s.asin()) / PI;
            let truth = 1e5 * (left + beyond * (right - left));
            worst = worst.max((found.x / truth - 1.0).abs());
            assert!(
                (found.x / truth - 1.0).abs() < 3e-3,
                "{height} {s}: {} {truth}",
                found.x
            );
        }
        told("profile", worst);
    }
}

/// What the fog of [`box_of_fog`] scatters to the eye of light that comes `toward` a place, by steps along the ray.
struct Fog {
    half: f64,
    scattering: f64,
    absorption: f64,
    g: f64,
}

impl Fog {
    /// Distances at which a ray enters and leaves it.
    fn chord(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let [a, b] = [-self.half, self.half].map(|p| (p - origin[axis]) / direction[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        [enter, leave.max(enter)]
    }

    fn phase(&self, mu: f64) -> f64 {
        let g = self.g;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5))
    }

    /// Light of the sun, from as many directions as are given; `left` is what windows leave of a ray up to a distance.
    fn sunlit(
        &self,
        ray: &Ray,
        end: f64,
        suns: &[DVec3],
        left: impl Fn(&Ray, f64) -> DVec3,
        blocked: impl Fn(&Ray) -> bool,
    ) -> DVec3 {
        const STEPS: usize = 3000;
        let [enter, leave] = self.chord(ray.origin, ray.direction);
        let leave = leave.min(end);
        let step = (leave - enter).max(0.0) / STEPS as f64;
        let extinction = self.scattering + self.absorption;
        let mut sum = DVec3::ZERO;
        for i in 0..STEPS {
            let t = enter + step * (i as f64 + 0.5);
            let toward = suns[i % suns.len()];
            let light = Ray {
                origin: ray.at(t),
                direction: toward,
            };
            if blocked(&light) {
                continue;
            }
            let depth = extinction * (t - enter + self.chord(light.origin, toward)[1]);
            let through = left(&light, 1e9) * left(ray, t);
            sum += through * self.phase(ray.direction.dot(toward)) * (-depth).exp();
        }
        1e5 * self.scattering * step * sum
    }
}

/// A wall with the window of [`upright`] in it, and the floor behind.
fn walled(diameter: f64) -> (Scene, Vec<[DVec3; 3]>) {
    let window = upright();
    let mut triangles = Vec::new();
    for (low, high) in [
        (dvec3(-5.0, 0.0, 2.0), dvec3(-1.0, 4.0, 2.0)),
        (dvec3(1.0, 0.0, 2.0), dvec3(5.0, 4.0, 2.0)),
        (dvec3(-1.0, 0.0, 2.0), dvec3(1.0, 0.5, 2.0)),
        (dvec3(-1.0, 2.5, 2.0), dvec3(1.0, 4.0, 2.0)),
    ] {
        let size = high - low;
        triangles.extend(quad(low, DVec3::X * size.x, DVec3::Y * size.y));
    }
    let mut made = scene(&triangles, 220.0, 40.0);
    made.sun = Some(SunEntry {
        azimuth_deg: 220.0,
        elevation_deg: 40.0,
        illuminance: Some(1e5),
        diameter_deg: Some(diameter),
    });
    window.put_into(&mut made);
    (made, triangles)
}

fn is_blocked(triangles: &[[DVec3; 3]], ray: &Ray, far: f64) -> bool {
    triangles.iter().any(|[a, b, c]| {
        let (e, f, s) = (*b - *a, *c - *a, ray.origin - *a);
        let p = ray.direction.cross(f);
        let determinant = e.dot(p);
        let u = s.dot(p) / determinant;
        let q = s.cross(e);
        let v = ray.direction.dot(q) / determinant;
        let t = f.dot(q) / determinant;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < far
    })
}

/// Relative RMSE over all channels.
fn off(found: &[DVec3], truth: &[DVec3]) -> f64 {
    let mean = truth.iter().sum::<DVec3>().element_sum();
    let square: f64 = found
        .iter()
        .zip(truth)
        .map(|(a, b)| (*a - *b).length_squared())
        .sum();
    (square * 3.0 * truth.len() as f64).sqrt() / mean
}

/// What is left along a ray by some windows.
fn by<'a>(windows: &'a [Window]) -> impl Fn(&Ray, f64) -> DVec3 + 'a {
    move |ray, far| windows.iter().map(|w| w.leaves(ray, far)).product()
}

/// The same from tables of the windows' angles, for many rays.
fn tabled(window: &Window) -> impl Fn(&Ray, f64) -> DVec3 + use<> {
    const STEPS: usize = 512;
    let window = window.clone();
    let table: Vec<Vec<DVec3>> = (0..window.columns.len())
        .map(|column| {
            let at = |i: usize| 0.5 * PI * i as f64 / STEPS as f64;
            let colour = window.colour(column);
            (0..STEPS)
                .map(|i| coloured(colour, at(i), window.count))
                .chain([DVec3::ZERO])
                .collect()
        })
        .collect();
    move |ray, far| match window.crossed(ray).filter(|(distance, ..)| *distance < far) {
        None => DVec3::ONE,
        Some((_, column, angle)) => {
            let at = angle / (0.5 * PI) * STEPS as f64;
            let first = (at as usize).min(STEPS - 1);
            let [a, b] = [0, 1].map(|k| table[column][first + k]);
            a.lerp(b, at - first as f64)
        }
    }
}

fn truth_of(
    seen: &Conditions,
    size: [u32; 2],
    of: impl Fn(&Ray, f64) -> DVec3 + Sync,
) -> Vec<DVec3> {
    (0..size[0] * size[1])
        .map(|i| {
            let pixel = DVec2::new(f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
            let ray = seen.view.ray(pixel);
            let hit = seen.geometry.closest(&ray, 0.0, f64::INFINITY);
            of(&ray, hit.map_or(f64::INFINITY, |hit| hit.distance))
        })
        .collect()
}

#[test]
fn the_air_behind_a_window_is_what_many_shadow_rays_say() {
    let fog = Fog {
        half: 4.0,
        scattering: 0.05,
        absorption: 0.02,
        g: 0.4,
    };
    let window = upright();
    let left = tabled(&window);
    let size = [16, 12];
    for (diameter, eye) in [
        (0.0, dvec3(3.0, 1.2, -2.5)),
        (0.53, dvec3(3.0, 1.2, -2.5)),
        // From outside, through the window.
        (0.0, dvec3(0.8, 1.8, 3.6)),
    ] {
        let (mut scene, triangles) = walled(diameter);
        scene.media = vec![box_of_fog(
            fog.half,
            fog.scattering,
            fog.absorption,
            Phase::HenyeyGreenstein { g: fog.g },
        )];
        let camera = Camera::look_at(eye, dvec3(0.0, 1.0, 0.0), 0.9);
        let seen = conditions(scene, camera, size);
        let suns: Vec<DVec3> = match diameter > 0.0 {
            false => vec![seen.sun.toward],
            true => {
                let (x, y) = seen.sun.toward.any_orthonormal_pair();
                let tan = (0.5 * diameter * DEG).tan();
                (0..89)
                    .map(|k| {
                        let r = tan * ((f64::from(k) + 0.5) / 89.0).sqrt();
                        let (sin, cos) = (2.399_963 * f64::from(k * 34 % 89)).sin_cos();
                        (seen.sun.toward + r * (cos * x + sin * y)).normalize()
                    })
                    .collect()
            }
        };
        let truth = truth_of(&seen, size, |ray, end| {
            let blocked = |light: &Ray| is_blocked(&triangles, light, 1e9);
            fog.sunlit(ray, end, &suns, &left, blocked)
        });
        for frame in pictures(&seen, Quality::High, &["radiosity", "air_sky", "sky_dome"]) {
            let found = layer(&frame, Field::InscatterSun);
            let apart = off(&found, &truth);
            eprintln!("{diameter} {eye}: {:.3} %", 100.0 * apart);
            let allowed = if diameter > 0.0 { 0.01 } else { 0.002 };
            assert!(apart < allowed, "{diameter} {eye}: {apart}");
            // The comparison tells glass of one colour, and glass without Fresnel's law.
            let one = Window {
                columns: vec![[250, 60, 40]],
                ..window.clone()
            };
            let colours = |ray: &Ray, far: f64| {
                let crossed = window.crossed(ray).filter(|(distance, ..)| *distance < far);
                crossed.map_or(DVec3::ONE, |(_, column, _)| {
                    coloured(window.colour(column), 0.0, 1)
                })
            };
            if diameter == 0.0 {
                let blocked = |light: &Ray| is_blocked(&triangles, light, 1e9);
                let one = tabled(&one);
                let wrong = truth_of(&seen, size, |ray, end| {
                    fog.sunlit(ray, end, &suns, &one, blocked)
                });
                assert!(off(&found, &wrong) > 0.05, "{}", off(&found, &wrong));
                let wrong = truth_of(&seen, size, |ray, end| {
                    fog.sunlit(ray, end, &suns, colours, blocked)
                });
                assert!(off(&found, &wrong) > 0.005, "{}", off(&found, &wrong));
            }
        }
    }
}

#[test]
fn the_eye_sees_through_panes_what_is_behind_them() {
    // A pane right before the eye, whose own shadow falls out of the picture.
    let eye = dvec3(0.0, 3.0, -6.0);
    let camera = Camera::look_at(eye, dvec3(0.0, 0.5, 0.0), 0.7);
    let [x, y, forward] = camera.axes();
    let pane = |offset: f64| Window {
        corner: eye + offset * forward - 0.5 * x - 0.5 * y,
        edges: [x, y],
        factor: 0.8,
        columns: vec![[200, 120, 60]],
        count: 1,
    };
    let panes = [pane(0.3), pane(0.4)];
    let make = |windows: &[Window]| {
        let mut scene = floor(windows, 50.0, 0.0);
        scene.sky.model = Some("cie:12".into());
        conditions(scene, camera, [24, 16])
    };
    let bare = make(&[]);
    let through = make(&panes);
    let quality = Quality::Draft;
    for (bare_frame, frame) in pictures(&bare, quality, &["radiosity"])
        .iter()
        .zip(pictures(&through, quality, &["radiosity"]))
    {
        let mut worst = 0.0f64;
        for field in [Field::Sun, Field::Background] {
            let (one, other) = (layer(bare_frame, field), layer(&frame, field));
            for (i, (one, other)) in one.iter().zip(&other).enumerate() {
                let pixel = DVec2::new((i % 24) as f64 + 0.5, (i / 24) as f64 + 0.5);
                let left = by(&panes)(&bare.view.ray(pixel), 1e9);
                assert!(left.x < 0.6, "the panes are before every pixel");
                if one.x > 0.0 {
                    worst = worst.max(between(*other, left * *one));
                }
                assert!(
                    near(*other, left * *one, 2e-4),
                    "{field:?} {i}: {one} {other} {left}"
                );
            }
        }
        told("eye", worst);
    }
}

#[test]
fn lamps_shine_through_panes() {
    let window = Window {
        columns: vec![[250, 200, 60], [60, 120, 250]],
        ..sheet(1.0, 0.85)
    };
    let at_lamp = dvec3(0.2, 2.0, 0.0);
    let floor = quad(dvec3(-5.0, 0.0, -5.0), DVec3::Z * 10.0, DVec3::X * 10.0);
    let mut scene = night(&floor, vec![lamp(at_lamp, 100.0, Distribution::Isotropic)]);
    window.put_into(&mut scene);
    let points: Vec<Receiver> = [-4.0, -1.0, -0.3, 0.5, 3.0]
        .map(|x| at(dvec3(x, 0.0, 0.4), DVec3::Y))
        .into();
    let conditions_of_points = receive::conditions(scene.clone(), &points);
    let frame = rendered_without(&["radiosity"], &conditions_of_points, Quality::High, &[]);
    for (point, found) in points.iter().zip(layer(&frame, Field::Lights)) {
        let way = at_lamp - point.position;
        let ray = Ray {
            origin: point.position,
            direction: way.normalize(),
        };
        let cosine = ray.direction.y;
        let truth = 100.0 * cosine / way.length_squared() * window.leaves(&ray, 1e9);
        assert!(near(found, truth, 1e-3), "{point:?}: {found} {truth}");
    }
    // In the air, on both sides of the pane, seen from below through it and from above.
    let (scattering, half) = (0.1, 4.0);
    scene.media = vec![box_of_fog(half, scattering, 0.0, Phase::Isotropic)];
    let left = tabled(&window);
    let size = [10, 8];
    for eye in [dvec3(0.5, 0.4, -3.0), dvec3(0.5, 1.6, -3.0)] {
        let camera = Camera::look_at(eye, dvec3(0.0, 1.0, 0.0), 0.8);
        let seen = conditions(scene.clone(), camera, size);
        let fog = Fog {
            half,
            scattering,
            absorption: 0.0,
            g: 0.0,
        };
        let truth = truth_of(&seen, size, |ray, end| {
            let foot = (at_lamp - ray.origin).dot(ray.direction);
            let aside = ray.at(foot).distance(at_lamp);
            let [enter, leave] = fog.chord(ray.origin, ray.direction);
            let angle = |t: f64| ((t - foot) / aside).atan();
            const STEPS: usize = 3000;
            let (first, last) = (angle(enter), angle(leave.min(end)));
            let mut sum = DVec3::ZERO;
            for i in 0..STEPS {
                let theta = first + (last - first) * (i as f64 + 0.5) / STEPS as f64;
                let t = foot + aside * theta.tan();
                let way = at_lamp - ray.at(t);
                let light = Ray {
                    origin: ray.at(t),
                    direction: way.normalize(),
                };
                let depth = scattering * (t - enter + way.length());
                sum += left(&light, way.length()) * left(ray, t) * (-depth).exp();
            }
            100.0 * scattering / (4.0 * PI) * sum * (last - first) / STEPS as f64 / aside
        });
        let mut on_floor = None;
        for frame in pictures(&seen, Quality::High, &["radiosity", "air_sky"]) {
            let apart = off(&layer(&frame, Field::InscatterLights), &truth);
            eprintln!("{eye}: {:.3} %", 100.0 * apart);
            assert!(apart < 0.005, "{eye}: {apart}");
            let lights = layer(&frame, Field::Lights);
            let before = on_floor.get_or_insert(lights.clone());
            assert!(off(&lights, before) < 1e-5, "{eye}");
        }
    }
}

/// The share of a uniform sky's light that a level pane lets through to what lies under it, by the cosine law or alike from all
/// directions.
fn of_dome(normal: DVec3, count: u32, by_cosine: bool) -> DVec3 {
    const STEPS: usize = 2000;
    let mut sum = DVec3::ZERO;
    for i in 0..STEPS {
        let cosine = (i as f64 + 0.5) / STEPS as f64;
        let weight = if by_cosine { 2.0 * cosine } else { 1.0 };
        let working = tyndall::colour::Space::Rec709.to_working() * normal;
        let one = |share: f64| Incidence::new(cosine).transmittance(share, count);
        sum += weight * DVec3::from_array(working.to_array().map(one));
    }
    sum / STEPS as f64
}

#[test]
fn a_uniform_sky_shines_through_a_level_pane() {
    let window = Window {
        corner: dvec3(-3e3, 0.5, -3e3),
        edges: [DVec3::X * 6e3, DVec3::Z * 6e3],
        columns: vec![[230, 120, 60]],
        ..sheet(0.5, 0.9)
    };
    let mut scene = floor(std::slice::from_ref(&window), 40.0, 0.0);
    scene.sun = Some(SunEntry {
        azimuth_deg: 180.0,
        elevation_deg: -30.0,
        illuminance: Some(0.0),
        diameter_deg: Some(0.0),
    });
    let points = [at(dvec3(0.3, 0.0, 0.2), DVec3::Y)];
    let uniform = Model::Uniform { luminance: 1000.0 };
    let conditions_of_points =
        common::air::under(receive::conditions(scene.clone(), &points), uniform);
    let found = received(&conditions_of_points, Wanted::Reference);
    let truth = 1000.0 * PI * of_dome(window.colour(0), 1, true);
    assert!(near(found.sky[0], truth, 5e-3), "{} {truth}", found.sky[0]);

    // Thin air between floor and pane scatters what comes from above; nothing comes from the black floor.
    let mut scene = floor(std::slice::from_ref(&window), 40.0, 0.0);
    scene.materials[0] = material(0.0);
    scene.media = vec![box_of_fog(0.4, 1e-3, 0.0, Phase::Isotropic)];
    let camera = Camera::look_at(dvec3(0.0, 0.2, -0.39), dvec3(0.0, 0.2, 1.0), 0.1);
    let seen = common::air::under(conditions(scene, camera, [4, 4]), uniform);
    let found = common::air::air_light(&seen, Quality::High, &[]);
    let truth = 1e-3 * 0.79 * 1000.0 * 0.5 * of_dome(window.colour(0), 1, false);
    for found in found {
        assert!(near(found, truth, 0.02), "{found} {truth}");
    }
}

#[test]
fn surfaces_light_each_other_through_panes_and_lose_nothing_else() {
    // A panel that the sun lights from behind the pane, and a point that sees it along the pane's normal, or on a slant.
    let panel = quad(dvec3(-0.1, 0.0, -0.1), DVec3::Z * 0.2, DVec3::X * 0.2);
    for degrees in [0.0f64, 65.0] {
        let toward = dvec3(0.0, (0.3 * PI).sin(), -(0.3 * PI).cos());
        let eye = [at(2.5 * toward, -toward)];
        let (sin, cos) = (degrees * DEG).sin_cos();
        let across = DVec3::X;
        let normal = cos * toward + sin * toward.cross(across);
        let edge = normal.cross(across);
        let window = Window {
            columns: vec![[240, 180, 60]],
            ..Window::plain(
                1.5 * toward - 0.5 * across - 0.5 * edge,
                [across, edge],
                0.8,
            )
        };
        let [bare, through] = [vec![], vec![window.clone()]].map(|windows: Vec<Window>| {
            let mut scene = scene(&panel, 180.0, 50.0);
            windows
                .iter()
                .for_each(|window| window.put_into(&mut scene));
            received(&receive::conditions(scene, &eye), Wanted::Reference).indirect[0]
        });
        let truth = coloured(window.colour(0), degrees * DEG, 1) * bare;
        assert!(
            bare.x > 0.0 && near(through, truth, 0.01),
            "{degrees}: {through} {truth}"
        );
    }
    // A room in two halves: what surfaces receive is absorbed, goes out or stays in the pane.
    let mut room = cuboid(dvec3(-1.0, -1.0, -2.0), dvec3(1.0, 1.0, 2.0));
    room.truncate(room.len() - 2);
    let make = |factor: f64| {
        let mut scene = scene(&room, 100.0, 30.0);
        scene.sky.model = Some("uniform:5000".into());
        let edges = [DVec3::Y * 2.0, DVec3::Z * 4.0];
        Window::plain(dvec3(0.2, -1.0, -2.0), edges, factor).put_into(&mut scene);
        let seen = conditions(scene, Camera::look_at(DVec3::ZERO, DVec3::Z, 1.0), [4, 4]);
        let detail = Detail {
            sky: 1,
            care: Care {
                rays: 64,
                outline: 0.05,
            },
            patch: 0.25,
            patches: 1000,
            patch_rays: 100_000,
            hemicube: 0,
            hemicube_spots: 1,
            patch_spots: 0,
        };
        let transport = Transport::new(&seen, detail, None, Task::unwatched()).expect("sound");
        let account = Light::new(&transport, &seen, 1e-4, Task::unwatched()).expect("sound");
        account.account
    };
    let [clear, dark] = [1.0, 0.3].map(make);
    for account in [clear, dark] {
        let gone = account.absorbed + account.escaped + account.taken + account.unshot;
        assert!(near(gone, account.received, 1e-3), "{account:?}");
    }
    assert!(dark.received.y < 0.9 * clear.received.y && dark.taken.y > 0.0);
}

#[test]
fn alpha_says_where_glass_is_and_how_much() {
    // Left of x = 0 a hole, right of it glass of which four tenths are there.
    let window = sheet(2.0, 0.5);
    for (mode, share) in [
        (AlphaMode::Mask { cutoff: 0.3 }, 1.0),
        (AlphaMode::Blend, 0.4),
    ] {
        let mut made = floor(std::slice::from_ref(&window), 50.0, 0.0);
        made.textures.push(Texture {
            name: "alpha".into(),
            width: 2,
            height: 1,
            pixels: vec![[255, 255, 255, 0], [255, 255, 255, 102]],
            wrap: [Wrap::Clamp; 2],
        });
        made.materials[1].texture = Some(1);
        made.materials[1].alpha_mode = mode;
        made.media = vec![box_of_fog(1.0, 0.1, 0.0, Phase::Isotropic)];
        let through = 1.0 - share + share * glass(0.5, 40.0 * DEG, 1);
        for diameter in [0.0, 0.53] {
            let sun = made.sun.as_mut().expect("it has one");
            sun.diameter_deg = Some(diameter);
            let points = [-0.5, 0.5].map(|x| at(dvec3(x, 0.0, 0.1), DVec3::Y));
            let found = sunlight(
                &receive::conditions(made.clone(), &points),
                Wanted::Reference,
            );
            // The fog takes its part of both alike.
            let ratio = found[1].x / found[0].x;
            assert!(
                (ratio / through - 1.0).abs() < 2e-3,
                "{share} {diameter}: {ratio} {through}"
            );
        }
        made.sun = Some(tyndall::studies::scenes::point_sun(180.0, 50.0));
        // Of the air the same, on rays beside each other.
        let camera = Camera::look_at(dvec3(0.0, 0.5, -4.0), dvec3(0.0, 0.5, 0.0), 0.2);
        let frames = pictures(
            &conditions(made, camera, [2, 1]),
            Quality::High,
            &["radiosity", "air_sky"],
        );
        for frame in frames {
            let air = layer(&frame, Field::InscatterSun);
            let ratio = air[1].x.min(air[0].x) / air[0].x.max(air[1].x);
            assert!(
                (ratio / through - 1.0).abs() < 2e-3,
                "{share}: {ratio} {through}"
            );
        }
    }
}
