//! The sheet of docs/radiosity.md: one court at six times of a day, its walls and the haze in it lit by sun, sky and each other; prints
//! what the light of each moment cost, over a transport that is found once.
//!
//! `cargo run --release --example court_sheet -- docs/court-sheet.png`

use image::{Rgb, RgbImage};
use tyndall::Result;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::{display, exposure, luminance};
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::error::Error;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::SiteEntry;
use tyndall::studies::scenes;

const TIMES: [&str; 6] = ["05:15", "06:45", "09:30", "13:00", "18:30", "20:40"];
const TILE: [u32; 2] = [320, 200];

fn main() -> Result<()> {
    let name = std::env::args().nth(1).unwrap_or("court-sheet.png".into());
    let court = scenes::court();
    let mut scene = court.scene;
    scene.sun = None;
    scene.site = Some(SiteEntry {
        latitude_deg: 43.77,
        longitude_deg: 11.26,
        elevation: 50.0,
        timezone: Some("Europe/Rome".into()),
    });
    let at = |time: &str| format!("2026-06-21T{time}:00+02:00");
    scene.time = Some(at(TIMES[0]));
    // Plaster, terracotta: what walls send has their colour.
    for (material, colour) in scene.materials.iter_mut().zip([[0.75, 0.55, 0.38]]) {
        material.base_color = colour.into();
    }
    let request = Request {
        size: Some(TILE),
        camera: CameraChoice::Given(court.camera),
        ..Request::default()
    };
    let start = Conditions::new(scene, &request)?;
    let mut backend = Backend::open(Wanted::Auto)?;
    let mut sheet = RgbImage::new(3 * TILE[0], 2 * TILE[1]);
    let overrules = Overrules {
        quality: Quality::Preview,
        ..Overrules::default()
    };
    for (place, time) in (0..).zip(TIMES) {
        let begun = std::time::Instant::now();
        let conditions = start.at(&at(time))?;
        let plan = Plan::new(&conditions, &overrules)?;
        let rendered = backend.render(&plan, &Limits::default(), &|_| {})?;
        println!(
            "{time} in {:.1} s, made anew: {:?}",
            begun.elapsed().as_secs_f64(),
            rendered.made.products
        );
        let frame = rendered.frame;
        let colour = |i: usize| frame.picture(i);
        let luminances = (0..frame.pixels()).map(|i| luminance(colour(i)));
        let ev100 = exposure::auto(luminances).map_or(0.0, |ev| ev - 0.5);
        for i in 0..frame.pixels() as u32 {
            let (x, y) = (i % TILE[0], i / TILE[0]);
            let rgb = display::encode(colour(i as usize), ev100, [x, y], true);
            let corner = [place % 3 * TILE[0], place / 3 * TILE[1]];
            sheet.put_pixel(corner[0] + x, corner[1] + y, Rgb(rgb));
        }
    }
    sheet.save(&name).map_err(|e| {
        Error::failed(
            format!("{name} could not be written: {e}"),
            "check the folder",
        )
    })
}
