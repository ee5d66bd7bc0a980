//! What the user says: geometry, materials, cameras, place, time, media.
//!
//! A scene is read from a glTF/GLB or OBJ file (+Y up, metres), or from a TOML file that names one and adds what it
//! lacks. Nothing here is physics yet: [`crate::conditions`] makes it so, and is the one place where domains are checked.

mod across;
mod assembly;
mod base_color;
mod builtin;
pub mod camera;
mod check;
pub mod curtain;
pub mod cut_out;
pub mod disc;
pub mod edges;
pub mod emission;
pub mod ends;
mod fan;
mod files;
mod filling;
pub mod framing;
pub mod geometry;
pub mod glass;
mod glazing;
mod gltf;
pub mod half_plane;
pub mod hints;
pub mod indoors;
pub mod lamp;
mod load;
mod mtl;
mod mtl_pictures;
mod named;
mod obj;
mod obj_model;
pub mod opacity;
pub mod pane;
pub mod panes;
mod parts;
pub mod penumbra;
pub mod placement;
mod polygon;
mod reflectance;
pub mod shade;
mod share;
pub(crate) mod texels;
mod text;
mod toml;
pub mod tree;
mod wide;
mod window_shade;

use crate::medium::{ClearAir, Medium};
use crate::warning::Warning;
use glam::{DAffine3, DVec2, DVec3, DVec4};
use std::collections::BTreeMap;

pub use builtin::{BUILTIN, builtin_files};
pub use camera::{Camera, Projection, Ray};
pub use emission::Emission;
pub use files::SceneFiles;
pub use geometry::{Geometry, Hit};
pub use lamp::{LampEntry, LampForm};
pub use load::{from_bytes, load, load_placed};
pub use pane::Pane;
pub use panes::Panes;
pub use parts::Part;
pub use placement::{Placement, Up};
pub use toml::schema;
pub use window_shade::WindowShade;

/// Everything that a user can say about a scene.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// The file's name, or the name of a built-in scene.
    pub name: String,
    /// All triangles, in scene axes and metres, f64.
    pub mesh: Mesh,
    /// Materials; [`Triangle::material`] counts in this list.
    pub materials: Vec<Material>,
    /// The objects that the triangles belong to, in their order; empty where nothing tells.
    pub parts: Vec<Part>,
    /// The material of faces for which the mesh's file has none.
    pub no_material: Option<u32>,
    /// Pictures that materials refer to.
    pub textures: Vec<Texture>,
    /// Materials that shine, by their index in [`Scene::materials`].
    pub emissions: BTreeMap<u32, Emission>,
    /// Cameras of the file, in its order.
    pub cameras: Vec<NamedCamera>,
    /// Punctual lights of the mesh's file, kept as they stand.
    pub lights: Vec<PunctualLight>,
    /// Lamps of the scene file.
    pub lamps: Vec<LampEntry>,
    /// Nodes of the mesh's file that have a name, once for each place where they are.
    pub nodes: Vec<NamedNode>,
    /// Azimuth that the scene's -Z axis faces [degrees]; 0: +X is east.
    pub north_deg: f64,
    /// The moment, as the user wrote it (RFC 3339, local without an offset, or `JD...`).
    pub time: Option<String>,
    /// The place.
    pub site: Option<SiteEntry>,
    /// The camera that the scene file itself sets.
    pub camera: Option<Camera>,
    /// A sun that stands in for place and time.
    pub sun: Option<SunEntry>,
    /// The sky that the scene file asks for.
    pub sky: SkyEntry,
    /// The endless plane below everything.
    pub ground: Ground,
    /// Blinds of groups of windows.
    pub shades: Vec<WindowShade>,
    /// The media, in the file's order.
    pub media: Vec<Medium>,
    /// The clear air between the eye and what it sees; absent: what lies there is seen through nothing but `media`.
    pub air: Option<ClearAir>,
    /// How the scene wants to be pictured when no flag says otherwise.
    pub picture: PictureEntry,
    /// What was left out or is doubtful.
    pub warnings: Vec<Warning>,
}

/// Triangles with shared vertices.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Vertex positions [m], scene axes.
    pub positions: Vec<DVec3>,
    /// Unit vertex normals, one a position; a zero vector where the file has none (the triangle's own is used).
    pub normals: Vec<DVec3>,
    /// Texture coordinates of the base colour, one a position (zero where the file has none), v down as in glTF.
    pub uvs: Vec<DVec2>,
    /// Linear Rec. 709 vertex colours and opacity, 0 to 1, one a position, or empty when no vertex has one.
    pub colors: Vec<DVec4>,
    /// The triangles.
    pub triangles: Vec<Triangle>,
}

/// Three vertices and a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into [`Mesh::positions`], counter-clockwise seen from the front.
    pub vertices: [u32; 3],
    /// Index into [`Scene::materials`].
    pub material: u32,
}

/// A Lambertian surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Base colour, linear Rec. 709, 0 to 1; multiplies the texture.
    pub base_color: DVec3,
    /// Opacity factor, 0 to 1; multiplies the texture's alpha.
    pub alpha: f64,
    /// Index into [`Scene::textures`].
    pub texture: Option<usize>,
    /// How alpha is used.
    pub alpha_mode: AlphaMode,
    /// What lets light straight through, if it is glass.
    pub pane: Option<Pane>,
}

/// How a material's alpha is used (glTF 2.0, 3.9.4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// There is a surface where alpha reaches the cutoff, and nothing elsewhere; shadows too are cut out.
    Mask {
        /// The least alpha that is a surface.
        cutoff: f64,
    },
    /// There is a part of a surface: see [`opacity`].
    Blend,
}

/// A base colour picture, read at its nearest texel.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Its name or address in the file.
    pub name: String,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// sRGB-encoded red, green, blue, and linear alpha, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
    /// What happens outside 0 to 1, across and down.
    pub wrap: [Wrap; 2],
}

/// What a texture shows outside 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// It repeats.
    Repeat,
    /// It repeats, every other time mirrored.
    Mirror,
    /// Its edge goes on.
    Clamp,
}

/// A camera with its name in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCamera {
    /// The node's or camera's name, or `camera N`.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// A node of a glTF and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedNode {
    /// Its name in the file.
    pub name: String,
    /// From its own axes to those of the scene.
    pub to_scene: DAffine3,
}

/// A light of KHR_lights_punctual, in scene axes.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// The node's or light's name.
    pub name: String,
    /// Linear Rec. 709 colour times intensity: lux (directional) or candela (point, spot).
    pub color: DVec3,
    /// Where it is [m].
    pub position: DVec3,
    /// Where it shines (the light's own -Z), unit length.
    pub direction: DVec3,
    /// Directional, point or spot.
    pub kind: PunctualKind,
}

/// The three kinds of KHR_lights_punctual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PunctualKind {
    /// Parallel light.
    Directional,
    /// The same in all directions.
    Point,
    /// A cone.
    Spot {
        /// Half angle of the full-strength cone [rad].
        inner: f64,
        /// Half angle at which it ends [rad].
        outer: f64,
    },
}

/// A place on the earth, as the user wrote it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SiteEntry {
    /// North positive [degrees].
    pub latitude_deg: f64,
    /// East positive [degrees].
    pub longitude_deg: f64,
    /// Above sea level [m].
    pub elevation: f64,
    /// IANA zone; looked up from the coordinates when absent.
    pub timezone: Option<String>,
}

/// A sun put where the user wants it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunEntry {
    /// From north through east [degrees]: where the light comes from.
    pub azimuth_deg: f64,
    /// Above the horizon [degrees]; no refraction is added.
    pub elevation_deg: f64,
    /// On a plane facing the sun, before the scene's own media [lx]; white. Absent: the real sun's there.
    pub illuminance: Option<f64>,
    /// Uniform disc [degrees]; 0 is a point sun; absent: the real one.
    pub diameter_deg: Option<f64>,
}

/// The sky that a scene asks for; what is absent takes the default or the flag.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SkyEntry {
    /// `perez`, `preetham`, `hosek` or `cie:N`.
    pub model: Option<String>,
    /// Turbidity [1].
    pub turbidity: Option<f64>,
    /// Direct-normal irradiance [W/m2].
    pub direct_normal: Option<f64>,
    /// Diffuse-horizontal irradiance [W/m2].
    pub diffuse_horizontal: Option<f64>,
}

/// An endless plane that rays meet which miss everything else below the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Whether there is one.
    pub enabled: bool,
    /// Its height [m]; absent: the scene's lowest point.
    pub height: Option<f64>,
    /// Reflectance, 0 to 1.
    pub albedo: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Ground {
            enabled: true,
            height: None,
            albedo: 0.2,
        }
    }
}

/// How the scene wants to be pictured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PictureEntry {
    /// Width and height [pixels].
    pub size: Option<[u32; 2]>,
    /// Samples a pixel.
    pub samples: Option<u32>,
    /// EV100; absent: automatic.
    pub exposure_ev100: Option<f64>,
}

impl Scene {
    /// Whether it has lamps that take part: those of the scene file, points and spots of the mesh's, surfaces that shine.
    pub fn has_lamps(&self) -> bool {
        let is_lamp = |light: &PunctualLight| light.kind != PunctualKind::Directional;
        let shines = || {
            let mut triangles = self.mesh.triangles.iter();
            triangles.any(|t| {
                // What lets light through shines with nothing.
                let is_glass = self.materials[t.material as usize].pane.is_some();
                !is_glass && self.emissions.contains_key(&t.material)
            })
        };
        let has_lamps = !self.lamps.is_empty() || self.lights.iter().any(is_lamp);
        has_lamps || !self.emissions.is_empty() && shines()
    }
}

impl Mesh {
    /// The corners of a triangle [m], by its number.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let vertices = self.triangles[triangle as usize].vertices;
        vertices.map(|v| self.positions[v as usize])
    }

    /// The least box around all vertices that a triangle uses [m]; `None` without triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut corners = self
            .triangles
            .iter()
            .flat_map(|t| t.vertices)
            .map(|v| self.positions[v as usize]);
        let first = corners.next()?;
        Some(corners.fold((first, first), |(min, max), p| (min.min(p), max.max(p))))
    }
}
