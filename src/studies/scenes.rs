//! Scenes in which methods are measured: made in code, in metres, +Y up, the same on every machine. All have a white point
//! sun of 100 000 lx unless they say otherwise.

use crate::conditions::{CameraChoice, Conditions, Request};
use crate::error::Result;
use crate::medium::{Medium, Phase, Shape};
use crate::scene::{
    AlphaMode, Camera, Ground, Material, Mesh, Scene, SunEntry, Texture, Triangle, Wrap,
};
use crate::units::DEG;
use glam::{DVec2, DVec3};

/// The names of the views of the studies.
pub const NAMES: [&str; 11] = [
    "slats",
    "colonnade",
    "forest",
    "gates",
    "slit",
    "mountains",
    "antisolar",
    "hills",
    "far-slit",
    "room",
    "court",
];

/// The view of a name; `None` for another than those of [`NAMES`].
pub fn named(name: &str) -> Option<StudyView> {
    Some(match name {
        "slats" => slats(1.0),
        "colonnade" => colonnade(),
        "forest" => forest(700),
        "gates" => gates(),
        "slit" => slit(),
        "mountains" => mountains(),
        "antisolar" => antisolar(),
        "hills" => hills(),
        "far-slit" => far_slit(),
        "room" => room(),
        "court" => court(),
        _ => return None,
    })
}

/// Three corners [m].
pub type Corners = [DVec3; 3];

/// A Lambertian material.
pub fn material(base_color: f64) -> Material {
    Material {
        name: "grey".into(),
        base_color: DVec3::splat(base_color),
        alpha: 1.0,
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        pane: None,
    }
}

/// A white point sun of 100 000 lx.
pub fn point_sun(azimuth_deg: f64, elevation_deg: f64) -> SunEntry {
    SunEntry {
        azimuth_deg,
        elevation_deg,
        illuminance: Some(1e5),
        diameter_deg: Some(0.0),
    }
}

/// A scene of loose triangles, without ground, under a white point sun of 100 000 lx that stands in `azimuth_deg` and
/// `elevation_deg`.
pub fn scene(triangles: &[Corners], azimuth_deg: f64, elevation_deg: f64) -> Scene {
    let positions: Vec<DVec3> = triangles.iter().flatten().copied().collect();
    Scene {
        name: "made in code".into(),
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
        sun: Some(point_sun(azimuth_deg, elevation_deg)),
        ground: Ground {
            enabled: false,
            height: Some(0.0),
            albedo: 0.2,
        },
        ..Scene::default()
    }
}

/// Two triangles for a parallelogram.
pub fn quad(corner: DVec3, a: DVec3, b: DVec3) -> [Corners; 2] {
    [
        [corner, corner + a, corner + b],
        [corner + a, corner + a + b, corner + b],
    ]
}

/// The twelve triangles of a box.
pub fn cuboid(min: DVec3, max: DVec3) -> Vec<Corners> {
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
#[derive(Debug, Clone)]
pub struct StudyView {
    /// Its name in tables.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// What sees it.
    pub camera: Camera,
}

impl StudyView {
    /// What physics makes of it, one ray through each pixel's centre.
    ///
    /// # Errors
    /// Those of [`Conditions::new`].
    pub fn conditions(&self, size: [u32; 2]) -> Result<Conditions> {
        let request = Request {
            size: Some(size),
            samples: Some(1),
            camera: CameraChoice::Given(self.camera),
            ..Request::default()
        };
        Conditions::new(self.scene.clone(), &request)
    }
}

/// Fog under slats, between walls.
pub fn slats(scale: f64) -> StudyView {
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
    StudyView {
        name: "slats",
        scene,
        camera: Camera::look_at(at(0.5, 1.5, 4.5), at(0.0, 1.6, -5.0), 60.0 * DEG),
    }
}

/// Columns between the eye and a low sun.
pub fn colonnade() -> StudyView {
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
    StudyView {
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
pub fn hills() -> StudyView {
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
    StudyView {
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
pub fn into_the_sun() -> StudyView {
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

/// A closed room whose wall at x = 4 has one upright slit of 0.3, full of haze.
pub fn slit() -> StudyView {
    let mut triangles = Vec::new();
    let slab = |z0: f64, z1: f64, y0: f64, y1: f64| {
        cuboid(DVec3::new(3.9, y0, z0), DVec3::new(4.1, y1, z1))
    };
    for [z0, z1, y0, y1] in [
        [-5.0, -0.15, 0.0, 4.0],
        [0.15, 5.0, 0.0, 4.0],
        [-0.15, 0.15, 0.0, 0.5],
        [-0.15, 0.15, 3.5, 4.0],
    ] {
        triangles.extend(slab(z0, z1, y0, y1));
    }
    for (min, max) in [
        ([-4.1, 0.0, -5.0], [-3.9, 4.0, 5.0]),
        ([-4.1, 0.0, -5.1], [4.1, 4.0, -4.9]),
        ([-4.1, 0.0, 4.9], [4.1, 4.0, 5.1]),
        ([-4.1, -0.1, -5.1], [4.1, 0.0, 5.1]),
        ([-4.1, 4.0, -5.1], [4.1, 4.1, 5.1]),
    ] {
        triangles.extend(cuboid(min.into(), max.into()));
    }
    let mut scene = scene(&triangles, 75.0, 25.0);
    scene.media = vec![room_fog(
        DVec3::new(-3.9, 0.0, -4.9),
        DVec3::new(3.9, 4.0, 4.9),
    )];
    StudyView {
        name: "slit",
        scene,
        camera: Camera::look_at(
            DVec3::new(-1.5, 1.6, 4.5),
            DVec3::new(0.5, 1.6, -3.0),
            65.0 * DEG,
        ),
    }
}

fn room_fog(min: DVec3, max: DVec3) -> Medium {
    let phase = Phase::HenyeyGreenstein { g: 0.5 };
    fog(Shape::Box { min, max }, 0.06, 0.01, phase)
}

/// Walls one behind the other, each with a gate, under a low sun from the side: a ray crosses several shadows.
pub fn gates() -> StudyView {
    let mut triangles = Vec::new();
    for i in 0..6 {
        let z = -4.0 * f64::from(i);
        for (x0, x1, y0, y1) in [
            (-6.0, -1.0, 0.0, 6.0),
            (1.0, 6.0, 0.0, 6.0),
            (-1.0, 1.0, 3.0, 6.0),
        ] {
            triangles.extend(cuboid(
                DVec3::new(x0, y0, z - 0.1),
                DVec3::new(x1, y1, z + 0.1),
            ));
        }
    }
    let mut scene = scene(&triangles, 50.0, 35.0);
    scene.ground.enabled = true;
    scene.media = vec![fog(
        Shape::Haze { top: 8.0 },
        0.03,
        0.003,
        Phase::HenyeyGreenstein { g: 0.6 },
    )];
    StudyView {
        name: "gates",
        scene,
        camera: Camera::look_at(
            DVec3::new(-0.3, 1.7, 6.0),
            DVec3::new(0.0, 1.9, -10.0),
            60.0 * DEG,
        ),
    }
}

/// Evenly spread numbers in 0 to 1, without a generator's state: the fractional parts of multiples of irrational numbers.
fn spread(i: u32, which: usize) -> f64 {
    // The generalised golden ratio in four dimensions (Roberts 2018).
    const STEPS: [f64; 4] = [
        0.856_674_883_854_502_9,
        0.733_891_856_627_126,
        0.628_706_721_037_811_6,
        0.538_597_258_364_016_2,
    ];
    (0.5 + f64::from(i) * STEPS[which]).fract()
}

/// A wood in the morning: trunks, and leaves that are holes in cards (alpha-masked), `cards` of them.
pub fn forest(cards: u32) -> StudyView {
    let mut triangles = Vec::new();
    for i in 0..40 {
        let (x, z) = (30.0 * spread(i, 0) - 15.0, 34.0 * spread(i, 1) - 30.0);
        if x.abs() < 1.2 && z > 0.0 {
            continue;
        }
        let r = 0.12 + 0.15 * spread(i, 2);
        triangles.extend(cuboid(
            DVec3::new(x - r, 0.0, z - r),
            DVec3::new(x + r, 9.0, z + r),
        ));
    }
    let solid = triangles.len();
    let mut uvs = vec![DVec2::ZERO; 3 * solid];
    for i in 0..cards {
        let centre = DVec3::new(
            32.0 * spread(i, 0) - 16.0,
            4.0 + 6.0 * spread(i, 1),
            38.0 * spread(i, 2) - 32.0,
        );
        let turn = 2.0 * std::f64::consts::PI * spread(i, 3);
        let tilt = 1.2 * (spread(i.wrapping_mul(7), 0) - 0.5);
        let across = DVec3::new(turn.cos(), 0.0, turn.sin());
        let along = across
            .cross(DVec3::new(tilt.sin(), tilt.cos(), 0.0))
            .normalize();
        let size = 0.9 + 0.7 * spread(i.wrapping_mul(3), 1);
        let corner = centre - 0.5 * size * (across + along);
        triangles.extend(quad(corner, size * across, size * along));
        let [o, x, y] = [DVec2::ZERO, DVec2::X, DVec2::Y];
        uvs.extend([o, x, y, x, x + y, y]);
    }
    let mut scene = scene(&triangles, 25.0, 48.0);
    scene.mesh.uvs = uvs;
    scene.textures = vec![leaves(64)];
    scene.materials.push(Material {
        name: "leaves".into(),
        base_color: DVec3::ONE,
        texture: Some(0),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..material(1.0)
    });
    for triangle in &mut scene.mesh.triangles[solid..] {
        triangle.material = 1;
    }
    scene.ground.enabled = true;
    scene.media = vec![fog(
        Shape::Haze { top: 12.0 },
        0.02,
        0.002,
        Phase::HenyeyGreenstein { g: 0.6 },
    )];
    StudyView {
        name: "forest",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.0, 1.7, 7.0),
            DVec3::new(1.0, 3.2, -10.0),
            60.0 * DEG,
        ),
    }
}

/// A picture of leaves: ellipses that are there (alpha 1) on nothing (alpha 0).
fn leaves(side: u32) -> Texture {
    let is_leaf = |u: f64, v: f64| {
        (0..14).any(|i| {
            let (x, y) = (spread(i, 0), spread(i, 1));
            let (sin, cos) = (6.3 * spread(i, 2)).sin_cos();
            let (du, dv) = (u - x, v - y);
            let (a, b) = ((du * cos + dv * sin) / 0.14, (dv * cos - du * sin) / 0.055);
            a * a + b * b < 1.0
        })
    };
    Texture {
        name: "leaves".into(),
        width: side,
        height: side,
        pixels: (0..side * side)
            .map(|i| {
                let at = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
                let alpha = if is_leaf(at(i % side), at(i / side)) {
                    255
                } else {
                    0
                };
                [96, 128, 64, alpha]
            })
            .collect(),
        wrap: [Wrap::Clamp; 2],
    }
}

/// Mountains, 50 km deep, under a low sun, in air that thins with height.
pub fn mountains() -> StudyView {
    let cells = 240;
    let point = |x: usize, z: usize| {
        let (u, v) = (x as f64 / cells as f64, z as f64 / cells as f64);
        let ridge = |f: f64, g: f64, p: f64| 1.0 - (f * u + g * v + p).sin().abs();
        let height = 900.0 * ridge(11.0, 4.0, 0.3)
            + 700.0 * ridge(-6.0, 13.0, 1.1)
            + 300.0 * ridge(31.0, 23.0, 2.0)
            + 110.0 * ridge(83.0, -61.0, 0.7);
        DVec3::new(40_000.0 * (u - 0.5), height, -50_000.0 * v)
    };
    let triangles: Vec<Corners> = (0..cells * cells)
        .flat_map(|i| {
            let (x, z) = (i % cells, i / cells);
            let [a, b, c, d] = [
                point(x, z),
                point(x, z + 1),
                point(x + 1, z),
                point(x + 1, z + 1),
            ];
            [[a, c, b], [c, d, b]]
        })
        .collect();
    let mut scene = scene(&triangles, 62.0, 9.0);
    scene.media = vec![fog(
        Shape::Height {
            base: 0.0,
            scale_height: 1200.0,
            far: 60_000.0,
        },
        6e-5,
        4e-6,
        Phase::HenyeyGreenstein { g: 0.6 },
    )];
    StudyView {
        name: "mountains",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.0, 2300.0, 500.0),
            DVec3::new(1000.0, 1300.0, -20_000.0),
            50.0 * DEG,
        ),
    }
}

/// The sun behind the eye: shadows of a fence run together before it.
pub fn antisolar() -> StudyView {
    let mut triangles = Vec::new();
    for i in 0..13 {
        let x = -9.0 + 1.5 * f64::from(i);
        triangles.extend(cuboid(
            DVec3::new(x, 0.0, 8.0),
            DVec3::new(x + 0.5, 9.0 + (f64::from(i) * 2.4).sin(), 8.4),
        ));
    }
    let mut scene = scene(&triangles, 182.0, 20.0);
    scene.ground.enabled = true;
    scene.media = vec![fog(
        Shape::Box {
            min: DVec3::new(-30.0, 0.0, -40.0),
            max: DVec3::new(30.0, 14.0, 7.0),
        },
        0.02,
        0.002,
        Phase::Rayleigh,
    )];
    StudyView {
        name: "antisolar",
        scene,
        camera: Camera::look_at(
            DVec3::new(0.4, 4.0, 4.0),
            DVec3::new(0.2, 0.5, -10.0),
            65.0 * DEG,
        ),
    }
}

/// A slit 3 m wide, 500 m sunward of a box of fog, under the real sun's disc without limb darkening: what the disc's edge
/// looks like in the air.
pub fn far_slit() -> StudyView {
    let sun = (90.0, 5.0);
    let mut triangles = Vec::new();
    for (z0, z1) in [(-60.0, -1.5), (1.5, 60.0)] {
        triangles.extend(quad(
            DVec3::new(500.0, -60.0, z0),
            DVec3::new(0.0, 200.0, 0.0),
            DVec3::new(0.0, 0.0, z1 - z0),
        ));
    }
    let mut scene = scene(&triangles, sun.0, sun.1);
    if let Some(sun) = &mut scene.sun {
        sun.diameter_deg = Some(0.533);
    }
    scene.media = vec![fog(
        Shape::Box {
            min: DVec3::new(-10.0, -10.0, -12.0),
            max: DVec3::new(10.0, 10.0, 12.0),
        },
        1e-4,
        0.0,
        Phase::Isotropic,
    )];
    StudyView {
        name: "far-slit",
        scene,
        // From above, along the slit: each column of pixels is one place across it.
        camera: Camera::look_at(
            DVec3::new(0.0, 60.0, 0.0),
            DVec3::new(0.0, 0.0, 0.0),
            12.0 * DEG,
        ),
    }
}

/// A room of 4 m by 3 m by 5 m with light grey walls, full of haze, whose wall at x = 2 has one window of 1.2 m by 1.4 m, 0.2 m deep: sky,
/// sun and ground outside reach it through that alone.
pub fn room() -> StudyView {
    let mut triangles = Vec::new();
    for (z0, z1, y0, y1) in [
        (-2.7, -0.6, 0.0, 3.0),
        (0.6, 2.7, 0.0, 3.0),
        (-0.6, 0.6, 0.0, 1.0),
        (-0.6, 0.6, 2.4, 3.0),
    ] {
        let (min, max) = (DVec3::new(2.0, y0, z0), DVec3::new(2.2, y1, z1));
        triangles.extend(cuboid(min, max));
    }
    for (min, max) in [
        ([-2.2, 0.0, -2.7], [-2.0, 3.0, 2.7]),
        ([-2.2, 0.0, -2.7], [2.2, 3.0, -2.5]),
        ([-2.2, 0.0, 2.5], [2.2, 3.0, 2.7]),
        ([-2.2, -0.2, -2.7], [2.2, 0.0, 2.7]),
        ([-2.2, 3.0, -2.7], [2.2, 3.2, 2.7]),
        // A table.
        ([-0.4, 0.7, -0.9], [0.4, 0.75, 0.9]),
    ] {
        triangles.extend(cuboid(min.into(), max.into()));
    }
    let mut scene = under_sky(&triangles, 75.0, 35.0);
    scene.ground.height = Some(-0.2);
    scene.media = vec![room_fog(
        DVec3::new(-2.0, 0.0, -2.5),
        DVec3::new(2.0, 3.0, 2.5),
    )];
    StudyView {
        name: "room",
        scene,
        camera: Camera::look_at(
            DVec3::new(-1.7, 1.6, 2.3),
            DVec3::new(0.8, 1.2, -1.5),
            70.0 * DEG,
        ),
    }
}

/// A court of 12 m by 12 m between grey walls 6 m high, one half of it under a roof, in haze.
pub fn court() -> StudyView {
    let mut triangles = Vec::new();
    for (min, max) in [
        ([-6.3, 0.0, -6.3], [-6.0, 6.0, 6.3]),
        ([6.0, 0.0, -6.3], [6.3, 6.0, 6.3]),
        ([-6.0, 0.0, -6.3], [6.0, 6.0, -6.0]),
        ([-6.0, 0.0, 6.0], [6.0, 6.0, 6.3]),
        // The roof, and a pier that carries it.
        ([-6.0, 4.5, -6.0], [0.0, 4.8, 6.0]),
        ([-0.4, 0.0, -0.3], [0.0, 4.5, 0.3]),
    ] {
        triangles.extend(cuboid(min.into(), max.into()));
    }
    let mut scene = under_sky(&triangles, 120.0, 50.0);
    scene.media = vec![fog(
        Shape::Haze { top: 9.0 },
        0.02,
        0.002,
        Phase::HenyeyGreenstein { g: 0.6 },
    )];
    StudyView {
        name: "court",
        scene,
        camera: Camera::look_at(
            DVec3::new(-5.5, 1.7, 5.5),
            DVec3::new(1.5, 2.0, -4.0),
            65.0 * DEG,
        ),
    }
}

/// A scene with a ground of albedo 0.2, under a clear sky with its sun.
fn under_sky(triangles: &[Corners], azimuth_deg: f64, elevation_deg: f64) -> Scene {
    let mut scene = scene(triangles, azimuth_deg, elevation_deg);
    scene.sun = Some(SunEntry {
        azimuth_deg,
        elevation_deg,
        illuminance: None,
        diameter_deg: None,
    });
    scene.sky.model = Some("perez".into());
    scene.ground.enabled = true;
    scene
}
