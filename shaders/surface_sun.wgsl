// Sunlight on surfaces, with exact shadows.

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
    if is_shaded(p, surface.number - GROUND - 1u) {
        return;
    }
    let depth = sun_optical_depth(p, beam.toward);
    sun[i] += vec4f(surface.albedo / 3.14159265358979 * beam.strength * cosine * exp(-depth), 0.0);
}
