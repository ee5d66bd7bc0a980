//! Where short labels find room beside their points, one after the other.

use tyndall::units::DEG;

/// Lengths of a label's way from its point [units of the drawing], each with what it costs.
const RINGS: [(f64, f64); 4] = [(9.0, 0.0), (16.0, 6.0), (26.0, 14.0), (40.0, 24.0)];

/// From what length on a label is tied to its point by a line.
pub const TIED: f64 = 20.0;

/// The highest cost of a label that is still drawn: a line of the plot across it costs as much as it is long.
const HIGHEST_COST: f64 = 30.0;

/// A rectangle: left, top, right, bottom.
type Area = [f64; 4];

/// What is occupied already.
pub struct Room {
    frame: Area,
    taken: Vec<Area>,
    lines: Vec<[[f64; 2]; 2]>,
}

/// Where a label stands.
pub struct Place {
    pub centre: [f64; 2],
    /// Its way from the point.
    pub length: f64,
}

impl Room {
    /// Room inside a frame.
    pub fn new(frame: Area) -> Self {
        Self {
            frame,
            taken: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Occupies what lies around a point.
    pub fn mark(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.taken
            .push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Draws a line, which labels should not cross.
    pub fn line(&mut self, points: &[[f64; 2]]) {
        self.lines.extend(points.windows(2).map(|p| [p[0], p[1]]));
    }

    /// Occupies the area of a size around a place, if it is free and inside the frame.
    pub fn claim(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2]) -> bool {
        let area = [
            x - 0.5 * width,
            y - 0.5 * height,
            x + 0.5 * width,
            y + 0.5 * height,
        ];
        let is_free = within(area, self.frame) && !self.taken.iter().any(|t| meet(area, *t));
        if is_free {
            self.taken.push(area);
        }
        is_free
    }

    /// The best place for a label of a width and a height, which it then occupies; `None` where every place costs too much.
    pub fn place(&mut self, at: [f64; 2], size: [f64; 2]) -> Option<Place> {
        let mut best: Option<(f64, Place, Area)> = None;
        for (length, ring_cost) in RINGS {
            for step in 0..16 {
                // To the upper right first.
                let turn = 22.5 * f64::from(step) - 180.0;
                let (sin, cos) = ((turn - 45.0) * DEG).sin_cos();
                let centre = [
                    at[0] + cos * (length + 0.5 * size[0]),
                    at[1] + sin * (length + 0.5 * size[1]),
                ];
                let area = [
                    centre[0] - 0.5 * size[0],
                    centre[1] - 0.5 * size[1],
                    centre[0] + 0.5 * size[0],
                    centre[1] + 0.5 * size[1],
                ];
                if !within(area, self.frame) || self.taken.iter().any(|t| meet(area, *t)) {
                    continue;
                }
                let crossed: f64 = self.lines.iter().map(|line| inside(*line, area)).sum();
                let cost = ring_cost + crossed + 0.03 * turn.abs();
                if cost < HIGHEST_COST && best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                    best = Some((cost, Place { centre, length }, area));
                }
            }
        }
        best.map(|(_, place, area)| {
            self.taken.push(area);
            place
        })
    }
}

fn within(a: Area, b: Area) -> bool {
    a[0] >= b[0] && a[1] >= b[1] && a[2] <= b[2] && a[3] <= b[3]
}

fn meet(a: Area, b: Area) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// The length of a line inside an area (Liang and Barsky 1984).
fn inside([a, b]: [[f64; 2]; 2], area: Area) -> f64 {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let way = b[axis] - a[axis];
        let ends = [area[axis] - a[axis], area[axis + 2] - a[axis]];
        if way == 0.0 {
            if ends[0] > 0.0 || ends[1] < 0.0 {
                return 0.0;
            }
        } else {
            let [s, t] = ends.map(|end| end / way);
            from = from.max(s.min(t));
            to = to.min(s.max(t));
        }
    }
    (to - from).max(0.0) * (b[0] - a[0]).hypot(b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_off_lines() {
        assert!((inside([[-1.0, 1.0], [3.0, 1.0]], [0.0, 0.0, 2.0, 2.0]) - 2.0).abs() < 1e-12);
        assert_eq!(inside([[-1.0, 3.0], [3.0, 3.0]], [0.0, 0.0, 2.0, 2.0]), 0.0);

        let mut room = Room::new([0.0, 0.0, 200.0, 200.0]);
        room.mark([100.0, 100.0], 5.0);
        room.line(&[[0.0, 100.0], [200.0, 100.0]]);
        let mut areas: Vec<Area> = Vec::new();
        while let Some(place) = room.place([100.0, 100.0], [40.0, 14.0]) {
            let [x, y] = place.centre;
            let area = [x - 20.0, y - 7.0, x + 20.0, y + 7.0];
            assert!(areas.iter().all(|other| !meet(area, *other)));
            assert!(inside([[0.0, 100.0], [200.0, 100.0]], area) < HIGHEST_COST);
            areas.push(area);
        }
        assert!((4..20).contains(&areas.len()), "{}", areas.len());
        // No room at all: no label.
        assert!(
            Room::new([0.0, 0.0, 30.0, 30.0])
                .place([15.0, 15.0], [40.0, 14.0])
                .is_none()
        );
    }
}
