// Light let through between the end of each ray and the eye.

@compute @workgroup_size(8, 8)
fn attenuate(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let surface = surfaces[pixel_index(id)];
    // Air that a surface lies behind attenuates its light beyond the end of rays that meet nothing, too.
    let end = select(surface.distance, ray_end(surface, origin, direction), surface.number == NOTHING);
    transmittance[pixel_index(id)] = vec4f(exp(-optical_depth(origin, direction, end, sources_of(surface))), 0.0);
}
