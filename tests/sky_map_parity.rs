//! The GPU's maps of the sky against the reference's, texel by texel, on whatever adapter there is.

mod common;

use glam::{DVec3, Vec3};
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::sky::map::{Map, Projection};
use tyndall::sky::{Irradiance, Model, Sky, SunAt, SunLight, SunPath};
use tyndall::units::DEG;

fn toward(azimuth: f64, elevation: f64) -> DVec3 {
    let ((sa, ca), (se, ce)) = ((azimuth * DEG).sin_cos(), (elevation * DEG).sin_cos());
    DVec3::new(ce * sa, se, -ce * ca)
}

const GROUND: DVec3 = DVec3::new(900.0, 800.0, 700.0);

/// The map with its sun, by the reference.
fn by_reference(map: &Map, sky: &Sky, light: &SunLight) -> Vec<DVec3> {
    let mut row = vec![Vec3::ZERO; map.width as usize];
    let painter = map.painter(sky, GROUND);
    let rows = (0..map.height).flat_map(|y| {
        painter.row(y, &mut row);
        row.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>()
    });
    with_sun(map, sky, light, rows.collect())
}

/// The same by the device.
fn by_gpu(gpu: &mut Gpu, map: &Map, sky: &Sky, light: &SunLight) -> Vec<DVec3> {
    let painted = gpu.paint(map, sky, GROUND).expect("the device works");
    let texels = painted.texels.iter().map(|v| v.as_dvec3()).collect();
    with_sun(map, sky, light, texels)
}

fn with_sun(map: &Map, sky: &Sky, light: &SunLight, mut texels: Vec<DVec3>) -> Vec<DVec3> {
    for (texel, more) in map.disc(light, sky.toward_sun()) {
        texels[texel] += more;
    }
    texels
}

/// The worst difference of a texel, over its own largest channel.
fn worst(found: &[DVec3], truth: &[DVec3]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let differences = found.iter().zip(truth).map(|(found, truth)| {
        assert!(found.is_finite() && found.min_element() >= 0.0, "{found}");
        (*found - *truth).abs().max_element() / truth.max_element().max(1e-30)
    });
    differences.fold(0.0, f64::max)
}

fn maps() -> [Map; 3] {
    [
        Map::new(Projection::Equirectangular, 720, 360).unwrap(),
        Map::new(Projection::Fisheye, 361, 361).unwrap(),
        // An odd side: the middle row of four faces looks exactly along the horizon.
        Map::new(Projection::Cube, 6 * 181, 181).unwrap(),
    ]
}

fn models() -> Vec<Model> {
    let mut models = vec![
        Model::Perez {
            turbidity: 3.0,
            irradiance: None,
        },
        Model::Perez {
            turbidity: 2.0,
            irradiance: Some(Irradiance {
                direct_normal: 420.0,
                diffuse_horizontal: 160.0,
            }),
        },
        Model::Uniform { luminance: 4000.0 },
    ];
    for turbidity in [2.0, 10.0] {
        models.push(Model::Preetham { turbidity });
        models.push(Model::Hosek {
            turbidity,
            albedo: 0.3,
        });
    }
    for kind in [1, 5, 8, 12, 15, 16] {
        models.push(Model::Cie {
            kind,
            turbidity: 3.0,
            irradiance: None,
        });
    }
    models
}

fn sky_and_sun(model: Model, azimuth: f64, elevation: f64) -> (Sky, SunLight) {
    let sky = Sky::new(model, SunAt::unrefracted(toward(azimuth, elevation))).unwrap();
    let path = SunPath::standard(elevation * DEG, model.turbidity());
    let light = sky.sunlight(&path).unwrap();
    (sky, light)
}

#[test]
fn every_texel_agrees_with_the_reference() {
    if !common::gpu("every_texel_agrees_with_the_reference") {
        return;
    }
    let mut gpu = Gpu::open(Choice::Any).expect("there is an adapter");
    let mut highest = 0.0_f64;
    for model in models() {
        for elevation in [90.0, 58.3, 25.0, 8.0, 3.0, 0.2, -2.0, -7.0, -14.0, -20.0] {
            let (sky, light) = sky_and_sun(model, 213.4, elevation);
            for map in maps() {
                let found = by_gpu(&mut gpu, &map, &sky, &light);
                let off = worst(&found, &by_reference(&map, &sky, &light));
                highest = highest.max(off);
            }
        }
    }
    assert!(highest < 1e-4, "{highest:.2e}");
}

#[test]
fn the_sun_keeps_its_energy_and_its_texel() {
    if !common::gpu("the_sun_keeps_its_energy_and_its_texel") {
        return;
    }
    let mut gpu = Gpu::open(Choice::Any).expect("there is an adapter");
    let (sky, light) = sky_and_sun(models()[0], 30.25, 12.25);
    let (dark, _) = sky_and_sun(Model::Uniform { luminance: 0.0 }, 30.25, 12.25);
    for map in maps() {
        // All of the sun and nothing else, however few the texels.
        let mut energy = DVec3::ZERO;
        for (i, rgb) in by_gpu(&mut gpu, &map, &dark, &light).iter().enumerate() {
            let (x, y) = (i as u32 % map.width, i as u32 / map.width);
            let middle = map.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            if middle.is_some_and(|d| d.y >= 0.0) {
                energy += *rgb * map.solid_angle(x, y);
            }
        }
        let off = (energy / light.illuminance - DVec3::ONE)
            .abs()
            .max_element();
        assert!(off < 1e-9, "{map:?}: {off}");
        let texels = by_gpu(&mut gpu, &map, &sky, &light);
        let brightest = (0..texels.len())
            .max_by(|a, b| texels[*a].y.total_cmp(&texels[*b].y))
            .unwrap();
        let truth = by_reference(&map, &sky, &light)[brightest];
        assert!((texels[brightest] / truth - DVec3::ONE).abs().max_element() < 1e-4);
    }
}

#[test]
fn half_a_degree_is_noticed() {
    if !common::gpu("half_a_degree_is_noticed") {
        return;
    }
    let mut gpu = Gpu::open(Choice::Any).expect("there is an adapter");
    for elevation in [40.0, 6.0, -4.0] {
        let (sky, light) = sky_and_sun(models()[0], 213.4, elevation);
        let dimmed = light.dimmed(0.0);
        let (moved, _) = sky_and_sun(models()[0], 213.9, elevation);
        for map in maps() {
            let truth = by_reference(&map, &sky, &dimmed);
            let off = worst(&by_gpu(&mut gpu, &map, &moved, &dimmed), &truth);
            assert!(off > 1e-3, "{map:?} {elevation}: {off:.1e}");
        }
    }
}

#[test]
fn a_map_larger_than_a_band_is_whole() {
    if !common::gpu("a_map_larger_than_a_band_is_whole") {
        return;
    }
    let mut gpu = Gpu::open(Choice::Any).expect("there is an adapter");
    let (sky, light) = sky_and_sun(models()[0], 213.4, 25.0);
    // Not a whole number of bands.
    let map = Map::new(Projection::Equirectangular, 2500, 1250).unwrap();
    let found = by_gpu(&mut gpu, &map, &sky, &light);
    assert!(worst(&found, &by_reference(&map, &sky, &light)) < 1e-4);
}
