//! ephemeris
