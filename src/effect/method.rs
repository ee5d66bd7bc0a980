//! The ways of integrating sunlight in the air.

/// How a GPU integrates sunlight in the air. They differ only in that: inputs, outputs and tests are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Exact runs in rows around the sun's direction: [`crate::effect::shafts_rectified`].
    Rectified,
    /// Sparse rays of these rows, and what lies between them: [`crate::effect::shafts_epipolar`].
    Epipolar,
    /// Prefix sums of filtered rows: [`crate::effect::shafts_prefiltered`].
    Prefiltered,
    /// Even steps: [`crate::effect::shafts_march`].
    March,
    /// Virtual planes: [`crate::effect::shafts_planes`].
    Planes,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 5] = [
        Method::Rectified,
        Method::Epipolar,
        Method::Prefiltered,
        Method::March,
        Method::Planes,
    ];

    /// Its name in flags and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Method::Rectified => "rectified",
            Method::Epipolar => "epipolar",
            Method::Prefiltered => "prefiltered",
            Method::March => "march",
            Method::Planes => "planes",
        }
    }
}
