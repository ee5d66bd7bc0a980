//! The text of a pass's shader: what all see, what its `uses` declare, and its own.

use super::shared;
use crate::conditions::Conditions;
use crate::effect::{Field, Number, Pass, Product, Resource, Settings};
use crate::sky;

/// What is read before every shader, whether it counts its reads or not.
const COMMON: &str = concat!(
    include_str!("../../../shaders/common/tile.wgsl"),
    include_str!("../../../shaders/common/beam.wgsl"),
    include_str!("../../../shaders/common/media.wgsl"),
    include_str!("../../../shaders/common/runs.wgsl"),
);

/// Shaders call these everywhere; where nothing is counted there is no buffer for it.
const NO_COUNTS: &str =
    "fn count_reads(n: u32) {}\nfn count_nodes(n: u32) {}\nfn report_counts() {}\n";

/// The sky's table: `sky_numbers` must be declared beside it.
pub(super) fn sky_table() -> String {
    sky::constants() + include_str!("../../../shaders/common/sky_table.wgsl")
}

/// What every shader begins with.
pub(super) fn common(counting: bool) -> String {
    let counts = match counting {
        true => include_str!("../../../shaders/common/counts.wgsl"),
        false => NO_COUNTS,
    };
    format!("{}{COMMON}{counts}", shared::constants())
}

/// How a shader may use a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Binding {
    Read,
    Write,
    Uniform,
    Texture,
    TextureArray,
}

impl Binding {
    pub fn of(resource: &Resource) -> Self {
        match resource {
            Resource::Update(_) | Resource::Each | Resource::Make(_) => Binding::Write,
            Resource::Numbers => Binding::Texture,
            Resource::Faces => Binding::TextureArray,
            Resource::Knobs(_) => Binding::Uniform,
            _ => Binding::Read,
        }
    }
}

/// The name of a resource in the shader, and its type there.
fn declared(resource: &Resource) -> (&'static str, &'static str) {
    let product = |product: &Product| (product.name, product.wgsl);
    match resource {
        Resource::Read(Field::Surface) | Resource::Update(Field::Surface) => {
            ("surfaces", "array<Surface>")
        }
        Resource::Read(field) | Resource::Update(field) => (field.name(), "array<vec4f>"),
        Resource::Each => ("layer", "array<vec4f>"),
        Resource::Use(used) | Resource::Make(used) => product(used),
        Resource::Numbers => ("numbers", "texture_2d<u32>"),
        Resource::Faces => ("faces", "texture_2d_array<u32>"),
        Resource::Corners => ("corners", "array<f32>"),
        Resource::Attributes => ("attributes", "array<Attributes>"),
        Resource::MaterialOf => ("material_of", "array<u32>"),
        Resource::Materials => ("materials", "array<Material>"),
        Resource::Texels => ("texels", "array<u32>"),
        Resource::Knobs(_) => ("knobs", "Knobs"),
        Resource::Table(_) => ("table", "array<f32>"),
        Resource::Sky => ("sky_numbers", "array<f32>"),
    }
}

/// The whole text of a pass's shader, as the device is given it.
pub fn shader_text(
    pass: &Pass,
    conditions: &Conditions,
    settings: &Settings<'_>,
    counting: bool,
) -> String {
    let mut text = common(counting);
    for (resource, binding) in pass.uses.iter().zip(0..) {
        let (name, kind) = declared(resource);
        let space = match Binding::of(resource) {
            Binding::Read => "<storage, read>",
            Binding::Write => "<storage, read_write>",
            Binding::Uniform => "<uniform>",
            Binding::Texture | Binding::TextureArray => "",
        };
        match resource {
            Resource::Knobs(knobs) => text += &knob_struct(&knobs(conditions, settings)),
            Resource::Sky => text += &sky_table(),
            _ => {}
        }
        text += &format!("@group(1) @binding({binding}) var{space} {name}: {kind};\n");
    }
    text + pass.shader
}

fn knob_struct(knobs: &[(&'static str, Number)]) -> String {
    let members = knobs.iter().map(|(name, number)| match number {
        Number::Float(_) => format!("    {name}: f32,\n"),
        Number::Count(_) => format!("    {name}: u32,\n"),
    });
    format!("struct Knobs {{\n{}}}\n", members.collect::<String>())
}

/// The bytes of the knobs' struct.
pub(super) fn knob_bytes(knobs: &[(&'static str, Number)]) -> Vec<u8> {
    knobs
        .iter()
        .flat_map(|(_, number)| match number {
            Number::Float(value) => value.to_le_bytes(),
            Number::Count(value) => value.to_le_bytes(),
        })
        .collect()
}
