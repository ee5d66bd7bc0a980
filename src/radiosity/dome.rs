//! The sky's patches, found by direction.

use crate::sky::Sky;
use crate::sky::patches::{Finder, Patch, Subdivision, dome, luminances, radiances};
use glam::DVec3;

/// The sky dome in patches whose number is found from a direction.
#[derive(Debug, Clone)]
pub struct Dome {
    finder: Finder,
    patches: Vec<Patch>,
}

impl Dome {
    /// The patches of a subdivision; a Reinhart factor other than 1 to 16 is the nearest of these.
    pub fn new(subdivision: Subdivision) -> Self {
        let subdivision = match subdivision {
            Subdivision::Reinhart(factor) => Subdivision::Reinhart(factor.clamp(1, 16)),
            other => other,
        };
        Dome {
            finder: Finder::new(subdivision),
            patches: dome(subdivision).unwrap_or_default(),
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

    /// The number of the patch of a direction above the horizon; of one below it, the patch on the horizon.
    pub fn patch_of(&self, toward: DVec3) -> u32 {
        self.finder.patch_of(&self.patches, toward)
    }

    /// Mean luminance of each patch [cd/m2].
    pub fn luminances(&self, sky: &Sky) -> Vec<f64> {
        luminances(sky, &self.patches)
    }

    /// Mean radiance of each patch [cd/m2, RGB].
    pub fn radiances(&self, sky: &Sky) -> Vec<DVec3> {
        radiances(sky, &self.patches)
    }
}
