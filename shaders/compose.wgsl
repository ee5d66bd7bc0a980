// Light of surfaces and background through the air to the eye.

@group(1) @binding(0) var<storage, read_write> layer: array<vec4f>;
@group(1) @binding(1) var<storage, read> transmittance: array<vec4f>;

@compute @workgroup_size(8, 8)
fn attenuate(@builtin(global_invocation_id) id: vec3u) {
    if inside_tile(id) {
        layer[pixel_index(id)] *= transmittance[pixel_index(id)];
    }
}
