// The rectified map: rows around the sun's direction as seen from the eye, read by the effects that have such rows. See
// src/effect/rows.rs.

// Where a row begins in the tree, for rows of so many leaves.
fn tree_row(row: u32, blocks: u32) -> u32 {
    return row * (blocks + 21u * (blocks / 64u));
}

// What lies along a ray in its slice.
struct Slice {
    // Azimuth around the sun from that of the tile's middle; in an orthographic view the offset of the plane.
    row: f32,
    // Distance from the axis, and height toward the sun, where the ray begins; sine and cosine of its angle from the sun.
    start: f32,
    base: f32,
    sine: f32,
    cosine: f32,
    // What is compared with a place's threshold.
    c: f32,
}

struct Rows {
    count: u32,
    columns: u32,
    first: f32,
    step: f32,
    // Columns: a + bend = (least + bend) exp(rate x).
    least: f32,
    bend: f32,
    rate: f32,
    width: f32,
    // Thresholds in 16 bits: 1 + (c - low) scale.
    low: f32,
    scale: f32,
}

fn ordered(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, bits >= 0x80000000u);
}

fn from_ordered(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 0x7fffffffu, bits >= 0x80000000u));
}

// Where rays end, in sixteenths of a doubling from 2^-32 m on: the sum, and of how many.
const LOG_SUM = 14u;
const LOG_COUNT = 15u;

// Whether any pixel asks for rows.
fn is_asked() -> bool {
    return atomicLoad(&asked[0]) <= atomicLoad(&asked[1]);
}

// As many rows as keep the distance that `count` of them have across the tile's diagonal: up to pi times as many where the
// axis lies in the tile.
fn row_count(count: u32, row: vec2f, c: vec2f) -> u32 {
    if tile.projection == ORTHOGRAPHIC {
        return count;
    }
    let nearest = select(min(abs(c.x), abs(c.y)), 0.0, c.x * c.y < 0.0);
    let sine = (1.0 - nearest) / length(vec2f(1.0 - nearest, nearest));
    let middle = rays[(tile.extent.y / 2u) * tile.extent.x + tile.extent.x / 2u].xyz;
    let last = rays[tile.extent.x * tile.extent.y - 1u].xyz;
    let diagonal = length(rays[0].xyz - middle) + length(last - middle);
    return u32(clamp(ceil(f32(count) * (row.y - row.x) * sine / max(diagonal, 1e-6)), f32(count), f32(knobs.most_rows)));
}

fn rows_of(count: u32, columns: u32) -> Rows {
    let row = vec2f(from_ordered(atomicLoad(&asked[0])), from_ordered(atomicLoad(&asked[1])));
    let a = vec2f(from_ordered(atomicLoad(&asked[2])), from_ordered(atomicLoad(&asked[3])));
    let c = vec2f(from_ordered(atomicLoad(&asked[4])), from_ordered(atomicLoad(&asked[5])));
    var rows: Rows;
    rows.count = row_count(count, row, c);
    rows.columns = columns;
    rows.first = row.x;
    rows.step = max(row.y - row.x, 1e-7 * max(abs(row.x), abs(row.y)) + 1e-30) / f32(rows.count);
    rows.least = a.x;
    rows.width = max(a.y - a.x, 1e-6 * max(abs(a.x), abs(a.y)) + 1e-30);
    if tile.projection == ORTHOGRAPHIC {
        // Parallel rays are as dense everywhere.
        rows.bend = 0.0;
        rows.rate = 0.0;
    } else {
        // Most rays may end near although a few go far: columns are for most.
        let mean = exp2(f32(atomicLoad(&asked[LOG_SUM])) / (16.0 * f32(max(atomicLoad(&asked[LOG_COUNT]), 1u))) - 32.0);
        rows.bend = 0.05 * min(a.y, 2.0 * mean);
        rows.rate = log((a.x + rows.width + rows.bend) / (a.x + rows.bend));
    }
    // A little more than the range, so that equal thresholds still differ.
    let pad = 1e-3 * (c.y - c.x) + 1e-6 * max(abs(c.x), abs(c.y)) + 1e-30;
    rows.low = c.x - pad;
    rows.scale = 65533.0 / (c.y - c.x + 2.0 * pad);
    return rows;
}

// Distance from the axis at a place x of a row, 0 to 1.
fn across_of(rows: Rows, x: f32) -> f32 {
    if rows.rate < 1e-3 {
        return rows.least + rows.width * x;
    }
    return (rows.least + rows.bend) * exp(rows.rate * x) - rows.bend;
}

fn place_of(rows: Rows, a: f32) -> f32 {
    if rows.rate < 1e-3 {
        return (a - rows.least) / rows.width;
    }
    return log(max((a + rows.bend) / (rows.least + rows.bend), 1e-30)) / rows.rate;
}

fn threshold_bits(rows: Rows, d: f32) -> u32 {
    return u32(clamp(round(1.0 + (d - rows.low) * rows.scale), 0.0, 65535.0));
}

// The direction across the light from which rows of a tile are counted; in an orthographic view that of all slices.
fn reference_across() -> vec2f {
    let middle = (tile.extent.y / 2u) * tile.extent.x + tile.extent.x / 2u;
    let across = axis_parts(rays[middle].xyz).xy;
    let size = length(across);
    return select(vec2f(1.0, 0.0), across / size, size > 1e-6);
}

fn slice_of(origin: vec3f, direction: vec3f) -> Slice {
    let d = axis_parts(direction);
    let e = reference_across();
    var slice: Slice;
    slice.sine = length(d.xy);
    slice.cosine = d.z;
    if tile.projection == ORTHOGRAPHIC {
        let o = axis_parts(origin);
        slice.row = e.x * o.y - e.y * o.x;
        slice.start = dot(e, o.xy);
        slice.base = o.z;
        slice.c = slice.base * slice.sine - slice.start * slice.cosine;
        return slice;
    }
    if slice.sine > 0.0 {
        slice.row = atan2(e.x * d.y - e.y * d.x, dot(e, d.xy));
    }
    slice.c = slice.cosine / (abs(slice.cosine) + slice.sine);
    return slice;
}

// Light coordinates of the place at distance a from the axis in a slice.
fn slice_place(row: f32, a: f32) -> vec2f {
    let e = reference_across();
    let eye = vec2f(beam.across.w, beam.along.w);
    if tile.projection == ORTHOGRAPHIC {
        return eye + a * e + row * vec2f(-e.y, e.x);
    }
    let turn = vec2f(cos(row), sin(row));
    return eye + a * vec2f(turn.x * e.x - turn.y * e.y, turn.x * e.y + turn.y * e.x);
}

// Height over the eye, toward the sun, of the first surface that the light meets at a place; far below where there is none.
fn slice_height(at: vec2f) -> f32 {
    if any(at < beam.casters.xy) || any(at > beam.casters.zw) {
        return -1e30;
    }
    let k = covering(at);
    if k == beam.partitions {
        return -1e30;
    }
    return caster_height(k, vec2i((at - beam.maps[k].least) / beam.maps[k].texel)) - beam.height.w;
}

// What a ray's c is compared with: lit where c is not less.
fn slice_threshold(slice: Slice, h: f32, a: f32) -> f32 {
    if tile.projection == ORTHOGRAPHIC {
        return h * slice.sine - a * slice.cosine;
    }
    let sum = abs(h) + a;
    return select(h / sum, -1.0, sum <= 0.0);
}

// Whether a ray runs so nearly along the light that one place across it decides for all of the ray.
fn along_light(slice: Slice, span: vec2f) -> bool {
    let texel = min(beam.maps[0].texel.x, beam.maps[0].texel.y);
    return (span.y - span.x) * slice.sine < 0.5 * texel || slice.sine < 1e-6;
}

// Where such a ray turns from dark to light (or, away from the sun, from light to dark).
fn turn_along_light(slice: Slice, span: vec2f) -> f32 {
    let a = slice.start + 0.5 * (span.x + span.y) * slice.sine;
    let t = (slice_height(slice_place(slice.row, a)) - slice.base) / slice.cosine;
    return clamp(t, span.x, span.y);
}

// A ray on its way through a row: the threshold that it keeps, and the columns that it crosses.
struct Crossing {
    c: u32,
    first: u32,
    last: u32,
}

fn crossing_of(rows: Rows, slice: Slice, shaded: vec2f) -> Crossing {
    let columns = f32(rows.columns);
    let from_column = place_of(rows, slice.start + shaded.x * slice.sine) * columns;
    let to_column = place_of(rows, slice.start + shaded.y * slice.sine) * columns;
    let first = u32(clamp(floor(from_column), 0.0, columns - 1.0));
    // Thresholds are whole numbers: rounding down keeps the order.
    let c = u32(clamp(1.0 + (slice.c - rows.low) * rows.scale, 0.0, 65535.0));
    return Crossing(c, first, u32(clamp(ceil(to_column), f32(first) + 1.0, columns)));
}

// The ray's distance at which a column begins, within the part that can be shaded.
fn column_distance(rows: Rows, slice: Slice, span: Span, column: f32) -> f32 {
    let a = across_of(rows, column / f32(rows.columns));
    return clamp((a - slice.start) / slice.sine, span.shaded.x, span.shaded.y);
}

// Azimuth (or offset) of a row's middle.
fn row_middle(rows: Rows, row: u32) -> f32 {
    return rows.first + (f32(row) + 0.5) * rows.step;
}

// How wide a texel is at a place, of the finest map that covers it.
fn texel_at(at: vec2f) -> f32 {
    return length(beam.maps[min(covering(at), beam.partitions - 1u)].texel);
}

// What stands for a border that casters' edges do not tell: that of something without an edge nearby, or with holes.
const NO_EDGE = -2.0 * FARTHEST;
const HOLES = -3.0 * FARTHEST;

// Where the shadow ends (or begins, unless it is lit behind) that the caster over a dark place of the row throws on the ray
// itself, if that is near the column's border at t. From there on casters are followed that throw shadow on: that beyond the
// edge, or what the maps show a texel farther on.
fn edge_of_shadow(rows: Rows, slice: Slice, span: Span, row: u32, column: f32, t: f32, lit_behind: bool) -> f32 {
    let outward = select(-1.0, 1.0, lit_behind);
    let onward = outward * normalize(axis_parts(run_direction).xy);
    let dark = across_of(rows, (column - 0.5 * outward) / f32(rows.columns));
    // Where to look, and where if that is in vain: at the ray's own azimuth.
    var place = slice_place(row_middle(rows, row), dark);
    var instead = slice_place(slice.row, dark);
    var texel = texel_at(place);
    // The row is not quite the ray's own, and edges may run along it.
    let apart = abs(slice.row - row_middle(rows, row));
    let shift = apart * select(slice.start + t * slice.sine, 1.0, tile.projection == ORTHOGRAPHIC);
    let blur = (2.0 * texel + 1000.0 * shift) / slice.sine;
    let reach = blur + column_distance(rows, slice, span, column + 2.0) - column_distance(rows, slice, span, column - 2.0);
    var edge = NO_EDGE;
    var last = NO_CASTER;
    var beyond = NO_CASTER;
    var tries = 2u;
    for (var k = 0u; k < 12u && (tries > 0u || beyond != NO_CASTER); k++) {
        var caster = beyond;
        beyond = NO_CASTER;
        if caster == NO_CASTER {
            tries -= 1u;
            caster = caster_at(place);
            count_reads(1u);
            place = instead;
            if caster == CUT_OUT {
                return select(edge, HOLES, last == NO_CASTER);
            }
        }
        if caster == NO_CASTER || caster == last {
            continue;
        }
        let shadow = shadow_of(caster, run_origin, run_direction);
        let ends = select(shadow.span.yx, shadow.span, lit_behind);
        // It must reach on from the edge so far. Before the column's border what fills less than a texel may be missing on the
        // maps; behind it they show light.
        let over = 1e-6 * abs(edge) + select(0.0, texel / slice.sine, outward * (t - edge) > 0.0);
        let goes_on = outward * (ends.y - edge) > 0.0 && outward * (ends.x - edge) < over;
        if shadow.span.y < shadow.span.x || !select(goes_on, abs(ends.y - t) < reach, last == NO_CASTER) {
            continue;
        }
        edge = ends.y;
        last = caster;
        beyond = select(shadow.beyond.x, shadow.beyond.y, lit_behind);
        place = slice_place(slice.row, slice.start + edge * slice.sine);
        texel = texel_at(place);
        // What goes on there may be thin.
        instead = place + 0.25 * texel * onward;
        place += 0.75 * texel * onward;
        tries = 2u;
    }
    return edge;
}

// Where a ray turns near a column's beginning, halved `halvings` times by asking the maps at the ray's own azimuth. `between`
// are the neighbouring borders' columns.
fn halved_border(rows: Rows, slice: Slice, span: Span, column: f32, lit_behind: bool, halvings: u32, between: vec2f) -> f32 {
    // Not beyond the middles between neighbouring borders.
    var ends = vec2f(max(column - 1.5, 0.5 * (column + between.x)), min(column + 1.5, 0.5 * (column + between.y)));
    for (var k = 0u; k < halvings; k++) {
        let middle = 0.5 * (ends.x + ends.y);
        let a = across_of(rows, middle / f32(rows.columns));
        let lit = slice.c >= slice_threshold(slice, slice_height(slice_place(slice.row, a)), a);
        ends = select(vec2f(middle, ends.y), vec2f(ends.x, middle), lit == lit_behind);
    }
    count_reads(halvings);
    return column_distance(rows, slice, span, 0.5 * (ends.x + ends.y));
}

// Sunlight that a ray scatters to the eye [1/sr]: shaded by one row, or by the one place that a ray along the light meets.
// The row's columns are gone through from the eye outward; children that are as the ray is are passed over at once.
// Borders are made exact unless `halvings` is 0: taken from the edges of casters, or halved where those tell nothing. Where
// many lie along a ray, those from the first thing with holes on, as leaves are, stay at their columns: they are off to both
// sides, each tells little, and to ask for what casts them would be most of the reads.
fn scattered_in_row(origin: vec3f, direction: vec3f, slice: Slice, span: Span, rows: Rows, row: u32, halvings: u32) -> vec3f {
    begin_runs(origin, direction, span.air, span.sources);
    let along = span.shaded.y <= span.shaded.x || along_light(slice, span.shaded);
    let crossing = crossing_of(rows, slice, span.shaded);
    let blocks = rows.columns / 8u;
    var at_row = row;
    var first_leaf = tree_row(row, blocks);
    // Where nodes of each level begin, from the row's first leaf on.
    let low = blocks;
    let middle = low + blocks / 4u;
    let high = middle + blocks / 16u;
    var column = select(crossing.first, crossing.last, along);
    // Levels 1 to 3 are nodes whose four children are 8, 32 and 128 columns wide; 0 is a leaf of eight columns.
    var level = 3u;
    var held0 = vec4u(0u);
    var held1 = vec4u(0u);
    var held2 = vec4u(0u);
    var held3 = vec4u(0u);
    if !along {
        count_nodes(1u);
        held3 = tree[first_leaf + high + column / 512u];
    }
    // What comes behind the last column: a ray along the light turns twice, all is lit, the air ends.
    var last = select(2u, select(0u, 2u, span.shaded.y <= span.shaded.x), along);
    var before = -1e9;
    while last < 4u {
        while column < crossing.last && !is_full() {
            let held = select(select(select(held0, held1, level == 1u), held2, level == 2u), held3, level == 3u);
            let shift = select(2u * level + 1u, 0u, level == 0u);
            let children = select(4u, 8u, level == 0u);
            // Not less than the lower and the upper half of each word.
            let lower = vec4u(vec4u(crossing.c) >= (held & vec4u(0xffffu)));
            let upper = vec4u(vec4u(crossing.c) >= (held >> vec4u(16u)));
            let some = dot(lower, vec4u(1u, 2u, 4u, 8u));
            let all = dot(upper, vec4u(1u, 2u, 4u, 8u));
            let each = dot(lower, vec4u(1u, 4u, 16u, 64u)) | dot(upper, vec4u(2u, 8u, 32u, 128u));
            let lit = select(all, each, level == 0u);
            let mixed = select(some & ~all, 0u, level == 0u);
            let whole = children << shift;
            let begin = column / whole * whole;
            let other = select(lit | mixed, ~lit, is_lit()) & ((1u << children) - 1u);
            let next = other & (0xffffffffu << ((column - begin) >> shift));
            if next == 0u {
                column = begin + whole;
                level = select(select(select(1u, 2u, column % 32u == 0u), 3u, column % 128u == 0u), 3u, level == 3u);
                if column % 512u == 0u && column < crossing.last {
                    count_nodes(1u);
                    held3 = tree[first_leaf + high + column / 512u];
                }
            } else {
                let child = firstTrailingBit(next);
                column = max(column, begin + (child << shift));
                if ((mixed >> child) & 1u) != 0u {
                    level -= 1u;
                    count_reads(u32(level == 0u));
                    count_nodes(u32(level != 0u));
                    let node = select(select(middle + column / 128u, low + column / 32u, level == 1u), column / 8u, level == 0u);
                    let found = tree[first_leaf + node];
                    held0 = select(held0, found, level == 0u);
                    held1 = select(held1, found, level == 1u);
                    held2 = select(held2, found, level == 2u);
                } else if column < crossing.last {
                    // Distances are found later, for all borders together.
                    turn(!is_lit(), -1.0 - f32(column));
                }
            }
        }
        // All dark: the row on the ray's other side may show a beam that the ray just enters, as that of a slit whose sides run
        // along the rows. Where it does not, borders from its casters leave nothing between them.
        let is_dark = run_count == 2u && run_borders[1] == -1.0 - f32(crossing.first);
        if column >= crossing.last && last == 2u && !along && halvings > 0u && is_dark && at_row == row {
            let onward = slice.row > row_middle(rows, row);
            if select(row > 0u, row + 1u < rows.count, onward) {
                at_row = select(row - 1u, row + 1u, onward);
                first_leaf = tree_row(at_row, blocks);
                column = crossing.first;
                level = 3u;
                count_nodes(1u);
                held3 = tree[first_leaf + high + column / 512u];
                continue;
            }
        }
        while column >= crossing.last && last < 4u && !is_full() {
            var lit = last == 2u;
            var t = span.shaded.y;
            if last == 0u {
                lit = slice.cosine < 0.0;
                t = span.shaded.x;
            } else if last == 1u {
                count_reads(1u);
                lit = slice.cosine >= 0.0;
                t = turn_along_light(slice, span.shaded);
            } else if last == 3u {
                t = span.air.y;
            }
            turn(lit, t);
            last += 1u;
        }
        // Borders as dense as columns are not all found: to move each to an edge nearby would favour light or shadow.
        let among = run_borders[1] - run_borders[max(run_count, 2u) - 1u];
        let dense = run_count >= 15u && run_borders[1] < 0.0 && run_borders[run_count - 1u] < 0.0 && among < 3.0 * f32(run_count);
        var exact = halvings > 0u && !dense;
        for (var k = 0u; k < run_count; k++) {
            let column = -1.0 - run_borders[k];
            let after = -1.0 - run_borders[min(k + 1u, 15u)];
            let next = select(1e9, after, k + 1u < run_count && after >= 0.0);
            // Light of the other row counts only where casters bound it: elsewhere it begins last and ends first.
            let unbounded = select(span.shaded.x, span.shaded.y, (k & 1u) == 0u);
            if column > f32(crossing.first) {
                let near = column_distance(rows, slice, span, column);
                var t = select(unbounded, near, at_row == row);
                if exact {
                    let edge = edge_of_shadow(rows, slice, span, at_row, column, near, (k & 1u) == 0u);
                    exact = edge != HOLES || run_count <= 8u;
                    if edge > NO_EDGE {
                        t = clamp(edge, span.shaded.x, span.shaded.y);
                    } else if exact && at_row == row {
                        t = halved_border(rows, slice, span, column, (k & 1u) == 0u, halvings, vec2f(before, next));
                    }
                }
                run_borders[k] = max(t, run_borders[max(k, 1u) - 1u]);
            } else if column >= 0.0 {
                // The first column begins before the ray does.
                run_borders[k] = select(max(unbounded, run_borders[max(k, 1u) - 1u]), span.shaded.x, at_row == row);
            }
            before = select(before, column, column >= 0.0);
        }
        integrate_runs();
    }
    return run_sum;
}
