//! Ten minutes of a day in the built-in scene, one picture a minute, over one scene and one device; prints what each had to make.
//!
//! `cargo run --release --example day -- FOLDER`

use std::path::PathBuf;
use tyndall::Result;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::{Conditions, Request};
use tyndall::output::png;
use tyndall::plan::{Overrules, Plan};
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
    let mut backend = Backend::open(Wanted::Auto)?;
    println!("{}", backend.describe());
    for minute in 0..10 {
        let conditions = start.at(&format!("2026-10-22T11:{minute:02}:00+02:00"))?;
        let plan = Plan::new(&conditions, &Overrules::default())?;
        let rendered = backend.render(&plan, &Limits::default(), &|_| {})?;
        let frame = &rendered.frame;
        let bytes = png::encode(frame, EXPOSURE);
        let path = folder.join(format!("{minute:02}.png"));
        png::write(&path, frame.width, frame.height, &bytes)?;
        let (seconds, made) = (rendered.elapsed.as_secs_f64(), &rendered.made);
        println!("11:{minute:02} in {seconds:.1} s, made anew: {made:?}");
    }
    Ok(())
}
