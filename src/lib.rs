//! tyndall says where the sun stands, what the sky looks like and what light does in the air, in physical units.
//!
//! # The story
//!
//! A [`Scene`](scene::Scene) is what the user says: triangles, materials, a camera, a place and a time, media.
//! [`Conditions`](conditions::Conditions) are what physics makes of it: the sun's place and light, the sky, the air, all inside the
//! domains of their equations. A [`Plan`](plan::Plan) asks every [`Effect`](effect::Effect) whether the scene calls for it, why,
//! and what would be missing without it. A [`Backend`](backend::Backend) runs the plan: the
//! [`Reference`](backend::reference::Reference) in f64 on the CPU, exact and slow, or a [`Gpu`](backend::gpu::Gpu). What comes out is
//! a [`Frame`](frame::Frame): layers in cd/m2 and the record of how they came about,
//! which [`output`] writes to files.
//!
//! ```
//! use tyndall::backend::{Backend, Limits, Step, Wanted};
//! use tyndall::conditions::{Conditions, Request};
//! use tyndall::plan::{Overrules, Plan};
//! use tyndall::scene::Scene;
//!
//! # fn main() -> tyndall::Result<()> {
//! let scene = Scene::builtin("nave")?;
//! let request = Request { size: Some([24, 15]), samples: Some(1), ..Request::default() };
//! let conditions = Conditions::new(scene, &request)?;
//! let plan = Plan::new(&conditions, &Overrules::default())?;
//! let mut backend = Backend::open(Wanted::Reference)?;
//! let progress = |step: Step| eprintln!("{} {:.0} %", step.stage, 100.0 * step.share);
//! let picture = backend.render(&plan, &Limits::default(), &progress)?;
//! assert!(picture.frame.layer("inscatter_sun").is_some(), "there are light shafts in it");
//! # Ok(())
//! # }
//! ```
//!
//! Parts of it serve alone. Where the sun stands at a place and a time:
//!
//! ```
//! use tyndall::ephemeris::{Site, Tier, Weather, civil::resolve, sun_position};
//!
//! # fn main() -> tyndall::Result<()> {
//! let paris = Site::new(48.8584, 2.2945, 35.0)?;
//! let evening = resolve("2026-06-21T18:30", None, Some(&paris), None)?; // by the clock of the place
//! let sun = sun_position(Tier::Spa, &evening.instant, &paris, &Weather::standard(&paris));
//! assert_eq!(format!("{:.1} {:.1}", sun.azimuth_deg(), sun.elevation_apparent_deg()), "271.2 30.9");
//! # Ok(())
//! # }
//! ```
//!
//! and how bright the sky is, in any direction:
//!
//! ```
//! use glam::DVec3;
//! use tyndall::colour::luminance;
//! use tyndall::sky::{Model, Sky, SunAt};
//!
//! # fn main() -> tyndall::Result<()> {
//! let toward_sun = DVec3::new(0.0, 0.5, 0.75f64.sqrt()); // +Y is up, -Z north: 30 degrees high in the south
//! let clear = Model::Perez { turbidity: 3.0, irradiance: None };
//! let sky = Sky::new(clear, SunAt::unrefracted(toward_sun))?;
//! let zenith = luminance(sky.radiance(DVec3::Y)); // cd/m2
//! assert!((1_000.0..3_000.0).contains(&zenith));
//! # Ok(())
//! # }
//! ```
//!
//! Whole programs to begin with, in `examples/`: `sun_position`, `roof` (what sun, sky and ground give to a tilted roof in W/m2) and
//! `own_scene` (a picture of one's own GLB in thirty lines); `cargo run --release --example roof`.
//!
//! # Where things are
//!
//! A module uses only what stands before it here; a test reads the `use` lines and fails otherwise.
//!
//! | module | what |
//! |---|---|
//! | [`split_mix`] | deterministic numbers that look like chance |
//! | [`units`], [`error`] | the unit rule; one error: what was wrong, where, the valid range, what to do |
//! | [`memory`] | lists that may be large: made, or an error where memory does not suffice |
//! | [`file`] | reading a file whole: no device, no pipe, no more than is allowed |
//! | [`task`] | how far a long task is, and how it is stopped |
//! | [`warning`] | what was left out, is doubtful or approximate, and what to do |
//! | [`beam`] | light from a direction or a place, which shadows and scattering go by |
//! | [`colour`] | spectra, CIE 1931, RGB spaces, exposure, display transform |
//! | [`ephemeris`] | where the sun is, in four tiers of accuracy; times and zones as people write them |
//! | [`sky`] | sky models, twilight, the sun's light, dome patches |
//! | [`photometry`] | luminous intensity of lamps by direction: formulas, IES and EULUMDAT files |
//! | [`medium`] | phase functions, densities, optical depth and its integrals |
//! | [`scene`] | geometry, materials, cameras, loading, what stands in the way of light |
//! | [`frame`] | what a backend makes, and the one table of fields and layers |
//! | [`accuracy`] | how far numbers are from the truth |
//! | [`conditions`] | scene, time and view become physics; the one place where domains are checked |
//! | [`radiosity`] | light from sky and surfaces, everywhere: who sees whom, and how bright all are |
//! | [`effect`] | one file an effect: equations, decision, reference, passes |
//! | [`plan`] | which effects run, and why not the others |
//! | [`backend`] | a GPU or the reference: rendering, checking, choosing by error or time |
//! | [`output`] | EXR, PNG, HDR, JSON |
//! | [`studies`] | what accuracy costs |
//! | [`timelapse`] | frames over a range of times, and a film of them |
//! | [`daylight`] | sensors on grids, a year of weather, the metrics of standards |
//!
//! # How to add an effect
//!
//! Two files and their names in the list: see [`effect`].
//!
//! # Conventions
//!
//! SI and radians; another unit is in the name (`latitude_deg`). Scene axes are right-handed, +Y up, metres; with `north` 0, -Z faces
//! north and +X east. Directions say where they point (`toward_sun`). RGB triples are in the working space, linear Rec. 2020 with
//! white D65, and photometric: their luminance is in cd/m2, or their illuminance in lux. Physics on the CPU is f64.

pub mod accuracy;
pub mod backend;
pub mod beam;
pub mod colour;
pub mod conditions;
pub mod daylight;
pub mod effect;
pub mod ephemeris;
pub mod error;
pub mod file;
pub mod frame;
pub mod medium;
pub mod memory;
pub mod output;
pub mod photometry;
pub mod plan;
pub mod radiosity;
pub mod scene;
pub mod sky;
pub mod split_mix;
pub mod studies;
pub mod task;
pub mod timelapse;
pub mod units;
pub mod warning;

pub use error::{Error, Result};
pub use warning::Warning;
