//! What Rust and the shaders share: constants, which stand here alone and are printed for the shaders, and structs, declared once
//! here and compared with the shaders' by a test.

use crate::effect::lamps_on_device;
use crate::effect::soft_edges::PENUMBRA_NUMBERS;
use crate::frame::NO_HIT;
use crate::medium::FARTHEST;
use encase::{ShaderType, internal::WriteInto};
use glam::{Mat3, UVec2, Vec2, Vec3, Vec4};

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident: u32 = $value:expr;)*) => {
        $($(#[$doc])* pub const $name: u32 = $value;)*

        /// The constants that count, as text of a shader.
        fn counts() -> String {
            [$((stringify!($name), $name)),*]
                .map(|(name, value)| format!("const {name} = {value}u;\n"))
                .concat()
        }
    };
}

constants! {
    /// Projections of [`TileView`].
    PERSPECTIVE: u32 = 0;
    ORTHOGRAPHIC: u32 = 1;
    PANORAMA: u32 = 2;
    /// How a texture goes on outside of itself, of [`Material`].
    REPEAT: u32 = 0;
    MIRROR: u32 = 1;
    CLAMP: u32 = 2;
    /// Shapes of [`Medium`].
    BOX: u32 = 0;
    HAZE: u32 = 1;
    HEIGHT: u32 = 2;
    /// Phase functions of [`Medium`]: Draine's holds Cornette and Shanks's and the mixture for fog.
    ISOTROPIC: u32 = 0;
    RAYLEIGH: u32 = 1;
    HENYEY_GREENSTEIN: u32 = 2;
    DRAINE: u32 = 3;
    NISHITA_HAZY: u32 = 4;
    NISHITA_MURKY: u32 = 5;
    /// Kinds of [`Beam`].
    PARALLEL: u32 = 0;
    LOCAL: u32 = 1;
    /// The most partitions that a beam has.
    PARTITIONS: u32 = 16;
    /// Added to the number of a caster that has holes.
    CUT_OUT: u32 = 0x8000_0000;
    /// Texels in a row of the tree of casters.
    TREE_WIDTH: u32 = 4096;
    /// So many penumbrae are told apart along a ray; and the numbers that a pixel has for the parts of its ray in penumbrae.
    MOST_RAMPS: u32 = 24;
    PENUMBRA_SIZE: u32 = PENUMBRA_NUMBERS;
    /// Places of the table of what a line across the disc leaves of its light.
    SHARES: u32 = 257;
    /// Texels of a lamp and of a spot, kinds of distributions, and what light comes from.
    LAMP_TEXELS: u32 = lamps_on_device::LAMP_TEXELS;
    SPOT_TEXELS: u32 = lamps_on_device::SPOT_TEXELS;
    LIGHT_EVEN: u32 = lamps_on_device::EVEN;
    LIGHT_SPOT: u32 = lamps_on_device::SPOT;
    LIGHT_DOTS: u32 = lamps_on_device::DOTS;
    LIGHT_ELLIPSE: u32 = lamps_on_device::ELLIPSE;
    LIGHT_CONE: u32 = lamps_on_device::CONE;
    LIGHT_TABLE: u32 = lamps_on_device::TABLE;
    FORM_POINT: u32 = lamps_on_device::POINT;
    FORM_LINE: u32 = lamps_on_device::LINE;
    FORM_RECTANGLE: u32 = lamps_on_device::RECTANGLE;
    FORM_SPHERE: u32 = lamps_on_device::SPHERE;
    /// Numbers of a [`Surface`] that is none, and of the ground; those of triangles follow.
    NOTHING: u32 = 0;
    GROUND: u32 = 1;
}

/// The constants, as text of a shader.
pub fn constants() -> String {
    let lengths = [("NO_HIT", f64::from(NO_HIT)), ("FARTHEST", FARTHEST)];
    let lengths = lengths.map(|(name, value)| format!("const {name} = {value:e};\n"));
    counts() + &lengths.concat()
}

/// `TileView` of shaders/common/tile.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
pub struct TileView {
    pub corner: UVec2,
    pub extent: UVec2,
    pub whole: Vec2,
    pub right: Vec3,
    pub projection: u32,
    pub up: Vec3,
    pub media: u32,
    pub forward: Vec3,
    pub grounded: u32,
    pub project: Vec4,
    pub ground: Vec4,
    pub depth: f32,
    pub origin: Vec3,
    pub origin_right: Vec3,
    pub origin_down: Vec3,
    pub eye: Vec3,
    pub working_from_rec709: Mat3,
}

/// `Attributes` of shaders/common/tile.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
pub struct Attributes {
    pub normal: [f32; 3],
    pub color: [f32; 4],
    pub uv: [f32; 2],
}

/// `Facet` of shaders/common/tile.wgsl.
#[derive(Debug, Clone, Copy, Default, PartialEq, ShaderType)]
pub struct Facet {
    pub plane: Vec4,
    pub material: u32,
}

/// `Material` of shaders/common/tile.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
pub struct Material {
    pub color: Vec3,
    pub least_alpha: f32,
    pub texel: u32,
    pub size: UVec2,
    pub wrap: UVec2,
}

/// `Surface` of shaders/common/tile.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
pub struct Surface {
    pub normal: Vec3,
    pub distance: f32,
    pub facet: Vec3,
    pub number: u32,
    pub albedo: Vec3,
}

/// Size of a [`Surface`].
pub const SURFACE_BYTES: u64 = <Surface as encase::ShaderSize>::SHADER_SIZE.get();

/// `Medium` of shaders/common/media.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
pub struct Medium {
    pub scattering: Vec3,
    pub shape: u32,
    pub extinction: Vec3,
    pub phase: u32,
    pub least: Vec3,
    pub g: f32,
    pub greatest: Vec3,
    pub start: f32,
    pub overhead: Vec3,
    pub scale_height: f32,
    pub far: f32,
    pub clear: u32,
    pub g_draine: f32,
    pub a: f32,
    pub weight: f32,
}

/// `PartitionMap` of shaders/common/beam.wgsl.
#[derive(Debug, Clone, Copy, Default, PartialEq, ShaderType)]
pub struct PartitionMap {
    pub least: Vec2,
    pub texel: Vec2,
    pub size: Vec2,
    pub heights: Vec2,
}

/// `Beam` of shaders/common/beam.wgsl.
#[derive(Debug, Clone, Copy, Default, PartialEq, ShaderType)]
pub struct Beam {
    pub toward: Vec3,
    pub partitions: u32,
    pub strength: Vec3,
    pub side: f32,
    pub across: Vec4,
    pub along: Vec4,
    pub height: Vec4,
    pub casters: Vec4,
    pub maps: [PartitionMap; PARTITIONS as usize],
    pub position: Vec3,
    pub kind: u32,
    pub extent: f32,
    pub near: f32,
    pub highest: f32,
}

/// The bytes of a uniform.
pub fn uniform<T: ShaderType + WriteInto>(value: &T) -> Vec<u8> {
    let mut buffer = encase::UniformBuffer::new(Vec::new());
    buffer
        .write(value)
        .expect("a vector takes as many bytes as it is given");
    buffer.into_inner()
}

/// The bytes of a list.
pub fn list<T: ShaderType + encase::ShaderSize + WriteInto>(values: &[T]) -> Vec<u8> {
    let mut buffer = encase::StorageBuffer::new(Vec::new());
    buffer
        .write(values)
        .expect("a vector takes as many bytes as it is given");
    buffer.into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga::{TypeInner, front::wgsl};

    /// Names, offsets and size of a struct of the shaders.
    fn reflected(source: &str, name: &str) -> (Vec<(String, u64)>, u64) {
        let module = wgsl::parse_str(source).expect("the common text is WGSL");
        let (_, found) = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some(name))
            .expect("the shaders have this struct");
        let TypeInner::Struct { members, span } = &found.inner else {
            panic!("{name} is a struct");
        };
        let members = members
            .iter()
            .map(|m| (m.name.clone().unwrap_or_default(), u64::from(m.offset)))
            .collect();
        (members, u64::from(*span))
    }

    macro_rules! same {
        ($source:expr, $name:ident { $($field:ident),* }) => {{
            let names = [$(stringify!($field)),*];
            let ours: Vec<(String, u64)> = names
                .iter()
                .enumerate()
                .map(|(i, n)| (n.to_string(), $name::METADATA.offset(i)))
                .collect();
            let size = <$name as encase::ShaderSize>::SHADER_SIZE.get();
            // The list above has every field, in order: a missing one does not compile.
            let $name { $($field: _),* } = $name::default();
            (ours, size) == reflected($source, stringify!($name))
        }};
    }

    #[test]
    fn structs_lie_alike_on_both_sides() {
        let common = super::super::source::common(false);
        let same_tile_view = |source: &str| {
            same!(
                source,
                TileView {
                    corner,
                    extent,
                    whole,
                    right,
                    projection,
                    up,
                    media,
                    forward,
                    grounded,
                    project,
                    ground,
                    depth,
                    origin,
                    origin_right,
                    origin_down,
                    eye,
                    working_from_rec709
                }
            )
        };
        assert!(same_tile_view(&common));
        assert!(same!(&common, Attributes { normal, color, uv }));
        assert!(same!(&common, Facet { plane, material }));
        assert!(same!(
            &common,
            Material {
                color,
                least_alpha,
                texel,
                size,
                wrap
            }
        ));
        assert!(same!(
            &common,
            Surface {
                normal,
                distance,
                facet,
                number,
                albedo
            }
        ));
        assert!(same!(
            &common,
            Medium {
                scattering,
                shape,
                extinction,
                phase,
                least,
                g,
                greatest,
                start,
                overhead,
                scale_height,
                far,
                clear,
                g_draine,
                a,
                weight
            }
        ));
        assert!(same!(
            &common,
            PartitionMap {
                least,
                texel,
                size,
                heights
            }
        ));
        assert!(same!(
            &common,
            Beam {
                toward,
                partitions,
                strength,
                side,
                across,
                along,
                height,
                casters,
                maps,
                position,
                kind,
                extent,
                near,
                highest
            }
        ));
        let moved = common.replace("depth: f32,\n", "depth: mat4x4f,\n");
        assert_ne!(moved, common);
        assert!(!same_tile_view(&moved));
    }
}
