// Sunlight on surfaces, shadows filtered over four texels. Each texel is compared with the height of the receiver's own
// plane at the texel's centre, so that a plane never shades itself; the bias clears what stands on the plane within a texel.

fn lit_share(p: vec3f, facet: vec3f) -> f32 {
    let at = light_coordinates(p);
    if any(at.xy < beam.casters.xy) || any(at.xy > beam.casters.zw) {
        return 1.0;
    }
    let k = covering(at.xy, 1.0);
    if k == beam.partitions {
        return 1.0;
    }
    let map = beam.maps[k];
    let n = vec3f(dot(beam.across.xyz, facet), dot(beam.along.xyz, facet), dot(beam.height.xyz, facet));
    let slope = -n.xy / max(n.z, 1e-3);
    let bias = 2.0 * max(map.texel.x, map.texel.y) * (1.0 + length(slope)) + 4e-7 * (abs(beam.heights.x) + abs(beam.heights.y));
    let q = (at.xy - map.least) / map.texel - 0.5;
    let base = floor(q);
    let f = q - base;
    var share = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let offset = vec2f(f32(i & 1u), f32(i >> 1u));
        let texel = base + offset;
        let centre = map.least + (texel + 0.5) * map.texel;
        let plane = at.z + dot(slope, centre - at.xy);
        let weight = select(1.0 - f.x, f.x, offset.x > 0.0) * select(1.0 - f.y, f.y, offset.y > 0.0);
        share += select(0.0, weight, caster_height(k, vec2i(texel)) <= plane + bias);
    }
    return share;
}

@compute @workgroup_size(8, 8)
fn light_surfaces(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let surface = surfaces[i];
    let cosine = dot(surface.normal, beam.toward);
    if surface.number == NOTHING || cosine <= 0.0 || dot(surface.facet, beam.toward) <= 0.0 {
        return;
    }
    let p = ray_origin(id) + surface.distance * ray_direction(id);
    let share = lit_share(p, surface.facet);
    if share == 0.0 {
        return;
    }
    let depth = sun_optical_depth(p, beam.toward);
    sun[i] += vec4f(surface.albedo / 3.14159265358979 * beam.strength * cosine * share * exp(-depth), 0.0);
}
