//! What is asked of a scene beside what it says itself.

use crate::ephemeris::civil::Fold;
use crate::ephemeris::{Tier, TimeScale};
use crate::scene::Camera;

/// Width and height of a picture where nobody says [pixels].
pub const DEFAULT_SIZE: [u32; 2] = [960, 600];

/// What is asked of a scene beside what it says itself.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Width and height of the picture [pixels]; absent: the scene's, or [`DEFAULT_SIZE`].
    pub size: Option<[u32; 2]>,
    /// Rays through pixels that differ from a neighbour; absent: the scene's, or 1.
    pub samples: Option<u32>,
    /// The camera.
    pub camera: CameraChoice,
    /// The ephemeris.
    pub tier: Tier,
    /// The zone of local times: an IANA name or an offset; absent: the site's.
    pub timezone: Option<String>,
    /// Which reading of a time that a clock change skips or repeats.
    pub fold: Option<Fold>,
    /// The scale of a Julian date.
    pub time_scale: TimeScale,
    /// TT - UT1 [s]; absent: tabulated.
    pub delta_t: Option<f64>,
    /// Air pressure at the site [hPa]; absent: the standard atmosphere's.
    pub pressure_hpa: Option<f64>,
    /// Air temperature at the site [degrees Celsius]; absent: the standard atmosphere's.
    pub temperature_c: Option<f64>,
}

/// Which camera.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum CameraChoice {
    /// The scene file's own, else the mesh's first, else one that frames everything.
    #[default]
    Scene,
    /// One of the mesh's, by name.
    Named(String),
    /// One that stands inside with light in sight: see [`crate::scene::indoors`].
    Inside,
    /// This one.
    Given(Camera),
}
