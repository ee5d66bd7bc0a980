//! Effects: everything that light does in a picture, one file each.
//!
//! # How to add an effect
//!
//! 1. Write `src/effect/<name>.rs`: its documentation (equations, source, what is neglected), a constant [`Effect`] whose `name` is
//!    that of the file, and its tests.
//! 2. Write `shaders/<name>.wgsl` with the kernels that its [`Pass`]es name, and give it to them by
//!    `include_str!("../../shaders/<name>.wgsl")`.
//! 3. Declare the module here and name the constant in [`ALL`] (`src/effect/all.rs`), after those whose fields it reads and before
//!    `compose`, which multiplies what surfaces and background send by the transmittance; what the air sends is left as it is.
//!
//! The plan then lists it with its decision, reason and bound; `--force`, `--without` and `--set` reach it; the backends run it, the
//! report times it and the parity tests compare it. A new kind of result is one more line of the table of [`Field`]s.
//!
//! An effect whose `reads` nobody writes in a scene does not run there, and the plan says so: without media nobody writes
//! `transmittance`.
//!
//! ## On the CPU
//!
//! `decide` tells before anything is rendered whether the scene calls for it. `reference` prepares what a frame needs once and
//! returns the function that is run on batches of rays: [`Fields::update`] goes through the rays with their surfaces,
//! [`Fields::update_by`] with the values of another field too. It gets only the fields that the effect names. Physics is f64.
//!
//! ## On a GPU
//!
//! Without [`Pass`]es the CPU does its work there too, between the GPU's: the fields that it reads, writes or alters are fetched
//! from the device as the effects before it left them, and brought back.
//!
//! A pass is one entry point. What the backend puts before the shader's text:
//! - declarations in bind group 1 of all that its passes of the same text name in their `uses`, under the names that [`Resource`]
//!   tells. A field is `array<vec4f>`, one value a pixel, RGB in `xyz`; add to it (`lights[i] += ...`), since others may have. What one
//!   of these passes writes all may write; `knobs` has the members that any of them asks for;
//! - all of `shaders/common` but the files that some effects alone read (`rows.wgsl`, `sky_table.wgsl`). Names there are taken: the test
//!   `shaders_are_valid` tells of one that is used twice;
//! - constants that Rust and WGSL share, so that no number stands twice.
//!
//! | what a kernel may call | |
//! |---|---|
//! | `inside_tile(id)`, `pixel_index(id)` | whether a pixel is one of the picture, and its place in fields |
//! | `ray_origin(id)`, `ray_direction(id)` | its ray, relative to the eye; `surfaces[i].distance` [m] along it is its surface, `NO_HIT` if `surfaces[i].number` is `NOTHING` |
//! | `eye_relative(p)` | a corner of the scene relative to the eye. Other places of the scene come as knobs, `position - eye` taken in f64 |
//! | `air_span(o, d)`, `ray_end(surface, o, d)`, `sources_of(surface)` | where a ray meets air, where it ends, which media send light on it |
//! | `optical_depth(o, d, distance, sources)`, `sun_optical_depth(p, toward)` | along a ray; from a place to the sun |
//! | `beam_toward(p)`, `beam_illuminance(p)`, `beam_reaches(p)` | in passes for each beam: its light at a place, without shadow and media; whether anything stands in its way |
//! | `beam_scattered(o, d, t, sources)` | what the air sends to the eye from a place of the ray, for a beam that reaches it |
//! | `begin_runs`, `turn`, `integrate_runs`, `shaded_span`, `light_coordinates` | of parallel light alone: lit runs in closed form, where shadows may lie |
//!
//! A pass over pixels has `@workgroup_size(8, 8)` and begins by leaving those outside the picture alone; one over groups has the size
//! that it wants.
//!
//! Compare both backends with one sample a pixel, or by `--check`: of several, the reference takes them only where pixels differ.
//!
//! ## All of one
//!
//! Surfaces that glow by their albedo, on both backends. The test `added_effect` takes the shader from here.
//!
//! ```
//! use tyndall::backend::reference::Reference;
//! use tyndall::backend::Limits;
//! use tyndall::conditions::{Conditions, Request};
//! use tyndall::effect::{
//!     ALL, Contribution, Decision, Effect, Field, Knob, Number, Over, Pass, Resource, When,
//! };
//! use tyndall::plan::{Overrules, Plan};
//! use tyndall::scene::Scene;
//!
//! const GLOW: Effect = Effect {
//!     name: "glow",
//!     summary: "surfaces glow",
//!     reads: &[Field::Surface],
//!     writes: &[Field::Lights],
//!     knobs: &[Knob {
//!         name: "strength",
//!         meaning: "luminance of white [cd/m2]",
//!         values: [100.0; 4],
//!         range: [0.0, 1e6],
//!     }],
//!     decide: |_| Decision::run("it was added", Contribution::Bound(100.0)),
//!     reference: |_, settings, _| {
//!         let strength = settings.get("strength");
//!         Ok(Box::new(move |fields| {
//!             fields.update(Field::Lights, |_, _, surface, present| {
//!                 present + strength * surface.albedo
//!             });
//!         }))
//!     },
//!     passes: &[Pass {
//!         shader: r#"
//! @compute @workgroup_size(8, 8)
//! fn glow(@builtin(global_invocation_id) id: vec3u) {
//!     if !inside_tile(id) {
//!         return;
//!     }
//!     let i = pixel_index(id);
//!     lights[i] += vec4f(knobs.strength * surfaces[i].albedo, 0.0);
//! }
//! "#,
//!         entry: "glow",
//!         over: Over::Pixels,
//!         when: When::Tile,
//!         uses: &[
//!             Resource::Read(Field::Surface),
//!             Resource::Update(Field::Lights),
//!             Resource::Knobs(|_, settings| {
//!                 vec![("strength", Number::float(settings.get("strength")))]
//!             }),
//!         ],
//!     }],
//!     ..Effect::NOTHING
//! };
//!
//! # fn main() -> tyndall::Result<()> {
//! // An effect of the project itself stands in `ALL`, in `src/effect/all.rs`; one of your own is given to the plan.
//! let mut effects = ALL.to_vec();
//! let compose = effects.iter().position(|effect| effect.name == "compose");
//! effects.insert(compose.unwrap_or(effects.len()), &GLOW);
//! let request = Request { size: Some([24, 15]), samples: Some(1), ..Request::default() };
//! let conditions = Conditions::new(Scene::builtin("nave")?, &request)?;
//! let plan = Plan::with(&conditions, &Overrules::default(), &effects)?;
//! let picture = Reference::new(&plan)?.render(&Limits::default(), &|_| {})?;
//! assert!(picture.frame.layer("lights").is_some());
//! # Ok(())
//! # }
//! ```
//!
//! ## What an effect may keep, and for how long
//!
//! An effect itself has no state: it is data and functions. What it finds out and needs again it declares, with what that is
//! made of ([`Input`](crate::conditions::Input)), and the backend keeps it for as long as that is so:
//!
//! | made of | lives | on the GPU, a [`Product`] | on the CPU, a [`Keep`] |
//! |---|---|---|---|
//! | a beam | until the next beam | rows of the rectified map | |
//! | a tile | until the next tile or sample | sums over beams | |
//! | the view | until the camera moves | what depends on pixels | caches of what is seen |
//! | sun, sky, media | until the moment changes | light in the air | the sky's light on surfaces |
//! | geometry, materials alone | as long as the scene | form factors | form factors |
//!
//! A change of any of the effect's knobs ends it too (what depends on knobs alone is made of nothing: `reads: &[]`), and on a GPU a
//! new anchor of the scene. Sun, media and view are compared by value, the sky by identity: the same minute asked for again has
//! another sky. Results that no effect of a plan names are kept as long as they hold, up to 512 MiB. Products are filled by passes that run when they are needed:
//! [`When::Once`], or [`When::Until`] a condition holds that is read back from the device; on the CPU by the function that is given
//! to [`Keeper::get`]. A result that depends on something it does not name is wrong as soon as that changes: name it.

pub mod air_lamps;
pub mod air_shadow;
pub mod air_sky;
mod all;
mod beams;
pub mod compose;
mod definition;
pub mod emission;
mod fields;
mod kept;
pub mod lamp_faces;
pub mod lamps_on_device;
mod method;
pub mod pass;
pub mod radiosity;
pub mod rows;
mod settings;
pub mod shadow;
pub mod shafts;
pub mod shafts_epipolar;
pub mod shafts_march;
pub mod shafts_planes;
pub mod shafts_prefiltered;
pub mod shafts_rectified;
pub mod sky_dome;
pub mod soft_edges;
pub mod sun_disc;
pub mod surface_lamps;
pub mod surface_sun;
pub mod transmittance;
pub mod visibility;

pub use crate::frame::Field;
pub use all::ALL;
pub use beams::sun_beams;
pub use definition::{Batch, Contribution, Decision, Effect};
pub use fields::{Fields, Paid, Source, Surface};
pub use kept::{Keep, Keeper, Kept};
pub use method::Method;
pub use pass::{
    Extent, Life, Loop, MapSettings, Number, Over, Pass, Product, RasterView, Resource, TILE, When,
};
pub use settings::{Knob, Settings};
