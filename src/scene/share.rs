//! A share of light as a scene file writes it.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

/// A share of light, the same for all colours or linear Rec. 709.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(untagged)]
pub(super) enum Share {
    Gray(#[schemars(range(min = 0.0, max = 1.0))] f64),
    Rgb(#[schemars(inner(range(min = 0.0, max = 1.0)))] [f64; 3]),
}

impl Share {
    /// By channel, linear Rec. 709.
    pub fn rgb(self) -> DVec3 {
        match self {
            Share::Gray(share) => DVec3::splat(share),
            Share::Rgb(shares) => DVec3::from_array(shares),
        }
    }
}
