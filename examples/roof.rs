//! What sun, sky and ground give to a tilted roof [W/m2], from the two numbers that a weather station measures.
//!
//! The sky is Perez's of 1993: brighter around the sun and at the horizon, so that a roof that faces the sun receives more of it than a
//! sky of one brightness would give. Its pattern is found in cd/m2, and carries the measured diffuse irradiance here.
//!
//! `cargo run --release --example roof`

use glam::DVec3;
use tyndall::Result;
use tyndall::colour::luminance;
use tyndall::sky::patches::{Subdivision, dome, radiances};
use tyndall::sky::{Irradiance, Model, Sky, SunAt};

/// Reflectance of the ground around the house.
const ALBEDO: f64 = 0.2;

/// The direction of an azimuth (from north through east) and an elevation [degrees]: -Z is north, +X east, +Y up.
pub fn direction(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    DVec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        -azimuth.cos() * elevation.cos(),
    )
}

/// Irradiance of a plane by the sun, the sky and the ground [W/m2]; `normal` is where it faces, a unit vector.
pub fn on_a_plane(measured: Irradiance, toward_sun: DVec3, normal: DVec3) -> Result<[f64; 3]> {
    let model = Model::Perez {
        turbidity: 3.0,
        irradiance: Some(measured),
    };
    let sky = Sky::new(model, SunAt::unrefracted(toward_sun))?;
    let patches = dome(Subdivision::Reinhart(4))?;
    let seen = |normal: DVec3| -> f64 {
        let lights = patches.iter().zip(radiances(&sky, &patches));
        let sum = lights.map(|(patch, rgb)| {
            luminance(rgb) * patch.solid_angle * patch.direction.dot(normal).max(0.0)
        });
        sum.sum()
    };
    let level = measured.direct_normal * toward_sun.y + measured.diffuse_horizontal;
    Ok([
        measured.direct_normal * toward_sun.dot(normal).max(0.0),
        measured.diffuse_horizontal * seen(normal) / seen(DVec3::Y),
        level * ALBEDO * 0.5 * (1.0 - normal.y),
    ])
}

#[allow(dead_code)] // the tests call what is above
fn main() -> Result<()> {
    let measured = Irradiance {
        direct_normal: 620.0,
        diffuse_horizontal: 140.0,
    };
    let toward_sun = direction(225.0, 40.0);
    println!("a roof of 35 degrees, the sun in the south-west at 40 degrees");
    println!("faces         sun    sky  ground  all [W/m2]");
    for (name, azimuth) in [
        ("north", 0.0),
        ("east", 90.0),
        ("south", 180.0),
        ("west", 270.0),
    ] {
        let [sun, sky, ground] = on_a_plane(measured, toward_sun, direction(azimuth, 90.0 - 35.0))?;
        let all = sun + sky + ground;
        println!("{name:<10} {sun:>6.1} {sky:>6.1} {ground:>7.1} {all:>11.1}");
    }
    Ok(())
}
