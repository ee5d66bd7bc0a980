//! Rooms lit by daylight: triangles with reflectances, skies, and the points of a workplane.
//!
//! In metres, +Y up, +X east, +Z south. A room is an outline that rises to a ceiling; with walls of a thickness it stands in a
//! second such shell, and its openings have reveals. The ground lies 0.2 m below the floor, and the walls go down to it.

use super::build::{cuboid, quad};
use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::PI;
use tyndall::colour::Space;
use tyndall::scene::{Material, Mesh, Scene, SunEntry, Triangle};
use tyndall::studies::scenes::{Corners, material};

/// Height of the points above the floor.
pub const WORKPLANE: f64 = 0.85;
/// How far the ground lies below the floor.
const PLINTH: f64 = 0.2;

/// Triangles with reflectances, on an open ground, and points where the light is wanted.
#[derive(Clone)]
pub struct Room {
    pub name: &'static str,
    /// Corners, and the number of a reflectance.
    pub triangles: Vec<(Corners, u32)>,
    /// Linear Rec. 709, as scenes have them.
    pub reflectances: Vec<DVec3>,
    /// The ground's reflectance.
    pub ground: f64,
    /// All face upward.
    pub points: Vec<DVec3>,
}

/// A sky with its sun.
#[derive(Clone, Copy)]
pub struct Weather {
    pub name: &'static str,
    pub model: &'static str,
    /// Direct normal and diffuse horizontal irradiance [W/m2].
    pub measured: Option<[f64; 2]>,
    /// Azimuth and elevation [degrees].
    pub sun: [f64; 2],
    /// Illuminance of the sun [lx].
    pub lux: f64,
}

/// Overcast; a sun that no southern window lets in; a sun that it does.
pub const WEATHER: [Weather; 3] = [
    Weather {
        name: "overcast",
        model: "cie:16",
        measured: Some([0.0, 150.0]),
        sun: [180.0, 40.0],
        lux: 0.0,
    },
    Weather {
        name: "sun from the north-east",
        model: "perez",
        measured: Some([450.0, 180.0]),
        sun: [62.0, 41.0],
        lux: 48_000.0,
    },
    Weather {
        name: "sun through the window",
        model: "perez",
        measured: Some([750.0, 95.0]),
        sun: [197.0, 33.0],
        lux: 76_000.0,
    },
];

impl Room {
    /// The scene under a sky.
    pub fn under(&self, weather: &Weather) -> Scene {
        let positions: Vec<DVec3> = self.triangles.iter().flat_map(|(c, _)| *c).collect();
        let materials = self.reflectances.iter().map(|reflectance| Material {
            base_color: *reflectance,
            ..material(0.0)
        });
        let mut scene = Scene {
            name: self.name.into(),
            materials: materials.collect(),
            mesh: Mesh {
                normals: vec![DVec3::ZERO; positions.len()],
                uvs: vec![DVec2::ZERO; positions.len()],
                colors: Vec::new(),
                triangles: (self.triangles.iter().zip(0..))
                    .map(|((_, material), i)| Triangle {
                        vertices: [3 * i, 3 * i + 1, 3 * i + 2],
                        material: *material,
                    })
                    .collect(),
                positions,
            },
            sun: Some(SunEntry {
                azimuth_deg: weather.sun[0],
                elevation_deg: weather.sun[1],
                illuminance: Some(weather.lux),
                diameter_deg: Some(0.0),
            }),
            ..Scene::default()
        };
        scene.sky.model = Some(weather.model.into());
        scene.sky.direct_normal = weather.measured.map(|m| m[0]);
        scene.sky.diffuse_horizontal = weather.measured.map(|m| m[1]);
        scene.ground.height = Some(-PLINTH);
        scene.ground.albedo = self.ground;
        scene
    }

    /// The reflectances in the working space, in which light is reckoned.
    pub fn working(&self) -> Vec<DVec3> {
        let to_working: DMat3 = Space::Rec709.to_working();
        (self.reflectances.iter().map(|r| to_working * *r)).collect()
    }

    /// The same with all reflectances higher by `more`.
    pub fn lighter(&self, more: f64) -> Self {
        let mut room = self.clone();
        for reflectance in &mut room.reflectances {
            *reflectance += more;
        }
        room
    }

    fn add(&mut self, surface: u32, triangles: impl IntoIterator<Item = Corners>) {
        self.triangles
            .extend(triangles.into_iter().map(|corners| (corners, surface)));
    }
}

/// An opening in a wall: which wall of the outline, from where to where along it, and from where to where above the floor.
#[derive(Clone, Copy)]
pub struct Opening {
    pub wall: usize,
    pub along: [f64; 2],
    pub height: [f64; 2],
}

impl Opening {
    /// As many times as wide, from the same middle.
    pub fn wider(self, factor: f64) -> Self {
        let [a, b] = self.along;
        let (middle, half) = (0.5 * (a + b), 0.5 * factor * (b - a));
        let along = [middle - half, middle + half];
        Opening { along, ..self }
    }
}

/// A room with upright walls over an outline of right angles.
#[derive(Clone)]
pub struct Shell {
    /// Corners (x, z), counter-clockwise seen from above: east, then north, then west, then south for a box.
    pub outline: Vec<DVec2>,
    pub height: f64,
    /// Of walls, floor and ceiling; 0 for sheets.
    pub thickness: f64,
    pub openings: Vec<Opening>,
    /// Floor, walls, ceiling.
    pub reflectances: [f64; 3],
}

const FLOOR: u32 = 0;
const WALLS: u32 = 1;
const CEILING: u32 = 2;
/// What stands in a room or before it.
const THINGS: u32 = 3;

/// A box from x = 0 and z = -`depth` to x = `width` and z = 0. Wall 0 is the southern, 1 the eastern, 2 the northern, 3 the western;
/// along each one goes counter-clockwise.
pub fn plan(width: f64, depth: f64) -> Vec<DVec2> {
    vec![
        dvec2(0.0, 0.0),
        dvec2(width, 0.0),
        dvec2(width, -depth),
        dvec2(0.0, -depth),
    ]
}

impl Shell {
    /// The room with points a grid of about `spacing` apart, all half a spacing or more from the walls.
    pub fn room(&self, name: &'static str, spacing: f64) -> Room {
        let mut room = Room {
            name,
            triangles: Vec::new(),
            reflectances: (self.reflectances.iter().chain(&[0.4]))
                .map(|r| DVec3::splat(*r))
                .collect(),
            ground: 0.2,
            points: Vec::new(),
        };
        let base = if self.thickness > 0.0 { 0.0 } else { -PLINTH };
        self.faces(&mut room, &self.outline, base, self.height);
        room.add(FLOOR, level(&self.outline, 0.0));
        room.add(CEILING, level(&self.outline, self.height));
        if self.thickness > 0.0 {
            let outer = grown(&self.outline, self.thickness);
            let top = self.height + self.thickness;
            self.faces(&mut room, &outer, -PLINTH, top);
            room.add(WALLS, level(&outer, top));
            self.reveals(&mut room);
        }
        let (low, high) = bounds(&self.outline);
        let count = ((high - low) / spacing).round().max(DVec2::ONE);
        for j in 0..count.y as u32 {
            for i in 0..count.x as u32 {
                let share = (dvec2(i.into(), j.into()) + 0.5) / count;
                let at = low + share * (high - low);
                if inside(&self.outline, at) {
                    room.points.push(dvec3(at.x, WORKPLANE, at.y));
                }
            }
        }
        room
    }

    /// The walls of an outline with their openings, which are where they are in the room's own.
    fn faces(&self, room: &mut Room, outline: &[DVec2], base: f64, top: f64) {
        for wall in 0..outline.len() {
            let (corner, along) = edge(outline, wall);
            let length = along.length();
            let along = along / length;
            // Places along the outer wall count from the inner corner.
            let shift = (self.outline[wall] - corner).dot(along);
            let holes: Vec<[f64; 4]> = (self.openings.iter().filter(|o| o.wall == wall))
                .map(|o| {
                    let [a, b] = o.along.map(|s| s + shift);
                    [a, b, o.height[0] - base, o.height[1] - base]
                })
                .collect();
            let corner = dvec3(corner.x, base, corner.y);
            let along = dvec3(along.x, 0.0, along.y);
            let panel = panel(corner, along, DVec3::Y, [length, top - base], &holes);
            room.add(WALLS, panel);
        }
    }

    /// What is seen of the wall's thickness in its openings.
    fn reveals(&self, room: &mut Room) {
        for o in &self.openings {
            let (corner, along) = edge(&self.outline, o.wall);
            let along = along.normalize();
            let out = self.thickness * dvec3(-along.y, 0.0, along.x);
            let along = dvec3(along.x, 0.0, along.y);
            let at = |s: f64, y: f64| dvec3(corner.x, y, corner.y) + s * along;
            let ([a, b], [low, high]) = (o.along, o.height);
            for (from, side) in [
                (at(a, low), (b - a) * along),
                (at(a, high), (b - a) * along),
                (at(a, low), (high - low) * DVec3::Y),
                (at(b, low), (high - low) * DVec3::Y),
            ] {
                room.add(WALLS, quad(from, side, out));
            }
        }
    }
}

/// A corner of an outline and the way to the next.
fn edge(outline: &[DVec2], index: usize) -> (DVec2, DVec2) {
    let corner = outline[index];
    (corner, outline[(index + 1) % outline.len()] - corner)
}

fn bounds(outline: &[DVec2]) -> (DVec2, DVec2) {
    (outline.iter()).fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
        (low.min(*p), high.max(*p))
    })
}

/// Whether a point lies in an outline.
fn inside(outline: &[DVec2], at: DVec2) -> bool {
    let crosses = |i: &usize| {
        let (a, b) = (outline[*i], outline[(i + 1) % outline.len()]);
        (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)
    };
    (0..outline.len()).filter(crosses).count() % 2 == 1
}

/// An outline whose edges have moved outward.
fn grown(outline: &[DVec2], by: f64) -> Vec<DVec2> {
    let count = outline.len();
    let out = |i: usize| {
        let (_, along) = edge(outline, i);
        let along = along.normalize();
        dvec2(-along.y, along.x)
    };
    (0..count)
        .map(|i| outline[i] + by * (out(i) + out((i + count - 1) % count)))
        .collect()
}

/// Sorted values, each once.
fn lines(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// A level plane over an outline.
fn level(outline: &[DVec2], height: f64) -> Vec<Corners> {
    let (x, z) = (
        lines(outline.iter().map(|p| p.x)),
        lines(outline.iter().map(|p| p.y)),
    );
    let mut triangles = Vec::new();
    for z in z.windows(2) {
        for x in x.windows(2) {
            if inside(outline, 0.5 * dvec2(x[0] + x[1], z[0] + z[1])) {
                let (a, b) = (DVec3::X * (x[1] - x[0]), DVec3::Z * (z[1] - z[0]));
                triangles.extend(quad(dvec3(x[0], height, z[0]), a, b));
            }
        }
    }
    triangles
}

/// A rectangle along two unit vectors with holes (from, to, from, to).
pub fn panel(
    corner: DVec3,
    along: DVec3,
    up: DVec3,
    size: [f64; 2],
    holes: &[[f64; 4]],
) -> Vec<Corners> {
    let across = lines(
        holes
            .iter()
            .flat_map(|h| [h[0], h[1]])
            .chain([0.0, size[0]]),
    );
    let upward = lines(
        holes
            .iter()
            .flat_map(|h| [h[2], h[3]])
            .chain([0.0, size[1]]),
    );
    let mut triangles = Vec::new();
    for v in upward.windows(2) {
        for u in across.windows(2) {
            let (s, t) = (0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
            let hole = |h: &[f64; 4]| h[0] < s && s < h[1] && h[2] < t && t < h[3];
            if !holes.iter().any(hole) {
                let (a, b) = (along * (u[1] - u[0]), up * (v[1] - v[0]));
                triangles.extend(quad(corner + along * u[0] + up * v[0], a, b));
            }
        }
    }
    triangles
}

/// A room by its name, its openings `factor` times as wide.
pub fn room(name: &str, factor: f64) -> Option<Room> {
    let window = |wall: usize, along: [f64; 2], height: [f64; 2]| {
        let opening = Opening {
            wall,
            along,
            height,
        };
        opening.wider(factor)
    };
    // 4 by 6, 3 high.
    let study = Shell {
        outline: plan(4.0, 6.0),
        height: 3.0,
        thickness: 0.0,
        openings: vec![window(0, [0.8, 3.2], [0.9, 2.4])],
        reflectances: [0.3, 0.5, 0.8],
    };
    let room = match name {
        "study" => study.room("study", 0.6),
        "thick" => Shell {
            thickness: 0.3,
            ..study
        }
        .room("thick", 0.6),
        "two windows" => Shell {
            outline: plan(8.0, 5.0),
            openings: vec![
                window(0, [0.7, 3.1], [0.8, 2.3]),
                window(1, [1.5, 3.5], [1.0, 2.2]),
            ],
            reflectances: [0.2, 0.6, 0.7],
            ..study
        }
        .room("two windows", 0.7),
        "long" => Shell {
            outline: plan(3.0, 9.0),
            height: 2.7,
            thickness: 0.3,
            openings: vec![window(0, [0.3, 2.7], [0.85, 2.5])],
            reflectances: [0.1, 0.25, 0.35],
        }
        .room("long", 0.6),
        "white" => Shell {
            outline: plan(4.0, 4.0),
            height: 3.5,
            openings: vec![window(0, [1.2, 2.8], [1.2, 2.6])],
            reflectances: [0.85, 0.85, 0.85],
            ..study
        }
        .room("white", 0.5),
        "obstructed" => {
            let mut room = Shell {
                thickness: 0.3,
                ..study
            }
            .room("obstructed", 0.6);
            let house = cuboid(dvec3(-8.0, -PLINTH, 9.0), dvec3(9.0, 7.0, 17.0));
            room.add(THINGS, house);
            room.add(
                THINGS,
                cuboid(dvec3(-4.0, -PLINTH, 2.0), dvec3(-1.5, 5.0, 4.5)),
            );
            room
        }
        "furnished" => {
            let mut room = study.room("furnished", 0.6);
            // A table of a top and four legs, a cupboard against the wall, a screen that stands free, a chest.
            room.add(
                THINGS,
                cuboid(dvec3(1.15, 0.70, -3.25), dvec3(2.75, 0.74, -2.15)),
            );
            for x in [1.2, 2.64] {
                for z in [-3.2, -2.26] {
                    let foot = dvec3(x, 0.0, z);
                    room.add(THINGS, cuboid(foot, foot + dvec3(0.06, 0.7, 0.06)));
                }
            }
            room.add(
                THINGS,
                cuboid(dvec3(3.45, 0.0, -5.5), dvec3(4.0, 2.0, -3.5)),
            );
            room.add(
                THINGS,
                quad(
                    dvec3(0.45, 0.0, -4.4),
                    DVec3::Y * 1.6,
                    dvec3(1.1, 0.0, -0.35),
                ),
            );
            room.add(THINGS, cuboid(dvec3(0.0, 0.0, -1.6), dvec3(0.5, 0.5, -0.4)));
            // Those that a thing covers, or that nearly touch one.
            room.points.retain(|p| {
                let cupboard = p.x > 3.4 && p.z < -3.4 && p.z > -5.6;
                let screen = p.x > 0.3 && p.x < 1.7 && p.z > -4.9 && p.z < -4.3;
                !cupboard && !screen
            });
            room
        }
        "angle" => Shell {
            outline: vec![
                dvec2(0.0, 0.0),
                dvec2(4.0, 0.0),
                dvec2(4.0, -4.0),
                dvec2(8.0, -4.0),
                dvec2(8.0, -7.5),
                dvec2(0.0, -7.5),
            ],
            openings: vec![window(0, [0.8, 3.2], [0.9, 2.4])],
            ..study
        }
        .room("angle", 0.75),
        "well" => {
            // A shaft, open above, 1.8 by 1.8 and 9 deep, south of the room, on whose wall its only window opens.
            let mut room = Shell {
                outline: plan(4.0, 4.0),
                openings: vec![window(0, [1.3, 2.7], [0.9, 2.4])],
                reflectances: [0.3, 0.6, 0.8],
                ..study
            }
            .room("well", 0.5);
            room.reflectances[THINGS as usize] = DVec3::splat(0.75);
            let corner = dvec3(1.1, 0.0, 1.8);
            let rise = 9.0;
            room.add(
                THINGS,
                quad(
                    corner - PLINTH * DVec3::Y,
                    DVec3::X * 1.8,
                    DVec3::Y * (rise + PLINTH),
                ),
            );
            for x in [1.1, 2.9] {
                let foot = dvec3(x, -PLINTH, 0.0);
                room.add(
                    THINGS,
                    quad(foot, DVec3::Z * 1.8, DVec3::Y * (rise + PLINTH)),
                );
            }
            let above = dvec3(1.1, study.height, 0.0);
            room.add(
                THINGS,
                quad(above, DVec3::X * 1.8, DVec3::Y * (rise - study.height)),
            );
            room.add(
                THINGS,
                quad(dvec3(1.1, 0.0, 0.0), DVec3::X * 1.8, DVec3::Z * 1.8),
            );
            room
        }
        "coloured" => {
            let mut room = Shell {
                thickness: 0.3,
                ..study
            }
            .room("coloured", 0.6);
            room.reflectances = vec![
                dvec3(0.25, 0.35, 0.2),
                dvec3(0.7, 0.35, 0.2),
                dvec3(0.6, 0.7, 0.85),
                dvec3(0.4, 0.4, 0.4),
            ];
            room
        }
        _ => return None,
    };
    Some(room)
}

/// The names of the rooms.
pub const ROOMS: [&str; 10] = [
    "study",
    "thick",
    "two windows",
    "long",
    "white",
    "obstructed",
    "furnished",
    "angle",
    "well",
    "coloured",
];

/// The coloured room with furniture, for pictures.
pub fn interior() -> Room {
    let mut room = room("furnished", 1.0).expect("it is in the list");
    room.reflectances = vec![
        dvec3(0.35, 0.25, 0.16),
        dvec3(0.62, 0.58, 0.45),
        dvec3(0.8, 0.8, 0.78),
        dvec3(0.2, 0.3, 0.45),
    ];
    room
}

/// Houses of three colours along a street from north to south.
pub fn street() -> Room {
    let mut street = Room {
        name: "street",
        triangles: Vec::new(),
        reflectances: vec![
            dvec3(0.6, 0.35, 0.25),
            dvec3(0.7, 0.68, 0.6),
            dvec3(0.25, 0.35, 0.45),
        ],
        ground: 0.25,
        points: Vec::new(),
    };
    // From south to north: width along the street, height; the two sides in turn.
    for (side, houses) in [
        (-1.0, [(9.0, 11.0), (7.0, 8.0), (10.0, 14.0), (8.0, 9.5)]),
        (1.0, [(8.0, 9.0), (10.0, 12.5), (6.0, 7.0), (9.0, 15.0)]),
    ] {
        let mut z = 6.0;
        for ((width, height), colour) in houses.into_iter().zip([0, 1, 2, 0]) {
            let (near, far) = (4.5 * side, 12.0 * side);
            let low = dvec3(f64::min(near, far), -PLINTH, z - width);
            let high = dvec3(f64::max(near, far), height, z);
            street.add((colour + u32::from(side > 0.0)) % 3, cuboid(low, high));
            z -= width + 1.2;
        }
    }
    // A house across the end.
    street.add(
        1,
        cuboid(dvec3(-14.0, -PLINTH, -46.0), dvec3(14.0, 10.0, -38.0)),
    );
    street
}

/// The radiance of the ground where it lies open to a sky and a sun [cd/m2].
pub fn open_ground(albedo: f64, sky: DVec3, sun: DVec3, toward: DVec3) -> DVec3 {
    albedo / PI * (sky + sun * toward.y.max(0.0))
}
