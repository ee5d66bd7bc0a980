//! Exact lit runs against f64 shadow rays, one by one.

mod common;

use glam::{DVec2, DVec3};
use tyndall::beam::Beam;
use tyndall::scene::curtain::Run;
use tyndall::scene::{AlphaMode, Geometry, Material, Ray, Scene, Texture, Wrap};

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, min: DVec3, max: DVec3) -> DVec3 {
        min + (max - min) * DVec3::new(self.unit(), self.unit(), self.unit())
    }

    fn direction(&mut self) -> DVec3 {
        let y = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (self.unit() * std::f64::consts::TAU).sin_cos();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * cos, y, r * sin)
    }
}

fn scene_of(triangles: Vec<[DVec3; 3]>) -> Scene {
    common::build::scene(&triangles, 0.0, 45.0)
}

fn soup(count: usize, size: f64, random: &mut Random) -> Vec<[DVec3; 3]> {
    (0..count)
        .map(|_| {
            let middle = random.within(DVec3::splat(-10.0), DVec3::splat(10.0));
            [(); 3].map(|()| middle + size * random.direction())
        })
        .collect()
}

fn terrain(cells: usize) -> Vec<[DVec3; 3]> {
    let point = |x: usize, z: usize| {
        let (u, v) = (x as f64 / cells as f64, z as f64 / cells as f64);
        DVec3::new(
            20.0 * u - 10.0,
            (20.0 * u).sin() * (17.0 * v).cos() + 0.1 * (90.0 * u).sin(),
            20.0 * v - 10.0,
        )
    };
    (0..cells * cells)
        .flat_map(|i| {
            let (x, z) = (i % cells, i / cells);
            let corners = [
                point(x, z),
                point(x, z + 1),
                point(x + 1, z),
                point(x + 1, z + 1),
            ];
            [
                [corners[0], corners[1], corners[2]],
                [corners[2], corners[1], corners[3]],
            ]
        })
        .collect()
}

/// Points of a ray at which runs and shadow rays disagree, though the point is not within rounding of a run's end.
fn disagreements(
    geometry: &Geometry,
    ray: &Ray,
    far: f64,
    suns: &[DVec3],
    points: usize,
    random: &mut Random,
) -> usize {
    let mut dark: Vec<Vec<Run>> = Vec::new();
    let beams: Vec<Beam> = suns
        .iter()
        .map(|sun| Beam::parallel(*sun, DVec3::ONE))
        .collect();
    geometry.dark_runs(ray, far, &beams, &mut dark);
    let rounding = 1e-11 * (far + ray.origin.length() + geometry.extent());
    let mut wrong = 0;
    for (sun, runs) in suns.iter().zip(&dark) {
        for _ in 0..points {
            let t = far * random.unit();
            if runs.iter().flatten().any(|end| (t - end).abs() < rounding) {
                continue;
            }
            let shadow = Ray {
                origin: ray.at(t),
                direction: *sun,
            };
            let truth = geometry.occluded(&shadow, 0.0, f64::INFINITY);
            let claimed = runs.iter().any(|[a, b]| (*a..=*b).contains(&t));
            wrong += usize::from(truth != claimed);
        }
    }
    wrong
}

/// Points of the sun's disc around a direction.
fn disc(sun: DVec3, radius: f64) -> Vec<DVec3> {
    let (x, y) = sun.any_orthonormal_pair();
    (0..8)
        .map(|i| {
            let (sin, cos) = (i as f64).sin_cos();
            (sun + radius * ((i as f64 + 0.5) / 8.0).sqrt() * (cos * x + sin * y)).normalize()
        })
        .collect()
}

fn compare(scene: &Scene, rays: usize, seed: u64) -> usize {
    let geometry = Geometry::new(scene);
    let (min, max) = geometry.bounds();
    let size = max - min;
    let mut random = Random(seed);
    let mut checked = 0;
    for i in 0..rays {
        let ray = Ray {
            origin: random.within(min - 0.3 * size, max + 0.3 * size),
            direction: random.direction(),
        };
        let far = geometry
            .closest(&ray, 0.0, f64::INFINITY)
            .map_or(2.0 * geometry.extent(), |hit| hit.distance);
        let mut sun = random.direction();
        // Some along the ray, some against it, some almost parallel to it.
        match i % 16 {
            0 => sun = ray.direction,
            1 => sun = -ray.direction,
            2 => sun = (ray.direction + 1e-4 * sun).normalize(),
            3 => sun = (-ray.direction + 1e-7 * sun).normalize(),
            _ => {}
        }
        let suns = if i % 3 == 0 {
            disc(sun, 0.00465)
        } else {
            vec![sun]
        };
        let wrong = disagreements(&geometry, &ray, far, &suns, 64, &mut random);
        assert_eq!(wrong, 0, "ray {i}: {ray:?} suns {suns:?} far {far}");
        checked += 64 * suns.len();
    }
    checked
}

#[test]
fn lit_runs_agree_with_a_million_shadow_rays_on_soups_and_terrain() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut checked = 0;
    for (count, size) in [(20, 6.0), (300, 2.0), (20_000, 0.2)] {
        checked += compare(
            &scene_of(soup(count, size, &mut random)),
            1200,
            7 + count as u64,
        );
    }
    checked += compare(&scene_of(terrain(100)), 1500, 99);
    assert!(checked > 1_000_000, "only {checked}");
}

#[test]
fn lit_runs_agree_with_shadow_rays_on_real_scenes() {
    let Some(data) = common::data("lit_runs_agree_with_shadow_rays_on_real_scenes") else {
        return;
    };
    let mut checked = 0;
    for name in REAL_SCENES {
        let scene = tyndall::scene::load(&data.join("scenes").join(name)).expect(name);
        checked += compare(&scene, 400, 31);
    }
    assert!(checked > 100_000, "only {checked}");
}

const REAL_SCENES: [&str; 4] = [
    "living_room/living_room.glb",
    "volumetric_fog/VolumetricFogExample.glb",
    "terrain/Mountains.gltf",
    "gazebo/gazebo.obj",
];

#[test]
fn lit_runs_are_cut_out_texel_by_texel() {
    let mut random = Random(12345);
    let mut scene = scene_of(soup(60, 5.0, &mut random));
    scene.mesh.uvs = (0..scene.mesh.positions.len())
        .map(|_| DVec2::new(3.0 * random.unit() - 1.0, 3.0 * random.unit() - 1.0))
        .collect();
    scene.textures = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp]
        .map(|wrap| Texture {
            name: "holes".into(),
            width: 16,
            height: 9,
            pixels: (0..16 * 9)
                .map(|_| [255, 255, 255, (255.0 * random.unit()) as u8])
                .collect(),
            wrap: [wrap, Wrap::Repeat],
        })
        .to_vec();
    let material = scene.materials[0].clone();
    scene.materials = (0..3)
        .map(|i| Material {
            texture: Some(i),
            alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
            ..material.clone()
        })
        .collect();
    for (i, triangle) in scene.mesh.triangles.iter_mut().enumerate() {
        triangle.material = i as u32 % 3;
    }
    compare(&scene, 800, 4242);
}

#[test]
fn the_comparison_fails_when_the_sun_is_off() {
    let mut random = Random(77);
    let geometry = Geometry::new(&scene_of(soup(300, 2.0, &mut random)));
    let ray = Ray {
        origin: DVec3::new(0.0, 0.0, 20.0),
        direction: DVec3::NEG_Z,
    };
    let sun = DVec3::new(0.3, 0.8, 0.1).normalize();
    let off = (sun + DVec3::X * 0.5f64.to_radians()).normalize();
    let mut dark = Vec::new();
    geometry.dark_runs(&ray, 40.0, &[Beam::parallel(off, DVec3::ONE)], &mut dark);
    let wrong = (0..4000)
        .filter(|i| {
            let t = 40.0 * (*i as f64 + 0.5) / 4000.0;
            let shadow = Ray {
                origin: ray.at(t),
                direction: sun,
            };
            let truth = geometry.occluded(&shadow, 0.0, f64::INFINITY);
            truth != dark[0].iter().any(|[a, b]| (*a..=*b).contains(&t))
        })
        .count();
    assert!(wrong > 10, "{wrong}");
}
