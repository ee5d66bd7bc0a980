//! The sky models with their parameters, and the names that people write for them.

use crate::error::{Error, Result};

/// The turbidity that is taken when nothing is said: a clear day.
pub const DEFAULT_TURBIDITY: f64 = 3.0;

/// A sky model and its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// Perez, Seals & Michalsky 1993, all-weather.
    Perez {
        /// Turbidity [1] of the clear sky that is taken when no irradiance is given, and of the sky's colour; 1 to 10.
        turbidity: f64,
        /// What a weather station measures; absent: a clear sky.
        irradiance: Option<Irradiance>,
    },
    /// Preetham, Shirley & Smits 1999.
    Preetham {
        /// Turbidity [1], 2 to 10.
        turbidity: f64,
    },
    /// Hosek & Wilkie 2012.
    Hosek {
        /// Turbidity [1], 1 to 10.
        turbidity: f64,
        /// Albedo of the ground far around, 0 to 1.
        albedo: f64,
    },
    /// CIE S 011 general sky.
    Cie {
        /// 1 to 15, or 16 for the traditional overcast sky.
        kind: u8,
        /// Turbidity [1] of the sky's colour where there are no clouds; 1 to 10.
        turbidity: f64,
        /// What sets its level; absent: what is typical of the type.
        irradiance: Option<Irradiance>,
    },
    /// The same white luminance everywhere, whatever the sun: for tests and comparisons.
    Uniform {
        /// Luminance [cd/m2], finite and not negative.
        luminance: f64,
    },
}

/// Broadband solar irradiance, as weather files carry it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Irradiance {
    /// Direct normal [W/m2], not negative.
    pub direct_normal: f64,
    /// Diffuse horizontal [W/m2], not negative.
    pub diffuse_horizontal: f64,
}

impl Model {
    /// The model of a name: `perez`, `preetham`, `hosek`, `cie:1` to `cie:16`, `uniform:CD_PER_M2`.
    ///
    /// `turbidity` [1] and `albedo` (of the ground, 0 to 1) go to the models that take them, `irradiance` to `perez` and `cie`.
    ///
    /// # Errors
    /// [`Error::Input`] for another name, and for measured irradiance with a model that takes none.
    pub fn named(
        name: &str,
        turbidity: f64,
        irradiance: Option<Irradiance>,
        albedo: f64,
    ) -> Result<Self> {
        let model = match (name, name.split_once(':')) {
            ("perez", _) => Some(Model::Perez {
                turbidity,
                irradiance,
            }),
            ("preetham", _) => Some(Model::Preetham { turbidity }),
            ("hosek", _) => Some(Model::Hosek { turbidity, albedo }),
            (_, Some(("cie", kind))) => kind.parse().ok().map(|kind| Model::Cie {
                kind,
                turbidity,
                irradiance,
            }),
            (_, Some(("uniform", luminance))) => luminance
                .parse()
                .ok()
                .map(|luminance| Model::Uniform { luminance }),
            _ => None,
        };
        let model = model.ok_or_else(|| {
            Error::input(
                format!("sky `{name}`"),
                "there is no such sky",
                "write perez, preetham, hosek, cie:1 to cie:16, or uniform:CD_PER_M2",
            )
        })?;
        let takes_irradiance = matches!(model, Model::Perez { .. } | Model::Cie { .. });
        if irradiance.is_some() && !takes_irradiance {
            return Err(Error::input(
                format!("sky `{name}`"),
                "this sky takes no measured irradiance",
                "use perez or cie:N, or leave out direct_normal and diffuse_horizontal",
            ));
        }
        Ok(model)
    }

    /// The turbidity that goes with the model's clear sky [1].
    pub fn turbidity(&self) -> f64 {
        match self {
            Model::Perez { turbidity, .. }
            | Model::Preetham { turbidity }
            | Model::Hosek { turbidity, .. }
            | Model::Cie { turbidity, .. } => *turbidity,
            Model::Uniform { .. } => DEFAULT_TURBIDITY,
        }
    }

    /// The measured irradiance that the model was given, if any.
    pub fn irradiance(&self) -> Option<Irradiance> {
        match self {
            Model::Perez { irradiance, .. } | Model::Cie { irradiance, .. } => *irradiance,
            _ => None,
        }
    }

    /// The name on the command line.
    pub fn name(&self) -> String {
        match self {
            Model::Perez { .. } => "perez".into(),
            Model::Preetham { .. } => "preetham".into(),
            Model::Hosek { .. } => "hosek".into(),
            Model::Cie { kind, .. } => format!("cie:{kind}"),
            Model::Uniform { .. } => "uniform".into(),
        }
    }
}
