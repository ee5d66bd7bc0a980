//! How finely the air's light is found.

/// How finely the air's light is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Distance of eye rays on which J is found [pixels]; less in small pictures.
    pub columns: f64,
    /// Distance of places along them, and of those of the lattice, as a share of the distance from the eye.
    pub spacing: f64,
    /// A difference of J, as a share of it and times the part of the way from the eye on which it is, that is still found on
    /// finer places.
    pub difference: f64,
    /// The least distance of such finer places, as a share of the distance of all.
    pub finest: f64,
}
