//! Sky models by the names that people write.

use super::{Irradiance, Model};
use crate::error::{Error, Result};

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
}
