//! The values of a grid as a drawing: cells in false colours with isolines, over the outlines of the model.
//!
//! Level planes of one height are one plan, seen from above with -Z up on the paper; any other plane is drawn as its front is seen.
//! Outlines are where the model is cut by the plane, dark, glass blue.

use super::factor::Summary;
use super::grid::{Plane, Sensors};
use super::outline::Shape;
use super::section::section;
use crate::output::canvas::Color;
use crate::output::drawing::Drawing;
use crate::output::isolines::{Field, isolines};
use crate::output::lettering::Anchor;
use crate::output::scale::{Scale, short};
use crate::scene::Scene;
use crate::units::DEG;
use glam::{DVec2, DVec3, dvec2};

const INK: Color = [20, 20, 20];
const QUIET: Color = [110, 110, 110];
const GLASS: Color = [60, 130, 200];
const OUTLINE: Color = [70, 70, 70];

/// Width of the drawing, and the largest plan in it [units of the drawing].
const WIDTH: f64 = 1000.0;
const PLAN: [f64; 2] = [760.0, 640.0];
const MARGIN: f64 = 40.0;

/// Plans are cut no lower above their floor than this [m]: on the floor itself everything stands.
const LOWEST_CUT: f64 = 0.1;

/// What is written over a map.
#[derive(Debug, Clone, Default)]
pub struct Caption {
    /// The first line.
    pub title: String,
    /// Further lines: place, time, sky.
    pub lines: Vec<String>,
}

/// Draws the values of sensors, one each, in their order.
pub fn draw(
    scene: &Scene,
    sensors: &Sensors,
    values: &[f64],
    scale: &Scale,
    caption: &Caption,
) -> Drawing {
    let panels = panels(sensors);
    let frames: Vec<Frame> = panels
        .iter()
        .map(|planes| Frame::new(sensors, planes))
        .collect();
    let head = MARGIN + 30.0 + 20.0 * caption.lines.len() as f64;
    let height = |frame: &Frame| frame.size().y + 115.0;
    let total = head + frames.iter().map(height).sum::<f64>().max(400.0) + 20.0;
    let mut drawing = Drawing::new(WIDTH, total.ceil());
    drawing.text([MARGIN, MARGIN], 22.0, Anchor::Start, INK, &caption.title);
    for (i, line) in caption.lines.iter().enumerate() {
        let at = [MARGIN, MARGIN + 28.0 + 20.0 * i as f64];
        drawing.text(at, 13.0, Anchor::Start, QUIET, line);
    }
    legend(&mut drawing, scale, head + 20.0);
    let mut top = head;
    for (planes, mut frame) in panels.iter().zip(frames) {
        frame.top = top + 45.0;
        panel(&mut drawing, scene, sensors, values, scale, planes, &frame);
        top += height(&frame);
    }
    drawing
}

/// The planes that are drawn together: level ones of one height.
fn panels(sensors: &Sensors) -> Vec<Vec<usize>> {
    let mut panels: Vec<Vec<usize>> = Vec::new();
    for (i, plane) in sensors.planes.iter().enumerate() {
        let is_same = |panel: &&mut Vec<usize>| {
            let other = &sensors.planes[panel[0]];
            plane.is_level() && other.is_level() && (plane.origin.y - other.origin.y).abs() < 0.02
        };
        match panels.iter_mut().find(is_same) {
            Some(panel) => panel.push(i),
            None => panels.push(vec![i]),
        }
    }
    panels
}

/// Where a plan lies on the paper.
struct Frame {
    u: DVec3,
    v: DVec3,
    /// The least and the greatest coordinates along them that are shown [m].
    low: DVec2,
    high: DVec2,
    /// Units of the drawing in a metre.
    scale: f64,
    top: f64,
}

impl Frame {
    fn new(sensors: &Sensors, planes: &[usize]) -> Self {
        let first = &sensors.planes[planes[0]];
        let (u, v) = match first.is_level() {
            true => (DVec3::X, DVec3::NEG_Z),
            false => (first.u, first.v),
        };
        let own = planes.iter().map(|i| &sensors.planes[*i]);
        let corners = own.flat_map(|plane| {
            let sides = plane.whole.sides();
            sides
                .map(|[corner, _]| plane.at(corner))
                .map(|p| dvec2(p.dot(u), p.dot(v)))
        });
        let (low, high) = corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let around = (0.06 * (high - low).max_element()).clamp(0.2, 3.0);
        let (low, high) = (low - around, high + around);
        let scale = (DVec2::from(PLAN) / (high - low)).min_element();
        Frame {
            u,
            v,
            low,
            high,
            scale,
            top: 0.0,
        }
    }

    fn size(&self) -> DVec2 {
        self.scale * (self.high - self.low)
    }

    /// Coordinates [m] on the paper.
    fn flat(&self, place: DVec2) -> [f64; 2] {
        let at = self.scale * (place - self.low);
        [MARGIN + at.x, self.top + self.size().y - at.y]
    }

    /// A place of the scene on the paper.
    fn at(&self, place: DVec3) -> [f64; 2] {
        self.flat(dvec2(place.dot(self.u), place.dot(self.v)))
    }
}

fn panel(
    drawing: &mut Drawing,
    scene: &Scene,
    sensors: &Sensors,
    values: &[f64],
    scale: &Scale,
    planes: &[usize],
    frame: &Frame,
) {
    let of = |i: usize| {
        sensors
            .points
            .iter()
            .zip(values)
            .filter(move |(s, _)| s.plane == i)
    };
    let first = &sensors.planes[planes[0]];
    let names: Vec<&str> = planes
        .iter()
        .map(|i| sensors.planes[*i].name.as_str())
        .collect();
    let names = match names.len() {
        0..=4 => names.join(", "),
        count => format!("{} and {} more", names[..3].join(", "), count - 3),
    };
    let what = match first.is_level() {
        true => format!(
            "{names}: plane {} m above the floor, at {:.2} m",
            short(first.above),
            first.origin.y
        ),
        false => format!("{names}: seen from its front"),
    };
    drawing.text([MARGIN, frame.top - 30.0], 14.0, Anchor::Start, INK, what);
    let weighed: Vec<(f64, f64)> = (planes.iter())
        .flat_map(|i| of(*i).map(|(sensor, value)| (*value, sensor.area)))
        .collect();
    if let Some(s) = Summary::new(&weighed) {
        let [mean, median, minimum, maximum] = [s.mean, s.median, s.minimum, s.maximum].map(short);
        let text = format!(
            "mean {mean}, median {median}, least {minimum}, greatest {maximum} {}; uniformity {}; {} sensors on {} m2",
            scale.unit,
            short(s.uniformity),
            s.sensors,
            short(s.area)
        );
        drawing.text([MARGIN, frame.top - 12.0], 12.0, Anchor::Start, QUIET, text);
    }
    for i in planes {
        let plane = &sensors.planes[*i];
        for (sensor, value) in of(*i) {
            let cell = Shape::of_contour(plane.cell(sensor.cell).to_vec());
            for shape in plane.outline.within(&cell).shapes() {
                let Some(contour) = shape.contours().next() else {
                    continue;
                };
                let corners = contour
                    .iter()
                    .map(|p| frame.at(plane.at((*p).into())))
                    .collect();
                let tip = format!("{} {}", short(*value), scale.unit);
                let color = scale.color(*value);
                drawing.shape(corners, color, 0.5, color, tip);
            }
        }
    }
    for i in planes {
        lines(drawing, &sensors.planes[*i], of(*i), scale, frame);
    }
    outlines(drawing, scene, sensors, planes, frame);
    scale_bar(drawing, frame);
    if first.is_level() {
        north(drawing, scene.north_deg, frame);
    }
}

/// Isolines with their values.
fn lines<'a>(
    drawing: &mut Drawing,
    plane: &Plane,
    sensors: impl Iterator<Item = (&'a super::grid::Sensor, &'a f64)>,
    scale: &Scale,
    frame: &Frame,
) {
    let [columns, rows] = plane.cells.map(|n| n as usize);
    let mut values = vec![None; columns * rows];
    for (sensor, value) in sensors {
        let [column, row] = sensor.cell.map(|n| n as usize);
        values[row * columns + column] = Some(*value);
    }
    let field = Field {
        columns,
        values: &values,
    };
    let step = DVec2::from(plane.step);
    let place = |at: [f64; 2]| frame.at(plane.at(step * (DVec2::from(at) + 0.5)));
    let mut labels: Vec<[f64; 2]> = Vec::new();
    let apart = |a: [f64; 2], b: [f64; 2]| DVec2::from(a).distance(DVec2::from(b));
    for level in scale.levels() {
        let mut all: Vec<Vec<[f64; 2]>> = isolines(&field, level)
            .into_iter()
            .map(|line| line.into_iter().map(place).collect())
            .collect();
        let length = |line: &[[f64; 2]]| line.windows(2).map(|p| apart(p[0], p[1])).sum::<f64>();
        all.sort_by(|a, b| length(b).total_cmp(&length(a)));
        for line in &all {
            drawing.line(line.clone(), 1.1, INK, None);
        }
        // The longest line tells the value, where it has room.
        for line in all.iter().filter(|line| length(line) > 40.0).take(2) {
            let count = line.len();
            let spots = [
                count / 2,
                count / 3,
                2 * count / 3,
                count / 5,
                4 * count / 5,
            ];
            let is_free = |at: &[f64; 2]| labels.iter().all(|other| apart(*at, *other) > 34.0);
            if let Some(at) = spots.iter().map(|i| line[*i]).find(is_free) {
                drawing.text(at, 12.0, Anchor::Middle, INK, short(level));
                labels.push(at);
            }
        }
    }
}

/// The model where the plane cuts it, and the edge of the floor.
fn outlines(
    drawing: &mut Drawing,
    scene: &Scene,
    sensors: &Sensors,
    planes: &[usize],
    frame: &Frame,
) {
    let first = &sensors.planes[planes[0]];
    let lift = match first.is_level() {
        true => (LOWEST_CUT - first.above).max(0.0),
        // In front of the surface itself.
        false => (0.01 - first.above).max(0.0),
    };
    let normal = first.normal();
    for (ends, is_glass) in section(scene, first.origin + lift * normal, normal) {
        let [a, b] = ends.map(|p| dvec2(p.dot(frame.u), p.dot(frame.v)));
        if let Some([a, b]) = clipped([a, b], frame.low, frame.high) {
            let (width, color) = if is_glass { (1.6, GLASS) } else { (2.2, INK) };
            drawing.line(vec![frame.flat(a), frame.flat(b)], width, color, None);
        }
    }
    for i in planes {
        let plane = &sensors.planes[*i];
        for [a, b] in plane.whole.sides() {
            let ends = [a, b].map(|p| frame.at(plane.at(p)));
            drawing.line(ends.to_vec(), 0.8, OUTLINE, None);
        }
    }
}

/// The part of a segment that lies in a box (Liang & Barsky 1984).
fn clipped([a, b]: [DVec2; 2], low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
    let way = b - a;
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let ends = [low[axis] - a[axis], high[axis] - a[axis]];
        if way[axis] == 0.0 {
            if ends[0] > 0.0 || ends[1] < 0.0 {
                return None;
            }
            continue;
        }
        let [s, t] = ends.map(|end| end / way[axis]);
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (from < to).then(|| [a + from * way, a + to * way])
}

fn scale_bar(drawing: &mut Drawing, frame: &Frame) {
    // The longest round length below a quarter of the plan.
    let most = 0.25 * frame.size().x.max(200.0) / frame.scale;
    let unit = 10f64.powf(most.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|s| s * unit);
    let length = steps.into_iter().find(|s| *s <= most).unwrap_or(unit);
    let y = frame.top + frame.size().y + 22.0;
    let at = |x: f64| MARGIN + x * frame.scale;
    for (i, pair) in [[0.0, 0.5], [0.5, 1.0]].into_iter().enumerate() {
        let [a, b] = pair.map(|share| at(share * length));
        let fill = if i == 0 { INK } else { [255; 3] };
        drawing.shape(
            vec![[a, y - 3.0], [b, y - 3.0], [b, y + 3.0], [a, y + 3.0]],
            fill,
            0.8,
            INK,
            "",
        );
    }
    drawing.text(
        [at(length) + 8.0, y],
        12.0,
        Anchor::Start,
        INK,
        format!("{} m", short(length)),
    );
}

/// An arrow toward north. Of a plan with -Z up on the paper, whose azimuth is given [degrees].
fn north(drawing: &mut Drawing, up_deg: f64, frame: &Frame) {
    let centre = [
        MARGIN + frame.size().x - 26.0,
        frame.top + frame.size().y + 42.0,
    ];
    // North lies as far to the left of up as up lies to the right of north.
    let (sin, cos) = (-up_deg * DEG).sin_cos();
    let at = |x: f64, y: f64| [centre[0] + x * cos + y * sin, centre[1] + x * sin - y * cos];
    drawing.shape(
        vec![at(0.0, 18.0), at(7.0, -12.0), at(0.0, -6.0)],
        INK,
        1.0,
        INK,
        "north",
    );
    drawing.shape(
        vec![at(0.0, 18.0), at(0.0, -6.0), at(-7.0, -12.0)],
        [255; 3],
        1.0,
        INK,
        "north",
    );
    drawing.text(at(0.0, 26.0), 12.0, Anchor::Middle, INK, "N");
}

fn legend(drawing: &mut Drawing, scale: &Scale, top: f64) {
    let left = WIDTH - 150.0;
    let height = 320.0;
    let (low, bar) = (top + 40.0 + height, [left, left + 24.0]);
    drawing.text([left, top], 13.0, Anchor::Start, INK, &scale.quantity);
    let unit = match scale.is_log() {
        true => format!("[{}], by ratios", scale.unit),
        false => format!("[{}]", scale.unit),
    };
    drawing.text([left, top + 18.0], 12.0, Anchor::Start, QUIET, unit);
    let at = |place: f64| low - place * height;
    let steps = 64;
    for i in 0..steps {
        let [a, b] = [i, i + 1].map(|i| f64::from(i) / f64::from(steps));
        let value = scale.value(0.5 * (a + b));
        let color = scale.color(value);
        let corners = vec![
            [bar[0], at(a)],
            [bar[1], at(a)],
            [bar[1], at(b)],
            [bar[0], at(b)],
        ];
        drawing.shape(
            corners,
            color,
            0.5,
            color,
            format!("{} {}", short(value), scale.unit),
        );
    }
    for level in scale.levels() {
        let y = at(scale.place(level));
        drawing.line(vec![[bar[1], y], [bar[1] + 6.0, y]], 1.0, INK, None);
        drawing.text([bar[1] + 10.0, y], 12.0, Anchor::Start, INK, short(level));
    }
}
