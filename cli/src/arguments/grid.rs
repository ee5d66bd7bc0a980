//! The flags that say where sensors are.

use clap::Args;
use tyndall::Result;
use tyndall::conditions::Conditions;
use tyndall::daylight::grid::{GridSpec, Sensors};
use tyndall::output::scale::Scale;

/// Sensors on grids.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// Sensors on a grid over floors or on a surface: keys plane, spacing, inset (m), room, floor, surface, opening; may be repeated
    #[arg(long, value_name = "plane=M,spacing=M,...", value_parser = spec, conflicts_with = "points")]
    pub grid: Vec<GridSpec>,
}

impl GridArgs {
    /// The sensors in a scene.
    ///
    /// # Errors
    /// Those of [`Sensors::new`].
    pub fn sensors(&self, conditions: &Conditions) -> Result<Sensors> {
        Sensors::new(&conditions.scene, &conditions.geometry, &self.grid)
    }
}

fn spec(text: &str) -> Result<GridSpec, String> {
    GridSpec::parse(text).map_err(|e| format!("{}; {}", e.problem(), e.remedy()))
}

/// `LOW..HIGH` of a scale.
pub fn scale(text: &str) -> Result<Scale, String> {
    Scale::parse("", "", text).map_err(|e| format!("{}; {}", e.problem(), e.remedy()))
}
