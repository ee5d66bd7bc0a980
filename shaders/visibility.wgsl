// The first surface on each ray: triangles are drawn for their numbers, then the ray itself is cut with the triangle that
// was found, so that distance and normal have the ray's precision and not the rasteriser's.

fn projected(stored: vec3f) -> vec4f {
    let corner = eye_relative(stored);
    let x = dot(corner, tile.right);
    let y = dot(corner, tile.up);
    let z = dot(corner, tile.forward);
    if tile.projection == ORTHOGRAPHIC {
        return vec4f(tile.project.x * x + tile.project.y, tile.project.z * y + tile.project.w, 1.0 - z * tile.depth, 1.0);
    }
    // Depth is reversed: near over z keeps its digits at any distance.
    return vec4f(tile.project.x * x + tile.project.y * z, tile.project.z * y + tile.project.w * z, tile.depth, z);
}

struct Solid {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn picture_vertex(@location(0) corner: vec3f, @builtin(vertex_index) vertex: u32) -> Solid {
    return Solid(projected(corner), vertex / 3u);
}

@fragment
fn picture_fragment(in: Solid) -> @location(0) u32 {
    return in.triangle + 1u;
}

struct CutOut {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) @interpolate(flat) triangle: u32,
    @location(2) alpha: f32,
}

@vertex
fn picture_cut_vertex(@location(0) corner: vec3f, @builtin(vertex_index) vertex: u32) -> CutOut {
    let own = attributes[vertex];
    return CutOut(projected(corner), uv_of(own), vertex / 3u, alpha_of(own));
}

@fragment
fn picture_cut_fragment(in: CutOut) -> @location(0) u32 {
    let material = materials[facets[in.triangle].material];
    var alpha = 255.0;
    if material.size.x > 0u {
        alpha = f32(texels[texel_index(material, in.uv)] >> 24u);
    }
    if alpha * in.alpha < material.least_alpha {
        discard;
    }
    return in.triangle + 1u;
}

fn corner(index: u32) -> vec3f {
    return eye_relative(vec3f(corners[3u * index], corners[3u * index + 1u], corners[3u * index + 2u]));
}

fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    return pow((encoded + 0.055) / 1.055, 2.4);
}

fn met_triangle(triangle: u32, origin: vec3f, direction: vec3f) -> Surface {
    let first = 3u * triangle;
    let a = corner(first) - origin;
    let b = corner(first + 1u) - origin;
    let c = corner(first + 2u) - origin;
    let edge = cross(b - a, c - a);
    let facet = facets[triangle];
    let normal = facet.plane.xyz;
    let across = dot(normal, direction);
    let over = facet.plane.w - dot(normal, tile.eye) - dot(normal, origin);
    var surface: Surface;
    surface.number = triangle + GROUND + 1u;
    surface.facet = normal * select(1.0, -1.0, across > 0.0);
    let t = select(over / across, dot(a, direction), abs(across) < 1e-9);
    var p = t * direction - a;
    let e = b - a;
    let f = c - a;
    let square = dot(edge, edge);
    let inside = vec2f(dot(cross(p, f), edge), dot(cross(e, p), edge)) / square;
    let v = clamp(inside.x, 0.0, 1.0);
    let w = clamp(inside.y, 0.0, 1.0 - v);
    // The rasteriser may name a triangle that the ray passes by a hair; where its plane runs on as if along the ray, it is met at
    // its border.
    let border = dot(a + v * e + w * f, direction);
    let beside = max(abs(inside.x - v), abs(inside.y - w)) > 1e-5 && abs(t - border) > 1e-3 * abs(border);
    surface.distance = max(select(t, border, beside), 0.0);
    let u = 1.0 - v - w;
    let x = attributes[first];
    let y = attributes[first + 1u];
    let z = attributes[first + 2u];
    let shading = normal_of(x) * u + normal_of(y) * v + normal_of(z) * w;
    surface.normal = surface.facet;
    if dot(shading, shading) > 1e-12 {
        let side = dot(shading, edge) * dot(surface.facet, edge);
        surface.normal = normalize(shading) * select(1.0, -1.0, side < 0.0);
    }
    let material = materials[facet.material];
    var color = material.color * (color_of(x) * u + color_of(y) * v + color_of(z) * w);
    if material.size.x > 0u {
        let texel = texels[texel_index(material, uv_of(x) * u + uv_of(y) * v + uv_of(z) * w)];
        let encoded = vec3f(f32(texel & 255u), f32((texel >> 8u) & 255u), f32((texel >> 16u) & 255u)) / 255.0;
        color *= vec3f(srgb_decode(encoded.x), srgb_decode(encoded.y), srgb_decode(encoded.z));
    }
    surface.albedo = max(tile.working_from_rec709 * color, vec3f(0.0));
    return surface;
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let number = textureLoad(numbers, id.xy, 0).x;
    var surface: Surface;
    surface.distance = NO_HIT;
    if number > 0u {
        surface = met_triangle(number - 1u, origin, direction);
    } else {
        let height = tile.ground.w + origin.y;
        if tile.grounded != 0u && direction.y < 0.0 && height > 0.0 {
            surface.number = GROUND;
            surface.distance = min(height / -direction.y, NO_HIT);
            surface.normal = vec3f(0.0, 1.0, 0.0);
            surface.facet = surface.normal;
            surface.albedo = tile.ground.xyz;
        }
    }
    surfaces[pixel_index(id)] = surface;
}
