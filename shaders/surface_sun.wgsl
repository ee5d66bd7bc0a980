// Sunlight on surfaces, with exact shadows.

@compute @workgroup_size(8, 8)
fn light_surfaces(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let surface = surfaces[i];
    if surface.number == NOTHING {
        return;
    }
    let p = ray_origin(id) + surface.distance * ray_direction(id);
    let own = surface.number - GROUND - 1u;
    if knobs.disc == 1u {
        // Whether any of the disc lies before both planes.
        let least = -sin(beam.extent);
        if dot(surface.normal, beam.toward) > least && dot(surface.facet, beam.toward) > least {
            let disc = disc_of(beam.toward, beam.extent, vec3f(knobs.limb_red, knobs.limb_green, knobs.limb_blue));
            let share = disc_through(disc, p, own, surface.facet, surface.normal);
            let depth = sun_optical_depth(p, beam.toward);
            sun[i] += vec4f(surface.albedo / 3.14159265358979 * beam.strength * share * exp(-depth), 0.0);
        }
        return;
    }
    let cosine = dot(surface.normal, beam.toward);
    if cosine <= 0.0 || dot(surface.facet, beam.toward) <= 0.0 || is_shaded(p, own) {
        return;
    }
    let depth = sun_optical_depth(p, beam.toward);
    sun[i] += vec4f(surface.albedo / 3.14159265358979 * beam.strength * cosine * exp(-depth), 0.0);
}
