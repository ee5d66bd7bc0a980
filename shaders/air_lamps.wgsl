// Light of lamps in the air: exact lit runs by the fan between lamp and ray (src/scene/fan.rs) in 32 bits, and on these quadrature in
// the angle that the lamp sees (src/medium/local.rs).

// Some drivers end all loops of a shader together after 65 535 turns of the slowest of eight pixels: with this many of a pixel's own
// none comes near. A pixel that needs more is the reference's.
const MOST_TURNS = 7500u;

// Dark runs that are held at once. Where there are more, the ray is done up to the first that has no place, and searched again from there.
const RUNS = 16u;

// An optical depth through which nothing is seen, and one by which it may grow in a part.
const OPAQUE = 100.0;
const STEEP = 4.0;

// A part is halved at most so often.
const HALVINGS = 40u;

var<private> turns: u32;
var<private> origin: vec3f;
var<private> direction: vec3f;

// A spot on whose light the ray may come: from where to where; how far along the ray its foot on it is, the way from there to it, and how
// far from the ray it is, at least its radius.
var<private> met: Spot;
var<private> met_lamp: u32;
var<private> met_span: vec2f;
var<private> met_foot: f32;
var<private> met_across: vec3f;
var<private> met_aside: f32;
// Where its light begins, ends or bends on the ray: its outer cone, its side, its inner cone; behind the eye where nowhere.
var<private> met_outer: vec3f;
var<private> met_inner: vec2f;

var<private> dark: array<vec2f, RUNS>;
var<private> dark_count: u32;
// From where and up to where the dark runs are known.
var<private> dark_begin: f32;
var<private> dark_known: f32;

// Where the ray crosses a cone around an apex, whose quadratic form in the lamp's axes is given; behind the eye where it does not.
fn cone_crossings(lamp: u32, apex: vec3f, foot: f32, weights: vec4f) -> vec2f {
    let first = 1u + LAMP_TEXELS * lamp;
    let toward = lamp_texel(first + 1u).xyz;
    let around = lamp_texel(first + 2u).xyz;
    let third = lamp_texel(first + 3u).xyz;
    // From the ray's point nearest to the apex: there the linear terms are small.
    let nearest = (origin - apex) + foot * direction;
    let base = vec3f(dot(around, nearest), dot(third, nearest), dot(toward, nearest));
    let along = vec3f(dot(around, direction), dot(third, direction), dot(toward, direction));
    let w = weights.xyz;
    let square = dot(w * along, along);
    let linear = dot(w * along, base);
    let constant = dot(w * base, base);
    // linear^2 - square constant, without taking nearly equal numbers from each other (Lagrange's identity).
    let across = cross(along, base);
    let under = -(w.x * w.y * across.z * across.z + w.y * w.z * across.x * across.x + w.z * w.x * across.y * across.y);
    let q = -(linear + select(sqrt(max(under, 0.0)), -sqrt(max(under, 0.0)), linear < 0.0));
    let one = foot + q / select(square, 1.0, square == 0.0);
    let other = foot + constant / select(q, 1.0, q == 0.0);
    let none = weights.w == 0.0 || under < 0.0;
    return vec2f(select(one, -1.0, none || square == 0.0), select(other, -1.0, none || q == 0.0));
}

// Whether the met spot shines toward a place of the ray, for all that its cone and its side say.
fn met_faces(t: f32) -> bool {
    let way = (origin - met.position) + t * direction;
    let first = 1u + LAMP_TEXELS * met_lamp;
    let axis = lamp_texel(first + 1u);
    let across = vec2f(dot(way, lamp_texel(first + 2u).xyz), dot(way, lamp_texel(first + 3u).xyz));
    let before = met.one_sided == 0u || dot(met.side, way) > 0.0;
    return before && atan2(length(across), dot(way, axis.xyz)) <= axis.w;
}

// Takes up a spot; the most that it adds [cd/m2, luminance], 0 where the ray misses what it shines on.
fn meet(index: u32, end: f32) -> f32 {
    let first = u32(lamp_texel(0u).z) + SPOT_TEXELS * index;
    let a = lamp_texel(first);
    let b = lamp_texel(first + 1u);
    let c = lamp_texel(first + 2u);
    met = Spot(a.xyz, b.xyz, u32(b.w), c.x, c.y);
    met_lamp = u32(a.w);
    let way = met.position - origin;
    met_foot = dot(way, direction);
    met_across = way - met_foot * direction;
    met_aside = max(max(length(met_across), met.radius), 1e-9 * (1.0 + abs(met_foot)));
    let record = 1u + LAMP_TEXELS * met_lamp;
    let outer = cone_crossings(met_lamp, met.position, met_foot, lamp_texel(record + 10u));
    met_inner = cone_crossings(met_lamp, met.position, met_foot, lamp_texel(record + 11u));
    let against = dot(met.side, direction);
    let side = dot(met.side, way) / select(against, 1.0, against == 0.0);
    met_outer = vec3f(outer, select(side, -1.0, met.one_sided == 0u || against == 0.0));
    // The parts between, in order; those that face it span what it shines on.
    let inner = clamp(met_outer, vec3f(0.0), vec3f(end));
    let least = min(inner.x, min(inner.y, inner.z));
    let most = max(inner.x, max(inner.y, inner.z));
    let middle = clamp(inner.x + inner.y + inner.z - least - most, least, most);
    let begins = vec4f(0.0, least, middle, most);
    let ends = vec4f(least, middle, most, end);
    met_span = vec2f(end, 0.0);
    for (var k = 0u; k < 4u; k++) {
        if ends[k] > begins[k] && met_faces(0.5 * (begins[k] + ends[k])) {
            met_span = vec2f(min(met_span.x, begins[k]), max(met_span.y, ends[k]));
        }
    }
    turns += 5u + tile.media;
    // The ground stops the light of a spot under it.
    if is_under_ground(met.position.y) {
        let crossing = -(tile.ground.w + origin.y) / direction.y;
        let first_above = !is_under_ground(origin.y + met_span.x * direction.y);
        let last_above = !is_under_ground(origin.y + met_span.y * direction.y);
        met_span.x = select(met_span.x, clamp(crossing, met_span.x, met_span.y), first_above);
        met_span.y = select(met_span.y, select(clamp(crossing, met_span.x, met_span.y), met_span.x, first_above), last_above);
    }
    if met_span.y <= met_span.x {
        return 0.0;
    }
    let y = met_span - met_foot;
    let angle = atan2(met_aside * (y.y - y.x), met_aside * met_aside + y.x * y.y);
    let greatest = lamp_texel(record + 4u).w;
    let before = depth_along(origin, direction, met_span.x);
    let through = exp(-min(before.x, min(before.y, before.z)));
    return min(2.0 * greatest * met.share * knobs.strongest * (angle / met_aside), 1e30) * through;
}

// Adds a dark run; of more than have a place those nearest are kept.
fn darken(one: f32, other_end: f32, together: f32) {
    var run = vec2f(max(min(one, other_end), dark_begin), min(max(one, other_end), met_span.y));
    if run.y <= run.x || run.x >= dark_known {
        return;
    }
    var kept = 0u;
    var farthest = 0u;
    for (var k = 0u; k < dark_count; k++) {
        let other = dark[k];
        let apart = other.y + together < run.x || other.x > run.y + together;
        run = select(vec2f(min(run.x, other.x), max(run.y, other.y)), run, apart);
        dark[kept] = select(run, other, apart);
        farthest = select(farthest, kept, apart && other.x >= dark[farthest].x);
        kept += u32(apart);
    }
    turns += dark_count;
    dark_count = kept;
    if kept < RUNS {
        dark[kept] = run;
        dark_count += 1u;
    } else if run.x >= dark[farthest].x {
        dark_known = run.x;
    } else {
        dark_known = dark[farthest].x;
        dark[farthest] = run;
    }
}

// Finds what the casters darken of the met span, from a place of it on. In the ray's frame, n across the plane of lamp and ray, m toward the lamp, r
// along the ray, a point of the plane at height y over z shades t = along + (z - along) height / (height - y), height and along those of
// the lamp.
fn find_dark(begin: f32, ignored: u32) {
    dark_begin = begin;
    dark_count = 0u;
    dark_known = met_span.y;
    let base = origin + tile.eye;
    let way = met.position - origin;
    let along = dot(way, direction);
    let aside = way - along * direction;
    let rounding = 4e-7 * (length(met.position) + length(base) + length(origin));
    // On the ray there is no plane: any, and a lamp as near to it as f32 tells.
    let passed = length(aside);
    let height = max(passed, rounding + 1e-6 * abs(along));
    var m = axes_along(direction).x;
    if passed > 0.0 {
        m = aside / passed;
        m = normalize(m - dot(m, direction) * direction);
    }
    let r = direction;
    let n = cross(m, r);
    let top = height * 0.999999;
    let spot = base + along * r + height * m;
    let ends = vec2f(begin, met_span.y) - along;
    let first = (height * r + ends.x * m) / length(vec2f(height, ends.x));
    let last = (height * r + ends.y * m) / length(vec2f(height, ends.y));
    let end = tree_texel(0u).x;
    var i = 1u;
    var is_dark = false;
    while i < end && turns < MOST_TURNS && !is_dark {
        // The next caster whose box the fan meets, first: some drivers go through the rest for all pixels alike.
        var triangle = NO_CASTER;
        while i < end && triangle == NO_CASTER && turns < MOST_TURNS {
            turns += 1u;
            let low = tree_texel(2u * i);
            let high = tree_texel(2u * i + 1u);
            let half = 0.5 * (bitcast<vec3f>(high.xyz) - bitcast<vec3f>(low.xyz));
            let c = bitcast<vec3f>(low.xyz) + half - base;
            let slack = 2e-6 * (length(c) + length(half) + length(way));
            let d = c + base - spot;
            let up = dot(m, c);
            let met_box = abs(dot(n, c)) <= dot(abs(n), half) + slack
                && abs(up - 0.5 * height) <= 0.5 * height + dot(abs(m), half) + slack
                && dot(first, d) >= -dot(abs(first), half) - slack
                && dot(last, d) <= dot(abs(last), half) + slack;
            triangle = select(NO_CASTER, high.w - 1u, met_box && high.w != 0u);
            i = select(low.w, i + 1u, met_box);
        }
        if triangle == NO_CASTER {
            continue;
        }
        let facet = facets[triangle];
        let over = facet.plane.w - dot(facet.plane.xyz, spot);
        // A triangle whose plane holds the lamp, as the lamp's own face does, is seen edge on.
        if facet.material + 1u == ignored || abs(over) <= rounding {
            continue;
        }
        let size = textureDimensions(caster_corners);
        let at = vec2u(3u * triangle % size.x, 3u * triangle / size.x);
        let p0 = textureLoad(caster_corners, at, 0).xyz - base;
        let p1 = textureLoad(caster_corners, at + vec2u(1u, 0u), 0).xyz - base;
        let p2 = textureLoad(caster_corners, at + vec2u(2u, 0u), 0).xyz - base;
        // Corners by n, m, r, in such an order that the first lies alone on its side of the plane.
        let x = vec3f(dot(n, p0), dot(n, p1), dot(n, p2));
        let below = x < vec3f(0.0);
        if all(below) || !any(below) {
            continue;
        }
        var a = p0;
        var b = p1;
        var c = p2;
        var s = x;
        if below.x == below.z {
            a = p1;
            b = p2;
            c = p0;
            s = x.yzx;
        } else if below.x == below.y {
            a = p2;
            b = p0;
            c = p1;
            s = x.zxy;
        }
        // Where two edges are cut, by height and place. Each from its lower end to its upper, so that both triangles of an edge find the
        // same.
        let ya = vec2f(dot(m, a), dot(r, a));
        let yb = vec2f(dot(m, b), dot(r, b));
        let yc = vec2f(dot(m, c), dot(r, c));
        let is_low = s.x < 0.0;
        let fb = select(s.y, s.x, is_low) / select(s.y - s.x, s.x - s.y, is_low);
        let fc = select(s.z, s.x, is_low) / select(s.z - s.x, s.x - s.z, is_low);
        let u = mix(select(yb, ya, is_low), select(ya, yb, is_low), fb);
        let v = mix(select(yc, ya, is_low), select(ya, yc, is_low), fc);
        if max(u.x, v.x) < 0.0 || min(u.x, v.x) > top {
            continue;
        }
        // The part of the cut between the ray and the lamp's height. The plane, made in f64, says where it is at a height, unless it is level.
        let slope = dot(facet.plane.xyz, r);
        let rise = dot(facet.plane.xyz, m);
        let offset = facet.plane.w - dot(facet.plane.xyz, base);
        let is_level = abs(slope) < 1e-3 * abs(rise);
        let low = select(v, u, u.x < v.x);
        let high = select(u, v, u.x < v.x);
        let heights = clamp(vec2f(low.x, high.x), vec2f(0.0), vec2f(top));
        let share = (heights - low.x) / max(high.x - low.x, 1e-30);
        let by_share = mix(vec2f(low.y), vec2f(high.y), clamp(share, vec2f(0.0), vec2f(1.0)));
        let by_plane = (offset - rise * heights) / select(slope, 1.0, is_level);
        let bounds = vec2f(min(low.y, high.y), max(low.y, high.y));
        let is_low_cut = low.x < 0.0 && !is_level;
        let is_high_cut = high.x > top && !is_level;
        let exact = clamp(by_plane, vec2f(bounds.x), vec2f(bounds.y));
        let places = vec2f(select(by_share.x, exact.x, is_low_cut), select(by_share.y, exact.y, is_high_cut));
        let shaded = along + (places - along) * (height / (height - heights));
        darken(shaded.x, shaded.y, rounding);
        is_dark = dark_count == 1u && dark[0].x <= begin && dark[0].y >= met_span.y;
    }
}

// The first place behind `t` where the ray enters or leaves a medium, or the light of the met spot bends.
fn next_border(t: f32, end: f32) -> f32 {
    var next = end;
    let after = t + 4e-7 * abs(t) + 1e-30;
    let radius = sqrt(max(met.radius * met.radius - met_aside * met_aside, 0.0));
    let bends = vec4f(met_foot, met_foot - radius, met_foot + radius, met_outer.z);
    let cones = vec4f(met_outer.xy, met_inner);
    let both = min(select(vec4f(end), bends, bends > vec4f(after)), select(vec4f(end), cones, cones > vec4f(after)));
    next = min(next, min(min(both.x, both.y), min(both.z, both.w)));
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        let span = span_within(medium, origin, direction);
        let is_there = medium.shape != HEIGHT && span.y > span.x;
        next = select(next, span.x, is_there && span.x > after && span.x < next);
        next = select(next, span.y, is_there && span.y > after && span.y < next);
    }
    turns += tile.media + 1u;
    return next;
}

// A part of the ray without borders.
struct Stretch {
    begin: f32,
    length: f32,
    // From the foot to its beginning.
    y: f32,
    // A place that says which media are there.
    middle: vec3f,
    // Depth of homogeneous media from the eye to its beginning, and what it grows by a metre.
    depth: vec3f,
    slope: vec3f,
}

// How far into a stretch one is when the lamp has turned by an angle, u the tangent of its half: no angle is too small for it.
fn turned_by(stretch: Stretch, u: f32) -> f32 {
    let square = met_aside * met_aside + stretch.y * stretch.y;
    let under = met_aside * (1.0 - u * u) - 2.0 * stretch.y * u;
    return select(stretch.length, clamp(2.0 * u * square / max(under, 1e-37), 0.0, stretch.length), under > 0.0);
}

// Optical depth from the eye.
fn eye_depth(stretch: Stretch, into: f32) -> vec3f {
    var depth = stretch.depth + stretch.slope * into;
    for (var i = 0u; i < tile.media; i++) {
        if media[i].shape == HEIGHT {
            depth += depth_of(media[i].extinction, base_length(media[i], origin, direction, 0.0, stretch.begin + into));
        }
    }
    turns += tile.media;
    return depth;
}

// What the air sends from a place of a stretch to the eye for each turn of u, for a lamp of 1 cd.
fn sent(lamp: Lamp, stretch: Stretch, u: f32) -> vec3f {
    let into = turned_by(stretch, u);
    let t = stretch.begin + into;
    let p = origin + t * direction;
    // From the foot, near which the difference of two places has no digits.
    let y = stretch.y + into;
    let way = met_across - y * direction;
    let distance = length(way);
    let toward = select(vec3f(0.0, 1.0, 0.0), way / max(distance, 1e-37), distance > 0.0);
    let shape = spot_shape(lamp, met, -way);
    let apart = direction - toward;
    let one_minus_mu = 0.5 * dot(apart, apart);
    var source = vec3f(0.0);
    var depth = stretch.depth + stretch.slope * into;
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        let scattering = medium.scattering * phase_value(medium, one_minus_mu);
        if medium.shape == HEIGHT {
            source += scattering * density(medium, p, vec3f(0.0), 0.0);
            depth += depth_of(medium.extinction, base_length(medium, origin, direction, 0.0, t));
            depth += depth_of(medium.extinction, base_length(medium, p, toward, 0.0, distance));
        } else {
            source += select(vec3f(0.0), scattering, inside(medium, stretch.middle));
            depth += depth_of(medium.extinction, length_within(medium, p, toward, distance));
        }
    }
    turns += tile.media + 1u;
    // dt for an angle over the square of the distance: 1 / aside, unless the lamp gets no brighter there.
    let near = max(distance, met_aside) / met_aside;
    let rate = (1.0 + (y / met_aside) * (y / met_aside)) / (near * near) / met_aside;
    return 2.0 / (1.0 + u * u) * rate * shape * source * exp(-depth);
}

// What a stretch sends to the eye for a lamp of 1 cd, `present` being what others do: Kronrod's seven points and Gauss' three among
// them, on parts that are halved until both agree.
fn stretch_sends(lamp: Lamp, begin: f32, end: f32, present: vec3f) -> vec3f {
    var stretch: Stretch;
    stretch.begin = begin;
    stretch.length = end - begin;
    // One that begins a rounding before the foot begins there.
    stretch.y = select(begin - met_foot, 0.0, begin < met_foot && end > met_foot);
    stretch.middle = origin + (begin + 0.5 * stretch.length) * direction;
    var is_there = false;
    for (var i = 0u; i < tile.media; i++) {
        let medium = media[i];
        let inside_it = medium.shape != HEIGHT && inside(medium, stretch.middle);
        let before = select(length_within(medium, origin, direction, begin), 0.0, medium.shape == HEIGHT);
        // What is left of a difference below its rounding is nothing: dense media would make much of it.
        stretch.depth += depth_of(medium.extinction, select(before, 0.0, before < 5e-7 * begin));
        stretch.slope += select(vec3f(0.0), medium.extinction, inside_it);
        is_there = is_there || (inside_it || medium.shape == HEIGHT) && any(medium.scattering > vec3f(0.0));
    }
    turns += tile.media;
    let y = vec2f(stretch.y, end - met_foot);
    let aside2 = met_aside * met_aside;
    let distances = sqrt(aside2 + y * y);
    let all_turned = met_aside * stretch.length / (distances.x * distances.y + aside2 + y.x * y.y);
    var sum = vec3f(0.0);
    var scale = 0.0;
    var done = 0.0;
    var step = min(all_turned, lamp.detail);
    var halvings = 0u;
    while is_there && done < all_turned && turns < MOST_TURNS {
        // Not less than f32 adds to what is done.
        step = max(step, 4e-7 * done);
        let is_last = done + 1.0001 * step >= all_turned;
        step = select(step, all_turned - done, is_last);
        let before = eye_depth(stretch, turned_by(stretch, done));
        let behind = eye_depth(stretch, turned_by(stretch, done + step));
        if min(before.x, min(before.y, before.z)) > OPAQUE {
            break;
        }
        let rise = min(behind, vec3f(OPAQUE)) - min(before, vec3f(OPAQUE));
        let may_halve = halvings < HALVINGS && step > 8e-7 * done;
        // Where only the first skin of a part is seen, both rules may agree that they saw nothing.
        if may_halve && max(rise.x, max(rise.y, rise.z)) > STEEP {
            step *= 0.5;
            halvings += 1u;
            continue;
        }
        var fine = vec3f(0.0);
        var coarse = vec3f(0.0);
        for (var k = 0u; k < 7u; k++) {
            let j = abs(i32(k) - 3);
            let node = select(select(select(0.960491268708, 0.774596669241, j == 2), 0.434243749347, j == 1), 0.0, j == 0);
            let by_seven = select(select(select(0.104656226026, 0.268488089868, j == 2), 0.401397414776, j == 1), 0.450916538658, j == 0);
            let by_three = select(select(0.0, 0.555555555556, j == 2), 0.888888888889, j == 0);
            let place = done + 0.5 * step * (1.0 + select(node, -node, k < 3u));
            let value = sent(lamp, stretch, place);
            fine += 0.5 * step * by_seven * value;
            coarse += 0.5 * step * by_three * value;
        }
        let off = abs(fine - coarse);
        scale = max(scale, max(fine.x, max(fine.y, fine.z)));
        let all_of_it = present + sum;
        let allowed = knobs.error * max(scale, max(all_of_it.x, max(all_of_it.y, all_of_it.z)));
        if may_halve && max(off.x, max(off.y, off.z)) > allowed {
            step *= 0.5;
            halvings += 1u;
            continue;
        }
        sum += fine;
        done = select(done + step, all_turned, is_last);
        step = min(2.0 * step, lamp.detail);
        halvings = 0u;
    }
    return sum;
}

// What the met spot adds, for a lamp of 1 cd.
fn met_adds(lamp: Lamp) -> vec3f {
    var sum = vec3f(0.0);
    var at = met_span.x;
    while at < met_span.y && turns < MOST_TURNS {
        find_dark(at, lamp.ignored);
        while at < dark_known && turns < MOST_TURNS {
            // Out of the dark, and on to where it begins again.
            var to = dark_known;
            for (var k = 0u; k < dark_count; k++) {
                let run = dark[k];
                let is_in = run.x <= at && at < run.y;
                to = select(to, min(to, run.x), run.x > at);
                at = select(at, run.y, is_in);
            }
            turns += dark_count + 1u;
            if at >= to {
                continue;
            }
            let end = next_border(at, to);
            sum += stretch_sends(lamp, at, end, sum);
            at = end;
        }
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    if inscatter_lights[i].w != 0.0 {
        return;
    }
    origin = ray_origin(id);
    direction = ray_direction(id);
    let end = min(surfaces[i].distance, air_end(origin, direction, ALL_MEDIA));
    if end <= 0.0 {
        return;
    }
    let all_spots = u32(lamp_texel(0u).y);
    let some = (all_spots + knobs.parts - 1u) / knobs.parts;
    var index = min(part * some, all_spots);
    let last = min(index + some, all_spots);
    // What all the weakest may add, shared out evenly.
    let unseen = knobs.left_out / f32(all_spots);
    var sum = vec3f(0.0);
    while turns < MOST_TURNS {
        var most = 0.0;
        while index < last && turns < MOST_TURNS {
            most = meet(index, end);
            if most > unseen * lamp_luminance(sum) {
                break;
            }
            index += 1u;
        }
        if index >= last {
            break;
        }
        let lamp = lamp_of(met_lamp);
        sum += lamp.intensity * met_adds(lamp);
        index += 1u;
    }
    inscatter_lights[i] += vec4f(sum, select(0.0, 1.0, turns >= MOST_TURNS));
}
