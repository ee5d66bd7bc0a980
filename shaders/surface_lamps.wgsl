// Light of lamps on surfaces, with exact shadows: src/conditions/received.rs in 32 bits.

// Some drivers end all loops of a shader together after 65 535 turns of the slowest of eight pixels: with this many of a pixel's own
// none comes near. A pixel that needs more is the reference's.
const MOST_TURNS = 7500u;

// Gauss-Legendre nodes of two points lie so far from the middle, in halves of the whole.
const NODE = 0.57735026919;

// No part of a lamp is smaller than this, as a share of it each way.
const FINEST = 0.001953125;

struct Place {
    p: vec3f,
    facet: vec3f,
    normal: vec3f,
    own: u32,
    // Whether it is not under the ground.
    above: bool,
}

// The most that a place receives from a lamp [lx, luminance].
fn lamp_at_most(index: u32, place: Place) -> f32 {
    let first = 1u + LAMP_TEXELS * index;
    let position = lamp_texel(first).xyz;
    let axis = lamp_texel(first + 1u);
    let greatest = lamp_texel(first + 4u).w;
    let form = lamp_texel(first + 6u);
    let middle = position + 0.5 * (lamp_texel(first + 7u).xyz + lamp_texel(first + 8u).xyz);
    let way = middle - place.p;
    let distance = max(length(way), 1e-6);
    if u32(form.z) == FORM_POINT {
        let cosine = select(0.0, dot(place.normal, way) / distance, dot(place.facet, way) > 0.0);
        let aside = -dot(axis.xyz, way) < (lamp_texel(first + 9u).w - 1e-6) * distance;
        return select(greatest * max(cosine, 0.0) / (distance * distance), 0.0, aside);
    }
    let nearest = distance - form.w;
    if dot(place.facet, way) < -form.w * 1.0001 {
        return 0.0;
    }
    return select(FARTHEST, greatest / (nearest * nearest), nearest > 0.1 * form.w);
}

// The spot of a part of a lamp, which is laid out on the unit square, as seen from a place: Lamp::spot.
fn lamp_spot(lamp: Lamp, at: vec2f, size: f32, place: vec3f) -> Spot {
    var spot = Spot(lamp.position, vec3f(0.0), 0u, 1.0, 0.0);
    switch lamp.form {
        case FORM_LINE: {
            spot.position += at.x * lamp.edge;
            spot.share = size;
            spot.radius = 0.5 * size * lamp.size;
        }
        case FORM_RECTANGLE: {
            spot.position += at.x * lamp.edge + at.y * lamp.other;
            spot.side = lamp.side;
            spot.one_sided = 1u;
            spot.share = size * size;
            spot.radius = 0.5 * size * lamp.size;
        }
        case FORM_SPHERE: {
            let way = place - lamp.position;
            let distance = length(way);
            spot.share = size * size;
            spot.radius = lamp.size;
            if distance > lamp.size {
                let axes = axes_along(way / distance);
                let sine = lamp.size / distance;
                let least = sine * sine / (1.0 + sqrt(1.0 - sine * sine));
                let down = at.x * least;
                let across = sqrt(max(down * (2.0 - down), 0.0));
                let angle = 6.28318530717959 * at.y;
                let toward = (down - 1.0) * axes.z + across * (cos(angle) * axes.x + sin(angle) * axes.y);
                let along = -dot(way, toward);
                let foot = way + along * toward;
                let inside = max(lamp.size * lamp.size - dot(foot, foot), 0.0);
                let reach = along - sqrt(inside);
                spot.position = place + reach * toward;
                spot.share = reach * reach * 2.0 * least * spot.share / (lamp.size * lamp.size);
                spot.radius = 0.0;
            }
        }
        default: {}
    }
    return spot;
}

// What a place receives from one spot of a lamp [lx, RGB].
fn of_spot(lamp: Lamp, spot: Spot, place: Place) -> vec3f {
    let way = spot.position - place.p;
    let distance = length(way);
    let toward = way / max(distance, 1e-30);
    let cosine = select(0.0, dot(place.normal, toward), dot(place.facet, toward) > 0.0);
    if cosine <= 0.0 || place.above && is_under_ground(spot.position.y) {
        return vec3f(0.0);
    }
    let shape = spot_shape(lamp, spot, -way);
    let square = max(max(distance * distance, spot.radius * spot.radius), 1e-12);
    let light = cosine * shape / square * lamp.intensity;
    if all(light == vec3f(0.0)) {
        return vec3f(0.0);
    }
    if way_is_shaded(place.p, place.own, toward, distance, lamp.ignored, MOST_TURNS) {
        return vec3f(0.0);
    }
    shaded_steps += tile.media;
    return light * exp(-depth_along(place.p, toward, distance));
}

// What a place receives from one lamp [lx, RGB]. Of one with an extent, parts are halved each way until what their nodes differ by is
// below a share of the whole.
fn of_lamp(lamp: Lamp, place: Place) -> vec3f {
    let ways = select(select(2u, 1u, lamp.form == FORM_LINE), 0u, lamp.form == FORM_POINT);
    let nodes = 1u << ways;
    let across = select(1u, knobs.cells, ways > 0u);
    let count = across * select(1u, across, ways == 2u);
    var sum = vec3f(0.0);
    var seen = 0.0;
    var scale = 0.0;
    // A first look at the whole tells how bright it is.
    var looking = ways > 0u;
    var cell = 0u;
    // How often the cell has been halved, and which of its parts it is: a digit each time.
    var level = 0u;
    var path = 0u;
    while cell < count && shaded_steps < MOST_TURNS {
        var size = select(1.0 / f32(across), 1.0, looking);
        var low = select(size * vec2f(f32(cell % across), f32(cell / across)), vec2f(0.0), looking);
        for (var k = level; k > 0u; k--) {
            size *= 0.5;
            let digit = path >> (ways * (k - 1u));
            low += size * vec2f(f32(digit & 1u), f32((digit >> 1u) & (ways - 1u)));
        }
        shaded_steps += level + 2u;
        var all_nodes = vec3f(0.0);
        var most = 0.0;
        var least = FARTHEST;
        var strength = 0.0;
        for (var k = 0u; k < nodes; k++) {
            let side = vec2f(f32(k & 1u), f32(k >> 1u)) * 2.0 - 1.0;
            let at = low + 0.5 * size * (1.0 + NODE * side);
            let spot = lamp_spot(lamp, at, 0.5 * size, place.p);
            let value = of_spot(lamp, spot, place);
            let greatest = max(value.x, max(value.y, value.z));
            all_nodes += value;
            most = max(most, greatest);
            least = min(least, greatest);
            strength += greatest;
        }
        if looking {
            looking = false;
            scale = strength;
            continue;
        }
        scale = max(scale, strength);
        if nodes > 1u && most - least > knobs.share * scale && size >= FINEST {
            level += 1u;
            path <<= ways;
            continue;
        }
        sum += all_nodes;
        seen += strength;
        scale = max(scale, seen);
        // The next part: behind the last of four, that behind the one which they are.
        path += 1u;
        while level > 0u && (path & (nodes - 1u)) == 0u {
            path >>= ways;
            level -= 1u;
        }
        cell += select(0u, 1u, level == 0u);
        path = select(path, 0u, level == 0u);
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn receive(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let surface = surfaces[i];
    if surface.number == NOTHING || lights[i].w != 0.0 {
        return;
    }
    let p = ray_origin(id) + surface.distance * ray_direction(id);
    let rounding = 4e-7 * (length(p) + length(tile.eye));
    let above = !is_under_ground(p.y + rounding);
    let place = Place(p, surface.facet, surface.normal, surface.number - GROUND - 1u, above);
    let all_lamps = u32(lamp_texel(0u).x);
    let some = (all_lamps + knobs.parts - 1u) / knobs.parts;
    var index = min(part * some, all_lamps);
    let last = min(index + some, all_lamps);
    // What all the weakest may add, shared out evenly.
    let unseen = knobs.left_out / f32(all_lamps);
    var sum = vec3f(0.0);
    while shaded_steps < MOST_TURNS {
        while index < last && lamp_at_most(index, place) <= unseen * lamp_luminance(sum) {
            index += 1u;
            shaded_steps += 1u;
        }
        if index >= last {
            break;
        }
        sum += of_lamp(lamp_of(index), place);
        index += 1u;
    }
    let is_left = shaded_steps >= MOST_TURNS;
    lights[i] += vec4f(surface.albedo / 3.14159265358979 * sum, select(0.0, 1.0, is_left));
}
