//! Effects: everything that light does in a picture, one file each.
//!
//! # How to add an effect
//!
//! Write `src/effect/<name>.rs` with its documentation (equations, source, what is neglected), a constant [`Effect`] and its
//! tests, `shaders/<name>.wgsl` with the kernels that its [`Pass`]es name (without any, the CPU does its work), and name the constant in [`ALL`], after those whose fields it reads. The plan then lists it with its decision,
//! reason and bound; `--force`, `--without` and `--set` reach it; the backends run it, the report times it and the parity tests compare it. A new kind of
//! result is one more [`Field`].
//!
//! An effect has no state. `decide` tells before anything is rendered whether the scene calls for it; `reference` prepares
//! what a frame needs once and returns the function that is run on batches of rays.

pub mod air_shadow;
pub mod compose;
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

use crate::conditions::Conditions;
use crate::scene::Ray;
use glam::{DVec3, UVec2};

pub use pass::{Kind, Over, Pass, Resource, Scratch};
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
    /// The fields that must have been written before.
    pub reads: &'static [Field],
    /// The fields it writes or adds to.
    pub writes: &'static [Field],
    /// Whether the reference keeps results from pixel to pixel, so that later pixels cost less.
    pub remembers: bool,
    /// Which way of integrating sunlight in the air it is: of all that are one, a plan runs one.
    pub method: Option<Method>,
    /// What can be set by `--set <name>.<knob>=<value>`.
    pub knobs: &'static [Knob],
    /// Whether the scene calls for it, and what would be missing without it.
    pub decide: fn(&Conditions) -> Decision,
    /// The slow and exact way on the CPU, in f64: prepared once a frame, then run on batches of rays on all cores.
    pub reference: for<'a> fn(&'a Conditions, &Settings<'_>) -> Batch<'a>,
    /// What it does on a GPU; empty: `reference` does it on the CPU there too.
    pub passes: &'static [Pass],
}

impl Effect {
    /// Whether a user who writes `name` means it: its own name, or `shafts` for all methods of integrating sunlight in air.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || (name == "shafts" && self.method.is_some())
    }
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

/// An intermediate or final result: one value a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// The surface that the ray meets.
    Surface,
    /// Share of light that comes through from the ray's end to the eye [1], RGB.
    Transmittance,
    /// Sunlight reflected by surfaces [cd/m2].
    Sun,
    /// Sky light reflected by surfaces [cd/m2].
    Sky,
    /// Light of lamps reflected by surfaces [cd/m2].
    Lights,
    /// Sky and disc seen directly [cd/m2].
    Background,
    /// Sunlight scattered by the air [cd/m2].
    InscatterSun,
    /// Sky light scattered by the air [cd/m2].
    InscatterSky,
    /// Light of lamps scattered by the air [cd/m2].
    InscatterLights,
    /// Sunlight that the clear air before the sky would scatter where geometry shadows it [cd/m2].
    AirShadow,
    /// Sunlight that the clear air before the sky would scatter without shadows [cd/m2].
    AirLight,
}

impl Field {
    /// The fields whose sum is the picture.
    pub const LAYERS: [Field; 7] = [
        Field::Sun,
        Field::Sky,
        Field::Lights,
        Field::Background,
        Field::InscatterSun,
        Field::InscatterSky,
        Field::InscatterLights,
    ];

    /// Its name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Field::Surface => "surface",
            Field::Transmittance => "transmittance",
            Field::Sun => "sun",
            Field::Sky => "sky",
            Field::Lights => "lights",
            Field::Background => "background",
            Field::InscatterSun => "inscatter_sun",
            Field::InscatterSky => "inscatter_sky",
            Field::InscatterLights => "inscatter_lights",
            Field::AirShadow => "air_shadow",
            Field::AirLight => "air_light",
        }
    }
}

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// What it belongs to.
    pub source: Source,
    /// Distance along the ray [m]; infinite where nothing is met.
    pub distance: f64,
    /// Position [m].
    pub position: DVec3,
    /// Unit normal that shading uses, on the eye's side.
    pub normal: DVec3,
    /// Unit normal of the triangle itself, on the eye's side.
    pub facet: DVec3,
    /// Reflectance in the working space, 0 to 1.
    pub albedo: DVec3,
}

/// What a surface belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Nothing is met.
    Nothing,
    /// The endless ground plane.
    Ground,
    /// A triangle of the scene, with the weights of its second and third vertex.
    Triangle(u32, [f64; 2]),
}

impl Surface {
    /// What a ray that meets nothing has.
    pub const NOTHING: Surface = Surface {
        source: Source::Nothing,
        distance: f64::INFINITY,
        position: DVec3::ZERO,
        normal: DVec3::ZERO,
        facet: DVec3::ZERO,
        albedo: DVec3::ZERO,
    };

    /// Whether something is met.
    pub fn is_met(&self) -> bool {
        self.source != Source::Nothing
    }
}

/// A batch of rays and what the effects have found on them.
pub struct Fields {
    /// The rays.
    pub rays: Vec<Ray>,
    /// The pixel that each ray belongs to.
    pub pixels: Vec<UVec2>,
    /// [`Field::Surface`].
    pub surfaces: Vec<Surface>,
    values: [Option<Vec<DVec3>>; 10],
}

fn slot(field: Field) -> usize {
    match field {
        Field::Surface => unreachable!("surfaces are not colours"),
        Field::Transmittance => 0,
        Field::Sun => 1,
        Field::Sky => 2,
        Field::Lights => 3,
        Field::Background => 4,
        Field::InscatterSun => 5,
        Field::InscatterSky => 6,
        Field::InscatterLights => 7,
        Field::AirShadow => 8,
        Field::AirLight => 9,
    }
}

impl Fields {
    /// A batch with room for the fields that its effects write, and no other.
    pub fn new(rays: Vec<Ray>, pixels: Vec<UVec2>, written: &[Field]) -> Self {
        let count = rays.len();
        let mut fields = Fields {
            rays,
            pixels,
            surfaces: Vec::new(),
            values: Default::default(),
        };
        for &field in written {
            match field {
                Field::Surface => fields.surfaces = vec![Surface::NOTHING; count],
                Field::Transmittance => fields.values[slot(field)] = Some(vec![DVec3::ONE; count]),
                _ => fields.values[slot(field)] = Some(vec![DVec3::ZERO; count]),
            }
        }
        fields
    }

    /// The values of a field, one a ray; `None` when no effect of the plan writes it.
    pub fn get(&self, field: Field) -> Option<&[DVec3]> {
        self.values[slot(field)].as_deref()
    }

    /// Sets every value of a field to what `value` makes of the ray, the pixel, the surface and the present value.
    pub fn update(
        &mut self,
        field: Field,
        mut value: impl FnMut(&Ray, UVec2, &Surface, DVec3) -> DVec3,
    ) {
        let Some(values) = self.values[slot(field)].as_mut() else {
            return;
        };
        for (i, present) in values.iter_mut().enumerate() {
            *present = value(&self.rays[i], self.pixels[i], &self.surfaces[i], *present);
        }
    }

    /// Multiplies one field by another.
    pub fn multiply(&mut self, field: Field, by: Field) {
        let Some(factors) = self.values[slot(by)].take() else {
            return;
        };
        if let Some(values) = self.values[slot(field)].as_mut() {
            for (value, factor) in values.iter_mut().zip(&factors) {
                *value *= *factor;
            }
        }
        self.values[slot(by)] = Some(factors);
    }
}
