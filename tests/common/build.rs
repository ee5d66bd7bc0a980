//! Small scenes in code, and pictures of them.

use glam::{DVec2, DVec3};
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::reference::Reference;
use tyndall::scene::{AlphaMode, Camera, Ground, Material, Mesh, Scene, SunEntry, Triangle};

/// A Lambertian material.
pub fn material(base_color: f64) -> Material {
    Material {
        name: "grey".into(),
        base_color: DVec3::splat(base_color),
        alpha: 1.0,
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        transmissive: false,
    }
}

/// A scene of loose triangles, without ground, under a white point sun of 100 000 lx that stands in `azimuth_deg` and
/// `elevation_deg`.
pub fn scene(triangles: &[[DVec3; 3]], azimuth_deg: f64, elevation_deg: f64) -> Scene {
    let positions: Vec<DVec3> = triangles.iter().flatten().copied().collect();
    Scene {
        name: "made in a test".into(),
        materials: vec![material(0.5)],
        mesh: Mesh {
            normals: vec![DVec3::ZERO; positions.len()],
            uvs: vec![DVec2::ZERO; positions.len()],
            colors: Vec::new(),
            triangles: (0..triangles.len() as u32)
                .map(|i| Triangle {
                    vertices: [3 * i, 3 * i + 1, 3 * i + 2],
                    material: 0,
                })
                .collect(),
            positions,
        },
        sun: Some(SunEntry {
            azimuth_deg,
            elevation_deg,
            illuminance: Some(1e5),
            diameter_deg: Some(0.0),
        }),
        ground: Ground {
            enabled: false,
            height: Some(0.0),
            albedo: 0.2,
        },
        ..Scene::default()
    }
}

/// Two triangles for a parallelogram.
pub fn quad(corner: DVec3, a: DVec3, b: DVec3) -> [[DVec3; 3]; 2] {
    [
        [corner, corner + a, corner + b],
        [corner + a, corner + a + b, corner + b],
    ]
}

/// The twelve triangles of a box.
pub fn cuboid(min: DVec3, max: DVec3) -> Vec<[DVec3; 3]> {
    let d = max - min;
    let (x, y, z) = (DVec3::X * d.x, DVec3::Y * d.y, DVec3::Z * d.z);
    [
        quad(min, y, x),
        quad(min + z, x, y),
        quad(min, x, z),
        quad(min + y, z, x),
        quad(min, z, y),
        quad(min + x, y, z),
    ]
    .concat()
}

/// The conditions of a scene seen by a camera.
pub fn conditions(scene: Scene, camera: Camera, size: [u32; 2]) -> Conditions {
    let request = Request {
        size: Some(size),
        samples: Some(1),
        camera: CameraChoice::Given(camera),
        ..Request::default()
    };
    Conditions::new(scene, &request).expect("the scene is sound")
}

/// A picture at the finest quality.
pub fn render(conditions: &Conditions) -> Frame {
    render_at(conditions, Quality::Reference)
}

/// A picture, all of whose values have been checked to be finite and not negative.
pub fn render_at(conditions: &Conditions, quality: Quality) -> Frame {
    let overrules = Overrules {
        quality,
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let frame = Reference::new(&plan)
        .render(1 << 30, &|_| {})
        .expect("the picture fits into memory")
        .frame;
    frame
        .check()
        .expect("every value is finite and not negative");
    frame
}

/// A layer of a picture; zeros where it was not made.
pub fn layer(frame: &Frame, field: Field) -> Vec<DVec3> {
    match frame.layer(field.name()) {
        Some(layer) => layer.rgb.iter().map(|v| v.as_dvec3()).collect(),
        None => vec![DVec3::ZERO; frame.pixels()],
    }
}

/// Relative RMSE: sqrt(mean((a - b)^2)) / mean(b), over the first channel.
pub fn relative_rmse(a: &[DVec3], b: &[DVec3]) -> f64 {
    let n = a.len() as f64;
    let mean = b.iter().map(|v| v.x).sum::<f64>() / n;
    let square = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a.x - b.x).powi(2))
        .sum::<f64>()
        / n;
    square.sqrt() / mean
}
