// The sky behind everything.

@compute @workgroup_size(8, 8)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let direction = ray_direction(id);
    let i = pixel_index(id);
    if surfaces[i].number == NOTHING && direction.y >= 0.0 {
        background[i] += vec4f(sky(direction), 0.0);
    }
}
