//! What computes pictures: a GPU, or the reference on the CPU. One interface for whoever renders: the command line, studies, a
//! time-lapse, a viewer.
//!
//! A backend lasts over plans. Opening a device and compiling happen once a process; what a plan needs and the one before it had
//! is used again, as far as what it was made of is the same ([`Made`] tells what was not). So many pictures are rendered by one
//! backend over conditions that share what they can ([`at`], [`seen_from`]).
//!
//! [`at`]: crate::conditions::Conditions::at
//! [`seen_from`]: crate::conditions::Conditions::seen_from
//!
//! | module | what |
//! |---|---|
//! | [`reference`] | every effect in f64 on all cores, by its own exact way: the yardstick |
//! | [`gpu`] | the effects' passes on a device |
//! | `interface`, `rendering`, `film` | both as one; what a rendering may take and what it gives; the picture as it grows |
//! | [`check`] | how far a picture is from the reference |
//! | [`convergence`] | how far the points that stand for the sun's disc are from the disc |
//! | [`predict`] | how long the reference will take for a picture, judged by some of its pixels |
//! | [`choose`] | the quality and the method that an error or a time asks for, measured |

pub mod check;
pub mod choose;
pub mod convergence;
mod film;
pub mod gpu;
mod interface;
pub mod predict;
pub mod reference;
mod rendering;

pub use crate::task::{Progress, Step};
pub use interface::{Backend, Wanted};
pub use rendering::{Limits, Made, PICTURE, Rendered, StartUp, StepTime, Traffic};
