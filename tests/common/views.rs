//! Scenes with a camera, for comparing backends.

use super::build::*;
use glam::DVec3;
use tyndall::conditions::Conditions;
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::scene::{Camera, Scene, SunEntry};

/// The size of the pictures that are compared [pixels].
pub const SIZE: [u32; 2] = [96, 64];

const DEG: f64 = std::f64::consts::PI / 180.0;

/// A medium of even coefficients.
pub fn fog(shape: Shape, scattering: f64, absorption: f64, phase: Phase) -> Medium {
    Medium {
        shape,
        scattering: DVec3::splat(scattering),
        absorption: DVec3::splat(absorption),
        phase,
    }
}

/// A scene that is seen by a camera, from which a test can move sun and camera.
pub struct View {
    pub name: &'static str,
    pub scene: Scene,
    pub camera: Camera,
}

impl View {
    pub fn conditions(&self) -> Conditions {
        conditions(self.scene.clone(), self.camera, SIZE)
    }
}

/// Fog under slats, between walls.
pub fn slats(scale: f64) -> View {
    let at = |x: f64, y: f64, z: f64| scale * DVec3::new(x, y, z);
    let mut triangles = Vec::new();
    for i in 0..14 {
        let x = -4.0 + 8.0 * f64::from(i) / 14.0;
        triangles.extend(cuboid(at(x, 3.9, -5.0), at(x + 0.3, 4.0, 5.0)));
    }
    let corner = at(-4.0, 0.0, -5.0);
    triangles.extend(quad(corner, at(0.0, 0.0, 10.0), at(8.0, 0.0, 0.0)));
    triangles.extend(quad(corner, at(0.0, 4.0, 0.0), at(8.0, 0.0, 0.0)));
    let mut scene = scene(&triangles, 65.0, 50.0);
    scene.media = vec![fog(
        Shape::Box {
            min: corner,
            max: at(4.0, 4.0, 5.0),
        },
        0.06 / scale,
        0.01 / scale,
        Phase::HenyeyGreenstein { g: 0.5 },
    )];
    View {
        name: "slats",
        scene,
        camera: Camera::look_at(at(0.5, 1.5, 4.5), at(0.0, 1.6, -5.0), 60.0 * DEG),
    }
}

/// Columns between the eye and a low sun.
pub fn colonnade() -> View {
    let mut triangles = Vec::new();
    for i in 0..9 {
        let x = -10.0 + 2.5 * f64::from(i);
        triangles.extend(cuboid(
            DVec3::new(x, 0.0, -10.5),
            DVec3::new(x + 0.8, 5.0, -9.7),
        ));
    }
    triangles.extend(cuboid(
        DVec3::new(-11.0, 5.0, -10.6),
        DVec3::new(12.0, 5.8, -9.6),
    ));
    let mut scene = scene(&triangles, 8.0, 16.0);
    scene.ground.enabled = true;
    scene.media = vec![fog(
        Shape::Haze { top: 12.0 },
        0.02,
        0.002,
        Phase::HenyeyGreenstein { g: 0.7 },
    )];
    View {
        name: "colonnade",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.4, 1.7, 6.0),
            DVec3::new(0.0, 2.8, -10.0),
            60.0 * DEG,
        ),
    }
}

/// Hills under a low sun, in air that thins with height.
pub fn hills() -> View {
    let cells = 60;
    let point = |x: usize, z: usize| {
        let (u, v) = (x as f64 / cells as f64, z as f64 / cells as f64);
        let height = 90.0 * (9.0 * u).sin() * (7.0 * v).cos() + 25.0 * (31.0 * u + 17.0 * v).sin();
        DVec3::new(2000.0 * u - 1000.0, height, 2000.0 * v - 1000.0)
    };
    let triangles: Vec<[DVec3; 3]> = (0..cells * cells)
        .flat_map(|i| {
            let (x, z) = (i % cells, i / cells);
            let [a, b, c, d] = [
                point(x, z),
                point(x, z + 1),
                point(x + 1, z),
                point(x + 1, z + 1),
            ];
            [[a, b, c], [c, b, d]]
        })
        .collect();
    let mut scene = scene(&triangles, -70.0, 12.0);
    scene.sky.model = Some("preetham".into());
    scene.media = vec![fog(
        Shape::Height {
            base: -100.0,
            scale_height: 120.0,
            far: 20_000.0,
        },
        8e-4,
        1e-4,
        Phase::CornetteShanks { g: 0.6 },
    )];
    View {
        name: "hills",
        scene,
        camera: Camera::look_at(
            DVec3::new(100.0, 190.0, 900.0),
            DVec3::new(0.0, 40.0, -300.0),
            55.0 * DEG,
        ),
    }
}

/// The sun itself in the picture, and the sky around it.
pub fn into_the_sun() -> View {
    let mut view = colonnade();
    view.name = "into the sun";
    view.scene.sun = Some(SunEntry {
        azimuth_deg: 8.0,
        elevation_deg: 26.0,
        illuminance: None,
        diameter_deg: None,
    });
    view.scene.media = vec![fog(
        Shape::Haze { top: 30.0 },
        1e-3,
        1e-4,
        Phase::NishitaHazy,
    )];
    view.camera = Camera::look_at(
        DVec3::new(0.4, 1.7, 6.0),
        DVec3::new(2.0, 8.0, -10.0),
        60.0 * DEG,
    );
    view
}
