// What casters, cut out as they may be, keep of a light from a place: exact. A pass that sees it sees the tree of casters, attributes,
// facets, materials and texels.

// a.x b.y - a.y b.x, as far as f32 tells it from zero.
fn turned(a: vec3f, b: vec3f) -> f32 {
    let one = a.x * b.y;
    let other = a.y * b.x;
    let found = one - other;
    return select(found, 0.0, abs(found) <= 4e-7 * (abs(one) + abs(other)));
}

// Whether a caster stands on the way of length `far` from `start`, relative to the anchor, along axes.z. `blur` is how far
// `start` may be off; what it lies in by so little is no obstacle, and what the light lies in neither.
fn caster_meets(triangle: u32, start: vec3f, axes: RayAxes, blur: f32, far: f32) -> bool {
    let facet = facets[triangle];
    let across = dot(facet.plane.xyz, axes.z);
    let over = facet.plane.w - dot(facet.plane.xyz, start);
    // In the plane, by as much as places are rounded, is no obstacle.
    if abs(over) <= blur || over * across <= 0.0 || abs(over) >= far * abs(across) - blur {
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

// Steps through trees that all walks of an invocation have taken.
var<private> shaded_steps: u32;

// Whether anything but the caster `own` stands between a place, relative to the eye, and the light.
fn is_shaded(p: vec3f, own: u32) -> bool {
    if beam.kind == LOCAL {
        let way = beam.position - p;
        let far = length(way);
        return way_is_shaded(p, own, way / max(far, 1e-30), far, 0u, 0xffffffffu);
    }
    return way_is_shaded(p, own, beam.toward, FARTHEST, 0u, 0xffffffffu);
}

// The same for a way of its own, on which one material, its number and 1, is no obstacle; true too where so many steps have been
// taken before it is known.
fn way_is_shaded(p: vec3f, own: u32, toward: vec3f, far: f32, ignored: u32, most_steps: u32) -> bool {
    let start = p + tile.eye;
    let axes = axes_along(toward);
    let blur = 4e-7 * (length(p) + length(tile.eye));
    let tiny = select(vec3f(-1e-18), vec3f(1e-18), toward >= vec3f(0.0));
    let per_metre = 1.0 / select(toward, tiny, abs(toward) < vec3f(1e-18));
    let end = tree_texel(0u).x;
    var i = 1u;
    while i < end {
        // The next caster whose box is met, first: some drivers go through the rest for all pixels alike.
        var triangle = NO_CASTER;
        while i < end && triangle == NO_CASTER && shaded_steps < most_steps {
            shaded_steps += 1u;
            let low = tree_texel(2u * i);
            let high = tree_texel(2u * i + 1u);
            let a = (bitcast<vec3f>(low.xyz) - start) * per_metre;
            let b = (bitcast<vec3f>(high.xyz) - start) * per_metre;
            let first = min(a, b);
            let last = max(a, b);
            let enter = max(max(first.x, first.y), max(first.z, 0.0));
            let leave = min(min(last.x, last.y), min(last.z, far));
            let met = enter <= leave * 1.000001;
            triangle = select(NO_CASTER, high.w - 1u, met && high.w != 0u);
            i = select(low.w, i + 1u, met);
        }
        if shaded_steps >= most_steps {
            return true;
        }
        if triangle == NO_CASTER || triangle == own || facets[triangle].material + 1u == ignored {
            continue;
        }
        if caster_meets(triangle, start, axes, blur, far) {
            return true;
        }
    }
    return false;
}

// The middle of the k-th of a chord's parts of the same light, -1 to 1.
fn disc_place(disc: Disc, k: u32, shift: f32) -> f32 {
    let wanted = (f32(k) + shift) / 32.0;
    var u = 2.0 * wanted - 1.0;
    for (var i = 0u; i < 3u && disc.limb.y != 0.0; i++) {
        u += (wanted - disc_before(disc, u)) / (0.57207 * max(sqrt(sqrt(max(1.0 - u * u, 0.0))), 0.3));
    }
    return u;
}

// Those of a chord's bits at which a triangle with holes is solid.
fn disc_solid(disc: Disc, triangle: u32, outline: Outline, bits: u32, chord: vec2f, turn: vec2f, shift: f32) -> u32 {
    let material = materials[facets[triangle].material];
    let x = attributes[3u * triangle];
    let y = attributes[3u * triangle + 1u];
    let z = attributes[3u * triangle + 2u];
    var solid = 0u;
    for (var rest = bits; rest != 0u; rest &= rest - 1u) {
        let k = firstTrailingBit(rest);
        let place = chord.x * turn + chord.y * disc_place(disc, k, shift) * vec2f(-turn.y, turn.x);
        let d = vec3f(place, 1.0);
        let weights = max(vec3f(dot(outline.a, d), dot(outline.b, d), dot(outline.c, d)), vec3f(0.0));
        let w = weights / max(weights.x + weights.y + weights.z, 1e-30);
        var alpha = 255.0;
        if material.size.x > 0u {
            let uv = w.x * uv_of(x) + w.y * uv_of(y) + w.z * uv_of(z);
            alpha = f32(texels[texel_index(material, uv)] >> 24u);
        }
        alpha *= w.x * alpha_of(x) + w.y * alpha_of(y) + w.z * alpha_of(z);
        solid |= select(0u, 1u << k, alpha >= material.least_alpha);
    }
    return solid;
}

// The share of the disc's light that reaches a place, relative to the eye, of a surface, by channel, times the cosine of its
// normal; nothing comes from behind its facet.
fn disc_through(disc: Disc, p: vec3f, own: u32, facet: vec3f, normal: vec3f) -> vec3f {
    let start = p + tile.eye;
    let blur = 4e-7 * (length(p) + length(tile.eye));
    let face = disc_line(disc, facet);
    let level = disc_line(disc, normal);
    // Which chords lie most across the edges that are there.
    var across: array<f32, TURNS>;
    for (var k = 0u; k < TURNS; k++) {
        across[k] = 1.0;
    }
    var any = false;
    var walk = Walk(1u, tree_texel(0u).x, 0u);
    var triangle = disc_next(disc, &walk, start, own);
    while triangle != NO_CASTER {
        let outline = disc_outline(disc, triangle, start, blur);
        let meets = disc_meets(outline);
        if meets == MEETS_ALL && !has_holes(triangle) {
            return vec3f(0.0);
        }
        if meets != MEETS_NOTHING {
            any = true;
            for (var i = 0u; i < 3u; i++) {
                let line = select(select(outline.a, outline.b, i == 1u), outline.c, i == 2u);
                let size = length(line.xy);
                if abs(line.z) < size {
                    for (var k = 0u; k < TURNS; k++) {
                        let turn = disc_turn(k);
                        across[k] = min(across[k], abs(line.y * turn.x - line.x * turn.y) / size);
                    }
                }
            }
        }
        triangle = disc_next(disc, &walk, start, own);
    }
    let is_whole = face.z >= length(face.xy) && level.z >= length(level.xy);
    if !any && is_whole {
        return vec3f(level.z);
    }
    var best = 0u;
    for (var k = 1u; k < TURNS; k++) {
        best = select(best, k, across[k] > across[best]);
    }
    let turn = disc_turn(best);
    var dark: array<u32, CHORDS>;
    for (var j = 0u; j < CHORDS; j++) {
        dark[j] = 0u;
    }
    walk.at = 1u;
    triangle = select(NO_CASTER, disc_next(disc, &walk, start, own), any);
    while triangle != NO_CASTER {
        let outline = disc_outline(disc, triangle, start, blur);
        if disc_meets(outline) != MEETS_NOTHING {
            let holes = has_holes(triangle);
            for (var j = 0u; j < CHORDS; j++) {
                let angle = 3.14159265358979 * f32(j + 1u) / f32(CHORDS + 1u);
                let half = sin(angle);
                var run = vec2f(-half, half);
                run = disc_cut(run, outline.a, turn, cos(angle));
                run = disc_cut(run, outline.b, turn, cos(angle));
                run = disc_cut(run, outline.c, turn, cos(angle));
                if run.x < run.y {
                    var bits = disc_bits(disc, run / half, disc_shift(j));
                    if holes {
                        bits = disc_solid(disc, triangle, outline, bits, vec2f(cos(angle), half), turn, disc_shift(j));
                    }
                    dark[j] |= bits;
                }
            }
        }
        triangle = disc_next(disc, &walk, start, own);
    }
    var sum = vec3f(0.0);
    var whole = vec3f(0.0);
    for (var j = 0u; j < CHORDS; j++) {
        let angle = 3.14159265358979 * f32(j + 1u) / f32(CHORDS + 1u);
        let half = sin(angle);
        let weight = half * half * pow(vec3f(half), disc.limb);
        whole += weight;
        var run = vec2f(-half, half);
        run = disc_cut(run, face, turn, cos(angle));
        run = disc_cut(run, level, turn, cos(angle));
        if run.x < run.y {
            let lit = disc_bits(disc, run / half, disc_shift(j)) & ~dark[j];
            // Taken in the middle of the run, whatever of it is lit: discs are narrow.
            let middle = 0.5 * (run.x + run.y);
            let slope = level.y * turn.x - level.x * turn.y;
            let cosine = level.z + cos(angle) * dot(level.xy, turn) + middle * slope;
            sum += weight * (f32(countOneBits(lit)) / 32.0) * max(cosine, 0.0);
        }
    }
    return sum / whole;
}
