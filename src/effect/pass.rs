//! What an effect does on a GPU, as plain data: the backend that knows graphics interfaces reads it, nobody else.
//!
//! A pass is one entry point of the effect's shader and the list of what that sees. Nothing here allocates or compiles: a
//! backend makes what the passes of the plan's running effects name, and nothing for an effect that does not run. An effect
//! without passes is done on the CPU by its `reference`, under every backend.

use super::settings::Settings;
use crate::beam::Beam;
use crate::conditions::{Conditions, Input};
use crate::frame::Field;

/// One piece of an effect's work on a GPU.
pub struct Pass {
    /// The shader's text (WGSL). The backend puts before it all of `shaders/common` that every pass sees, and one declaration for
    /// each of the `uses` of the effect's passes that have this text.
    pub shader: &'static str,
    /// Its entry point, by which reports name the pass. A raster pass has `<entry>_vertex` and `<entry>_fragment`.
    pub entry: &'static str,
    /// What one run of it covers.
    pub over: Over,
    /// When it runs, and how often.
    pub when: When,
    /// What the shader sees in its bind group 1, in the order of the bindings, each under the name that
    /// [`Resource`] tells.
    pub uses: &'static [Resource],
}

/// What one run of a pass covers.
#[derive(Clone, Copy)]
pub enum Over {
    /// One invocation for each pixel of a tile, in workgroups of 8 by 8.
    Pixels,
    /// The same, once for each of these fields that the plan makes ([`Resource::Each`]).
    Fields(&'static [Field]),
    /// So many workgroups.
    Groups(fn(&Extent<'_>) -> [u32; 2]),
    /// All triangles, drawn.
    Raster(RasterView),
}

/// From where triangles are drawn.
#[derive(Clone, Copy)]
pub enum RasterView {
    /// From the camera: the numbers of triangles, from 1, become the tile's [`Resource::Numbers`]. The function says whether rays at
    /// silhouettes are traced on the CPU, since a rasteriser rounds corners.
    Camera(fn(&Settings<'_>) -> bool),
    /// From where a beam comes from: depths and numbers become the maps that `shaders/common/beam.wgsl` reads, whenever a pass
    /// that runs for each beam needs them. What is nearer to a local beam than its radius, or than a micrometre, is not in its
    /// maps. The first effect of a plan that draws them draws them for all.
    Beam(fn(&Settings<'_>) -> MapSettings),
    /// Into the five faces of a hemicube, of so many texels on a side: the numbers of triangles, from 1, become the effect's
    /// [`Resource::Faces`]. Where it stands and looks is up to the vertex shader, whose instance is the face: the one in front has
    /// the whole side, the four around it too, of which the half in front of the surface counts.
    Hemicube(fn(&Extent<'_>) -> u32),
}

/// How the shadow maps of beams are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapSettings {
    /// Parts of what is seen by its distance, one map each; more where it reaches far.
    pub partitions: usize,
    /// Share of logarithmic spacing in the split by distance, unless there are more parts; the rest is even.
    pub logarithmic: f64,
    /// The most texels on a side of a map.
    pub most: u32,
    /// Texels across a pixel's width in the middle of each partition, as far as `most` allows.
    pub density: f64,
}

/// When a pass runs, and how often.
#[derive(Clone, Copy)]
pub enum When {
    /// Once for each tile of the picture and each sample of its pixels.
    Tile,
    /// The same, but so many times, each for a part of the work ([`Resource::Part`] tells which). A pixel in whose field the pass leaves a
    /// fourth number other than 0 has more to do than a run may take: the effect's reference does it. An effect with such passes has one,
    /// and writes one field.
    Parts(fn(&Conditions, &Settings<'_>) -> u32),
    /// For each tile, once for each of these beams, which the shader sees with its shadow maps in its bind group 2. Such passes
    /// of all effects run in turns, beam by beam, so that maps are drawn once for all.
    EachBeam(fn(&Conditions, &Settings<'_>) -> Vec<Beam>),
    /// Once, before the first tile and only when a [`Product`] that it makes is not there or what that was made of has changed.
    Once,
    /// Like [`When::Once`], but together with the effect's other passes of the same loop, again and again until the loop's
    /// condition holds.
    Until(&'static Loop),
}

/// Passes that run in turns until a condition holds, which is read back from the device.
pub struct Loop {
    /// What is read back. Its bytes are given to `holds`.
    pub condition: &'static Product,
    /// Whether the passes are done, from the numbers that they left there.
    pub holds: fn(&[u32], &Settings<'_>) -> bool,
    /// Turns between two looks, at least 1: a look waits for the device.
    pub turns: u32,
    /// After so many turns the loop ends, whatever the condition says.
    pub most: fn(&Settings<'_>) -> u32,
}

/// A buffer that passes of one effect leave for later ones. How long it lives follows from what it reads: for a beam, for a tile,
/// or over tiles, frames and moments until any of its inputs, or a knob of its effect, has changed.
#[derive(Clone, Copy)]
pub struct Product {
    /// What it holds: its name in the shader too.
    pub name: &'static str,
    /// Its type in the shader, for example `array<vec4f>`.
    pub wgsl: &'static str,
    /// Its size [bytes].
    pub bytes: fn(&Extent<'_>) -> u64,
    /// What it is made of.
    pub reads: &'static [Input],
    /// Whether it begins its life as zeros; else as what stood there.
    pub zeroed: bool,
}

/// How long a product lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Life {
    /// Until the next beam.
    Beam,
    /// Until the next tile or sample.
    Tile,
    /// Until what it is made of changes.
    Kept,
}

impl Product {
    /// How long it lives.
    pub fn life(&self) -> Life {
        if self.reads.contains(&Input::Beam) {
            Life::Beam
        } else if self.reads.contains(&Input::Tile) {
            Life::Tile
        } else {
            Life::Kept
        }
    }
}

/// What decides how large something is.
pub struct Extent<'a> {
    /// The conditions.
    pub conditions: &'a Conditions,
    /// The effect's knobs.
    pub settings: Settings<'a>,
    /// Pixels of a tile.
    pub pixels: u64,
}

/// Passes go over a picture in tiles that are no longer on a side [pixels]: a quarter of a million rays are a few milliseconds on
/// hardware.
pub const TILE: u32 = 512;

/// A number that a shader knows by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// `f32`
    Float(f32),
    /// `u32`
    Count(u32),
}

impl Number {
    /// A knob that counts: rounded, as `u32`.
    pub fn count(value: f64) -> Self {
        Number::Count(value.round() as u32)
    }

    /// A knob that measures, as `f32`.
    pub fn float(value: f64) -> Self {
        Number::Float(value as f32)
    }
}

/// What a shader sees. A pass one of whose fields nobody writes does not run.
#[derive(Clone, Copy)]
pub enum Resource {
    /// A field, one value a pixel, under its own name: `array<vec4f>`; [`Field::Surface`] is `surfaces: array<Surface>`.
    Read(Field),
    /// The same, to be written or added to.
    Update(Field),
    /// The field that is at hand in [`Over::Fields`], to be written: `layer`.
    Each,
    /// A product that an earlier pass of the effect made, under its own name.
    Use(&'static Product),
    /// A product that this pass makes or goes on with, under its own name.
    Make(&'static Product),
    /// The number of the triangle in each pixel, 0 for none: `numbers: texture_2d<u32>`.
    Numbers,
    /// Those in each texel of a hemicube: `faces: texture_2d_array<u32>`.
    Faces,
    /// Corners of the triangles, relative to the scene's anchor (`eye_relative` makes them relative to the eye): `corners: array<f32>`.
    Corners,
    /// Normals, texture coordinates and colours at these corners: `attributes: array<Attributes>`.
    Attributes,
    /// Each triangle's plane and material: `facets: array<Facet>`.
    Facets,
    /// The materials: `materials: array<Material>`.
    Materials,
    /// Texels of all textures: `texels: array<u32>`.
    Texels,
    /// Whether anything stands between a surface and the pass's beam, exactly: `is_shaded(p, own)`, by the tree of all casters; and how
    /// much of a disc is seen past them: `disc_through(disc, p, own, facet, normal)`. The
    /// pass runs for each beam, and names attributes, facets, materials and texels too; without attributes and texels it has the
    /// tree and the disc's outlines alone. It does without the beam's shadow maps, which need not have been drawn: what asks them, `beam_reaches` for one, finds light everywhere.
    CasterTree,
    /// Corners of all casters, for passes that have the tree and no beam: what is shaded is up to `way_is_shaded`.
    CasterCorners,
    /// Lamps, as `shaders/common/lamps.wgsl` reads them: `lamps: texture_2d<f32>`. The pass has the knobs that
    /// [`super::lamps_on_device::knobs`] has.
    Lamps(fn(&Conditions, &Settings<'_>) -> Vec<[f32; 4]>),
    /// Which part of the work a run does, from 0: `part: u32`.
    Part,
    /// Where surfaces end as the sun's whole disc sees them, edges in a tree of their own: `ends: texture_2d<u32>`, as
    /// `shaders/soft_edges.wgsl` reads it.
    Ends,
    /// Numbers by name: `knobs: Knobs`, a struct with just these members.
    Knobs(fn(&Conditions, &Settings<'_>) -> Vec<(&'static str, Number)>),
    /// Numbers that the effect prepares: `table: array<f32>`.
    Table(fn(&Conditions, &Settings<'_>) -> Vec<f32>),
    /// The sky, if there is one: `sky(direction)` and what else `shaders/common/sky_table.wgsl` has.
    Sky,
}

impl Resource {
    /// The field that is read or updated.
    pub fn field(&self) -> Option<Field> {
        match self {
            Resource::Read(field) | Resource::Update(field) => Some(*field),
            _ => None,
        }
    }

    /// The product that is used or made.
    pub fn product(&self) -> Option<&'static Product> {
        match self {
            Resource::Use(product) | Resource::Make(product) => Some(product),
            _ => None,
        }
    }
}
