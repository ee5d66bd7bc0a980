//! What a photometric file says of a luminaire.

use super::planes::Symmetry;
use super::table::Table;
use std::fmt;
use std::sync::Arc;

/// A luminaire: how its light spreads, and what its file says beside that.
#[derive(Debug, Clone, PartialEq)]
pub struct Photometry {
    /// The standard that the file keeps to.
    pub standard: Standard,
    /// What its maker says in words, line by line.
    pub description: Vec<String>,
    /// Luminous intensity [cd], of the chosen lamps.
    pub table: Arc<Table>,
    /// What the distribution does not change under.
    pub symmetry: Symmetry,
    /// How many horizontal and vertical angles were measured; the table has those that symmetry implies too.
    pub measured: [usize; 2],
    /// Sets of lamps that the file has, and which of them this is, from 1.
    pub lamp_sets: [usize; 2],
    /// Stated flux of the bare lamps [lm], with the ballast; none where the luminaire alone was measured (absolute photometry).
    pub lamp_lumens: Option<f64>,
    /// Stated flux of the whole luminaire [lm]. [`Table::flux`] is what the intensities sum to.
    pub luminaire_lumens: Option<f64>,
    /// Electric power [W].
    pub watts: Option<f64>,
    /// Where the light leaves it.
    pub opening: Opening,
    /// How its flux changes when it is tilted.
    pub tilt: Option<Tilt>,
}

/// Standards of photometric files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standard {
    /// IES LM-63 of 1986, 1991, 1995, 2002 or 2019.
    Lm63 {
        /// The edition.
        year: u16,
    },
    /// EULUMDAT, also known as LDT.
    Eulumdat,
}

impl fmt::Display for Standard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Standard::Lm63 { year } => write!(f, "IES LM-63-{year}"),
            Standard::Eulumdat => f.write_str("EULUMDAT"),
        }
    }
}

/// The luminous opening of a luminaire, as its file states it. Intensities are those far away from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Its shape: `point`, `rectangle`, `box`, `disc`, `ellipse`, `cylinder`, `sphere` or `other`.
    pub shape: &'static str,
    /// Width, length and height [m].
    pub size: [f64; 3],
}

/// How the flux of a luminaire depends on its tilt, by the position in which its lamp burns (TILT of LM-63).
#[derive(Debug, Clone, PartialEq)]
pub struct Tilt {
    /// How the lamp lies in the luminaire: 1 upright when aimed straight down; 2 level, and stays so when tilted; 3 level, and does not.
    pub lamp: usize,
    /// Tilts, ascending [degrees].
    pub angles: Vec<f64>,
    /// Factors on every intensity, one for each tilt [1].
    pub factors: Vec<f64>,
}

impl Tilt {
    /// The factor on every intensity of a luminaire tilted by an angle from aiming straight down [degrees]: linear between the file's,
    /// beyond them that of the nearest. Tables up to 90 degrees hold for lamps turned over as well.
    pub fn factor(&self, tilt_deg: f64) -> f64 {
        let last = self.angles.len() - 1;
        let folds = self.angles[last] <= 90.0 && tilt_deg > 90.0;
        let tilt = if folds { 180.0 - tilt_deg } else { tilt_deg };
        let tilt = tilt.clamp(self.angles[0], self.angles[last]);
        let at = self.angles.partition_point(|a| *a <= tilt);
        if at > last {
            return self.factors[last];
        }
        let (before, after) = (at - 1, at);
        let share = (tilt - self.angles[before]) / (self.angles[after] - self.angles[before]);
        self.factors[before] + share * (self.factors[after] - self.factors[before])
    }
}
