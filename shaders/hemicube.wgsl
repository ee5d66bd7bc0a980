// Which triangle stands in each texel of hemicubes. Each instance is a face of one: its place and its axes.

struct Face {
    right: vec3f,
    // The half of the face in front of the surface has all its rows: clip.y = rows.x y + rows.y z.
    rows: vec2f,
    up: vec3f,
    near: f32,
    forward: vec3f,
    // What is not seen from there.
    home: u32,
    // The place in two parts: together they have the digits of f64 that distances from it need.
    high: vec3f,
    low: vec3f,
}

@group(0) @binding(0) var<storage, read> faces: array<Face>;

struct Drawn {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn hemicube_vertex(@location(0) high: vec3f, @location(1) low: vec3f, @location(2) home: u32,
                   @builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Drawn {
    let face = faces[number];
    let corner = (high - face.high) + (low - face.low);
    let y = dot(corner, face.up);
    let z = dot(corner, face.forward);
    // Depth is reversed: near over z keeps its digits at any distance.
    var at = vec4f(dot(corner, face.right), face.rows.x * y + face.rows.y * z, face.near, z);
    if home == face.home {
        // Behind the face.
        at = vec4f(0.0, 0.0, 0.0, -1.0);
    }
    return Drawn(at, vertex / 3u);
}

@fragment
fn hemicube_fragment(in: Drawn) -> @location(0) u32 {
    return in.triangle + 1u;
}
