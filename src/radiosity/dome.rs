//! The sky's patches, found by direction.

use crate::error::Result;
use crate::sky::Sky;
use crate::sky::patches::{Finder, Patch, Subdivision, dome, radiances};
use glam::DVec3;

/// The sky dome in patches whose number is found from a direction.
#[derive(Debug, Clone)]
pub struct Dome {
    finder: Finder,
    patches: Vec<Patch>,
}

impl Dome {
    /// The patches of a subdivision.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] for a Reinhart factor outside 1 to 16.
    pub fn new(subdivision: Subdivision) -> Result<Self> {
        Ok(Dome {
            finder: Finder::new(subdivision),
            patches: dome(subdivision)?,
        })
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are none: never.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The patches.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// The number of the patch of a direction above the horizon; of one below it, the patch on the horizon.
    pub fn patch_of(&self, toward: DVec3) -> u32 {
        self.finder.patch_of(&self.patches, toward)
    }

    /// Mean radiance of each patch [cd/m2, RGB].
    pub fn radiances(&self, sky: &Sky) -> Vec<DVec3> {
        radiances(sky, &self.patches)
    }
}
