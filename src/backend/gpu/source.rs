//! The text of a pass's shader: what all see, what its `uses` declare, and its own.

use super::shared;
use crate::conditions::Conditions;
use crate::effect::{Effect, Field, Number, Pass, Product, Resource, Settings};
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

/// Corners of all casters relative to the scene's anchor, row by row, where they come with a beam.
const CORNERS_OF_BEAM: &str = "@group(2) @binding(3) var caster_corners: texture_2d<f32>;\n";

/// What every shader begins with.
pub(super) fn common(counting: bool) -> String {
    text_before(counting) + CORNERS_OF_BEAM
}

fn text_before(counting: bool) -> String {
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
    FloatTexture,
}

impl Binding {
    fn of(resource: &Resource) -> Self {
        match resource {
            Resource::Update(_) | Resource::Each | Resource::Make(_) => Binding::Write,
            Resource::Numbers | Resource::CasterTree | Resource::Ends => Binding::Texture,
            Resource::Faces => Binding::TextureArray,
            Resource::CasterCorners | Resource::Lamps(_) => Binding::FloatTexture,
            Resource::Knobs(_) | Resource::Part => Binding::Uniform,
            _ => Binding::Read,
        }
    }
}

/// The passes of an effect that have one text with a pass.
fn of_same_text<'e>(effect: &'e Effect, pass: &'e Pass) -> impl Iterator<Item = &'e Pass> {
    effect
        .passes
        .iter()
        .filter(move |other| other.shader == pass.shader)
}

/// The numbers that a pass's shader knows by name: those of all passes of its text.
pub(super) fn knobs(
    effect: &Effect,
    pass: &Pass,
    conditions: &Conditions,
    settings: &Settings<'_>,
) -> Vec<(&'static str, Number)> {
    let others = of_same_text(effect, pass).flat_map(|p| p.uses);
    let mut all: Vec<(&'static str, Number)> = Vec::new();
    for resource in pass.uses.iter().chain(others) {
        let Resource::Knobs(own) = resource else {
            continue;
        };
        for (name, number) in own(conditions, settings) {
            if all.iter().all(|(known, _)| *known != name) {
                all.push((name, number));
            }
        }
    }
    all
}

/// All that the text of a pass's shader names, in the order of the bindings, and how: what the pass itself sees, which is so many,
/// and then what only other passes of the same text do. What any of them writes, all may: it is one text.
pub(super) fn bindings(effect: &Effect, pass: &Pass) -> (Vec<(Resource, Binding)>, usize) {
    let same =
        |other: &&Pass| std::ptr::eq(other.shader, pass.shader) || other.shader == pass.shader;
    let others = effect.passes.iter().filter(same).flat_map(|p| p.uses);
    let mut all: Vec<(Resource, Binding)> = Vec::new();
    for resource in pass.uses.iter().chain(others) {
        let (name, _) = declared(resource);
        let binding = Binding::of(resource);
        match all.iter_mut().find(|(known, _)| declared(known).0 == name) {
            Some((_, known)) if binding == Binding::Write => *known = binding,
            Some(_) => {}
            None => all.push((*resource, binding)),
        }
    }
    (all, pass.uses.len())
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
        Resource::Facets => ("facets", "array<Facet>"),
        Resource::Materials => ("materials", "array<Material>"),
        Resource::Texels => ("texels", "array<u32>"),
        Resource::CasterTree => ("caster_tree", "texture_2d<u32>"),
        Resource::Ends => ("ends", "texture_2d<u32>"),
        Resource::CasterCorners => ("caster_corners", "texture_2d<f32>"),
        Resource::Lamps(_) => ("lamps", "texture_2d<f32>"),
        Resource::Part => ("part", "u32"),
        Resource::Knobs(_) => ("knobs", "Knobs"),
        Resource::Table(_) => ("table", "array<f32>"),
        Resource::Sky => ("sky_numbers", "array<f32>"),
    }
}

/// The whole text of a pass's shader, as the device is given it.
pub fn shader_text(
    effect: &Effect,
    pass: &Pass,
    conditions: &Conditions,
    settings: &Settings<'_>,
    counting: bool,
) -> String {
    let (all, _) = bindings(effect, pass);
    let own_corners =
        |(resource, _): &(Resource, Binding)| matches!(resource, Resource::CasterCorners);
    let mut text = match all.iter().any(own_corners) {
        true => text_before(counting),
        false => common(counting),
    };
    for ((resource, access), binding) in all.iter().zip(0..) {
        let (name, kind) = declared(resource);
        let space = match access {
            Binding::Read => "<storage, read>",
            Binding::Write => "<storage, read_write>",
            Binding::Uniform => "<uniform>",
            Binding::Texture | Binding::TextureArray | Binding::FloatTexture => "",
        };
        match resource {
            Resource::Knobs(_) => {
                text += &knob_struct(&knobs(effect, pass, conditions, settings));
            }
            Resource::Sky => text += &sky_table(),
            Resource::Lamps(_) => text += include_str!("../../../shaders/common/lamps.wgsl"),
            Resource::CasterTree => {
                text += include_str!("../../../shaders/common/caster_tree.wgsl");
                text += include_str!("../../../shaders/common/disc.wgsl");
                if pass.uses.iter().any(|r| matches!(r, Resource::Texels)) {
                    text += include_str!("../../../shaders/common/shaded.wgsl");
                }
            }
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
