// The soft edges that the sun's disc makes of a point's shadows in the air: see src/effect/soft_edges.rs.

// A part of the ray from which an edge is seen to cross the disc. They stand in `penumbrae`, behind their number: some drivers are
// slow at arrays of an invocation's own.
struct Ramp {
    run: vec2f,
    // The edge's number. MIXED is added where it may not hide all that lies on its side of it; TOGETHER stands for several.
    edge: u32,
    // Where the edge passes over the disc's middle; FARTHEST where it does not.
    middle: f32,
}

const MIXED = 0x80000000u;
const TOGETHER = 0xffffffffu;
// In some drivers all loops of a shader, as the slowest of some pixels goes through them, together end after 65 535 turns.
const MOST_TURNS = 30000u;
const NODES = 4u;

var<private> first_ramp: u32;
var<private> ramp_count: u32;
var<private> turns: u32;
// Of four chords of the disc each: places across, half their lengths [radii], and how their bits are shifted; each one's share of the
// light.
var<private> chords: array<array<vec4f, 3>, CHORDS / 4u>;
var<private> chord_light: array<vec3f, CHORDS>;
var<private> chords_known: bool;

fn end_texel(index: u32) -> vec4u {
    return textureLoad(ends, vec2u(index % TREE_WIDTH, index / TREE_WIDTH), 0);
}

// A straight edge: the point of it that is nearest to the scene's anchor, and from there on the way to both ends.
struct Edge {
    point: vec3f,
    direction: vec3f,
    reach: vec2f,
}

fn edge_of(number: u32) -> Edge {
    let first = end_texel(0u).y + 2u * (number & ~MIXED);
    let a = bitcast<vec4f>(end_texel(first));
    let b = bitcast<vec4f>(end_texel(first + 1u));
    return Edge(a.xyz, b.xyz, vec2f(a.w, b.w));
}

// The share of the disc's light beside a line so many radii from its middle, positive where the middle is hidden.
fn light_beyond(depth: f32) -> vec3f {
    let at = 0.5 * (clamp(depth, -1.0, 1.0) + 1.0) * f32(SHARES - 1u);
    let first = min(u32(at), SHARES - 2u);
    let table = end_texel(0u).z;
    let a = bitcast<vec4f>(end_texel(table + first)).xyz;
    let b = bitcast<vec4f>(end_texel(table + first + 1u)).xyz;
    return mix(a, b, at - f32(first));
}

// How deep the disc's middle lies behind an edge [radii], seen from a place relative to the anchor; and across the edge on the disc.
fn edge_line(disc: Disc, edge: Edge, start: vec3f) -> vec3f {
    return disc_line(disc, cross(edge.point - start, edge.direction));
}

fn depth_behind(disc: Disc, edge: Edge, start: vec3f) -> f32 {
    let line = edge_line(disc, edge, start);
    return line.z / max(length(line.xy), 1e-30);
}

fn ramp_run(k: u32) -> vec2f {
    return penumbrae[first_ramp + k].xy;
}

fn ramp_edge(k: u32) -> u32 {
    return bitcast<u32>(penumbrae[first_ramp + k].z);
}

// Adds a ramp in the order of where they begin; where there is no room, the two that lie closest together become one.
fn add_ramp(ramp: Ramp) {
    if ramp_count == MOST_RAMPS {
        var at = 0u;
        var least = FARTHEST;
        for (var k = 0u; k + 1u < MOST_RAMPS; k++) {
            let gap = ramp_run(k + 1u).x - ramp_run(k).y;
            at = select(at, k, gap < least);
            least = min(least, gap);
        }
        let run = vec2f(ramp_run(at).x, max(ramp_run(at).y, ramp_run(at + 1u).y));
        penumbrae[first_ramp + at] = vec4f(run, bitcast<f32>(TOGETHER), FARTHEST);
        for (var k = at + 1u; k + 1u < MOST_RAMPS; k++) {
            penumbrae[first_ramp + k] = penumbrae[first_ramp + k + 1u];
        }
        ramp_count -= 1u;
        turns += 2u * MOST_RAMPS;
    }
    var at = ramp_count;
    while at > 0u {
        let before = penumbrae[first_ramp + at - 1u];
        if before.x <= ramp.run.x {
            break;
        }
        penumbrae[first_ramp + at] = before;
        at -= 1u;
        turns += 1u;
    }
    penumbrae[first_ramp + at] = vec4f(ramp.run, bitcast<f32>(ramp.edge), ramp.middle);
    ramp_count += 1u;
}

// p / q, far away where q is nearly nothing.
fn far_ratio(p: f32, q: f32) -> f32 {
    let divisor = select(q, select(1e-30, -1e-30, q < 0.0), abs(q) < 1e-30);
    return clamp(p / divisor, -FARTHEST, FARTHEST);
}

// Where the line `line` + s `change` on the disc's plane touches the disc: a s^2 + 2 b s + c = 0, below 0 where it crosses it.
struct Touch {
    a: f32,
    c: f32,
    square: f32,
    // In order; far away where there are none.
    roots: vec2f,
}

fn touches(line: vec3f, change: vec3f) -> Touch {
    let a = change.z * change.z - dot(change.xy, change.xy);
    let b = line.z * change.z - dot(line.xy, change.xy);
    let c = line.z * line.z - dot(line.xy, line.xy);
    let square = b * b - a * c;
    // Without a difference of like numbers.
    let q = -(b + select(sqrt(max(square, 0.0)), -sqrt(max(square, 0.0)), b < 0.0));
    let one = far_ratio(q, a);
    let other = far_ratio(c, q);
    let roots = vec2f(min(one, other), max(one, other));
    return Touch(a, c, square, select(vec2f(FARTHEST), roots, square > 0.0));
}

// What lies between a ray and the disc: n across their plane, m toward the disc, r along the ray.
struct Wedge {
    n: vec3f,
    m: vec3f,
    r: vec3f,
    // A place sees the disc over y along m within aslant y along n, and between steep y and flat y along r; unless the ray runs
    // along the light: then all that matters lies in a cone.
    aslant: f32,
    steep: f32,
    flat: f32,
    along: bool,
    apex: vec3f,
    wide: f32,
}

fn wedge_of(disc: Disc, start: vec3f, direction: vec3f, air: vec2f) -> Wedge {
    let cosine = dot(disc.z, direction);
    let aside = disc.z - cosine * direction;
    let sine = length(aside);
    var wedge: Wedge;
    wedge.r = direction;
    wedge.along = sine < 4.0 * disc.tangent;
    if wedge.along {
        wedge.apex = start + select(air.y, air.x, cosine > 0.0) * direction;
        wedge.wide = max(disc.tangent, sine / abs(cosine));
        return wedge;
    }
    wedge.m = aside / sine;
    wedge.n = cross(wedge.m, direction);
    wedge.aslant = disc.tangent / (sine - disc.tangent * abs(cosine));
    wedge.steep = (cosine + sine * disc.tangent) / (sine - cosine * disc.tangent);
    wedge.flat = (cosine - sine * disc.tangent) / (sine + cosine * disc.tangent);
    return wedge;
}

// Whether edges in a box can be seen on the disc from somewhere on the ray.
fn wedge_meets(wedge: Wedge, disc: Disc, start: vec3f, air: vec2f, least: vec3f, most: vec3f) -> bool {
    let half = 0.5 * (most - least);
    if wedge.along {
        let c = least + half - wedge.apex;
        let slack = 2e-6 * (length(c) + length(half));
        let far = dot(disc.z, c) + dot(abs(disc.z), half) + slack;
        // In the cone's own axes a box is at most as wide as its diagonal.
        let aside = length(c - dot(disc.z, c) * disc.z);
        return far >= 0.0 && aside <= far * wedge.wide + length(half) + slack;
    }
    let c = least + half - start;
    let slack = 2e-6 * (length(c) + length(half));
    let high = dot(wedge.m, c) + dot(abs(wedge.m), half) + slack;
    if high < 0.0 || abs(dot(wedge.n, c)) - dot(abs(wedge.n), half) - slack > wedge.aslant * high {
        return false;
    }
    let low = max(dot(wedge.m, c) - dot(abs(wedge.m), half) - slack, 0.0);
    let z = dot(wedge.r, c);
    let deep = dot(abs(wedge.r), half) + slack * (1.0 + max(abs(wedge.steep), abs(wedge.flat)));
    let first = z - deep - max(low * wedge.steep, high * wedge.steep);
    let last = z + deep - min(low * wedge.flat, high * wedge.flat);
    return first < air.y && last > air.x;
}

// The part of the ray from which something of an edge may be seen on the disc.
fn edge_reach(wedge: Wedge, a: vec3f, b: vec3f, air: vec2f) -> vec2f {
    if wedge.along {
        return air;
    }
    let p = vec3f(dot(wedge.n, a), dot(wedge.m, a), dot(wedge.r, a));
    let q = vec3f(dot(wedge.n, b), dot(wedge.m, b), dot(wedge.r, b));
    let slack = 2e-6 * (length(a) + length(b));
    let highest = max(p.y, q.y);
    if highest < -slack || (p.x > 0.0) == (q.x > 0.0) && min(abs(p.x), abs(q.x)) > wedge.aslant * highest + slack {
        return vec2f(0.0);
    }
    let heights = max(vec2f(p.y, q.y), vec2f(0.0));
    let first = vec2f(p.z, q.z) - heights * wedge.steep;
    let last = vec2f(p.z, q.z) - heights * wedge.flat;
    var run = vec2f(min(first.x, first.y), max(last.x, last.y));
    if min(p.y, q.y) < 0.0 {
        run = vec2f(min(run.x, min(p.z, q.z)), max(run.y, max(p.z, q.z)));
    }
    let more = slack * (1.0 + max(abs(wedge.steep), abs(wedge.flat)));
    return vec2f(max(run.x - more, air.x), min(run.y + more, air.y));
}

// A direction, or a place, as a point of the disc's plane: in the disc where z^2 > x^2 + y^2.
fn on_disc(disc: Disc, p: vec3f) -> vec3f {
    return vec3f(dot(p, disc.x), dot(p, disc.y), disc.tangent * dot(p, disc.z));
}

// Takes in from where on the ray an edge is seen to cross the disc.
//
// Places (t, s) of ray and edge that see each other within the disc are those of a conic section. It is an ellipse unless the disc
// meets the plane of directions of both.
fn take_edge(disc: Disc, wedge: Wedge, number: u32, start: vec3f, direction: vec3f, air: vec2f) {
    let edge = edge_of(number);
    let q = edge.point - start;
    let reach = edge_reach(wedge, q + edge.reach.x * edge.direction, q + edge.reach.y * edge.direction, air);
    let change = disc_line(disc, -cross(direction, edge.direction));
    // Counted from where the edge passes the middle, as far as the ray goes there: few digits are lost.
    let passes = far_ratio(-disc_line(disc, cross(q, edge.direction)).z, change.z);
    let base = clamp(passes, reach.x, max(reach.y, reach.x));
    let there = touches(disc_line(disc, cross(q - base * direction, edge.direction)), change);
    // Where its line crosses the disc: between the roots, or before and behind them.
    let roots = base + there.roots;
    var runs = array<vec2f, 2>(vec2f(max(reach.x, roots.x), min(reach.y, roots.y)), vec2f(0.0));
    if there.square <= 0.0 {
        runs[0] = select(vec2f(0.0), reach, there.c < 0.0);
    } else if there.a < 0.0 {
        runs[0] = vec2f(reach.x, min(reach.y, roots.x));
        runs[1] = vec2f(max(reach.x, roots.y), reach.y);
    }
    if reach.y <= reach.x {
        return;
    }
    let along = -on_disc(disc, direction);
    let onward = on_disc(disc, edge.direction);
    let middle = on_disc(disc, q);
    // Where its ends come into the disc and leave it.
    let one = touches(middle + edge.reach.x * onward + base * along, along).roots + base;
    let other = touches(middle + edge.reach.y * onward + base * along, along).roots + base;
    var k = 0u;
    while k < 10u {
        // The next part that is not empty, found first: some drivers go through the rest for all pixels alike.
        var part = vec2f(0.0);
        while k < 10u && part.y <= part.x {
            let run = select(runs[0], runs[1], k >= 5u);
            let places = clamp(vec4f(one, other), vec4f(run.x), vec4f(run.y));
            let low = vec2f(min(places.x, places.z), max(places.x, places.z));
            let high = vec2f(min(places.y, places.w), max(places.y, places.w));
            let ends = vec4f(low.x, min(low.y, high.x), max(low.y, high.x), high.y);
            let j = k % 5u;
            part = vec2f(select(run.x, ends[max(j, 1u) - 1u], j > 0u), select(run.y, ends[min(j, 3u)], j < 4u));
            k += 1u;
        }
        if part.y <= part.x {
            break;
        }
        // The part of the edge's line that is seen on the disc from there.
        let p = middle + 0.5 * (part.x + part.y) * along;
        let seen = touches(p, onward);
        let is_mixed = seen.a >= 0.0;
        let is_before = p.z + 0.5 * (seen.roots.x + seen.roots.y) * onward.z > 0.0;
        let is_seen = seen.square > 0.0 && is_before && seen.roots.y >= edge.reach.x && seen.roots.x <= edge.reach.y;
        let is_whole = seen.roots.x >= edge.reach.x && seen.roots.y <= edge.reach.y;
        if is_mixed || is_seen {
            add_ramp(Ramp(part, select(number | MIXED, number, is_whole && !is_mixed), passes));
        }
    }
    turns += 12u;
}

// The next edge whose box the wedge meets, and one more than its number; 0 behind the last.
fn next_end(walk: ptr<function, Walk>, wedge: Wedge, disc: Disc, start: vec3f, air: vec2f) -> u32 {
    while (*walk).at < (*walk).end {
        (*walk).steps += 1u;
        let low = end_texel(2u * (*walk).at);
        let high = end_texel(2u * (*walk).at + 1u);
        let met = wedge_meets(wedge, disc, start, air, bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz));
        (*walk).at = select(low.w, (*walk).at + 1u, met);
        if met && high.w != 0u {
            return high.w;
        }
    }
    return 0u;
}

fn find_ramps(disc: Disc, start: vec3f, direction: vec3f, air: vec2f) {
    let wedge = wedge_of(disc, start, direction, air);
    var walk = Walk(1u, end_texel(0u).x, 0u);
    while turns + walk.steps < MOST_TURNS {
        let number = next_end(&walk, wedge, disc, start, air);
        if number == 0u {
            break;
        }
        take_edge(disc, wedge, number - 1u, start, direction, air);
    }
    turns += walk.steps;
}

// Whether a caster without holes hides a point of the disc from a place; true too where `most` turns have been taken before it is known.
fn is_hidden(disc: Disc, start: vec3f, at: vec2f, blur: f32, most: u32) -> bool {
    let way = normalize(disc.z + disc.tangent * (at.x * disc.x + at.y * disc.y));
    let ray = Disc(disc.x, disc.y, way, 0.0, disc.limb);
    var walk = Walk(1u, tree_texel(0u).x, 0u);
    while turns + walk.steps < most {
        let triangle = disc_next(ray, &walk, start, NO_CASTER);
        if triangle == NO_CASTER {
            turns += walk.steps;
            return false;
        }
        if has_holes(triangle) {
            continue;
        }
        let outline = disc_outline(disc, triangle, start, blur);
        let d = vec3f(at, 1.0);
        if dot(outline.a, d) > 0.0 && dot(outline.b, d) > 0.0 && dot(outline.c, d) > 0.0 {
            break;
        }
    }
    turns += walk.steps;
    return true;
}

fn know_chords(disc: Disc) {
    if chords_known {
        return;
    }
    chords_known = true;
    var whole = vec3f(0.0);
    for (var j = 0u; j < CHORDS; j++) {
        let angle = 3.14159265358979 * f32(j + 1u) / f32(CHORDS + 1u);
        let half = sin(angle);
        chords[j / 4u][0][j % 4u] = cos(angle);
        chords[j / 4u][1][j % 4u] = half;
        chords[j / 4u][2][j % 4u] = disc_shift(j);
        chord_light[j] = half * half * pow(vec3f(half), disc.limb);
        whole += chord_light[j];
    }
    for (var j = 0u; j < CHORDS; j++) {
        chord_light[j] /= whole;
    }
    turns += 2u * CHORDS;
}

// The parts of four chords, from `first` to `last`, in which a line is not negative.
struct Cuts {
    first: vec4f,
    last: vec4f,
}

fn cut_chords(cuts: Cuts, line: vec3f, turn: vec2f, offsets: vec4f) -> Cuts {
    let middle = line.z + offsets * dot(line.xy, turn);
    let slope = line.y * turn.x - line.x * turn.y;
    let places = -middle / select(slope, 1.0, slope == 0.0);
    let first = select(cuts.first, max(cuts.first, places), slope > 0.0);
    let last = select(cuts.last, min(cuts.last, places), slope < 0.0);
    return Cuts(first, select(last, vec4f(-2.0), vec4<bool>(slope == 0.0) & (middle < vec4f(0.0))));
}

// The share of four chords' light before places of them, -1 to 1, as `disc_before`.
fn light_before(disc: Disc, places: vec4f) -> vec4f {
    let v = clamp(places, vec4f(-1.0), vec4f(1.0));
    if disc.limb.y == 0.0 {
        return 0.5 + 0.5 * v;
    }
    return 0.5 + 0.57207 * v * (1.0 - v * v * (0.083333 + v * v * (0.01875 + v * v * 0.023897)));
}

// Those of 32 bits of four chords that lie between two shares of their light.
fn bits_between(first: vec4f, last: vec4f, shifts: vec4f) -> vec4u {
    let a = vec4u(clamp(ceil(32.0 * first - shifts), vec4f(0.0), vec4f(32.0)));
    let b = vec4u(clamp(ceil(32.0 * last - shifts), vec4f(0.0), vec4f(32.0)));
    let below_a = select((vec4u(1u) << min(a, vec4u(31u))) - vec4u(1u), vec4u(0xffffffffu), a == vec4u(32u));
    let below_b = select((vec4u(1u) << min(b, vec4u(31u))) - vec4u(1u), vec4u(0xffffffffu), b == vec4u(32u));
    return below_b & ~below_a;
}

// What is left of four chords: all between `first` and `last` but for one part, and for bits.
struct Left {
    first: vec4f,
    last: vec4f,
    // Its end lies before its beginning where there is none yet.
    part_first: vec4f,
    part_last: vec4f,
    bits: vec4u,
}

// Keeps the light of a part off each of four chords: exactly, unless it is the second one that touches neither an end nor the first.
fn keep_off(disc: Disc, left: Left, cuts: Cuts, halves: vec4f, shifts: vec4f) -> Left {
    let near = vec4f(1e-5);
    let is_there = cuts.last > cuts.first;
    let at_first = is_there & (cuts.first <= left.first + near);
    let at_last = is_there & (cuts.last >= left.last - near);
    var now = left;
    now.first = select(now.first, max(now.first, cuts.last), at_first);
    now.last = select(now.last, min(now.last, cuts.first), at_last);
    let within = is_there & !at_first & !at_last;
    let is_new = left.part_first > left.part_last;
    let joins = within & (is_new | ((cuts.first <= left.part_last + near) & (cuts.last >= left.part_first - near)));
    now.part_first = select(now.part_first, min(now.part_first, cuts.first), joins);
    now.part_last = select(now.part_last, max(now.part_last, cuts.last), joins);
    let lone = within & !joins;
    if any(lone) {
        let bits = bits_between(light_before(disc, cuts.first / halves), light_before(disc, cuts.last / halves), shifts);
        now.bits |= select(vec4u(0u), bits, lone);
    }
    // The part may have come to lie at an end.
    let has_part = now.part_last >= now.part_first;
    let to_first = has_part & (now.part_first <= now.first + near);
    let to_last = has_part & (now.part_last >= now.last - near);
    now.first = select(now.first, max(now.first, now.part_last), to_first);
    now.last = select(now.last, min(now.last, now.part_first), to_last);
    now.part_first = select(now.part_first, vec4f(2.0), to_first | to_last);
    now.part_last = select(now.part_last, vec4f(-2.0), to_first | to_last);
    return now;
}

// The share of the disc's light that casters without holes leave to a place.
fn disc_seen(disc: Disc, start: vec3f, turn: vec2f, blur: f32) -> vec3f {
    var left: array<Left, CHORDS / 4u>;
    for (var j = 0u; j < CHORDS / 4u; j++) {
        left[j] = Left(-chords[j][1], chords[j][1], vec4f(2.0), vec4f(-2.0), vec4u(0u));
    }
    var walk = Walk(1u, tree_texel(0u).x, 0u);
    while turns + walk.steps < MOST_TURNS {
        let triangle = disc_next(disc, &walk, start, NO_CASTER);
        if triangle == NO_CASTER {
            break;
        }
        if has_holes(triangle) {
            continue;
        }
        let outline = disc_outline(disc, triangle, start, blur);
        let meets = disc_meets(outline);
        var is_dark = meets == MEETS_ALL;
        if meets == MEETS_PART {
            is_dark = true;
            for (var j = 0u; j < CHORDS / 4u; j++) {
                let chord = chords[j];
                var cuts = Cuts(-chord[1], chord[1]);
                cuts = cut_chords(cuts, outline.a, turn, chord[0]);
                cuts = cut_chords(cuts, outline.b, turn, chord[0]);
                cuts = cut_chords(cuts, outline.c, turn, chord[0]);
                left[j] = keep_off(disc, left[j], cuts, chord[1], chord[2]);
                is_dark = is_dark && all(left[j].last <= left[j].first);
            }
            turns += CHORDS / 4u;
        }
        if is_dark {
            turns += walk.steps;
            return vec3f(0.0);
        }
        turns += 1u;
    }
    var sum = vec3f(0.0);
    for (var j = 0u; j < CHORDS / 4u; j++) {
        let halves = chords[j][1];
        let shifts = chords[j][2];
        let own = left[j];
        let first = light_before(disc, own.first / halves);
        let last = max(light_before(disc, own.last / halves), first);
        let part_first = light_before(disc, own.part_first / halves);
        let part_last = max(light_before(disc, own.part_last / halves), part_first);
        var lit = last - first - (min(part_last, last) - clamp(part_first, first, last));
        if any(own.bits != vec4u(0u)) {
            let bits = own.bits & bits_between(first, last, shifts) & ~bits_between(part_first, part_last, shifts);
            lit -= vec4f(countOneBits(bits)) / 32.0;
        }
        lit = max(lit, vec4f(0.0));
        for (var k = 0u; k < 4u; k++) {
            sum += lit[k] * chord_light[4u * j + k];
        }
    }
    turns += walk.steps + CHORDS + CHORDS / 2u;
    return sum;
}

const NODE_PLACES = vec4f(0.0694318442, 0.3300094782, 0.6699905218, 0.9305681558);
const NODE_WEIGHTS = vec4f(0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226);

// The weights at a place, 0 to 1, of values at the nodes in the polynomial through these.
fn node_shares(place: f32) -> vec4f {
    let d = place - NODE_PLACES;
    return vec4f(d.y * d.z * d.w, d.x * d.z * d.w, d.x * d.y * d.w, d.x * d.y * d.z)
        * vec4f(-7.42054006, 18.79544941, -18.79544941, 7.42054006);
}

// What arrives of the light on a run: the share beside an edge, or that at the nodes, by channel.
struct Shares {
    edge: Edge,
    by_edge: bool,
    red: vec4f,
    green: vec4f,
    blue: vec4f,
}

fn share_at(disc: Disc, shares: Shares, p: vec3f, place: f32) -> vec3f {
    if shares.by_edge {
        return light_beyond(depth_behind(disc, shares.edge, p));
    }
    let nodes = node_shares(place);
    return clamp(vec3f(dot(nodes, shares.red), dot(nodes, shares.green), dot(nodes, shares.blue)), vec3f(0.0), vec3f(1.0));
}

// Places of 0 to 1 as far apart as before, or by more and more from 0 on.
fn grown(place: f32, growth: f32) -> f32 {
    if growth == 0.0 {
        return place;
    }
    return (exp(growth * place) - 1.0) / (exp(growth) - 1.0);
}

// The integral over a run of what the air sends to the eye of the light that arrives.
fn soft_run(disc: Disc, origin: vec3f, direction: vec3f, sources: u32, run: vec2f, shares: Shares) -> vec3f {
    var sum = vec3f(0.0);
    var at = run.x;
    for (var guard = 0u; guard <= 14u * tile.media && at < run.y; guard++) {
        let end = min(run.y, next_bend(origin, direction, disc.z, at));
        var depths: array<vec3f, 2>;
        for (var k = 0u; k < 2u; k++) {
            let t = mix(at, end, 0.001 + 0.998 * f32(k));
            depths[k] = optical_depth(origin, direction, t, sources) + sun_optical_depth(origin + t * direction, disc.z);
        }
        let change = abs(depths[1] - depths[0]);
        var uneven = max(change.x, max(change.y, change.z));
        for (var i = 0u; i < tile.media; i++) {
            if media[i].shape == HEIGHT {
                uneven = max(uneven, abs(direction.y * (end - at) / media[i].scale_height));
            }
        }
        let parts = u32(clamp(ceil(uneven), 1.0, 32.0));
        // Where more would be needed, they grow from the end at which there is more light.
        let growth = select(0.0, min(log(uneven), 60.0), uneven > 32.0);
        let is_near = dot(depths[1] - depths[0], vec3f(1.0)) >= 0.0;
        for (var k = 0u; k < parts * NODES; k++) {
            let before = grown(f32(k / NODES) / f32(parts), growth);
            let width = grown(f32(k / NODES + 1u) / f32(parts), growth) - before;
            let place = before + NODE_PLACES[k % NODES] * width;
            let t = select(end - place * (end - at), at + place * (end - at), is_near);
            let share = share_at(disc, shares, origin + tile.eye + t * direction, (t - run.x) / (run.y - run.x));
            sum += (end - at) * width * NODE_WEIGHTS[k % NODES] * share * beam_scattered(origin, direction, t, sources);
        }
        turns += parts * NODES + 4u;
        at = end;
    }
    return sum;
}

// Whether any of the light that a lone edge leaves arrives on a run: all else hides all of it, or nothing.
fn edge_is_open(disc: Disc, start: vec3f, direction: vec3f, run: vec2f, edge: Edge) -> bool {
    // A point in the middle of the most that the edge leaves tells which.
    let ends = vec2f(mix(run.x, run.y, 0.002), mix(run.x, run.y, 0.998));
    let one = edge_line(disc, edge, start + ends.x * direction);
    let other = edge_line(disc, edge, start + ends.y * direction);
    let sizes = max(vec2f(length(one.xy), length(other.xy)), vec2f(1e-30));
    let depths = vec2f(one.z, other.z) / sizes;
    let is_first = depths.x < depths.y;
    let p = start + select(ends.y, ends.x, is_first) * direction;
    let across = select(other.xy / sizes.y, one.xy / sizes.x, is_first);
    let open = -0.5 * (1.0 + clamp(min(depths.x, depths.y), -1.0, 1.0)) * across;
    return !is_hidden(disc, p, open, 4e-7 * (length(p - tile.eye) + length(tile.eye)), MOST_TURNS);
}

// The direction of chords that lies most across the edges that cross the disc from a part of the ray.
fn chords_across(disc: Disc, p: vec3f, at: f32) -> vec2f {
    var across: array<f32, TURNS>;
    for (var k = 0u; k < TURNS; k++) {
        across[k] = 1.0;
    }
    for (var k = 0u; k < ramp_count; k++) {
        let run = ramp_run(k);
        if run.x <= at && run.y > at && ramp_edge(k) != TOGETHER {
            let line = edge_line(disc, edge_of(ramp_edge(k)), p);
            let size = max(length(line.xy), 1e-30);
            for (var j = 0u; j < TURNS; j++) {
                let turn = disc_turn(j);
                across[j] = min(across[j], abs(line.y * turn.x - line.x * turn.y) / size);
            }
            turns += TURNS;
        }
    }
    var best = 0u;
    for (var k = 1u; k < TURNS; k++) {
        best = select(best, k, across[k] > across[best]);
    }
    turns += ramp_count + 2u * TURNS;
    return disc_turn(best);
}

// What a point in the disc's middle lights of a run.
fn middle_run(disc: Disc, origin: vec3f, direction: vec3f, sources: u32, run: vec2f) -> vec3f {
    var all: Shares;
    all.red = vec4f(1.0);
    all.green = vec4f(1.0);
    all.blue = vec4f(1.0);
    var sum = vec3f(0.0);
    var at = run.x;
    while at < run.y && turns < 2u * MOST_TURNS {
        // Up to where the next edge passes the middle.
        var end = run.y;
        for (var k = 0u; k < ramp_count; k++) {
            let passes = penumbrae[first_ramp + k].w;
            end = select(end, min(end, passes), passes > at);
        }
        let p = origin + tile.eye + 0.5 * (at + end) * direction;
        if !is_hidden(disc, p, vec2f(0.0), 4e-7 * (length(p - tile.eye) + length(tile.eye)), 2u * MOST_TURNS) {
            sum += soft_run(disc, origin, direction, sources, vec2f(at, end), all);
        }
        turns += ramp_count + 1u;
        at = end;
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn soften(@builtin(global_invocation_id) id: vec3u) {
    if !inside_tile(id) {
        return;
    }
    let i = pixel_index(id);
    let origin = ray_origin(id);
    let direction = ray_direction(id);
    let span = shaded_span(origin, direction, surfaces[i]);
    let disc = disc_of(beam.toward, beam.extent, vec3f(knobs.limb_red, knobs.limb_green, knobs.limb_blue));
    let start = origin + tile.eye;
    first_ramp = PENUMBRA_SIZE * i + 1u;
    ramp_count = 0u;
    if span.air.y > span.air.x {
        find_ramps(disc, start, direction, span.air);
    }
    var sum = vec3f(0.0);
    var found = 0u;
    var begun = -1.0;
    var at = select(0.0, ramp_run(0u).x, ramp_count > 0u);
    while turns < MOST_TURNS {
        // What crosses the disc there, and where that changes.
        var next = 2.0 * FARTHEST;
        var last = at;
        var shortest = FARTHEST;
        var count = 0u;
        var only = 0u;
        var is_together = false;
        for (var k = 0u; k < ramp_count; k++) {
            let run = ramp_run(k);
            let present = run.x <= at && run.y > at;
            count += u32(present);
            only = select(only, k, present);
            is_together = is_together || present && ramp_edge(k) == TOGETHER;
            shortest = select(shortest, min(shortest, run.y - run.x), present);
            last = select(last, max(last, run.y), present);
            let change = select(run.y, run.x, run.x > at);
            next = select(next, min(next, change), change > at);
        }
        turns += ramp_count;
        if is_together && knobs.replaces == 0u {
            // Where several edges became one, what a point lights is not known any more: it keeps its edges there.
            count = 0u;
        }
        if begun >= 0.0 && count == 0u {
            // A part of the ray in penumbrae ends.
            if knobs.replaces == 0u {
                sum -= middle_run(disc, origin, direction, span.sources, vec2f(begun, at));
            } else {
                // In place of a ramp that has ended.
                penumbrae[first_ramp + found] = vec4f(begun, at, 0.0, 0.0);
            }
            found += 1u;
            begun = -1.0;
        }
        if next > FARTHEST {
            break;
        }
        if count == 0u {
            at = next;
            continue;
        }
        begun = select(begun, at, begun < 0.0);
        var shares: Shares;
        shares.by_edge = count == 1u && (ramp_edge(only) & MIXED) == 0u;
        var is_open = true;
        if shares.by_edge {
            shares.edge = edge_of(ramp_edge(only));
            is_open = edge_is_open(disc, start, direction, vec2f(at, next), shares.edge);
        } else {
            // Much shorter parts than the shortest ramp tell no more.
            let enough = at + 0.125 * shortest;
            next = last;
            for (var k = 0u; k < ramp_count; k++) {
                let run = ramp_run(k);
                next = select(next, min(next, run.x), run.x > enough);
                next = select(next, min(next, run.y), run.y > enough);
            }
            turns += ramp_count;
            know_chords(disc);
            let turn = chords_across(disc, start + 0.5 * (at + next) * direction, at);
            for (var node = 0u; node < NODES; node++) {
                let p = start + mix(at, next, NODE_PLACES[node]) * direction;
                let seen = disc_seen(disc, p, turn, 4e-7 * (length(p - tile.eye) + length(tile.eye)));
                shares.red[node] = seen.x;
                shares.green[node] = seen.y;
                shares.blue[node] = seen.z;
            }
            is_open = any(shares.red + shares.green + shares.blue > vec4f(0.0));
        }
        if turns >= MOST_TURNS {
            // What was found of this part may be wrong.
            break;
        }
        if is_open {
            sum += soft_run(disc, origin, direction, span.sources, vec2f(at, next), shares);
        }
        at = next;
    }
    if begun >= 0.0 && at > begun {
        // Out of turns: the rest is left to a point.
        if knobs.replaces == 0u {
            sum -= middle_run(disc, origin, direction, span.sources, vec2f(begun, at));
        } else {
            penumbrae[first_ramp + found] = vec4f(begun, at, 0.0, 0.0);
        }
        found += 1u;
    }
    if knobs.replaces == 1u {
        penumbrae[PENUMBRA_SIZE * i] = vec4f(f32(found), 0.0, 0.0, 0.0);
    }
    inscatter_sun[i] = vec4f(max(inscatter_sun[i].xyz + sum, vec3f(0.0)), 0.0);
}
