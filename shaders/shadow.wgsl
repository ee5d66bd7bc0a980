// Casters as the light sees them. The instance is the partition, or the face of the cube around a local beam. No depth bias: the air has no receiver.

struct Caster {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) @interpolate(flat) triangle: u32,
    @location(2) alpha: f32,
}

fn caster(stored: vec3f, part: u32) -> vec4f {
    let corner = eye_relative(stored);
    if beam.kind == LOCAL {
        let at = in_face(corner - beam.position, part);
        return vec4f(at.x, at.y, beam.near, at.z);
    }
    let at = light_coordinates(corner);
    let map = beam.maps[part];
    let share = (at.xy - map.least) / (map.texel * beam.side);
    let depth = (at.z - map.heights.x) / (map.heights.y - map.heights.x);
    return vec4f(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, depth, 1.0);
}

@vertex
fn map_vertex(@location(0) corner: vec3f, @builtin(vertex_index) vertex: u32,
              @builtin(instance_index) part: u32) -> Caster {
    return Caster(caster(corner, part), vec2f(0.0), vertex / 3u, 1.0);
}

@fragment
fn map_fragment(in: Caster) -> @location(0) u32 {
    return in.triangle + 1u;
}

@vertex
fn map_cut_vertex(@location(0) corner: vec3f, @builtin(vertex_index) vertex: u32,
                  @builtin(instance_index) part: u32) -> Caster {
    let own = attributes[vertex];
    return Caster(caster(corner, part), uv_of(own), vertex / 3u, alpha_of(own));
}

@fragment
fn map_cut_fragment(in: Caster) -> @location(0) u32 {
    let material = materials[facets[in.triangle].material];
    var alpha = 255.0;
    if material.size.x > 0u {
        alpha = f32(texels[texel_index(material, in.uv)] >> 24u);
    }
    if alpha * in.alpha < material.least_alpha {
        discard;
    }
    return (in.triangle + 1u) | CUT_OUT;
}
