//! One side of a plane, cut into cells: squares that are quartered where something small stands near, and cut along what stands on
//! them.
//!
//! A patch is a part of a cell. Light that falls on one side of a wall must not come out of the other, so that a cell on which a
//! wall stands is cut along the wall's foot, however thin the wall is.

use super::planes::{Plane, Surfaces};
use super::tiles::{FINEST, Tile};
use crate::conditions::Conditions;
use crate::error::Result;
use crate::task::Task;
use glam::{DVec2, DVec3};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// One side of a plane, or of the ground.
pub(super) struct Face {
    /// The plane, with its normal on this side.
    pub plane: Plane,
    /// The lower corner and the side of the square that is quartered [m].
    low: DVec2,
    side: f64,
    nodes: Vec<Node>,
    /// The leaves.
    pub cells: Vec<Cell>,
}

#[derive(Clone, Copy)]
enum Node {
    /// The first of four: by x, then by y.
    Quarters(u32),
    Leaf(u32),
    /// Nothing of the surface is there.
    Empty,
}

/// A square of a face.
pub(super) struct Cell {
    pub side: f64,
    /// Lines along which it is cut: a unit normal in the plane, and how far the line is from the origin.
    pub cuts: Vec<(DVec2, f64)>,
    pub parts: Vec<Part>,
}

/// What lies on one side of each of a cell's cuts.
pub(super) struct Part {
    /// One bit for each cut: on which side.
    pub code: u32,
    /// What is there of the surface: convex polygons, and the triangle of each (the ground has none).
    pub pieces: Vec<(u32, Vec<DVec2>)>,
    pub area: f64,
    /// The rectangle around it [m].
    pub low: DVec2,
    pub high: DVec2,
    /// Whether it fills that rectangle.
    is_full: bool,
    /// The level of its finest tiles.
    pub depth: u32,
    /// Its number among all patches.
    pub patch: u32,
}

/// The level of the finest tiles of a face's finest cells; larger cells have tiles of the same size, as far as tiles go.
const TILES: u32 = 3;

/// What of the rectangle around a part must be there to count as all of it [1].
const FULL: f64 = 1.0 - 1e-6;

/// The most lines along which a cell is cut.
const MOST_CUTS: usize = 4;

impl Cell {
    fn code(&self, at: DVec2) -> u32 {
        code(&self.cuts, at)
    }

    /// The part of a point; the largest one where it lies on nothing.
    pub fn part(&self, at: DVec2) -> Option<&Part> {
        let code = self.code(at);
        self.parts
            .iter()
            .find(|part| part.code == code)
            .or_else(|| self.parts.iter().max_by(|a, b| a.area.total_cmp(&b.area)))
    }
}

impl Part {
    /// Whether there is surface at a point of the rectangle around it.
    pub fn covers(&self, at: DVec2) -> bool {
        self.is_full || self.pieces.iter().any(|(_, polygon)| holds(polygon, at))
    }

    /// The tile around a point that reaches no farther than `width` [m] from its middle, or the finest one.
    pub fn tile(&self, at: DVec2, width: f64) -> Tile {
        let size = self.high - self.low;
        let (mut level, mut side) = (0, 0.5 * size.max_element());
        while side > width && level < self.depth {
            (level, side) = (level + 1, 0.5 * side);
        }
        match level {
            0 => Tile::WHOLE,
            _ => Tile::at(level, (at - self.low) / size),
        }
    }

    /// Counts what lies upon each other once (a carpet in the floor's plane): the area is that of the union, by points.
    fn count_once(&mut self) {
        let size = self.high - self.low;
        if self.pieces.len() < 2 || self.area <= 1.0001 * size.x * size.y {
            return;
        }
        let (mut there, mut times) = (0, 0);
        for k in 0..1024 {
            let at = DVec2::new(f64::from(k % 32) + 0.5, f64::from(k / 32) + 0.5) / 32.0;
            let at = self.low + at * size;
            let count = self.pieces.iter().filter(|(_, p)| holds(p, at)).count();
            there += usize::from(count > 0);
            times += count;
        }
        if times > 0 {
            self.area *= there as f64 / times as f64;
        }
    }
}

fn code(cuts: &[(DVec2, f64)], at: DVec2) -> u32 {
    let side = |(k, (normal, distance)): (usize, &(DVec2, f64))| {
        u32::from(normal.dot(at) > *distance) << k
    };
    cuts.iter().enumerate().map(side).sum()
}

/// A square to be quartered or kept.
struct Open {
    face: usize,
    node: usize,
    low: DVec2,
    side: f64,
    pieces: Vec<(u32, Vec<DVec2>)>,
}

impl Face {
    /// One side of a plane, as one square.
    fn whole(plane: Plane, low: DVec2, side: f64) -> Self {
        Face {
            plane,
            low,
            side,
            nodes: vec![Node::Empty],
            cells: Vec::new(),
        }
    }

    /// The side of the square [m].
    pub fn side(&self) -> f64 {
        self.side
    }

    /// The squares that it is cut into: the lower corner and the side of each [m], and what of the surface is there.
    pub fn squares(&self) -> Vec<(DVec2, f64, Vec<Vec<DVec2>>)> {
        let mut squares = Vec::new();
        let mut open = vec![(0, self.low, self.side)];
        while let Some((node, low, side)) = open.pop() {
            match self.nodes[node] {
                Node::Empty => squares.push((low, side, Vec::new())),
                Node::Leaf(cell) => {
                    let parts = self.cells[cell as usize].parts.iter();
                    let pieces = parts.flat_map(|part| &part.pieces);
                    let pieces = pieces.map(|(_, polygon)| polygon.clone());
                    squares.push((low, side, pieces.collect()));
                }
                Node::Quarters(first) => {
                    let half = 0.5 * side;
                    for (quarter, x, y) in
                        [(0, 0.0, 0.0), (1, 1.0, 0.0), (2, 0.0, 1.0), (3, 1.0, 1.0)]
                    {
                        let low = low + half * DVec2::new(x, y);
                        open.push((first as usize + quarter, low, half));
                    }
                }
            }
        }
        squares
    }

    /// Whether there is surface at a point.
    pub fn covers(&self, at: DVec2) -> bool {
        let parts = self.cell(at).into_iter().flat_map(|(_, cell)| &cell.parts);
        let mut pieces = parts.flat_map(|part| &part.pieces);
        pieces.any(|(_, polygon)| holds(polygon, at))
    }

    /// The patch at a point.
    pub fn patch(&self, at: DVec2) -> Option<u32> {
        Some(self.cell(at)?.1.part(at)?.patch)
    }

    /// Whether no cut of the cells of either point runs between two points that are near to each other.
    pub fn is_uncut_between(&self, a: DVec2, b: DVec2) -> bool {
        [a, b].into_iter().all(|p| {
            self.cell(p).is_none_or(|(_, cell)| {
                let side = |normal: &DVec2, distance: f64, p: DVec2| normal.dot(p) > distance;
                let mut cuts = cell.cuts.iter();
                let slack = 1e-9 * cell.side;
                cuts.all(|(n, d)| (n.dot(a) - d).abs() > slack && side(n, *d, a) == side(n, *d, b))
            })
        })
    }

    /// The cell of a point.
    pub fn cell(&self, at: DVec2) -> Option<(u32, &Cell)> {
        let (mut low, mut side) = (self.low, self.side);
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Empty => return None,
                Node::Leaf(cell) => return Some((cell, &self.cells[cell as usize])),
                Node::Quarters(first) => {
                    side *= 0.5;
                    let right = at.x >= low.x + side;
                    let upper = at.y >= low.y + side;
                    low +=
                        side * DVec2::new(f64::from(u8::from(right)), f64::from(u8::from(upper)));
                    node = first as usize + usize::from(right) + 2 * usize::from(upper);
                }
            }
        }
    }
}

/// Both sides of all planes, and the ground, cut into cells.
pub(super) fn faces(
    conditions: &Conditions,
    surfaces: &Surfaces,
    share: f64,
    most: usize,
    task: Task<'_>,
) -> Result<(Vec<Face>, bool)> {
    let mut faces = Vec::new();
    let mut queue = Queue::default();
    let mut add = |plane: Plane, low: DVec2, side: f64, pieces: Vec<(u32, Vec<DVec2>)>| {
        let (face, node) = (faces.len(), 0);
        queue.push(Open {
            face,
            node,
            low,
            side,
            pieces,
        });
        faces.push(Face::whole(plane, low, side));
    };
    for plane in &surfaces.planes {
        let vertices = plane
            .triangles
            .iter()
            .flat_map(|t| conditions.scene.mesh.corners(*t));
        let heights = vertices.map(|p| plane.height(p));
        let (lowest, highest) = heights.fold((0.0f64, 0.0f64), |(low, high), height| {
            (low.min(height), high.max(height))
        });
        for (normal, rise) in [(plane.normal, highest), (-plane.normal, -lowest)] {
            let piece = |triangle: &u32| {
                let flat = conditions
                    .scene
                    .mesh
                    .corners(*triangle)
                    .map(|p| plane.flat(p));
                (*triangle, flat.to_vec())
            };
            // Positions are rounded in files: on each side it lies on the highest of its triangles, so that none of them shades it.
            let own = Plane {
                origin: plane.origin + rise * normal,
                normal,
                triangles: Vec::new(),
                ..plane.clone()
            };
            let side = plane.extent();
            let low = 0.5 * (plane.low + plane.high) - 0.5 * side;
            add(own, low, side, plane.triangles.iter().map(piece).collect());
        }
    }
    if let Some(ground) = conditions.ground {
        let (mut low, mut high) = conditions.geometry.bounds();
        for lamp in conditions.lamps.iter() {
            let at = lamp.middle();
            low = low.min(at.with_y(ground.height));
            high = high.max(at);
        }
        let middle = 0.5 * (low + high);
        let origin = DVec3::new(middle.x, ground.height, middle.z);
        let side = GROUND * (high - low).length().max(1e-3);
        let low = DVec2::splat(-0.5 * side);
        let square = vec![
            low,
            low + DVec2::new(side, 0.0),
            low + side,
            low + DVec2::new(0.0, side),
        ];
        let pieces = vec![(GROUND_TRIANGLE, square)];
        add(Plane::new(origin, DVec3::Y), low, side, pieces);
    }
    let mut leaves = faces.len();
    let mut coarse = false;
    while let Some(square) = queue.pop() {
        task.check()?;
        let number = square.face;
        let face = &mut faces[number];
        let wants = wants_quarters(conditions, face, surfaces, &square, share);
        if !wants || leaves + 3 > most {
            coarse |= wants;
            let cell = keep(conditions, face, surfaces, square);
            if let Some((node, cell)) = cell {
                face.nodes[node] = Node::Leaf(face.cells.len() as u32);
                face.cells.push(cell);
            }
            continue;
        }
        let first = face.nodes.len();
        face.nodes[square.node] = Node::Quarters(first as u32);
        face.nodes.extend([Node::Empty; 4]);
        let half = 0.5 * square.side;
        leaves -= 1;
        for quarter in 0..4 {
            let (x, y) = (quarter % 2, quarter / 2);
            let low = square.low + half * DVec2::new(x as f64, y as f64);
            let pieces: Vec<_> = square
                .pieces
                .iter()
                .filter_map(|(triangle, piece)| {
                    let inside = within(piece, low, low + half);
                    (area(&inside) > 0.0).then_some((*triangle, inside))
                })
                .collect();
            if !pieces.is_empty() {
                leaves += 1;
                queue.push(Open {
                    face: number,
                    node: first + quarter,
                    low,
                    side: half,
                    pieces,
                });
            }
        }
    }
    for face in &mut faces {
        let finest = face.cells.iter().map(|cell| cell.side);
        let finest = finest.fold(f64::INFINITY, f64::min);
        for cell in &mut face.cells {
            let coarser = (cell.side / finest).log2().round() as u32;
            for part in &mut cell.parts {
                part.depth = (TILES + coarser).min(FINEST);
            }
        }
    }
    Ok((faces, coarse))
}

/// Squares, the largest first, so that where there are too many all are coarse alike; of one size those that came first.
#[derive(Default)]
struct Queue {
    order: BinaryHeap<(Side, Reverse<usize>)>,
    squares: Vec<Option<Open>>,
}

impl Queue {
    fn push(&mut self, square: Open) {
        self.order
            .push((Side(square.side), Reverse(self.squares.len())));
        self.squares.push(Some(square));
    }

    fn pop(&mut self) -> Option<Open> {
        let (_, Reverse(index)) = self.order.pop()?;
        self.squares[index].take()
    }
}

/// The side of the square of ground that has patches of its own, over the scene's diagonal.
const GROUND: f64 = 16.0;

/// Of the ground's square, no lamp wants squares smaller than this share [1].
const FLAT: f64 = 1e-3;

/// Stands for the ground where a triangle's number is asked for.
pub(super) const GROUND_TRIANGLE: u32 = u32::MAX;

#[derive(PartialEq)]
struct Side(f64);

impl PartialOrd for Side {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Eq for Side {}

impl Ord for Side {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Whether a square is larger than its share of something that stands on it, or no farther from it than it is wide; one of the ground
/// also than the height of a lamp above it.
fn wants_quarters(
    conditions: &Conditions,
    face: &Face,
    surfaces: &Surfaces,
    square: &Open,
    share: f64,
) -> bool {
    let least = square.side / share;
    let own = square.pieces.iter().any(|(triangle, _)| {
        let size = surfaces.sizes.get(*triangle as usize);
        size.is_some_and(|size| *size < least)
    });
    if own {
        return true;
    }
    let (mut low, mut high) = around(&square.pieces);
    let plane = &face.plane;
    let mut reach = square.side;
    if square.pieces.iter().any(|(t, _)| *t == GROUND_TRIANGLE) {
        // What stands high above the ground shades it far away.
        reach *= 2.0;
        (low, high) = (low - 0.5 * reach, high + 0.5 * reach);
        let under_lamp = conditions.lamps.iter().any(|lamp| {
            let (at, height) = (plane.flat(lamp.middle()), plane.height(lamp.middle()));
            // One that stands on the ground has no height.
            height >= 0.0
                && square.side > height.max(FLAT * face.side)
                && at.cmpge(low).all()
                && at.cmple(high).all()
        });
        if under_lamp {
            return true;
        }
    }
    let bounds = plane.space([low, high], [0.0, reach]);
    // What only touches the border of a square stands near its neighbour too.
    surfaces.holds_smaller(bounds.0, bounds.1, least)
}

/// The rectangle around pieces.
fn around(pieces: &[(u32, Vec<DVec2>)]) -> (DVec2, DVec2) {
    let points = pieces.iter().flat_map(|(_, piece)| piece);
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
        (low.min(*p), high.max(*p))
    })
}

/// Makes a cell of a square: cuts it, and sorts the pieces into its parts.
fn keep(
    conditions: &Conditions,
    face: &Face,
    surfaces: &Surfaces,
    square: Open,
) -> Option<(usize, Cell)> {
    let cuts = cuts(conditions, face, surfaces, &square);
    let mut parts: Vec<Part> = Vec::new();
    let tiny = 1e-9 * square.side * square.side;
    for (triangle, piece) in square.pieces {
        let mut split = vec![piece];
        for (normal, distance) in &cuts {
            split = split
                .iter()
                .flat_map(|p| [clip(p, *normal, *distance), clip(p, -*normal, -*distance)])
                .filter(|p| area(p) > tiny)
                .collect();
        }
        for piece in split {
            let size = area(&piece);
            if size <= tiny {
                continue;
            }
            let middle = piece.iter().copied().sum::<DVec2>() / piece.len() as f64;
            let code = code(&cuts, middle);
            let at = match parts.iter().position(|part| part.code == code) {
                Some(at) => at,
                None => {
                    parts.push(Part {
                        code,
                        pieces: Vec::new(),
                        area: 0.0,
                        low: DVec2::INFINITY,
                        high: DVec2::NEG_INFINITY,
                        is_full: false,
                        depth: 0,
                        patch: u32::MAX,
                    });
                    parts.len() - 1
                }
            };
            let part = &mut parts[at];
            part.area += size;
            for p in &piece {
                part.low = part.low.min(*p);
                part.high = part.high.max(*p);
            }
            part.pieces.push((triangle, piece));
        }
    }
    if parts.is_empty() {
        return None;
    }
    for part in &mut parts {
        part.count_once();
        let size = part.high - part.low;
        part.is_full = part.area >= FULL * size.x * size.y;
    }
    let cell = Cell {
        side: square.side,
        cuts,
        parts,
    };
    Some((square.node, cell))
}

/// The lines on which what stands on a square meets it, the longest first.
fn cuts(
    conditions: &Conditions,
    face: &Face,
    surfaces: &Surfaces,
    square: &Open,
) -> Vec<(DVec2, f64)> {
    let plane = &face.plane;
    let (low, high) = (square.low, square.low + square.side);
    let lift = 1e-4 * square.side;
    let bounds = plane.space([low, high], [lift, 2.0 * lift]);
    // Lines by direction and distance, and how much of them lies in the square.
    let mut lines: Vec<(DVec2, f64, f64)> = Vec::new();
    surfaces.within(bounds.0, bounds.1, |triangle| {
        let corners = conditions.scene.mesh.corners(triangle);
        let heights = corners.map(|p| plane.height(p) - lift);
        let mut ends: Vec<DVec2> = Vec::new();
        for i in 0..3 {
            let (a, b) = (heights[i], heights[(i + 1) % 3]);
            if (a > 0.0) != (b > 0.0) {
                let p = corners[i].lerp(corners[(i + 1) % 3], a / (a - b));
                ends.push(plane.flat(p));
            }
        }
        let [Some(a), Some(b)] = [ends.first(), ends.get(1)] else {
            return false;
        };
        let Some([a, b]) = segment_within(*a, *b, low, high) else {
            return false;
        };
        let length = a.distance(b);
        if length <= 1e-6 * square.side {
            return false;
        }
        let normal = (b - a).perp() / length;
        let normal = match normal.x.abs() > 1e-9 {
            true => normal * normal.x.signum(),
            false => normal * normal.y.signum(),
        };
        let distance = normal.dot(0.5 * (a + b));
        let known = lines
            .iter_mut()
            .find(|(n, d, _)| n.dot(normal) > 0.999 && (*d - distance).abs() < 0.01 * square.side);
        match known {
            Some((_, _, sum)) => *sum += length,
            None => lines.push((normal, distance, length)),
        }
        false
    });
    // A line along the border cuts nothing off.
    let middle = 0.5 * (low + high);
    lines.retain(|(normal, distance, length)| {
        let reach = 0.5 * square.side * (normal.x.abs() + normal.y.abs());
        *length > 0.1 * square.side && (normal.dot(middle) - distance).abs() < 0.9999 * reach
    });
    lines.sort_by(|a, b| b.2.total_cmp(&a.2));
    lines.truncate(MOST_CUTS);
    lines.into_iter().map(|(n, d, _)| (n, d)).collect()
}

/// The part of a line segment inside a rectangle.
fn segment_within(a: DVec2, b: DVec2, low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    let way = b - a;
    for axis in 0..2 {
        if way[axis] == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let (p, q) = (
            (low[axis] - a[axis]) / way[axis],
            (high[axis] - a[axis]) / way[axis],
        );
        from = from.max(p.min(q));
        to = to.min(p.max(q));
    }
    (from < to).then(|| [a + from * way, a + to * way])
}

/// The part of a convex polygon where `normal . p <= distance` (Sutherland & Hodgman 1974).
pub(super) fn clip(polygon: &[DVec2], normal: DVec2, distance: f64) -> Vec<DVec2> {
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (p, q) = (normal.dot(a) - distance, normal.dot(b) - distance);
        if p <= 0.0 {
            inside.push(a);
        }
        if (p < 0.0 && q > 0.0) || (p > 0.0 && q < 0.0) {
            inside.push(a.lerp(b, p / (p - q)));
        }
    }
    inside
}

/// The part of a convex polygon in a rectangle.
pub(super) fn within(polygon: &[DVec2], low: DVec2, high: DVec2) -> Vec<DVec2> {
    let sides = [
        (DVec2::X, high.x),
        (DVec2::NEG_X, -low.x),
        (DVec2::Y, high.y),
        (DVec2::NEG_Y, -low.y),
    ];
    sides
        .into_iter()
        .fold(polygon.to_vec(), |p, (normal, distance)| {
            clip(&p, normal, distance)
        })
}

/// Whether a convex polygon holds a point, to rounding.
pub(super) fn holds(polygon: &[DVec2], at: DVec2) -> bool {
    let sides = (0..polygon.len()).map(|i| {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        (b - a).perp_dot(at - a)
    });
    let (low, high) = sides.fold((0.0f64, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
    low >= -1e-12 * high || high <= -1e-12 * low
}

/// The area of a polygon.
pub(super) fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else {
        return 0.0;
    };
    let fan = polygon[1..].windows(2);
    let twice: f64 = fan.map(|p| (p[0] - first).perp_dot(p[1] - first)).sum();
    0.5 * twice.abs()
}
