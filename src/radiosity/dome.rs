//! The sky's patches, found by direction.

use crate::sky::Sky;
use crate::sky::patches::{Patch, Subdivision, dome, radiances, row_of};
use glam::DVec3;

/// The sky dome in patches whose number is found from a direction.
#[derive(Debug, Clone)]
pub struct Dome {
    factor: u32,
    patches: Vec<Patch>,
}

impl Dome {
    /// Tregenza's patches, each split `factor` times each way: 145, 577, 2 305 (4) and so on; another factor than 1 to 16 is the
    /// nearest of these.
    pub fn new(factor: u32) -> Self {
        let factor = factor.clamp(1, 16);
        Dome {
            factor,
            patches: dome(Subdivision::Reinhart(factor)).unwrap_or_default(),
        }
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

    /// The patch of a direction above the horizon; of one below it, the patch on the horizon.
    pub fn patch_of(&self, toward: DVec3) -> u32 {
        row_of(self.factor, toward)
    }

    /// Mean radiance of each patch [cd/m2, RGB].
    pub fn radiances(&self, sky: &Sky) -> Vec<DVec3> {
        radiances(sky, &self.patches)
    }
}
