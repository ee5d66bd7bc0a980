//! The table of docs/air.md: how bright ground 40 km off is over the sky right behind it, by model of the sky and the sun's elevation.
//!
//! `cargo run --release --example far_ground`

use glam::DVec3;
use tyndall::Result;
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::medium::ClearAir;
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{Camera, Scene, SkyEntry, SunEntry};

/// Height of the eye, and distance of the ground [m].
const EYE: f64 = 200.0;
const FAR: f64 = 40e3;

const MODELS: [(&str, f64); 6] = [
    ("perez", 2.5),
    ("perez", 4.0),
    ("preetham", 2.5),
    ("hosek", 2.5),
    ("cie:12", 2.5),
    ("cie:1", 2.5),
];
const ELEVATIONS: [f64; 4] = [5.0, 20.0, 45.0, 70.0];

/// Luminance of the far ground and of the sky as far above the horizon as the ground is below [cd/m2], `turn` degrees from the sun.
fn ground_and_sky(model: (&str, f64), elevation: f64, turn: f64) -> Result<[f64; 2]> {
    let scene = Scene {
        sun: Some(SunEntry {
            azimuth_deg: 180.0,
            elevation_deg: elevation,
            illuminance: None,
            diameter_deg: None,
        }),
        sky: SkyEntry {
            model: Some(model.0.into()),
            turbidity: Some(model.1),
            ..SkyEntry::default()
        },
        air: Some(ClearAir::default()),
        ..Scene::default()
    };
    let eye = EYE * DVec3::Y;
    let (sin, cos) = (180.0 + turn).to_radians().sin_cos();
    // Two pixels, whose centres lie as far above the horizon as below.
    let camera = Camera::look_at(
        eye,
        eye + DVec3::new(sin, 0.0, -cos),
        4.0 * (EYE / FAR).atan(),
    );
    let request = Request {
        size: Some([1, 2]),
        samples: Some(1),
        camera: CameraChoice::Given(camera),
        ..Request::default()
    };
    let conditions = Conditions::new(scene, &request)?;
    let plan = Plan::new(&conditions, &Overrules::default())?;
    let rendered = Reference::new(&plan)?.render(&Limits::default(), &|_| {})?;
    Ok([1, 0].map(|row| luminance(rendered.frame.picture(row))))
}

fn main() -> Result<()> {
    println!("| sky, turbidity | sun | toward the sun | across | away from it |");
    println!("|---|---|---|---|---|");
    for model in MODELS {
        for elevation in ELEVATIONS {
            let mut cells = String::new();
            for turn in [0.0, 90.0, 180.0] {
                let [ground, sky] = ground_and_sky(model, elevation, turn)?;
                cells += &format!(" {:.2} |", ground / sky);
            }
            println!("| {}, {} | {elevation} |{cells}", model.0, model.1);
        }
    }
    Ok(())
}
