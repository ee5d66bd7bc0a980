//! What fills the air, as a TOML scene file says it.

use crate::error::{Error, Result};
use crate::medium::{ClearAir, Edge, Medium, Phase, Shape, Wave};
use crate::units::DEG;
use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// Makes an error of a key, of what is wrong with it and of what to do.
pub(super) type Wrong<'a> = &'a dyn Fn(&str, String, &str) -> Error;

/// What fills the air, by its shape.
#[derive(Deserialize, JsonSchema)]
#[serde(tag = "shape", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum MediumTable {
    /// Homogeneous inside a box; sunlight is attenuated from the box's face.
    Box {
        /// The corner of least coordinates [m].
        min: [f64; 3],
        /// The corner of greatest coordinates [m].
        max: [f64; 3],
        /// Scattering coefficient [1/m], a number or [R, G, B].
        scattering: Coefficient,
        /// Absorption coefficient [1/m], a number or [R, G, B]; 0 when absent.
        absorption: Option<Coefficient>,
        /// Isotropic when absent.
        phase: Option<PhaseTable>,
    },
    /// Homogeneous from the ground up; sunlight is attenuated from the top along the slant.
    Haze {
        /// Height of the upper boundary [m].
        top: f64,
        /// Scattering coefficient [1/m], a number or [R, G, B].
        scattering: Coefficient,
        /// Absorption coefficient [1/m], a number or [R, G, B]; 0 when absent.
        absorption: Option<Coefficient>,
        /// Isotropic when absent.
        phase: Option<PhaseTable>,
    },
    /// Coefficients that fall as exp(-(y - base) / scale_height) over a flat earth.
    Height {
        /// Height at which the coefficients are those given [m]; 0 when absent.
        base: Option<f64>,
        /// Height over which they fall by a factor e [m].
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        scale_height: f64,
        /// Where rays that meet nothing end [m].
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        far: f64,
        /// Scattering coefficient [1/m], a number or [R, G, B].
        scattering: Coefficient,
        /// Absorption coefficient [1/m], a number or [R, G, B]; 0 when absent.
        absorption: Option<Coefficient>,
        /// Isotropic when absent.
        phase: Option<PhaseTable>,
    },
    /// Fog below a wavy boundary, homogeneous: y = top + the sum over the waves of amplitude sin(2 pi (x cos d + z sin d) / wavelength +
    /// phase), d the wave's direction.
    Layer {
        /// Mean height of the boundary [m].
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
        top: f64,
        /// The waves of the boundary; flat when absent.
        #[serde(default)]
        waves: Vec<WaveTable>,
        /// Height at which it ends [m]; when absent it goes down without end.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
        bottom: Option<f64>,
        /// Where rays that meet nothing end [m]; 100 000 when absent.
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        far: Option<f64>,
        /// Scattering coefficient [1/m], a number or [R, G, B].
        scattering: Coefficient,
        /// Absorption coefficient [1/m], a number or [R, G, B]; 0 when absent.
        absorption: Option<Coefficient>,
        /// Isotropic when absent.
        phase: Option<PhaseTable>,
    },
    /// Smoke inside an ellipsoid.
    Ellipsoid {
        /// Its centre [m].
        #[schemars(inner(range(min = -1e9, max = 1e9)))]
        center: [f64; 3],
        /// Its half axes along X, Y and Z, before it is turned [m].
        #[schemars(inner(range(min = 1e-6, max = 1e9)))]
        radii: [f64; 3],
        /// How it is turned about its centre: by angles about the scene's X, then its Y, then its Z axis, each by the right-hand rule
        /// [degrees]; not at all when absent.
        #[schemars(inner(range(min = -3600.0, max = 3600.0)))]
        rotation: Option<[f64; 3]>,
        /// "sharp": homogeneous; "soft": its density falls as 1 - r^2 from the centre, where the coefficients are those given, to 0 at the
        /// rim. Sharp when absent.
        edge: Option<EdgeName>,
        /// Scattering coefficient [1/m], a number or [R, G, B].
        scattering: Coefficient,
        /// Absorption coefficient [1/m], a number or [R, G, B]; 0 when absent.
        absorption: Option<Coefficient>,
        /// Isotropic when absent.
        phase: Option<PhaseTable>,
    },
    /// The clear air between the eye and what it sees: molecules and aerosol, both thinning with height. Sun and sky hold its
    /// light already: rays that meet nothing gain none by it, and lose what geometry shadows.
    Air {
        /// Turbidity [1]; the sky's when absent.
        #[schemars(range(min = 1.0, max = 20.0))]
        turbidity: Option<f64>,
        /// Height in the scene of the site to which sun, sky and coefficients belong [m]; the ground's when absent.
        #[schemars(extend("x-unit" = "m"))]
        base: Option<f64>,
        /// Where rays that meet nothing end [m]; 100 000 when absent.
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        far: Option<f64>,
        /// Height over which the molecules fall by a factor e [m]; 8 434 when absent.
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        scale_height: Option<f64>,
        /// Height over which the aerosol falls by a factor e [m]; 1 200 when absent.
        #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
        aerosol_scale_height: Option<f64>,
        /// Share of the aerosol's extinction that is scattering; 0.925 when absent.
        #[schemars(range(min = 0.0, max = 1.0))]
        aerosol_albedo: Option<f64>,
        /// The aerosol's; Henyey-Greenstein with g = 0.703 when absent. Molecules follow Rayleigh.
        phase: Option<PhaseTable>,
    },
}

/// One wave of the boundary of a layer.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(super) struct WaveTable {
    /// How far it rises above its mean [m].
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
    amplitude: f64,
    /// From crest to crest [m].
    #[schemars(range(min = 1e-3, max = 1e9), extend("x-unit" = "m"))]
    wavelength: f64,
    /// In which its phase grows, from +X toward +Z [degrees]; 0 when absent.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "degrees"))]
    direction: Option<f64>,
    /// At x = z = 0 [degrees]; 0 when absent.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "degrees"))]
    phase: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub(super) enum EdgeName {
    Sharp,
    Soft,
}

/// A coefficient [1/m], the same for all colours or one for each channel of the working space.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(untagged)]
pub(super) enum Coefficient {
    Gray(#[schemars(range(min = 0.0), extend("x-unit" = "1/m"))] f64),
    Rgb(#[schemars(inner(range(min = 0.0)))] [f64; 3]),
}

/// How scattered light spreads over directions.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum PhaseTable {
    /// The same in every direction.
    Isotropic {},
    /// Molecules.
    Rayleigh {},
    /// Henyey & Greenstein 1941.
    HenyeyGreenstein {
        /// Mean cosine; above 0 is forward.
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 1.0))]
        g: f64,
    },
    /// Cornette & Shanks 1992.
    CornetteShanks {
        /// Parameter; above 0 is forward.
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 1.0))]
        g: f64,
    },
    /// Nishita et al. 1987, hazy.
    NishitaHazy {},
    /// Nishita et al. 1987, murky.
    NishitaMurky {},
    /// Draine 2003.
    Draine {
        /// Parameter; above 0 is forward.
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 1.0))]
        g: f64,
        /// Weight of the squared cosine: 0 is Henyey-Greenstein, 1 Cornette-Shanks.
        #[schemars(range(min = 0.0, max = 1e6))]
        a: f64,
    },
    /// Water droplets, Jendersie & d'Eon 2023.
    Fog {
        /// Diameter of the droplets [micrometres].
        #[schemars(range(min = 0.01, max = 50.0), extend("x-unit" = "um"))]
        droplet_um: f64,
    },
}

impl Coefficient {
    fn rgb(self) -> DVec3 {
        match self {
            Coefficient::Gray(c) => DVec3::splat(c),
            Coefficient::Rgb(c) => DVec3::from_array(c),
        }
    }
}

impl WaveTable {
    fn read(&self) -> Wave {
        Wave::new(
            self.amplitude,
            self.wavelength,
            self.direction.unwrap_or(0.0) * DEG,
            self.phase.unwrap_or(0.0) * DEG,
        )
    }
}

impl PhaseTable {
    fn read(self) -> Phase {
        match self {
            PhaseTable::Isotropic {} => Phase::Isotropic,
            PhaseTable::Rayleigh {} => Phase::Rayleigh,
            PhaseTable::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g },
            PhaseTable::CornetteShanks { g } => Phase::CornetteShanks { g },
            PhaseTable::NishitaHazy {} => Phase::NishitaHazy,
            PhaseTable::NishitaMurky {} => Phase::NishitaMurky,
            PhaseTable::Draine { g, a } => Phase::Draine { g, a },
            PhaseTable::Fog { droplet_um } => Phase::Fog {
                droplet: 1e-6 * droplet_um,
            },
        }
    }
}

/// What a `[[medium]]` is.
pub(super) enum Filling {
    Medium(Medium),
    Air(ClearAir),
}

impl MediumTable {
    /// The medium, or the clear air; `wrong` makes errors of its keys.
    pub(super) fn read(self, wrong: Wrong) -> Result<Filling> {
        let (shape, scattering, absorption, phase) = match self {
            MediumTable::Air {
                turbidity,
                base,
                far,
                scale_height,
                aerosol_scale_height,
                aerosol_albedo,
                phase,
            } => {
                let default = ClearAir::default();
                return Ok(Filling::Air(ClearAir {
                    turbidity,
                    base,
                    far: far.unwrap_or(default.far),
                    molecules_scale_height: scale_height.unwrap_or(default.molecules_scale_height),
                    aerosol_scale_height: aerosol_scale_height
                        .unwrap_or(default.aerosol_scale_height),
                    aerosol_albedo: aerosol_albedo.unwrap_or(default.aerosol_albedo),
                    aerosol_phase: phase.map_or(default.aerosol_phase, PhaseTable::read),
                }));
            }
            MediumTable::Box {
                min,
                max,
                scattering,
                absorption,
                phase,
            } => {
                let (min, max) = (DVec3::from_array(min), DVec3::from_array(max));
                if !min.cmplt(max).all() {
                    return Err(wrong(
                        "max",
                        format!("the box from {min} to {max} holds nothing"),
                        "let each number of max be greater than that of min",
                    ));
                }
                (Shape::Box { min, max }, scattering, absorption, phase)
            }
            MediumTable::Layer {
                top,
                waves,
                bottom,
                far,
                scattering,
                absorption,
                phase,
            } => {
                let waves: Vec<Wave> = waves.iter().map(WaveTable::read).collect();
                let rise: f64 = waves.iter().map(|wave| wave.amplitude.abs()).sum();
                if let Some(bottom) = bottom.filter(|bottom| *bottom >= top + rise) {
                    return Err(wrong(
                        "bottom",
                        format!(
                            "the layer from {bottom} m up to {} m holds nothing",
                            top + rise
                        ),
                        "let it lie below the highest crest, or leave it out",
                    ));
                }
                let far = far.unwrap_or(ClearAir::default().far);
                let shape = Shape::Layer {
                    top,
                    waves,
                    bottom,
                    far,
                };
                (shape, scattering, absorption, phase)
            }
            MediumTable::Ellipsoid {
                center,
                radii,
                rotation,
                edge,
                scattering,
                absorption,
                phase,
            } => {
                let [x, y, z] = rotation.unwrap_or_default().map(|angle| angle * DEG);
                let shape = Shape::Ellipsoid {
                    center: DVec3::from_array(center),
                    radii: DVec3::from_array(radii),
                    rotation: DQuat::from_rotation_z(z)
                        * DQuat::from_rotation_y(y)
                        * DQuat::from_rotation_x(x),
                    edge: match edge {
                        Some(EdgeName::Soft) => Edge::Soft,
                        Some(EdgeName::Sharp) | None => Edge::Sharp,
                    },
                };
                (shape, scattering, absorption, phase)
            }
            MediumTable::Haze {
                top,
                scattering,
                absorption,
                phase,
            } => (Shape::Haze { top }, scattering, absorption, phase),
            MediumTable::Height {
                base,
                scale_height,
                far,
                scattering,
                absorption,
                phase,
            } => (
                Shape::Height {
                    base: base.unwrap_or(0.0),
                    scale_height,
                    far,
                },
                scattering,
                absorption,
                phase,
            ),
        };
        Ok(Filling::Medium(Medium {
            shape,
            scattering: scattering.rgb(),
            absorption: absorption.map_or(DVec3::ZERO, Coefficient::rgb),
            phase: phase.map_or(Phase::Isotropic, PhaseTable::read),
        }))
    }
}
