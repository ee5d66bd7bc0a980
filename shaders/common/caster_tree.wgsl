// Whether a triangle stands between a place and a light: exact, by the tree of casters' bounding volumes. A pass that sees it
// must run for each beam, with whose casters it goes.

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

// a.x b.y - a.y b.x, as far as f32 tells it from zero.
fn turned(a: vec3f, b: vec3f) -> f32 {
    let one = a.x * b.y;
    let other = a.y * b.x;
    let found = one - other;
    return select(found, 0.0, abs(found) <= 4e-7 * (abs(one) + abs(other)));
}

// Whether a caster stands on the way of length `far` from `start`, relative to the anchor, along axes.z. `blur` is how far
// `start` may be off; what it lies in by so little is no obstacle.
fn caster_meets(triangle: u32, start: vec3f, axes: RayAxes, blur: f32, far: f32) -> bool {
    let facet = facets[triangle];
    let across = dot(facet.plane.xyz, axes.z);
    let over = facet.plane.w - dot(facet.plane.xyz, start);
    // In the plane, by as much as places are rounded, is no obstacle.
    if abs(over) <= blur || over * across <= 0.0 || over / across >= far {
        return false;
    }
    let size = textureDimensions(caster_corners);
    let at = vec2u(3u * triangle % size.x, 3u * triangle / size.x);
    let c0 = textureLoad(caster_corners, at, 0).xyz;
    let c1 = textureLoad(caster_corners, at + vec2u(1u, 0u), 0).xyz;
    let c2 = textureLoad(caster_corners, at + vec2u(2u, 0u), 0).xyz;
    let turn = mat3x3f(axes.x, axes.y, axes.z);
    let a = (c0 - start) * turn;
    let b = (c1 - start) * turn;
    let c = (c2 - start) * turn;
    let u = turned(b, c);
    let v = turned(c, a);
    let w = turned(a, b);
    // Seen edge-on, as far as f32 tells.
    if u == 0.0 && v == 0.0 && w == 0.0 {
        return false;
    }
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return false;
    }
    let material = materials[facet.material];
    if material.least_alpha >= 0.0 {
        let x = attributes[3u * triangle];
        let y = attributes[3u * triangle + 1u];
        let z = attributes[3u * triangle + 2u];
        let sum = u + v + w;
        var alpha = 255.0;
        if material.size.x > 0u {
            let uv = (u * uv_of(x) + v * uv_of(y) + w * uv_of(z)) / sum;
            alpha = f32(texels[texel_index(material, uv)] >> 24u);
        }
        if alpha * (u * alpha_of(x) + v * alpha_of(y) + w * alpha_of(z)) / sum < material.least_alpha {
            return false;
        }
    }
    return true;
}

// Whether anything but the caster `own` stands between a place, relative to the eye, and the light.
fn is_shaded(p: vec3f, own: u32) -> bool {
    let start = p + tile.eye;
    var toward = beam.toward;
    var far = FARTHEST;
    if beam.kind == LOCAL {
        let way = beam.position - p;
        far = length(way);
        toward = way / max(far, 1e-30);
    }
    let axes = axes_along(toward);
    let blur = 4e-7 * (length(p) + length(tile.eye));
    let tiny = select(vec3f(-1e-18), vec3f(1e-18), toward >= vec3f(0.0));
    let per_metre = 1.0 / select(toward, tiny, abs(toward) < vec3f(1e-18));
    let end = tree_texel(0u).x;
    var i = 1u;
    while i < end {
        let low = tree_texel(2u * i);
        let high = tree_texel(2u * i + 1u);
        let a = (bitcast<vec3f>(low.xyz) - start) * per_metre;
        let b = (bitcast<vec3f>(high.xyz) - start) * per_metre;
        let first = min(a, b);
        let last = max(a, b);
        let enter = max(max(first.x, first.y), max(first.z, 0.0));
        let leave = min(min(last.x, last.y), min(last.z, far));
        let met = enter <= leave * 1.000001;
        if met && high.w != 0u && high.w - 1u != own && caster_meets(high.w - 1u, start, axes, blur, far) {
            return true;
        }
        i = select(low.w, i + 1u, met);
    }
    return false;
}
