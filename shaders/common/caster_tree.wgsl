// The tree of casters' bounding volumes. A pass that sees it must run for each beam, with whose casters it goes.

// Two texels an entry: least corner and the entry at which to go on, greatest corner and one more than the caster's number, 0
// for a volume; relative to the scene's anchor. Entry 0 tells how many there are.
fn tree_texel(index: u32) -> vec4u {
    return textureLoad(caster_tree, vec2u(index % TREE_WIDTH, index / TREE_WIDTH), 0);
}

// Axes of which the third is a unit vector (Duff et al. 2017).
struct RayAxes {
    x: vec3f,
    y: vec3f,
    z: vec3f,
}

fn axes_along(z: vec3f) -> RayAxes {
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    return RayAxes(vec3f(1.0 + s * z.x * z.x * a, s * b, -s * z.x), vec3f(b, s + z.y * z.y * a, -z.y), z);
}
