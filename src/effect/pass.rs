//! What an effect does on a GPU, as plain data: the backend that knows graphics interfaces reads it, nobody else.
//!
//! A pass is one entry point of the effect's shader and the list of what that sees. Nothing here allocates or compiles: a
//! backend makes what the passes of the plan's running effects name, and nothing for an effect that does not run. An effect
//! without passes is done on the CPU by its `reference`, under every backend.

use super::{Field, Settings};
use crate::conditions::Conditions;

/// One piece of an effect's work on a GPU.
pub struct Pass {
    /// The shader's text (WGSL), to be read after all of `shaders/common`.
    pub shader: &'static str,
    /// Its entry point, by which reports name the pass. A raster pass has `<entry>_vertex` and `<entry>_fragment`.
    pub entry: &'static str,
    /// What one run of it covers.
    pub kind: Kind,
    /// What the shader sees in its bind group 1, in the order of the bindings.
    pub uses: &'static [Resource],
    /// What it leaves for the effect's later passes, its bind group 3, in the order of the bindings.
    pub scratch: &'static [Scratch],
}

/// A buffer that the passes of one effect share while they work on one tile and one point of the sun.
#[derive(Clone, Copy)]
pub struct Scratch {
    /// What it holds.
    pub name: &'static str,
    /// Its size [bytes] for an effect's knobs and a tile of so many pixels.
    pub bytes: fn(&Settings<'_>, u64) -> u64,
}

/// What one run of a pass covers.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// One invocation for each pixel of a tile.
    Pixels,
    /// Once for each point of the sun's disc, whose number is the effect's knob of that name. The shader sees that point and
    /// its shadow maps in its bind group 2. Such passes of all effects run in turns, point by point, when the first of them
    /// would: they read nothing that a pass of another kind writes after that.
    EachSun(&'static str, Over),
    /// One invocation for each pixel of a tile, once for each of these fields that the plan makes ([`Resource::Each`]).
    EachField(&'static [Field]),
    /// Draws all triangles as the camera sees them; their numbers, from 1, become the tile's [`Resource::Numbers`].
    Picture,
    /// Draws all triangles as the sun sees them into the z-partitions' depth maps, whenever a pass needs those.
    SunMaps,
}

/// What a pass for a point of the sun covers.
#[derive(Debug, Clone, Copy)]
pub enum Over {
    /// One invocation for each pixel of a tile, in workgroups of 8 by 8.
    Pixels,
    /// So many workgroups.
    Groups(fn(&Settings<'_>) -> [u32; 2]),
}

/// What a shader sees. A pass whose fields nobody writes does not run.
#[derive(Clone, Copy)]
pub enum Resource {
    /// A field, one value a pixel.
    Read(Field),
    /// A field that is written or added to.
    Update(Field),
    /// The field that is at hand in [`Kind::EachField`].
    Each,
    /// The number of the triangle in each pixel, 0 for none: a texture.
    Numbers,
    /// Corners of the triangles, relative to the eye.
    Corners,
    /// Normals, texture coordinates and colours at these corners.
    Attributes,
    /// Each triangle's material.
    MaterialOf,
    /// The materials.
    Materials,
    /// Texels of all textures.
    Texels,
    /// Numbers that the effect prepares once a frame.
    Table(fn(&Conditions, &Settings<'_>) -> Vec<f32>),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::ALL;

    #[test]
    fn passes_for_points_of_the_sun_read_nothing_that_others_write_after_the_first_of_them() {
        let passes = || ALL.iter().flat_map(|effect| effect.passes);
        let is_each_sun = |pass: &&Pass| matches!(pass.kind, Kind::EachSun(..));
        let mut written = Vec::new();
        for pass in passes().skip_while(|pass| !is_each_sun(pass)) {
            for resource in pass.uses {
                match resource {
                    Resource::Read(field) | Resource::Update(field) if is_each_sun(&pass) => {
                        assert!(!written.contains(field), "{}: {field:?}", pass.entry);
                    }
                    Resource::Update(field) => written.push(*field),
                    _ => {}
                }
            }
        }
        assert!(written.contains(&Field::Background));
    }
}
