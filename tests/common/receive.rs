//! Illuminances of points by sun, sky and surfaces, and the exact share of what a point sees that a polygon takes.

use super::build::{layer, material};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Receiver, Request, View};
use tyndall::effect::Field;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Material, Mesh, Scene, SunEntry, Triangle};
use tyndall::studies::scenes::Corners;

/// The quality at which tables of illuminances are held to their figures.
pub const QUALITY: Quality = Quality::High;

/// What points receive [lx], RGB, by the last step of the light before it arrives.
pub struct Lux {
    pub sun: Vec<DVec3>,
    pub sky: Vec<DVec3>,
    pub indirect: Vec<DVec3>,
}

impl Lux {
    /// All of it, at each point.
    pub fn total(&self) -> Vec<DVec3> {
        (0..self.sun.len())
            .map(|i| self.sun[i] + self.sky[i] + self.indirect[i])
            .collect()
    }
}

pub fn at(position: DVec3, normal: DVec3) -> Receiver {
    Receiver {
        position,
        normal: normal.normalize(),
    }
}

/// Conditions whose receivers are points.
pub fn conditions(scene: Scene, points: &[Receiver]) -> Conditions {
    let request = Request {
        size: Some([8, 8]),
        samples: Some(1),
        camera: CameraChoice::Given(Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0)),
        ..Request::default()
    };
    let conditions = Conditions::new(scene, &request).expect("the scene is sound");
    let view = View::of_points(points);
    conditions.seen_from(view).expect("the points are sound")
}

/// Knobs and values.
pub type Settings<'a> = &'a [(&'a str, f64)];

/// What the points of conditions receive.
pub fn received(conditions: &Conditions, backend: Wanted) -> Lux {
    received_by(conditions, backend, &[])
}

/// What the points of conditions receive by some knobs.
pub fn received_by(conditions: &Conditions, backend: Wanted, set: Settings) -> Lux {
    received_at(QUALITY, conditions, backend, set)
}

/// The same at some quality.
pub fn received_at(
    quality: Quality,
    conditions: &Conditions,
    backend: Wanted,
    set: Settings,
) -> Lux {
    let set = set.iter().map(|(k, v)| (k.to_string(), *v)).collect();
    let overrules = Overrules {
        quality,
        set,
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let mut backend = Backend::open(backend).expect("there is one");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it works").frame;
    frame.check().expect("every value is sound");
    let count = conditions.view.points().expect("there are points").len();
    let of = |field| {
        let mut all = layer(&frame, field);
        all.truncate(count);
        all
    };
    Lux {
        sun: of(Field::Sun),
        sky: of(Field::Sky),
        indirect: of(Field::Indirect),
    }
}

/// What points of a scene receive by the reference.
pub fn receive(scene: Scene, points: &[Receiver]) -> Lux {
    receive_by(scene, points, &[])
}

/// What points of a scene receive by the reference and some knobs.
pub fn receive_by(scene: Scene, points: &[Receiver], set: Settings) -> Lux {
    received_by(&conditions(scene, points), Wanted::Reference, set)
}

/// Deviations that are looked at together: each is printed, and those above what is allowed fail at the end.
#[derive(Default)]
pub struct Deviations(Vec<String>);

impl Deviations {
    /// Notes a deviation.
    pub fn note(&mut self, what: &str, off: f64, allowed: f64) {
        let line = format!(
            "{what}: off by {:.3} %, allowed {:.3} %",
            100.0 * off,
            100.0 * allowed
        );
        eprintln!("{line}");
        // What is no number is no deviation within anything.
        if off.is_nan() || off >= allowed {
            self.0.push(line);
        }
    }

    /// Notes the greatest share by which values are off.
    pub fn near(&mut self, what: &str, found: &[f64], truth: &[f64], allowed: f64) {
        self.note(what, worst(found, truth), allowed);
    }

    /// Notes the greatest share of `whole` by which values are off, where some of the truths are next to nothing.
    pub fn near_of(&mut self, whole: f64, what: &str, found: &[f64], truth: &[f64], allowed: f64) {
        let off = found.iter().zip(truth).map(|(f, t)| (f - t).abs() / whole);
        self.note(what, off.fold(0.0, f64::max), allowed);
    }

    /// Fails where one was too great.
    #[track_caller]
    pub fn end(self) {
        assert!(self.0.is_empty(), "{:#?}", self.0);
    }
}

/// Luminances.
pub fn y(values: &[DVec3]) -> Vec<f64> {
    values.iter().map(|v| luminance(*v)).collect()
}

/// A scene of triangles with grey reflectances, without sun, sky and ground.
pub fn surfaces(triangles: &[(Corners, f64)]) -> Scene {
    let positions: Vec<DVec3> = triangles.iter().flat_map(|(c, _)| *c).collect();
    let mut reflectances: Vec<f64> = triangles.iter().map(|(_, r)| *r).collect();
    reflectances.sort_by(f64::total_cmp);
    reflectances.dedup();
    let number = |r: &f64| {
        reflectances
            .iter()
            .position(|other| other == r)
            .unwrap_or(0) as u32
    };
    let mut scene = Scene {
        name: "made in the test".into(),
        mesh: Mesh {
            normals: vec![DVec3::ZERO; positions.len()],
            uvs: vec![DVec2::ZERO; positions.len()],
            colors: Vec::new(),
            triangles: (triangles.iter().zip(0..))
                .map(|((_, r), i)| Triangle {
                    vertices: [3 * i, 3 * i + 1, 3 * i + 2],
                    material: number(r),
                })
                .collect(),
            positions,
        },
        materials: reflectances.iter().map(|r| grey(*r)).collect(),
        ..sun(Scene::default(), [180.0, 45.0], 0.0)
    };
    scene.ground.enabled = false;
    scene.ground.height = Some(0.0);
    scene
}

fn grey(reflectance: f64) -> Material {
    material(reflectance)
}

/// A scene with a white point sun of azimuth and elevation [degrees] and an illuminance [lx].
pub fn sun(mut scene: Scene, [azimuth_deg, elevation_deg]: [f64; 2], lux: f64) -> Scene {
    scene.sun = Some(SunEntry {
        azimuth_deg,
        elevation_deg,
        illuminance: Some(lux),
        diameter_deg: Some(0.0),
    });
    scene
}

/// A scene with a sky.
pub fn sky(mut scene: Scene, model: &str) -> Scene {
    scene.sky.model = Some(model.into());
    scene
}

/// A scene on an endless plane.
pub fn ground(mut scene: Scene, height: f64, albedo: f64) -> Scene {
    scene.ground.enabled = true;
    scene.ground.height = Some(height);
    scene.ground.albedo = albedo;
    scene
}

/// The part of a convex polygon that lies on the side of a plane to which its normal points.
pub fn clipped(polygon: &[DVec3], origin: DVec3, normal: DVec3) -> Vec<DVec3> {
    let height = |p: DVec3| normal.dot(p - origin);
    let mut kept = Vec::new();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (p, q) = (height(a), height(b));
        if p >= 0.0 {
            kept.push(a);
        }
        if p * q < 0.0 {
            kept.push(a + (b - a) * (p / (p - q)));
        }
    }
    kept
}

/// The form factor from a surface element to a convex polygon: the integral of cos(theta) dw / pi (Lambert 1760).
pub fn form_factor(point: &Receiver, polygon: &[DVec3]) -> f64 {
    let polygon = clipped(polygon, point.position, point.normal);
    let toward: Vec<DVec3> = polygon.iter().map(|p| *p - point.position).collect();
    let edge = |i: usize| {
        let (a, b) = (toward[i], toward[(i + 1) % toward.len()]);
        let cross = a.cross(b);
        let sine = cross.length();
        match sine > 0.0 {
            true => sine.atan2(a.dot(b)) * point.normal.dot(cross / sine),
            false => 0.0,
        }
    };
    (0..toward.len()).map(edge).sum::<f64>().abs() / (2.0 * PI)
}

/// The corners of a rectangle.
pub fn rectangle(corner: DVec3, a: DVec3, b: DVec3) -> [DVec3; 4] {
    [corner, corner + a, corner + a + b, corner + b]
}

/// Nodes and weights of Gauss-Legendre quadrature on 0 to 1.
pub fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let legendre = |x: f64| {
        let (mut p, mut before) = (1.0, 0.0);
        for k in 0..count {
            let k = k as f64;
            (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
        }
        (p, n * (x * p - before) / (x * x - 1.0))
    };
    (0..count)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            for _ in 0..50 {
                let (p, slope) = legendre(x);
                x -= p / slope;
            }
            let (_, slope) = legendre(x);
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Points with weights that sum to 1, for means over a rectangle.
pub fn over_rectangle(
    corner: DVec3,
    a: DVec3,
    b: DVec3,
    normal: DVec3,
    count: usize,
) -> Vec<(Receiver, f64)> {
    let nodes = gauss(count);
    let each = |&(u, wu): &(f64, f64)| {
        let along = corner + u * a;
        let point = move |&(v, wv): &(f64, f64)| (at(along + v * b, normal), wu * wv);
        nodes.iter().map(point).collect::<Vec<_>>()
    };
    nodes.iter().flat_map(each).collect()
}

/// The greatest relative difference.
pub fn worst(found: &[f64], truth: &[f64]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let off = found.iter().zip(truth).map(|(f, t)| (f / t - 1.0).abs());
    off.fold(0.0, f64::max)
}
