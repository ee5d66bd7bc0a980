//! Scenes with a camera, for comparing backends: those of the studies at the size at which tests compare them.

use super::build;
use tyndall::conditions::Conditions;
pub use tyndall::studies::scenes::*;

/// The size of the pictures that are compared [pixels].
pub const SIZE: [u32; 2] = [96, 64];

/// The conditions of a view at that size.
pub fn at_size(view: &StudyView) -> Conditions {
    build::conditions(view.scene.clone(), view.camera, SIZE)
}
