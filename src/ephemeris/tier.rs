//! What the position of the sun may cost.

use crate::error::{Error, Result};

/// What the position of the sun may cost: each tier is a published algorithm.
///
/// The errors are great-circle distances on the sky from 1900 to 2100, with the same universal time and delta-T.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tier {
    /// The day of the year alone (Spencer 1971): 1.2 degrees.
    Day,
    /// Meeus's low-accuracy sun (1998, chapter 25): 0.0105 degrees.
    Minute,
    /// Reda & Andreas 2004: 0.0003 degrees.
    #[default]
    Spa,
    /// VSOP87 (Bretagnon & Francou 1988), precession of Vondrak et al. 2011, nutation IAU 2000B: 0.2 arcseconds.
    Arcsecond,
}

impl Tier {
    /// All tiers, the cheapest first.
    pub const ALL: [Tier; 4] = [Tier::Day, Tier::Minute, Tier::Spa, Tier::Arcsecond];
}

impl std::str::FromStr for Tier {
    type Err = Error;
    fn from_str(text: &str) -> Result<Self> {
        Tier::ALL
            .into_iter()
            .find(|tier| tier.to_string() == text)
            .ok_or_else(|| {
                Error::input(
                    "tier",
                    format!("`{text}` is not known"),
                    "write day, minute, spa or arcsecond",
                )
            })
    }
}

impl std::fmt::Display for Tier {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Tier::Day => "day",
            Tier::Minute => "minute",
            Tier::Spa => "spa",
            Tier::Arcsecond => "arcsecond",
        })
    }
}
