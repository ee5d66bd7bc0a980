//! Effects: everything that light does in a picture, one file each.
//!
//! # How to add an effect
//!
//! Write `src/effect/<name>.rs` with its documentation (equations, source, what is neglected), a constant [`Effect`] and its
//! tests, `shaders/<name>.wgsl` with the kernels that its [`Pass`]es name, and name the constant in [`ALL`], after those whose
//! fields it reads. The plan then lists it with its decision, reason and bound; `--force`, `--without` and `--set` reach it; the
//! backends run it, the report times it and the parity tests compare it. A new kind of result is one more line of the table of
//! [`Field`]s.
//!
//! ## On the CPU
//!
//! `decide` tells before anything is rendered whether the scene calls for it. `reference` prepares what a frame needs once and
//! returns the function that is run on batches of rays: [`Fields::update`] goes through the rays with their surfaces. Physics is
//! f64.
//!
//! ## On a GPU
//!
//! Without [`Pass`]es the CPU does its work there too, between the GPU's: the fields that it reads, writes or alters are fetched
//! from the device as the effects before it left them, and brought back. Nothing need be done for it.
//!
//! A pass is one entry point. What the backend prints before the shader's text:
//! - a declaration for each of the pass's `uses`, in bind group 1, under the names that [`Resource`] tells. A field is
//!   `array<vec4f>`, one value a pixel, RGB in `xyz`; add to it (`lights[i] += ...`), since others may have;
//! - `shaders/common`: `tile` (the tile, the camera), `rays`, `media`, and their functions; in passes for each beam `beam` and its
//!   maps. These names and those of the functions there are taken: the test `shaders_are_valid` tells of one that is used twice;
//! - constants that Rust and WGSL share ([`crate::backend::gpu`]), so that no number stands twice.
//!
//! A pass over pixels has `@workgroup_size(8, 8)`, and begins by leaving those outside the picture alone:
//!
//! ```wgsl
//! @compute @workgroup_size(8, 8)
//! fn glow(@builtin(global_invocation_id) id: vec3u) {
//!     if !inside_tile(id) {
//!         return;
//!     }
//!     let i = pixel_index(id);
//!     lights[i] += vec4f(knobs.strength * surfaces[i].albedo, 0.0);
//! }
//! ```
//!
//! Its ray begins at `ray_origin(id)`, relative to the eye, in the direction `ray_direction(id)`, and meets its surface at
//! `surfaces[i].distance`; a surface of number 0 is none. All of this effect stands in `tests/added_effect.rs`, which takes the
//! text above from here.
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
//! A change of any of the effect's knobs ends it too. Products are filled by passes that run when they are needed:
//! [`When::Once`], or [`When::Until`] a condition holds that is read back from the device; on the CPU by the function that is given
//! to [`Kept::get`]. A result that depends on something it does not name is wrong as soon as that changes: name it.

pub mod air_shadow;
pub mod compose;
mod fields;
mod kept;
pub mod pass;
pub mod rows;
pub mod shadow;
pub mod shafts;
pub mod shafts_epipolar;
pub mod shafts_march;
pub mod shafts_planes;
pub mod shafts_prefiltered;
pub mod shafts_rectified;
pub mod sky_dome;
pub mod sun_disc;
pub mod surface_sky;
pub mod surface_sun;
pub mod transmittance;
pub mod visibility;

use crate::beam::Beam;
use crate::conditions::Conditions;

pub use crate::frame::Field;
pub use fields::{Fields, Source, Surface};
pub use kept::{Keep, Kept};
pub use pass::{
    Extent, Life, Loop, MapSettings, Number, Over, Pass, Product, RasterView, Resource, When,
};
pub use shafts::Method;

/// Every effect, in the order in which they run: each after those whose fields it reads.
pub const ALL: &[&Effect] = &[
    &visibility::VISIBILITY,
    &transmittance::TRANSMITTANCE,
    &sky_dome::SKY_DOME,
    &sun_disc::SUN_DISC,
    &shadow::SHADOW,
    &surface_sun::SURFACE_SUN,
    &surface_sky::SURFACE_SKY,
    &shafts_rectified::SHAFTS_RECTIFIED,
    &shafts_epipolar::SHAFTS_EPIPOLAR,
    &shafts_prefiltered::SHAFTS_PREFILTERED,
    &shafts_march::SHAFTS_MARCH,
    &shafts_planes::SHAFTS_PLANES,
    &air_shadow::AIR_SHADOW,
    &compose::COMPOSE,
];

/// What light does in one respect: data and functions, no state.
pub struct Effect {
    /// Its name, the same in the plan, the flags and the report; the stem of its file.
    pub name: &'static str,
    /// What it adds to the picture, in a few words.
    pub summary: &'static str,
    /// The fields that effects before it must have written.
    pub reads: &'static [Field],
    /// The fields it writes or adds to.
    pub writes: &'static [Field],
    /// The fields it changes where effects before it wrote them; one that nobody wrote is left alone.
    pub alters: &'static [Field],
    /// What its reference keeps from ray to ray and frame to frame, so that later ones cost less.
    pub keeps: &'static [&'static Keep],
    /// Which way of integrating sunlight in the air it is: of all that are one, a plan runs one.
    pub method: Option<Method>,
    /// What can be set by `--set <name>.<knob>=<value>`.
    pub knobs: &'static [Knob],
    /// Whether the scene calls for it, and what would be missing without it.
    pub decide: fn(&Conditions) -> Decision,
    /// The slow and exact way on the CPU, in f64: prepared once a frame, then run on batches of rays on all cores.
    pub reference: for<'a> fn(&'a Conditions, &Settings<'_>, &Kept) -> Batch<'a>,
    /// What it does on a GPU; empty: `reference` does it on the CPU there too.
    pub passes: &'static [Pass],
}

impl Effect {
    /// One that does nothing: what an effect does not say is as here.
    pub const NOTHING: Effect = Effect {
        name: "nothing",
        summary: "",
        reads: &[],
        writes: &[],
        alters: &[],
        keeps: &[],
        method: None,
        knobs: &[],
        decide: |_| Decision::nothing("there is nothing to do"),
        reference: |_, _, _| Box::new(|_| {}),
        passes: &[],
    };

    /// Whether it draws the shadow maps of beams.
    pub fn draws_maps(&self) -> bool {
        let beam = |pass: &Pass| matches!(pass.over, Over::Raster(RasterView::Beam(_)));
        self.passes.iter().any(beam)
    }

    /// Whether a user who writes `name` means it: its own name, or `shafts` for all methods of integrating sunlight in air.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || (name == "shafts" && self.method.is_some())
    }
}

/// The beams of the sun's disc, as many as the knob `suns` says, or one where no penumbra is as wide as a pixel.
pub fn sun_beams(conditions: &Conditions, settings: &Settings<'_>) -> Vec<Beam> {
    conditions.sun_beams(settings.get("suns") as usize)
}

/// What an effect does to a batch of rays.
pub type Batch<'a> = Box<dyn Fn(&mut Fields) + Send + Sync + 'a>;

/// A number that trades accuracy for time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knob {
    /// Its name.
    pub name: &'static str,
    /// What it counts, with its unit.
    pub meaning: &'static str,
    /// Its value at each quality: draft, preview, high, reference.
    pub values: [f64; 4],
    /// Its least and greatest value.
    pub range: [f64; 2],
}

/// Whether a scene calls for an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// Whether it runs.
    pub run: bool,
    /// Whether it could run at all (a skipped effect can be forced only then).
    pub possible: bool,
    /// Why.
    pub reason: String,
    /// The most that it can contribute to a pixel [cd/m2 of luminance].
    pub contribution: Contribution,
}

/// How much an effect can contribute to a pixel's luminance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contribution {
    /// No pixel gets more [cd/m2].
    Bound(f64),
    /// A typical pixel gets about this much [cd/m2]; not a bound.
    Estimate(f64),
    /// Without it there is no picture.
    Everything,
}

impl Decision {
    /// It runs.
    pub fn run(reason: impl Into<String>, contribution: Contribution) -> Self {
        Decision {
            run: true,
            possible: true,
            reason: reason.into(),
            contribution,
        }
    }

    /// There is nothing for it to do: it would add exactly nothing.
    pub fn nothing(reason: impl Into<String>) -> Self {
        Decision {
            run: false,
            possible: false,
            reason: reason.into(),
            contribution: Contribution::Bound(0.0),
        }
    }

    /// It adds nothing that this picture shows, though it could be run.
    pub fn skip(reason: impl Into<String>, contribution: Contribution) -> Self {
        Decision {
            run: false,
            possible: true,
            reason: reason.into(),
            contribution,
        }
    }
}

/// The knobs of one effect as a plan has set them.
#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    /// The knobs' names and values.
    pub values: &'a [(&'static str, f64)],
}

impl Settings<'_> {
    /// The value of a knob that the effect declares.
    pub fn get(&self, knob: &str) -> f64 {
        self.values
            .iter()
            .find(|(name, _)| *name == knob)
            .map(|(_, value)| *value)
            .expect("an effect asks only for knobs that it declares")
    }
}
