//! A picture of one's own GLB (or glTF, OBJ, TOML) at a place and a time, to look at (PNG) and in numbers (EXR).
//!
//! `cargo run --release --example own_scene -- room.glb room`

use std::path::Path;
use tyndall::Result;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::{Space, exposure, luminance};
use tyndall::conditions::{Conditions, Request};
use tyndall::output::{Format, Numbers, OutputSpace, picture, select_layers};
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{SiteEntry, load};

/// Renders `scene` into `to`.png and `to`.exr; the exposure of the PNG [EV100].
pub fn render(scene: &Path, to: &Path, size: [u32; 2]) -> Result<f64> {
    let mut scene = load(scene)?;
    // What a mesh does not say: where it stands, and when.
    scene.site = Some(SiteEntry {
        latitude_deg: 48.8584,
        longitude_deg: 2.2945,
        elevation: 35.0,
        timezone: None,
    });
    scene.time = Some("2026-06-21T16:30".into());
    let request = Request {
        size: Some(size),
        samples: Some(4),
        ..Request::default()
    };
    let conditions = Conditions::new(scene, &request)?;
    let plan = Plan::new(&conditions, &Overrules::default())?;
    let frame = Backend::open(Wanted::Auto)?
        .render(&plan, &Limits::default(), &|_| {})?
        .frame;
    let metered = exposure::auto((0..frame.pixels()).map(|i| luminance(frame.picture(i))));
    let ev100 = metered.unwrap_or(0.0); // of a black picture: any
    let space = OutputSpace::new(Space::Rec709, Numbers::default());
    for ending in ["png", "exr"] {
        let path = to.with_extension(ending);
        picture::write(
            &path,
            Format::of(&path)?,
            &frame,
            &space,
            &select_layers::<&str>(&[])?,
            ev100,
        )?;
    }
    Ok(ev100)
}

#[allow(dead_code)] // the tests call what is above
fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, to] = &arguments[..] else {
        eprintln!("usage: own_scene SCENE NAME");
        std::process::exit(2);
    };
    let ev100 = render(Path::new(scene), Path::new(to), [480, 300])?;
    println!("{to}.png and {to}.exr, EV100 {ev100:.1}");
    Ok(())
}
