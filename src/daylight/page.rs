//! One page for a permit's file: everything that a [`Report`] tells, in one HTML file that needs no other.
//!
//! A figure is written with the digits that it is good for; `data-value` has all of them, as the tables of numbers do.

use super::heat_map;
use super::report::{Line, Report, Room};
use std::fmt::Write;

const STYLE: &str = "\
body{font:14px/1.45 system-ui,sans-serif;color:#1a1a1a;max-width:1020px;margin:2em auto;padding:0 1em}\
h1{font-size:1.5em;margin:0 0 .2em}h2{font-size:1.15em;margin:1.8em 0 .4em;border-bottom:1px solid #bbb}\
table{border-collapse:collapse;width:100%}td,th{padding:.25em .6em;text-align:left;vertical-align:top;border-bottom:1px solid #e3e3e3}\
th{background:#f4f4f1}td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}\
.how{color:#555;font-size:.88em}pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f4f4f1;padding:.6em;font-size:.85em}\
svg{max-width:100%;height:auto}.w{background:#fff4d6}.maps svg{max-width:48%}\
@media print{body{margin:0;font-size:11px}h2{break-after:avoid}tr,svg{break-inside:avoid}}";

/// A picture of the page: SVG, and what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub title: String,
    /// The picture.
    pub svg: String,
}

/// The page of a report; `maps` are pictures of planes.
pub fn html(report: &Report, maps: &[Picture]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Daylight over a year</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>Daylight over a year</h1>\n<p>Made with {}.</p>\n",
        escaped(&report.program)
    );
    for room in &report.rooms {
        figures(&mut page, room);
    }
    let _ = write!(
        page,
        "<h2>The year, hour by hour</h2>\n<p>Mean illuminance of all sensors; standard time.</p>\n{}",
        heat_map::svg(
            &report.hourly_mean_lx,
            "Mean illuminance of all sensors, day by hour"
        )
    );
    if !maps.is_empty() {
        page.push_str("<h2>Maps</h2>\n<div class=\"maps\">\n");
        for map in maps {
            let _ = writeln!(page, "<h3>{}</h3>\n{}", escaped(&map.title), map.svg);
        }
        page.push_str("</div>\n");
    }
    page.push_str("<h2>What went in</h2>\n<table>\n");
    for Line { name, value } in &report.inputs {
        let _ = writeln!(
            page,
            "<tr><th>{}</th><td>{}</td></tr>",
            escaped(name),
            escaped(value)
        );
    }
    page.push_str("</table>\n<h2>Materials</h2>\n<table>\n<tr><th>Material</th><th>Reflectance</th><th>Transmittance</th></tr>\n");
    for surface in &report.materials {
        let through = surface
            .transmittance
            .map_or(String::new(), |t| format!("{t:.3}"));
        let reflects = match surface.transmittance {
            Some(_) => String::new(),
            None => format!("{:.3}", surface.reflectance),
        };
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td class=\"n\">{reflects}</td><td class=\"n\">{through}</td></tr>",
            escaped(&surface.name)
        );
    }
    page.push_str("</table>\n");
    list(&mut page, "Assumptions", "", &report.assumptions);
    if !report.warnings.is_empty() {
        list(&mut page, "Warnings", " class=\"w\"", &report.warnings);
    }
    let _ = write!(
        page,
        "<h2>The weather file's own header</h2>\n<p>What it says of its source and its licence stands in its comments.</p>\n<pre>{}</pre>\n\
         </body>\n</html>\n",
        escaped(&report.weather_header.join("\n"))
    );
    page
}

fn figures(page: &mut String, room: &Room) {
    let _ = writeln!(
        page,
        "<h2>{}</h2>\n<p>{} sensors, {:.2} m<sup>2</sup></p>\n<table>\n<tr><th>Figure</th><th>Value</th><th>Unit</th><th></th></tr>",
        escaped(&room.name),
        room.sensors,
        room.area
    );
    for figure in &room.figures {
        let edition = match figure.edition {
            "" => String::new(),
            edition => format!(" ({edition})"),
        };
        let value = match figure.value {
            Some(value) => format!(
                "<td class=\"n\" data-room=\"{}\" data-key=\"{}\" data-value=\"{value}\">{}</td>",
                escaped(&room.name),
                escaped(&figure.key),
                shown(value)
            ),
            None => "<td class=\"n\">-</td>".into(),
        };
        let _ = writeln!(
            page,
            "<tr><td>{}<div class=\"how\">{}{}</div></td>{value}<td>{}</td><td>{}</td></tr>",
            escaped(&figure.name),
            escaped(&figure.method),
            escaped(&edition),
            figure.unit,
            escaped(&figure.verdict)
        );
    }
    page.push_str("</table>\n");
}

fn list(page: &mut String, title: &str, class: &str, lines: &[String]) {
    let _ = writeln!(page, "<h2>{title}</h2>\n<ul{class}>");
    for line in lines {
        let _ = writeln!(page, "<li>{}</li>", escaped(line));
    }
    page.push_str("</ul>\n");
}

/// A figure for people: three digits, and whole numbers above them.
pub fn shown(value: f64) -> String {
    match value.abs() {
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// A text as HTML.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() && c != '\n' => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_the_digits_that_they_are_good_for() {
        assert_eq!(
            [0.0, 2.345, 12.34, 123.6].map(shown),
            ["0.00", "2.35", "12.3", "124"]
        );
        assert_eq!(
            escaped("<a & \"b\">\u{7}"),
            "&lt;a &amp; &quot;b&quot;&gt;\u{fffd}"
        );
    }
}
