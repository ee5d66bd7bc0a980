//! A plot of error against cost, or of any two measured quantities: both axes logarithmic, the Pareto front behind.

use crate::plots::labels::{Room, TIED};

use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;
use tyndall::output::atomic;
use tyndall::output::canvas::Color;
use tyndall::output::drawing::{Drawing, escaped};
use tyndall::output::lettering::{Anchor, text_width};
use tyndall::studies::pareto;
use tyndall::{Error, Result};

const INK: Color = [25, 25, 25];
const QUIET: Color = [110, 110, 110];
const DECADE: Color = [205, 205, 205];
const BETWEEN: Color = [233, 233, 233];
const FRONT: Color = [255, 221, 130];
const PAPER: Color = [255; 3];

/// Colours that eyes without red, green or blue cones tell apart (Okabe and Ito 2008), the darkest and lightest alternating.
const COLORS: [Color; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 130, 95],
    [150, 60, 120],
    [60, 160, 215],
    [200, 130, 0],
    [60, 60, 60],
];

/// Colours of other programs.
const RIVALS: [Color; 3] = [[120, 120, 120], [150, 150, 150], [90, 90, 90]];

const SIZE: [f64; 2] = [1200.0, 800.0];
const LEFT: f64 = 92.0;
const TOP: f64 = 104.0;
const BOTTOM: f64 = 690.0;
const MARKER: f64 = 6.5;
const LABEL: f64 = 13.0;
const TICK: f64 = 15.0;
const FRONT_WIDTH: f64 = 9.0;

/// A quantity along an axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Its name.
    pub label: String,
    /// Its unit, without brackets; none if empty.
    pub unit: String,
}

/// A measurement.
#[derive(Debug, Clone)]
pub struct Point {
    /// Cost, > 0.
    pub x: f64,
    /// Error, >= 0. A zero stands on the lower edge.
    pub y: f64,
    /// A few letters beside it, if there is room; all of it in the HTML.
    pub label: String,
    /// Whether nothing beats it ([`tyndall::studies::pareto::front`]).
    pub on_front: bool,
}

/// Measurements that belong together. A line joins those that no other of them beats, so that it falls and never turns back.
#[derive(Debug, Clone)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// The measurements.
    pub points: Vec<Point>,
}

/// What is to be plotted.
#[derive(Debug, Clone)]
pub struct Plot {
    /// The line on top.
    pub title: String,
    /// The line below: on what machine, of what scene, at what size.
    pub caption: String,
    /// The cost.
    pub x: Axis,
    /// The error.
    pub y: Axis,
    /// What was measured.
    pub series: Vec<Series>,
    /// What others reach: grey, dashed, with hollow markers.
    pub rivals: Vec<Series>,
}

impl Plot {
    /// Writes it as its name's end says, .svg, .png (2400 x 1600 pixels) or .html (one file without scripts, in which every
    /// point tells its numbers).
    ///
    /// # Errors
    /// [`Error::Input`] for another ending or for nothing to plot; [`Error::Domain`] for a point that has no place on the
    /// axes; [`Error::File`] if it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let extension = path.extension().and_then(|e| e.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("html") => {
                let page = self.html()?;
                atomic::write(path, |file| file.write_all(page.as_bytes()))
            }
            Some("svg" | "png") => self.draw()?.save(path),
            _ => Err(Error::input(
                path.display().to_string(),
                "the name ends in none of .svg, .png and .html",
                "choose one of the three",
            )),
        }
    }

    fn html(&self) -> Result<String> {
        Ok(format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{}</title>\n\
             <style>body {{ margin: 2em auto; max-width: {}px }} svg {{ max-width: 100%; height: auto }}</style>\n\
             </head>\n<body>\n{}</body>\n</html>\n",
            escaped(&self.title),
            SIZE[0],
            self.draw()?.svg()
        ))
    }

    /// Draws it.
    ///
    /// # Errors
    /// [`Error::Input`] for nothing to plot; [`Error::Domain`] for a point that has no place on the axes.
    pub fn draw(&self) -> Result<Drawing> {
        let styles = self.styles();
        let legend = styles
            .iter()
            .map(|style| text_width(&style.series.name, 15.0))
            .fold(text_width("Pareto front", 15.0), f64::max)
            .min(420.0);
        let right = SIZE[0] - legend - 92.0;
        let chart = Chart::new(self, [LEFT, TOP, right, BOTTOM])?;

        let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
        drawing.text([24.0, 38.0], 25.0, Anchor::Start, INK, &*self.title);
        drawing.text([24.0, 78.0], 17.0, Anchor::Start, INK, self.y.text());
        let middle = 0.5 * (LEFT + right);
        let below = [middle, BOTTOM + 58.0];
        drawing.text(below, 17.0, Anchor::Middle, INK, self.x.text());
        let lowest = [24.0, SIZE[1] - 18.0];
        drawing.text(lowest, 13.0, Anchor::Start, QUIET, &*self.caption);

        chart.grid(&mut drawing);
        let front = self.staircase(&chart);
        drawing.line(front.clone(), FRONT_WIDTH, FRONT, None);
        chart.frame(&mut drawing);
        for style in &styles {
            let line = style.series.line(&chart);
            drawing.line(line, style.width, style.color, style.dash);
        }
        for style in &styles {
            for point in &style.series.points {
                style.mark(&mut drawing, chart.at(point), self.tip(style.series, point));
            }
        }
        self.labels(&mut drawing, &chart, &styles, &front);

        let mut y = TOP + 14.0;
        for style in &styles {
            let x = right + 24.0;
            let line = vec![[x, y], [x + 36.0, y]];
            drawing.line(line, style.width, style.color, style.dash);
            style.mark(&mut drawing, [x + 18.0, y], style.series.name.clone());
            let name = [x + 46.0, y];
            drawing.text(name, 15.0, Anchor::Start, INK, &*style.series.name);
            y += 27.0;
        }
        if !front.is_empty() {
            let x = right + 24.0;
            let step = [
                [x, y + 1.0],
                [x + 18.0, y + 1.0],
                [x + 18.0, y + 9.0],
                [x + 36.0, y + 9.0],
            ];
            drawing.line(step.to_vec(), FRONT_WIDTH, FRONT, None);
            let name = [x + 46.0, y + 5.0];
            drawing.text(name, 15.0, Anchor::Start, INK, "Pareto front");
        }
        Ok(drawing)
    }

    fn all(&self) -> impl Iterator<Item = (&Series, &Point)> {
        let series = self.series.iter().chain(&self.rivals);
        series.flat_map(|series| series.points.iter().map(move |point| (series, point)))
    }

    fn styles(&self) -> Vec<Style<'_>> {
        let ours = self.series.iter().enumerate().map(|(i, series)| Style {
            series,
            color: COLORS[i % COLORS.len()],
            width: 1.8,
            dash: None,
            corners: MARKERS[i % MARKERS.len()],
            hollow: i >= MARKERS.len(),
        });
        let rivals = self.rivals.iter().enumerate().map(|(i, series)| Style {
            series,
            color: RIVALS[i % RIVALS.len()],
            width: 1.4,
            dash: Some([6.0, 4.0]),
            corners: MARKERS[i % MARKERS.len()],
            hollow: true,
        });
        ours.chain(rivals).collect()
    }

    /// The least error that any cost buys, from where the first point is to the edge.
    fn staircase(&self, chart: &Chart) -> Vec<[f64; 2]> {
        let on_front = self.all().filter(|(_, point)| point.on_front);
        let mut corners: Vec<[f64; 2]> = on_front.map(|(_, point)| chart.at(point)).collect();
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [_, top, right, _] = chart.area;
        let (top, right) = (top + FRONT_WIDTH, right - FRONT_WIDTH);
        let mut line: Vec<[f64; 2]> = Vec::new();
        for [x, y] in corners {
            let before = line.last().map_or(top, |last| last[1]);
            line.extend([[x, before], [x, y]]);
        }
        line.extend(line.last().map(|last| [right, last[1]]));
        line
    }

    /// Labels that have room, those of the front first.
    fn labels(&self, drawing: &mut Drawing, chart: &Chart, styles: &[Style], front: &[[f64; 2]]) {
        let mut room = Room::new(chart.area);
        room.line(front);
        for style in styles {
            room.line(&style.series.line(chart));
            let points = style.series.points.iter();
            points.for_each(|p| room.mark(chart.at(p), MARKER + 1.0));
        }
        for on_front in [true, false] {
            for style in styles {
                let points = style.series.points.iter();
                for point in points.filter(|p| p.on_front == on_front && !p.label.is_empty()) {
                    let at = chart.at(point);
                    let size = [text_width(&point.label, LABEL) + 4.0, LABEL + 2.0];
                    let Some(place) = room.place(at, size) else {
                        continue;
                    };
                    if place.length > TIED {
                        tie(drawing, at, place.centre, size);
                    }
                    let color = style.color.map(|c| (f32::from(c) * 0.75) as u8);
                    drawing.text(place.centre, LABEL, Anchor::Middle, color, &*point.label);
                }
            }
        }
    }

    fn tip(&self, series: &Series, point: &Point) -> String {
        let value = |axis: &Axis, v: f64| {
            let unit = if axis.unit.is_empty() { "" } else { " " };
            format!("{} {}{unit}{}", axis.label, significant(v), axis.unit)
        };
        let mut lines = vec![series.name.clone()];
        if !point.label.is_empty() {
            lines.push(point.label.clone());
        }
        lines.push(value(&self.x, point.x));
        lines.push(value(&self.y, point.y));
        if point.on_front {
            lines.push("on the Pareto front".into());
        }
        lines.join("\n")
    }
}

impl Series {
    /// Through those of its points that none costs less and errs less than, from the cheapest on.
    fn line(&self, chart: &Chart) -> Vec<[f64; 2]> {
        let pairs: Vec<[f64; 2]> = self.points.iter().map(|p| [p.x, p.y]).collect();
        let points = self.points.iter().zip(pareto::front(&pairs));
        let mut best: Vec<&Point> = points.filter(|(_, on)| *on).map(|(p, _)| p).collect();
        best.sort_by(|a, b| a.x.total_cmp(&b.x));
        best.into_iter().map(|point| chart.at(point)).collect()
    }
}

impl Axis {
    fn text(&self) -> String {
        match &*self.unit {
            "" => self.label.clone(),
            unit => format!("{} [{unit}]", self.label),
        }
    }
}

/// A thin line from a point to the nearest place of its label's box.
fn tie(drawing: &mut Drawing, at: [f64; 2], centre: [f64; 2], size: [f64; 2]) {
    let half = [0.5 * size[0], 0.5 * size[1] - 2.0];
    let to: [f64; 2] =
        std::array::from_fn(|i| at[i].clamp(centre[i] - half[i], centre[i] + half[i]));
    let length = (to[0] - at[0]).hypot(to[1] - at[1]).max(1e-6);
    let from = std::array::from_fn(|i| at[i] + (to[i] - at[i]) * (MARKER + 2.0) / length);
    drawing.line(vec![from, to], 0.8, QUIET, None);
}

/// How a series looks.
struct Style<'a> {
    series: &'a Series,
    color: Color,
    width: f64,
    dash: Option<[f64; 2]>,
    corners: Corners,
    hollow: bool,
}

impl Style<'_> {
    fn mark(&self, drawing: &mut Drawing, [x, y]: [f64; 2], tip: String) {
        let corners = (self.corners)();
        let at = |[u, v]: [f64; 2]| [x + MARKER * u, y + MARKER * v];
        let points = corners.into_iter().map(at).collect();
        if self.hollow {
            drawing.shape(points, PAPER, 1.8, self.color, tip);
        } else {
            drawing.shape(points, self.color, 1.2, PAPER, tip);
        }
    }
}

/// The corners of a marker of about the area of a circle of radius 1.
type Corners = fn() -> Vec<[f64; 2]>;

const MARKERS: [Corners; 8] = [
    || star(48, 1.0, 1.0, 0.0),
    || star(4, 1.25, 1.25, 0.125),
    || star(3, 1.45, 1.45, 0.0),
    || star(4, 1.35, 1.35, 0.0),
    || star(3, 1.45, 1.45, 0.5),
    || star(10, 1.55, 0.7, 0.0),
    || cross(0.0),
    || cross(0.125),
];

/// A polygon around a point, every second corner at another radius; turned by a part of the circle, its first corner up.
fn star(corners: u32, outer: f64, inner: f64, turn: f64) -> Vec<[f64; 2]> {
    let corner = |i: u32| {
        let radius = if i.is_multiple_of(2) { outer } else { inner };
        let (sin, cos) = (TAU * (f64::from(i) / f64::from(corners) + turn)).sin_cos();
        [radius * sin, -radius * cos]
    };
    (0..corners).map(corner).collect()
}

/// A cross with thick arms, turned by a part of the circle.
fn cross(turn: f64) -> Vec<[f64; 2]> {
    const ARM: [[f64; 2]; 3] = [[-0.42, -1.3], [0.42, -1.3], [0.42, -0.42]];
    let arm = |i: i32| {
        let (sin, cos) = (TAU * (f64::from(i) / 4.0 + turn)).sin_cos();
        ARM.map(|[u, v]| [cos * u - sin * v, sin * u + cos * v])
    };
    (0..4).flat_map(arm).collect()
}

/// The axes: where a measurement stands.
struct Chart {
    /// Left, top, right, bottom.
    area: [f64; 4],
    /// The logarithms at the axes' ends.
    x: [f64; 2],
    y: [f64; 2],
}

impl Chart {
    fn new(plot: &Plot, area: [f64; 4]) -> Result<Self> {
        for (series, point) in plot.all() {
            let costs = point.x > 0.0 && point.x.is_finite();
            if !(costs && point.y >= 0.0 && point.y.is_finite()) {
                return Err(Error::domain(
                    format!("a point of {}", series.name),
                    format!("({}, {})", point.x, point.y),
                    "finite numbers, x > 0 and y >= 0",
                    "leave out what could not be measured",
                ));
            }
        }
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let logs = values.filter(|v| *v > 0.0).map(f64::log10);
            let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
            // Some air at the ends, and two ticks at least.
            let air = (0.07 * (high - low)).max(0.5 * (0.8 - (high - low)));
            [low - air, high + air]
        };
        let x = range(&mut plot.all().map(|(_, point)| point.x));
        let mut y = range(&mut plot.all().map(|(_, point)| point.y));
        if !x[0].is_finite() {
            return Err(Error::input(
                &*plot.title,
                "there is nothing to plot",
                "give at least one point",
            ));
        }
        if !y[0].is_finite() {
            // Errors of zero alone: any axis shows them.
            y = [-1.0, 1.0];
        }
        Ok(Chart { area, x, y })
    }

    fn at(&self, point: &Point) -> [f64; 2] {
        let [_, _, _, bottom] = self.area;
        let y = if point.y > 0.0 {
            self.down(point.y.log10())
        } else {
            bottom
        };
        [self.along(point.x.log10()), y]
    }

    fn along(&self, log: f64) -> f64 {
        let [left, _, right, _] = self.area;
        left + (right - left) * (log - self.x[0]) / (self.x[1] - self.x[0])
    }

    fn down(&self, log: f64) -> f64 {
        let [_, top, _, bottom] = self.area;
        bottom - (bottom - top) * (log - self.y[0]) / (self.y[1] - self.y[0])
    }

    fn grid(&self, drawing: &mut Drawing) {
        let [left, top, right, bottom] = self.area;
        for tick in ticks(self.x, right - left, along_x) {
            let x = self.along(tick.log);
            let (width, color) = tick.stroke();
            drawing.line(vec![[x, top], [x, bottom]], width, color, None);
            if let Some(text) = tick.text {
                drawing.text([x, bottom + 20.0], TICK, Anchor::Middle, INK, text);
            }
        }
        for tick in ticks(self.y, bottom - top, |_| 26.0) {
            let y = self.down(tick.log);
            let (width, color) = tick.stroke();
            drawing.line(vec![[left, y], [right, y]], width, color, None);
            if let Some(text) = tick.text {
                drawing.text([left - 10.0, y], TICK, Anchor::End, INK, text);
            }
        }
    }

    fn frame(&self, drawing: &mut Drawing) {
        let [left, top, right, bottom] = self.area;
        let axes = vec![[left, top], [left, bottom], [right, bottom]];
        drawing.line(axes, 1.6, INK, None);
    }
}

struct Tick {
    log: f64,
    /// Of ten, if it is one.
    power: Option<i32>,
    text: Option<String>,
}

impl Tick {
    fn stroke(&self) -> (f64, Color) {
        if self.power.is_some() {
            (1.0, DECADE)
        } else {
            (0.8, BETWEEN)
        }
    }
}

/// The room that a number takes on the axis of x.
fn along_x(text: &str) -> f64 {
    text_width(text, TICK) + 12.0
}

/// Ticks at 1, 2 and 5 times the powers of ten between two logarithms, on an axis of a length. All have numbers if those have
/// the room that they take, else the powers of ten, or some of them.
fn ticks([from, to]: [f64; 2], length: f64, room: fn(&str) -> f64) -> Vec<Tick> {
    let mut list = Vec::new();
    for power in from.floor() as i32..=to.ceil() as i32 {
        for digit in [1, 2, 5] {
            let log = f64::from(power) + f64::from(digit).log10();
            if (from..=to).contains(&log) {
                let text = match power {
                    -4..=-1 => format!("{:.*}", power.unsigned_abs() as usize, 10_f64.powf(log)),
                    0..=4 => format!("{:.0}", 10_f64.powf(log)),
                    _ => format!("{digit}e{power}"),
                };
                list.push(Tick {
                    log,
                    power: (digit == 1).then_some(power),
                    text: Some(text),
                });
            }
        }
    }
    let widest = list.iter().flat_map(|tick| &tick.text).map(|t| room(t));
    let decades = widest.fold(0.0, f64::max) * (to - from) / length;
    // From 1 to 2 is 0.3 of a decade.
    if decades > 2.0_f64.log10() {
        let every = decades.ceil() as i32;
        for tick in &mut list {
            if tick.power.is_none_or(|power| power % every != 0) {
                tick.text = None;
            }
        }
    }
    list
}

/// A number with three significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    // After rounding, so that 9.999 is 10.0.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let power = rounded.abs().log10().floor();
    if (-4.0..6.0).contains(&power) {
        format!("{rounded:.*}", (2.0 - power).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_falls_and_never_turns_back() {
        let mut plot = sample();
        let point = |x, y| Point {
            x,
            y,
            label: String::new(),
            on_front: false,
        };
        // Dearer and worse; dearer and better; cheaper than the last.
        plot.series[0].points = [(2.0, 5.0), (3.0, 6.0), (8.0, 2.0), (4.0, 3.0), (9.0, 2.5)]
            .map(|(x, y)| point(x, y))
            .to_vec();
        let chart = Chart::new(&plot, [LEFT, TOP, 800.0, BOTTOM]).expect("they have places");
        let line = plot.series[0].line(&chart);
        let expected = [(2.0, 5.0), (4.0, 3.0), (8.0, 2.0)].map(|(x, y)| chart.at(&point(x, y)));
        assert_eq!(line, expected);
        // Lower errors stand lower on the page.
        assert!(
            line.windows(2)
                .all(|p| p[1][0] > p[0][0] && p[1][1] > p[0][1])
        );
    }

    /// A plot of made-up numbers: four methods that get better with steps, at their own rates and prices.
    fn sample() -> Plot {
        let methods = [
            (
                "march",
                0.10,
                2.2,
                0.80,
                [16, 32, 64, 128, 256, 512].as_slice(),
            ),
            ("epipolar", 0.9, 0.55, 0.75, &[16, 32, 64, 128, 256]),
            ("rectified", 1.6, 0.012, 0.40, &[64, 128, 256, 512, 1024]),
            ("planes", 0.35, 1.4, 0.35, &[8, 16, 32, 64, 128]),
            ("prefiltered", 0.9, 0.06, 0.18, &[1, 2, 4, 8, 16]),
        ];
        let point = |cost: f64, error: f64, label: String| Point {
            x: cost,
            y: error,
            label,
            on_front: false,
        };
        let mut series: Vec<Series> = methods
            .iter()
            .map(|(name, cost, error, rate, steps)| Series {
                name: (*name).into(),
                points: steps
                    .iter()
                    .map(|n| {
                        let relative = f64::from(*n) / f64::from(steps[0]);
                        let cost = cost * relative.powf(0.7);
                        point(
                            cost,
                            error * 30.0 * relative.powf(-rate * 1.3),
                            n.to_string(),
                        )
                    })
                    .collect(),
            })
            .collect();
        let pairs: Vec<[f64; 2]> = series
            .iter()
            .flat_map(|s| s.points.iter().map(|p| [p.x, p.y]))
            .collect();
        let points = series.iter_mut().flat_map(|s| &mut s.points);
        for (point, on_front) in points.zip(pareto::front(&pairs)) {
            point.on_front = on_front;
        }
        Plot {
            title: "Light shafts: what accuracy costs".into(),
            caption: "Made-up adapter, software; scene nave, 1280 x 800; medians of 30 frames"
                .into(),
            x: Axis {
                label: "in-scatter time of a frame".into(),
                unit: "ms".into(),
            },
            y: Axis {
                label: "relative RMSE".into(),
                unit: "%".into(),
            },
            series,
            rivals: vec![
                Series {
                    name: "ray marching elsewhere".into(),
                    points: [(0.4, 60.0, "32"), (0.8, 35.0, "64"), (1.7, 19.0, "128")]
                        .map(|(x, y, label)| point(x, y, label.into()))
                        .into(),
                },
                Series {
                    name: "radial blur".into(),
                    points: vec![point(0.12, 160.0, "blur".into())],
                },
            ],
        }
    }

    #[test]
    fn a_plot_is_a_picture_a_drawing_and_a_page() {
        let plot = sample();
        let folder = tempfile::tempdir().expect("there is a temporary folder");
        let path = |name: &str| folder.path().join(name);
        for name in ["plot.svg", "plot.png", "plot.html"] {
            plot.save(&path(name)).expect(name);
        }
        let picture = image::open(path("plot.png")).expect("a picture").to_rgb8();
        assert_eq!(picture.dimensions(), (2400, 1600));
        // Each colour of a series is there, and the front's.
        for color in COLORS[..5].iter().chain([&FRONT]) {
            assert!(picture.pixels().any(|p| p.0 == *color), "{color:?}");
        }
        let page = std::fs::read_to_string(path("plot.html")).expect("a page");
        assert!(page.starts_with("<!DOCTYPE html>") && !page.contains("<script"));
        let points = plot.all().count();
        let legend = plot.series.len() + plot.rivals.len();
        assert_eq!(page.matches("</title></polygon>").count(), points + legend);
        assert!(page.contains("<title>march\n16\nin-scatter time of a frame 0.100 ms\n"));
        assert_eq!(
            page.matches("on the Pareto front").count(),
            plot.all().filter(|(_, point)| point.on_front).count()
        );
    }

    #[test]
    fn a_crowd_keeps_its_markers_and_loses_labels_only() {
        let mut plot = sample();
        let series = (0..9).map(|i| Series {
            name: format!("method number {i} of a long name"),
            points: (0..12)
                .map(|n| {
                    let (i, n) = (f64::from(i), f64::from(n));
                    Point {
                        x: 3e-5 * 1.9_f64.powf(n + 0.2 * i),
                        y: 2e-7 * 2.0_f64.powf(12.0 - n + 0.7 * (i + n * i).sin()),
                        label: format!("{n} x {i}"),
                        on_front: false,
                    }
                })
                .collect(),
        });
        plot.series = series.collect();
        plot.rivals.clear();
        let svg = plot.draw().expect("it can be drawn").svg();
        assert_eq!(svg.matches("<polygon").count(), 9 * 12 + 9);
        let words = svg.matches("</text>").count();
        assert!((60..9 * 12 + 50).contains(&words), "{words}");
    }

    #[test]
    fn what_cannot_be_plotted_is_named() {
        let problem = |change: fn(&mut Plot)| {
            let mut plot = sample();
            change(&mut plot);
            plot.draw().err().map(|error| error.to_string())
        };
        assert_eq!(problem(|_| ()), None);
        // An error of zero stands on the edge; one point has axes around it.
        assert_eq!(problem(|p| p.series[0].points[0].y = 0.0), None);
        assert_eq!(
            problem(|p| p.series.iter_mut().for_each(|s| s.points.truncate(1))),
            None
        );
        let bad: [fn(&mut Plot); 3] = [
            |p| p.series[0].points[0].x = 0.0,
            |p| p.rivals[0].points[0].y = f64::NAN,
            |p| p.series[1].points[0].y = -1.0,
        ];
        for change in bad {
            let found = problem(change).expect("it has no place");
            assert!(found.contains("a point of"), "{found}");
        }
        let nothing = problem(|p| {
            p.series.clear();
            p.rivals.clear();
        });
        assert!(nothing.expect("an error").contains("nothing to plot"));
        assert!(sample().save(Path::new("plot.pdf")).is_err());
    }

    #[test]
    fn ticks_and_numbers_are_round() {
        let texts = |range, length| -> Vec<String> {
            ticks(range, length, along_x)
                .into_iter()
                .filter_map(|t| t.text)
                .collect()
        };
        assert_eq!(
            texts([-1.05, 1.1], 600.0),
            ["0.1", "0.2", "0.5", "1", "2", "5", "10"]
        );
        assert_eq!(
            texts([-6.1, -2.0], 400.0),
            ["1e-6", "1e-5", "0.0001", "0.001", "0.01"]
        );
        for (value, text) in [
            (0.0, "0"),
            (9.999, "10.0"),
            (0.012_34, "0.0123"),
            (1234.0, "1230"),
            (1.5e-7, "1.50e-7"),
        ] {
            assert_eq!(significant(value), text);
        }
    }
}
