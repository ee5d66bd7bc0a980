//! Milliseconds a ray for the exact lit runs among leaves: cards whose texture's alpha cuts them out.
//!
//! `cargo bench --bench curtain [-- NAME]`. One core; rays through a camera's picture, each up to the first surface, under one sun.

use glam::{DVec2, DVec3};
use std::time::Instant;
use tyndall::beam::Beam;
use tyndall::scene::{AlphaMode, Camera, Geometry, Ray, Scene, Texture, Wrap};
use tyndall::studies::scenes::{StudyView, forest, quad, scene};

/// A number of 0 to 1 that looks like chance.
fn spread(i: u32, k: u32) -> f64 {
    let mut x = i.wrapping_mul(0x9E37_79B9) ^ k.wrapping_mul(0x85EB_CA6B) ^ 0x5bd1_e995;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    f64::from(x ^ (x >> 16)) / 4_294_967_296.0
}

/// Leaves with soft edges and a serrated outline on nothing.
fn leaves(width: u32, height: u32) -> Texture {
    let mut alpha = vec![0u8; (width * height) as usize];
    for leaf in 0..90 {
        let (x, y) = (spread(leaf, 0), spread(leaf, 1));
        let (sin, cos) = (6.3 * spread(leaf, 2)).sin_cos();
        for (i, a) in alpha.iter_mut().enumerate() {
            let (u, v) = (i as u32 % width, i as u32 / width);
            let (du, dv) = (
                f64::from(u) / f64::from(width) - x,
                f64::from(v) / f64::from(height) - y,
            );
            let (along, across) = (du * cos + dv * sin, dv * cos - du * sin);
            let edge = 0.02 * (1.0 - (along / 0.07).powi(2)) * (1.0 + 0.1 * (900.0 * along).sin());
            let there = (0.5 + 400.0 * (edge - across.abs())).clamp(0.0, 1.0);
            *a = (*a).max((255.0 * there) as u8);
        }
    }
    Texture {
        name: "leaves".into(),
        width,
        height,
        pixels: alpha.iter().map(|a| [90, 130, 60, *a]).collect(),
        wrap: [Wrap::Repeat; 2],
    }
}

/// A tree of `count` cards of a size [m] before the camera.
fn cards(count: u32, size: f64, texture: Texture) -> StudyView {
    let mut triangles = Vec::new();
    let mut uvs = Vec::new();
    for i in 0..count {
        let at = |k| 2.0 * spread(i, k) - 1.0;
        let centre = 2.5 * DVec3::new(at(3), at(4) + 1.4, at(5));
        let across = DVec3::new(at(6), 0.3 * at(7), at(8)).normalize();
        let (across, along) = (size * across, size * across.any_orthonormal_vector());
        triangles.extend(quad(centre - 0.5 * (across + along), across, along));
        let [o, x, y] = [DVec2::ZERO, DVec2::X, DVec2::Y];
        uvs.extend([o, x, y, x, x + y, y]);
    }
    let mut scene: Scene = scene(&triangles, 30.0, 50.0);
    scene.mesh.uvs = uvs;
    scene.textures = vec![texture];
    scene.materials[0].texture = Some(0);
    scene.materials[0].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    StudyView {
        name: "cards",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.0, 1.7, 9.0),
            DVec3::new(0.0, 3.0, 0.0),
            50f64.to_radians(),
        ),
    }
}

fn measure(name: &str, view: &StudyView, rays: u32) {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
        return;
    }
    let geometry = Geometry::new(&view.scene);
    let sun = DVec3::new(0.35, 0.77, -0.45).normalize();
    let beam = [Beam::parallel(sun, DVec3::ONE)];
    let size = [240, 150];
    let rays: Vec<(Ray, f64)> = (0..rays)
        .map(|i| {
            let at = DVec2::new(spread(i, 11), spread(i, 12));
            let ray = view.camera.ray(at * DVec2::new(240.0, 150.0), size);
            let hit = geometry.closest(&ray, 0.0, f64::INFINITY);
            (ray, hit.map_or(60.0, |hit| hit.distance))
        })
        .collect();
    let mut dark = Vec::new();
    let (mut runs, mut length) = (0, 0.0);
    let start = Instant::now();
    for (ray, far) in &rays {
        geometry.dark_runs(ray, *far, &beam, &mut dark);
        runs += dark[0].len();
        length += dark[0].iter().map(|[a, b]| b - a).sum::<f64>();
    }
    let curtain = start.elapsed().as_secs_f64() / rays.len() as f64;
    let start = Instant::now();
    let mut hidden = 0;
    for (ray, far) in &rays {
        let shadow = Ray {
            origin: ray.at(0.5 * far),
            direction: sun,
        };
        hidden += u32::from(geometry.occluded(&shadow, 0.0, f64::INFINITY));
    }
    let shadow = start.elapsed().as_secs_f64() / rays.len() as f64;
    println!(
        "{name}, {} triangles: {:.4} ms a ray ({:.1} runs, {:.12} m dark), {:.2} us a shadow ray ({hidden} hidden)",
        view.scene.mesh.triangles.len(),
        1e3 * curtain,
        f64::from(runs as u32) / rays.len() as f64,
        length / rays.len() as f64,
        1e6 * shadow,
    );
}

fn main() {
    let texture = leaves(1024, 512);
    measure(
        "tree of cards of 1 m",
        &cards(200, 1.0, texture.clone()),
        4000,
    );
    measure(
        "tree of cards of 4 m",
        &cards(200, 4.0, texture.clone()),
        2000,
    );
    measure("small wood", &forest(4000), 2000);
    let mut wood = forest(100_000);
    measure("wood, small texture", &wood, 400);
    wood.scene.textures = vec![texture];
    measure("wood, large texture", &wood, 400);
}
