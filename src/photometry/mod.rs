//! Luminous intensity of lamps by direction: formulas, measured tables, and how a lamp hangs.
//!
//! A [`Distribution`] says how the light of a lamp spreads in the lamp's own frame, a [`Pose`] how that frame stands in the scene:
//! the axis is theta = 0, and phi turns from [`Pose::around`] about the axis by the right-hand rule.
//!
//! Sources: Nishita, Miyawaki & Nakamae 1987, equations 7 to 10 (the ends of their periods, and what lies outside the beam, as
//! [`Distribution`] says); IES LM-63; EULUMDAT (Stockmar 1990); CIE 121 for the three types of goniometers.

mod distribution;
mod eulumdat;
mod grid;
mod ies;
mod luminaire;
mod planes;
mod pose;
mod read;
mod table;
mod words;

pub use distribution::Distribution;
pub use luminaire::{Opening, Photometry, Standard, Tilt};
pub use planes::Symmetry;
pub use pose::Pose;
pub use read::{from_bytes, read};
pub use table::{Goniometer, Peak, Table};
