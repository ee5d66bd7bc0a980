//! The contact sheet of docs/sky.md: twelve heights of the sun from night to noon under three weathers.
//!
//! `cargo run --release --example sky_sheet -- docs/sky-sheet.png`

use glam::{DVec3, Vec3};
use image::{Rgb, RgbImage};
use tyndall::Result;
use tyndall::colour::{display, exposure, luminance};
use tyndall::error::Error;
use tyndall::sky::map::{Map, Projection};
use tyndall::sky::{Irradiance, Model, Sky, SunAt, SunPath};
use tyndall::units::DEG;

const ELEVATIONS: [f64; 12] = [
    -18.0, -12.0, -8.0, -5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 62.0,
];
const TILE: u32 = 152;

fn main() -> Result<()> {
    let name = std::env::args().nth(1).unwrap_or("sky-sheet.png".into());
    let weathers = [
        Model::Perez {
            turbidity: 2.5,
            irradiance: None,
        },
        Model::Perez {
            turbidity: 6.0,
            irradiance: None,
        },
        Model::Perez {
            turbidity: 3.0,
            irradiance: Some(Irradiance {
                direct_normal: 0.0,
                diffuse_horizontal: 120.0,
            }),
        },
    ];
    let map = Map::new(Projection::Fisheye, TILE, TILE)?;
    let mut sheet = RgbImage::new(TILE * ELEVATIONS.len() as u32, TILE * weathers.len() as u32);
    for (row, model) in weathers.into_iter().enumerate() {
        for (column, elevation) in ELEVATIONS.into_iter().enumerate() {
            // The sun sets toward the bottom of the circle.
            let toward_sun = DVec3::new(0.0, (elevation * DEG).sin(), (elevation * DEG).cos());
            let sky = Sky::new(model, SunAt::unrefracted(toward_sun))?;
            let light = sky.sunlight(&SunPath::standard(elevation * DEG, model.turbidity()))?;
            let painter = map.painter(&sky, DVec3::ZERO);
            let mut painted = vec![Vec3::ZERO; (TILE * TILE) as usize];
            for (texels, y) in painted.chunks_mut(TILE as usize).zip(0..TILE) {
                painter.row(y, texels);
            }
            let mut texels: Vec<DVec3> = painted.iter().map(|rgb| rgb.as_dvec3()).collect();
            for (texel, rgb) in map.disc(&light, toward_sun) {
                texels[texel] += rgb;
            }
            // One stop more than a meter gives, as for every sky.
            let ev100 =
                exposure::auto(texels.iter().map(|v| luminance(*v))).map_or(0.0, |ev| ev - 1.0);
            for (i, rgb) in texels.into_iter().enumerate() {
                let (x, y) = (
                    column as u32 * TILE + i as u32 % TILE,
                    row as u32 * TILE + i as u32 / TILE,
                );
                sheet.put_pixel(x, y, Rgb(display::encode(rgb, ev100, [x, y], true)));
            }
        }
    }
    sheet.save(&name).map_err(|e| {
        Error::failed(
            format!("{name} could not be written: {e}"),
            "check the folder",
        )
    })
}
