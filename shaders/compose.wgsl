// Light of surfaces and background through the air to the eye.

@compute @workgroup_size(8, 8)
fn attenuate(@builtin(global_invocation_id) id: vec3u) {
    if inside_tile(id) {
        layer[pixel_index(id)] *= transmittance[pixel_index(id)];
    }
}
