//! Maps of the sky: every direction once, and the sun with its full energy.

use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};
use tyndall::colour::luminance;
use tyndall::sky::map::{Map, Projection};
use tyndall::sky::{Irradiance, Model, Sky, SunAt, SunLight, SunPath};
use tyndall::units::DEG;

fn toward(azimuth: f64, elevation: f64) -> DVec3 {
    let ((sa, ca), (se, ce)) = ((azimuth * DEG).sin_cos(), (elevation * DEG).sin_cos());
    DVec3::new(ce * sa, se, -ce * ca)
}

fn maps(height: u32) -> [Map; 3] {
    [
        Map::new(Projection::Equirectangular, 2 * height, height).unwrap(),
        Map::new(Projection::Fisheye, height, height).unwrap(),
        Map::new(Projection::Cube, 6 * height, height).unwrap(),
    ]
}

#[test]
fn a_point_shows_its_own_direction() {
    for map in maps(64) {
        for y in 0..map.height {
            for x in 0..map.width {
                let (x, y) = (f64::from(x) + 0.37, f64::from(y) + 0.61);
                let Some(d) = map.direction(x, y) else {
                    assert_eq!(map.projection, Projection::Fisheye);
                    continue;
                };
                assert!((d.length() - 1.0).abs() < 1e-12);
                let p = map.point(d).unwrap();
                assert!(
                    (p.x - x).abs() < 1e-6 && (p.y - y).abs() < 1e-6,
                    "{map:?} {x} {y} {p}"
                );
            }
        }
    }
    // North in the middle, east to its right, the zenith on top; the fisheye is seen from below.
    let [equirect, fisheye, cube] = maps(64);
    assert!((equirect.direction(64.0, 32.0).unwrap() - DVec3::NEG_Z).length() < 1e-12);
    assert!((equirect.direction(96.0, 32.0).unwrap() - DVec3::X).length() < 1e-12);
    assert!((equirect.direction(5.0, 0.0).unwrap() - DVec3::Y).length() < 1e-12);
    assert!((fisheye.direction(32.0, 0.0).unwrap() - DVec3::NEG_Z).length() < 1e-12);
    assert!((fisheye.direction(0.0, 32.0).unwrap() - DVec3::X).length() < 1e-12);
    for (face, axis) in [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ]
    .into_iter()
    .enumerate()
    {
        let d = cube.direction(64.0 * face as f64 + 32.0, 32.0).unwrap();
        assert!((d - axis).length() < 1e-12);
    }
}

#[test]
fn texels_fill_the_sphere() {
    let [equirect, fisheye, cube] = maps(128);
    let sum = |map: Map| -> f64 {
        (0..map.height)
            .flat_map(|y| (0..map.width).map(move |x| (x, y)))
            .filter(|(x, y)| {
                map.direction(f64::from(*x) + 0.5, f64::from(*y) + 0.5)
                    .is_some()
            })
            .map(|(x, y)| map.solid_angle(x, y))
            .sum()
    };
    assert!((sum(equirect) / (4.0 * PI) - 1.0).abs() < 1e-12);
    assert!((sum(cube) / (4.0 * PI) - 1.0).abs() < 1e-12);
    // The circle's rim cuts texels: half of them, on the average, are counted.
    assert!((sum(fisheye) / (2.0 * PI) - 1.0).abs() < 2e-3);
}

#[test]
fn a_map_sums_to_the_sky_and_the_sun() {
    let model = Model::Perez {
        turbidity: 3.0,
        irradiance: None,
    };
    for (elevation, height) in [
        (40.0, 512),
        (40.0, 64),
        (89.9, 128),
        (0.1, 256),
        (-0.1, 256),
    ] {
        let toward_sun = toward(123.0, elevation);
        let sky = Sky::new(model, SunAt::unrefracted(toward_sun)).unwrap();
        let light = sky
            .sunlight(&SunPath::standard(elevation * DEG, 3.0))
            .unwrap();
        for map in maps(height) {
            let disc = map.disc(&light, toward_sun);
            let mut energy = DVec3::ZERO;
            for (index, rgb) in &disc {
                let (x, y) = (*index as u32 % map.width, *index as u32 / map.width);
                energy += *rgb * map.solid_angle(x, y);
                let d = map.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
                // Within the disc's radius and half a texel's diagonal of the sun.
                if let Some(d) = d {
                    let off = d.cross(toward_sun).length().atan2(d.dot(toward_sun));
                    assert!(
                        off < light.angular_radius + 2.3 / f64::from(height) * FRAC_PI_2,
                        "{map:?} {off}"
                    );
                }
            }
            // All of it, however few texels.
            let error =
                (energy - light.illuminance).abs().max_element() / light.illuminance.max_element();
            assert!(
                error < 1e-9,
                "{map:?} {elevation}: {energy} {}",
                light.illuminance
            );
        }
        let [map, ..] = maps(height);
        let mut horizontal = DVec3::ZERO;
        let painter = map.painter(&sky, DVec3::ZERO);
        let mut row = vec![Vec3::ZERO; map.width as usize];
        for y in 0..height / 2 {
            painter.row(y, &mut row);
            for (x, rgb) in row.iter().map(|rgb| rgb.as_dvec3()).enumerate() {
                let sine = map.direction(x as f64 + 0.5, f64::from(y) + 0.5).unwrap().y;
                horizontal += rgb * sine * map.solid_angle(x as u32, y);
            }
        }
        let own = luminance(sky.horizontal_illuminance());
        assert!(
            (luminance(horizontal) / own - 1.0).abs() < 5e-3,
            "{elevation} {height}"
        );
    }
    // Texel by texel the disc has its own luminance when it covers many.
    let light = SunLight::new(&SunPath::standard(40.0 * DEG, 3.0)).unwrap();
    let map = Map::new(Projection::Equirectangular, 16384, 8192).unwrap();
    let disc = map.disc(&light, toward(10.0, 40.0));
    let centre = disc
        .iter()
        .map(|(_, rgb)| luminance(*rgb))
        .fold(0.0, f64::max);
    assert!(
        (centre / luminance(light.disc_luminance(0.0)) - 1.0).abs() < 0.1,
        "{centre}"
    );
    assert!(map.disc(&light.dimmed(0.0), DVec3::Y).is_empty());
}

#[test]
fn rows_are_the_sky_direction_by_direction() {
    let irradiance = Some(Irradiance {
        direct_normal: 420.0,
        diffuse_horizontal: 160.0,
    });
    let models = [
        Model::Perez {
            turbidity: 1.5,
            irradiance: None,
        },
        Model::Perez {
            turbidity: 3.0,
            irradiance,
        },
        Model::Preetham { turbidity: 2.0 },
        Model::Preetham { turbidity: 10.0 },
        Model::Hosek {
            turbidity: 1.0,
            albedo: 0.0,
        },
        Model::Hosek {
            turbidity: 10.0,
            albedo: 1.0,
        },
        Model::Cie {
            kind: 4,
            turbidity: 3.0,
            irradiance: None,
        },
        Model::Cie {
            kind: 13,
            turbidity: 3.0,
            irradiance: None,
        },
        Model::Cie {
            kind: 16,
            turbidity: 3.0,
            irradiance: None,
        },
        Model::Uniform { luminance: 7.0 },
    ];
    let [map, ..] = maps(180);
    let ground = DVec3::new(1.0, 2.0, 3.0);
    let mut row = vec![Vec3::ZERO; map.width as usize];
    for model in models {
        // Also with the sun in the middle of a texel, and on both sides of every join of day, twilight and night.
        for elevation in [
            90.0, 60.5, 30.0, 9.9, 5.2, 2.5, 0.5, -0.5, -4.0, -11.0, -13.0, -19.0,
        ] {
            let sky = |off: f64| {
                Sky::new(model, SunAt::unrefracted(toward(120.5 + off, elevation))).unwrap()
            };
            let worst = |sky: &Sky, of: &Sky, row: &mut [Vec3]| {
                let painter = map.painter(of, ground);
                let mut worst = 0.0_f64;
                for y in 0..map.height {
                    painter.row(y, row);
                    for (x, texel) in row.iter().enumerate() {
                        let d = map.direction(x as f64 + 0.5, f64::from(y) + 0.5).unwrap();
                        let exact = if d.y < 0.0 { ground } else { sky.radiance(d) };
                        // A channel that the gamut cuts off is held against the others.
                        let off = (texel.as_dvec3() - exact).abs().max_element();
                        worst = worst.max(off / exact.max_element());
                    }
                }
                worst
            };
            let own = sky(0.0);
            let found = worst(&own, &own, &mut row);
            assert!(found < 1e-6, "{model:?} {elevation}: {found}");
            // Half a degree is seen, where the model has a sun; clouds at dusk have none.
            if !matches!(
                model,
                Model::Uniform { .. } | Model::Cie { kind: 4 | 16, .. }
            ) && elevation < 90.0
                && elevation > -18.0
            {
                assert!(
                    worst(&own, &sky(0.5), &mut row) > 1e-4,
                    "{model:?} {elevation}"
                );
            }
        }
    }
}

#[test]
fn a_map_of_wrong_shape_is_an_error() {
    for (projection, w, h) in [
        (Projection::Equirectangular, 100, 100),
        (Projection::Equirectangular, 10, 5),
        (Projection::Fisheye, 10, 20),
        (Projection::Cube, 10, 10),
        (Projection::Fisheye, 0, 0),
        (Projection::Fisheye, 40_000, 40_000),
    ] {
        assert!(Map::new(projection, w, h).unwrap_err().is_input());
    }
}
