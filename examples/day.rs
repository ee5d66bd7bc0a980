//! Ten minutes of a day in the built-in scene, one picture a minute, over one scene and one device.
//!
//! `cargo run --release --example day -- FOLDER`

use std::ops::ControlFlow;
use std::path::PathBuf;
use tyndall::Result;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::display;
use tyndall::conditions::{Conditions, Request};
use tyndall::output::png;
use tyndall::plan::Overrules;
use tyndall::scene::Scene;

/// The same for all pictures, so that they can be shown one after the other [EV100].
const EXPOSURE: f64 = 8.5;

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or(".".into()));
    let request = Request {
        size: Some([240, 150]),
        samples: Some(1),
        ..Request::default()
    };
    let start = Conditions::new(Scene::builtin("nave")?, &request)?;
    let times: Vec<String> = (0..10)
        .map(|minute| format!("2026-10-22T11:{minute:02}:00+02:00"))
        .collect();
    let mut backend = Backend::open(Wanted::Auto)?;
    println!("{}", backend.describe());
    let moments = times.iter().map(|time| start.at(time));
    let (overrules, limits) = (Overrules::default(), Limits::default());
    backend.render_all(
        moments,
        &overrules,
        &limits,
        &|_| {},
        |number, _, rendered| {
            let frame = &rendered.frame;
            let encode = |x, y, rgb| display::encode(rgb, EXPOSURE, [x, y], true);
            let path = folder.join(format!("{number:02}.png"));
            png::write(
                &path,
                frame.width,
                frame.height,
                &png::encode(frame, encode),
            )?;
            println!(
                "{} {} in {:.1} s, made anew: {:?}",
                path.display(),
                times[number],
                rendered.elapsed.as_secs_f64(),
                rendered.made
            );
            Ok(ControlFlow::Continue(()))
        },
    )
}
