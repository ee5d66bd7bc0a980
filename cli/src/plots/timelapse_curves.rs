//! What a time-lapse has planned, over its frames: the sun's path, and the exposure.

use super::contact_sheet::Clock;
use chrono::{DateTime, FixedOffset, TimeDelta, Timelike};
use tyndall::output::canvas::Color;
use tyndall::output::drawing::Drawing;
use tyndall::output::lettering::Anchor;
use tyndall::timelapse::plan::{ExposurePlan, FrameLine, Header, Outline};

const INK: Color = [25, 25, 25];
const QUIET: Color = [110, 110, 110];
const GRID: Color = [218, 218, 218];
const SUN: Color = [213, 94, 0];
const CURVE: Color = [0, 114, 178];
const PAPER: Color = [255; 3];

/// Twilights and night: down to which elevation [degrees], and their colour.
const TWILIGHTS: [(f64, f64, Color, &str); 4] = [
    (0.0, -6.0, [231, 238, 250], "civil twilight"),
    (-6.0, -12.0, [212, 222, 241], "nautical twilight"),
    (-12.0, -18.0, [192, 203, 228], "astronomical twilight"),
    (-18.0, -90.0, [172, 183, 211], "night"),
];

const SIZE: [f64; 2] = [1200.0, 470.0];
const TOP: f64 = 64.0;
const BOTTOM: f64 = 400.0;

/// Where a panel's axes end: left and right.
const PATH: [f64; 2] = [70.0, 570.0];
const EXPOSURE: [f64; 2] = [680.0, 1170.0];

/// A panel: numbers to places.
struct Panel {
    sides: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
}

impl Panel {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let [left, right] = self.sides;
        [
            left + share(x, self.x) * (right - left),
            BOTTOM - share(y, self.y) * (BOTTOM - TOP),
        ]
    }

    fn frame(&self, drawing: &mut Drawing) {
        let [left, right] = self.sides;
        let corners = [
            [left, TOP],
            [right, TOP],
            [right, BOTTOM],
            [left, BOTTOM],
            [left, TOP],
        ];
        drawing.line(corners.to_vec(), 1.2, INK, None);
    }
}

/// A range around values, with some room on both sides, and no smaller than `least`.
fn around(values: impl Iterator<Item = f64>, least: f64) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let room = (0.06 * (high - low)).max(0.5 * (least - (high - low)));
    [low - room, high + room]
}

/// A step that divides a range into at most `most` parts, of those that people count in.
fn step(range: [f64; 2], most: f64, steps: &[f64]) -> f64 {
    let length = range[1] - range[0];
    let last = steps.last().copied().unwrap_or(1.0);
    let found = steps.iter().copied().find(|step| length / step <= most);
    found.unwrap_or_else(|| (length / most / last).ceil() * last)
}

/// The multiples of a step in a range.
fn ticks(range: [f64; 2], step: f64) -> impl Iterator<Item = f64> {
    let (first, last) = (
        (range[0] / step).ceil() as i64,
        (range[1] / step).floor() as i64,
    );
    (first..=last).map(move |i| i as f64 * step)
}

/// Draws both panels.
pub fn draw(title: &str, Outline { header, lines, .. }: &Outline) -> Drawing {
    let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
    drawing.text([PATH[0], 24.0], 19.0, Anchor::Start, INK, title);
    sun_path(&mut drawing, lines);
    exposure(&mut drawing, header, lines);
    drawing
}

/// Where the sun stands in each frame, from north through east.
fn sun_path(drawing: &mut Drawing, lines: &[FrameLine]) {
    let mut azimuths = Vec::with_capacity(lines.len());
    for line in lines {
        let azimuth = line.sun_azimuth_deg;
        // The shorter way from the one before.
        let before = azimuths.last().copied().unwrap_or(azimuth);
        azimuths.push(azimuth + 360.0 * ((before - azimuth) / 360.0).round());
    }
    let mut x = around(azimuths.iter().copied(), 20.0);
    // Days on end go round and round.
    let round = x[1] - x[0] > 460.0;
    if round {
        azimuths = lines.iter().map(|line| line.sun_azimuth_deg).collect();
        x = [0.0, 360.0];
    }
    let elevations = || lines.iter().map(|line| line.sun_elevation_deg);
    let panel = Panel {
        sides: PATH,
        x,
        y: around(elevations(), 10.0),
    };
    let [left, right] = panel.sides;
    for (high, low, color, name) in TWILIGHTS {
        let [top, bottom] = [high, low].map(|e| panel.at([x[0], e])[1].clamp(TOP, BOTTOM));
        if bottom - top > 0.5 {
            let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
            drawing.shape(corners.to_vec(), color, 0.0, color, name);
            if bottom - top > 16.0 {
                let place = [right - 6.0, bottom - 8.0];
                drawing.text(place, 11.0, Anchor::End, QUIET, name);
            }
        }
    }
    for azimuth in ticks(
        x,
        step(x, 8.0, &[1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0]),
    ) {
        let at = panel.at([azimuth, 0.0])[0];
        drawing.line(vec![[at, TOP], [at, BOTTOM]], 0.7, GRID, None);
        let text = format!("{}°", azimuth.rem_euclid(360.0));
        drawing.text([at, BOTTOM + 16.0], 13.0, Anchor::Middle, INK, text);
    }
    let steps = [0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0];
    for elevation in ticks(panel.y, step(panel.y, 8.0, &steps)) {
        let at = panel.at([0.0, elevation])[1];
        let width = if elevation == 0.0 { 1.6 } else { 0.7 };
        let color = if elevation == 0.0 { QUIET } else { GRID };
        drawing.line(vec![[left, at], [right, at]], width, color, None);
        let text = format!("{elevation}°");
        drawing.text([left - 8.0, at], 13.0, Anchor::End, INK, text);
    }
    let points: Vec<[f64; 2]> = azimuths
        .iter()
        .zip(elevations())
        .map(|(&a, e)| panel.at([a, e]))
        .collect();
    let mut stretch = Vec::new();
    for point in &points {
        let torn = stretch
            .last()
            .is_some_and(|last: &[f64; 2]| (last[0] - point[0]).abs() > 0.5 * (right - left));
        if round && torn {
            drawing.line(std::mem::take(&mut stretch), 2.0, SUN, None);
        }
        stretch.push(*point);
    }
    drawing.line(stretch, 2.0, SUN, None);
    marks(drawing, lines, &points, panel.sides);
    panel.frame(drawing);
    let middle = 0.5 * (left + right);
    let text = "the sun: apparent elevation over azimuth, from north through east";
    drawing.text([middle, BOTTOM + 44.0], 14.0, Anchor::Middle, INK, text);
}

/// Some frames with their local times: the first, the last, and a few between them.
fn marks(drawing: &mut Drawing, lines: &[FrameLine], points: &[[f64; 2]], sides: [f64; 2]) {
    let all: Vec<&FrameLine> = lines.iter().collect();
    let clock = Clock::of(&all);
    let count = lines.len().min(6);
    let middle = 0.5 * (sides[0] + sides[1]);
    for mark in 0..count {
        let place = if count > 1 {
            mark * (lines.len() - 1) / (count - 1)
        } else {
            0
        };
        let [x, y] = points[place];
        let corners = (0..24).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 24.0).sin_cos();
            [x + 4.0 * cos, y + 4.0 * sin]
        });
        let label = clock.label(&lines[place]);
        drawing.shape(corners.collect(), PAPER, 1.8, SUN, &*label);
        let (anchor, beside) = match x > middle {
            true => (Anchor::End, -9.0),
            false => (Anchor::Start, 9.0),
        };
        drawing.text([x + beside, y - 9.0], 12.0, anchor, INK, label);
    }
}

/// The exposure of each frame, and where it comes from.
fn exposure(drawing: &mut Drawing, header: &Header, lines: &[FrameLine]) {
    let start = instant(&lines[0].local);
    let seconds = |text: &str| (instant(text) - start).as_seconds_f64();
    let x = around(lines.iter().map(|line| seconds(&line.local)), 60.0);
    let keys = match &header.exposure {
        ExposurePlan::Fixed(_) => &[][..],
        ExposurePlan::Curve(keys) => keys,
    };
    let values = lines.iter().map(|line| line.ev100);
    let panel = Panel {
        sides: EXPOSURE,
        x,
        y: around(values.chain(keys.iter().map(|key| key.ev100)), 1.0),
    };
    let [left, right] = panel.sides;
    for ev in ticks(panel.y, step(panel.y, 8.0, &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0])) {
        let at = panel.at([0.0, ev])[1];
        drawing.line(vec![[left, at], [right, at]], 0.7, GRID, None);
        // Steps are tenths at the finest.
        let text = format!("{}", (10.0 * ev).round() / 10.0);
        drawing.text([left - 8.0, at], 13.0, Anchor::End, INK, text);
    }
    time_axis(drawing, &panel, start);
    let points = lines
        .iter()
        .map(|line| panel.at([seconds(&line.local), line.ev100]));
    drawing.line(points.collect(), 2.0, CURVE, None);
    for key in keys {
        drawing.circle(
            panel.at([seconds(&key.instant), key.ev100]),
            4.0,
            1.5,
            CURVE,
        );
    }
    panel.frame(drawing);
    let text = match &header.exposure {
        ExposurePlan::Fixed(_) => "exposure of each frame, one for all [EV100]",
        ExposurePlan::Curve(_) => "exposure of each frame [EV100]; circles: key frames as metered",
    };
    let middle = 0.5 * (left + right);
    drawing.text([middle, BOTTOM + 44.0], 14.0, Anchor::Middle, INK, text);
}

/// Local times, by the clock of the first frame.
fn time_axis(drawing: &mut Drawing, panel: &Panel, start: DateTime<FixedOffset>) {
    const MINUTE: f64 = 60.0;
    const HOUR: f64 = 3600.0;
    const DAY: f64 = 86_400.0;
    let steps = [
        1.0,
        2.0,
        5.0,
        10.0,
        15.0,
        30.0,
        MINUTE,
        2.0 * MINUTE,
        5.0 * MINUTE,
        10.0 * MINUTE,
        15.0 * MINUTE,
        30.0 * MINUTE,
        HOUR,
        2.0 * HOUR,
        3.0 * HOUR,
        6.0 * HOUR,
        12.0 * HOUR,
        DAY,
        2.0 * DAY,
        7.0 * DAY,
        14.0 * DAY,
        30.0 * DAY,
    ];
    let step = step(panel.x, 6.0, &steps);
    // Counted from midnight, so that ticks are round times.
    let since = f64::from(start.time().num_seconds_from_midnight());
    for tick in ticks(panel.x.map(|x| x + since), step) {
        let at = panel.at([tick - since, 0.0])[0];
        drawing.line(vec![[at, TOP], [at, BOTTOM]], 0.7, GRID, None);
        let time = start + TimeDelta::milliseconds((1000.0 * (tick - since)) as i64);
        let shape = match step {
            step if step < MINUTE => "%H:%M:%S",
            step if step < DAY => "%H:%M",
            _ => "%d %b",
        };
        let text = time.format(shape).to_string();
        drawing.text([at, BOTTOM + 16.0], 13.0, Anchor::Middle, INK, text);
    }
}

/// An instant that a plan holds; the beginning of 1970 for what is none.
fn instant(text: &str) -> DateTime<FixedOffset> {
    DateTime::parse_from_rfc3339(text).unwrap_or_default()
}
