// What every shader sees: the tile, the eye, the rays and the air. Positions are relative to the eye, in metres: they are
// made from f64 on the CPU.

struct TileView {
    // First pixel of the tile, and its size.
    corner: vec2u,
    extent: vec2u,
    // Size of a whole tile, which `project` fills [pixels].
    whole: vec2f,
    // Axes of the camera, level ones of a panorama.
    right: vec3f,
    // PERSPECTIVE, ORTHOGRAPHIC or PANORAMA.
    projection: u32,
    up: vec3f,
    media: u32,
    forward: vec3f,
    // Whether there is a ground plane.
    grounded: u32,
    // clip.x = project.x X + project.y W, clip.y = project.z Y + project.w W, in the tile; in a panorama X is the longitude in
    // half turns, Y the latitude in quarter turns, W 1.
    project: vec4f,
    // Reflectance of the ground; height of the eye over it.
    ground: vec4f,
    // Perspective: distance of the near plane; orthographic: one over the greatest depth.
    depth: f32,
    // Ray origin of an orthographic view at the tile's corner, and its change from pixel to pixel.
    origin: vec3f,
    origin_right: vec3f,
    origin_down: vec3f,
    // The eye relative to the scene's anchor [m].
    eye: vec3f,
    // From linear Rec. 709 to the working space, column by column.
    working_from_rec709: mat3x3f,
}

// Of a vertex, without gaps.
struct Attributes {
    normal: array<f32, 3>,
    // Linear Rec. 709 and alpha.
    color: array<f32, 4>,
    uv: array<f32, 2>,
}

// A triangle's plane and material.
struct Facet {
    // Unit normal; and distance of the plane from the scene's anchor along it: made in f64, however far the corners are.
    plane: vec4f,
    material: u32,
}

struct Material {
    // Linear Rec. 709.
    color: vec3f,
    // A place is solid from this product of the texel's and the vertices' alpha on, in 0 to 255; below 0: no cut-out.
    least_alpha: f32,
    // First texel, size, and how it goes on outside (REPEAT, MIRROR, CLAMP); a size of 0: no texture.
    texel: u32,
    size: vec2u,
    wrap: vec2u,
}

// What a ray meets. Number 0 is nothing, 1 the ground, 2 and on a triangle.
struct Surface {
    normal: vec3f,
    distance: f32,
    facet: vec3f,
    number: u32,
    albedo: vec3f,
}

@group(0) @binding(0) var<uniform> tile: TileView;
// Unit direction of each pixel's ray.
@group(0) @binding(1) var<storage, read> rays: array<vec4f>;
@group(0) @binding(2) var<storage, read> media: array<Medium>;

fn inside_tile(id: vec3u) -> bool {
    return all(id.xy < tile.extent);
}

fn pixel_index(id: vec3u) -> u32 {
    return id.y * tile.extent.x + id.x;
}

fn ray_direction(id: vec3u) -> vec3f {
    return rays[pixel_index(id)].xyz;
}

fn ray_origin(id: vec3u) -> vec3f {
    if tile.projection != ORTHOGRAPHIC {
        return vec3f(0.0);
    }
    return tile.origin + f32(id.x) * tile.origin_right + f32(id.y) * tile.origin_down;
}

// A corner of the scene, which is stored relative to the anchor, relative to the eye.
fn eye_relative(corner: vec3f) -> vec3f {
    return corner - tile.eye;
}

fn uv_of(attributes: Attributes) -> vec2f {
    return vec2f(attributes.uv[0], attributes.uv[1]);
}

fn normal_of(attributes: Attributes) -> vec3f {
    return vec3f(attributes.normal[0], attributes.normal[1], attributes.normal[2]);
}

fn color_of(attributes: Attributes) -> vec3f {
    return vec3f(attributes.color[0], attributes.color[1], attributes.color[2]);
}

fn alpha_of(attributes: Attributes) -> f32 {
    return attributes.color[3];
}

fn wrapped(position: f32, size: u32, wrap: u32) -> u32 {
    let n = f32(size);
    var p = floor(position * n);
    if wrap == REPEAT {
        p -= n * floor(p / n);
    } else if wrap == MIRROR {
        p -= 2.0 * n * floor(p / (2.0 * n));
        p = select(2.0 * n - 1.0 - p, p, p < n);
    }
    return u32(clamp(p, 0.0, n - 1.0));
}

// The nearest texel of the finest level, as the reference reads it.
fn texel_index(material: Material, uv: vec2f) -> u32 {
    let x = wrapped(uv.x, material.size.x, material.wrap.x);
    let y = wrapped(uv.y, material.size.y, material.wrap.y);
    return material.texel + y * material.size.x + x;
}
