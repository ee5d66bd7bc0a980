//! One HTML page of a time-lapse: what went in, what came out. It needs nothing else but the film, which it plays from its side.

use std::fmt::Write;
use std::path::Path;
use tyndall::ephemeris::coordinates;
use tyndall::output::drawing::{data_link, escaped};
use tyndall::timelapse::cluster;
use tyndall::timelapse::film::Film;
use tyndall::timelapse::frames::Rate;
use tyndall::timelapse::plan::{ExposurePlan, Header, Outline};

/// What a page tells.
pub struct Page<'a> {
    /// The plan file, in few lines.
    pub outline: &'a Outline,
    /// What was left out, is doubtful or approximate.
    pub warnings: &'a [String],
    /// The film, and its address from the page.
    pub film: Option<(&'a Film, &'a str)>,
    /// The contact sheet, a PNG.
    pub sheet: Option<&'a [u8]>,
    /// The sun's path and the exposure, an SVG.
    pub curves: &'a str,
    /// The plan file.
    pub plan: &'a Path,
}

const STYLE: &str = "body { margin: 2em auto; max-width: 1200px; padding: 0 1em; font: 16px/1.5 system-ui, sans-serif; color: #191919 } \
    h1 { font-size: 1.6em; margin: 0 } h2 { font-size: 1.15em; margin: 2em 0 .5em } img, svg, video { max-width: 100%; height: auto } \
    video { width: 100%; background: black } table { border-collapse: collapse } th, td { padding: .15em 1em .15em 0; text-align: left; \
    vertical-align: top; border-bottom: 1px solid #e2e2e2 } th { font-weight: 600; white-space: nowrap } \
    .frames td, .frames th { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap } \
    .frames td.words { text-align: left; white-space: normal } code { font-size: .88em; overflow-wrap: anywhere } \
    summary { cursor: pointer } .quiet { color: #6e6e6e }";

/// What a sequence is called: its scene and its days.
pub fn title(Outline { header, lines, .. }: &Outline) -> String {
    let days = [lines.first(), lines.last()];
    let [first, last] = days.map(|l| l.and_then(|l| l.local.get(..10)).unwrap_or_default());
    match first == last {
        true => format!("{}, {first}", header.scene),
        false => format!("{}, {first} to {last}", header.scene),
    }
}

impl Page<'_> {
    /// The page.
    pub fn html(&self) -> String {
        let title = escaped(&title(self.outline));
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        if let Some((film, address)) = self.film {
            let _ = writeln!(
                html,
                "<p><video controls muted loop preload=\"metadata\" width=\"{}\" height=\"{}\" src=\"{}\"></video></p>",
                film.size[0],
                film.size[1],
                attribute(address)
            );
        }
        html += "<table>\n";
        for (name, value) in self.facts() {
            let _ = writeln!(html, "<tr><th>{name}</th><td>{value}</td></tr>");
        }
        html += "</table>\n";
        html += "<h2>Warnings</h2>\n";
        if self.warnings.is_empty() {
            html += "<p>none</p>\n";
        } else {
            html += "<ul>\n";
            for warning in self.warnings {
                let _ = writeln!(html, "<li>{}</li>", escaped(warning));
            }
            html += "</ul>\n";
        }
        let _ = writeln!(html, "<h2>Sun and exposure</h2>\n{}", self.curves);
        if let Some(sheet) = self.sheet {
            let link = data_link(sheet);
            let _ = writeln!(
                html,
                "<h2>Contact sheet</h2>\n<p><img alt=\"the frames with their local times\" src=\"{link}\"></p>"
            );
        }
        self.table(&mut html);
        html += "</body>\n</html>\n";
        html
    }

    /// Names and values, the latter HTML.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let Outline { header, lines, .. } = self.outline;
        let Header { site, size, .. } = header;
        let code = |text: &str| format!("<code>{}</code>", escaped(text));
        let ends = [lines.first(), lines.last()].map(|l| l.map_or("", |l| &*l.local));
        let mut facts = vec![
            ("scene", escaped(&header.scene)),
            (
                "place",
                format!(
                    "{}, {:.0} m above the sea",
                    coordinates(site.latitude_deg, site.longitude_deg),
                    site.elevation
                ),
            ),
            (
                "time",
                format!("{} to {}", escaped(ends[0]), escaped(ends[1])),
            ),
            (
                "frames",
                format!(
                    "{} of {} x {} pixels, numbers {} to {}",
                    header.frames,
                    size[0],
                    size[1],
                    header.first,
                    header.indices().end - 1
                ),
            ),
            (
                "files",
                header
                    .outputs
                    .iter()
                    .map(|o| code(o))
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
            (
                "exposure",
                match &header.exposure {
                    ExposurePlan::Fixed(ev) => format!("EV100 {ev:.2} for all"),
                    ExposurePlan::Curve(keys) => {
                        format!("a curve through {} key frames", keys.len())
                    }
                },
            ),
            (
                "predicted time",
                format!(
                    "{} of one machine",
                    duration(self.outline.predicted_seconds)
                ),
            ),
        ];
        if let Some((film, _)) = self.film {
            let [frames, part] = film.fps;
            let rate = Rate::new(frames, part).map_or(0.0, Rate::per_second);
            let length = film.frames as f64 / rate.max(0.1);
            facts.push((
                "film",
                format!(
                    "{:.1} s at {} frames a second, {:.1} MB, by {}",
                    length,
                    if part == 1 {
                        frames.to_string()
                    } else {
                        format!("{frames}/{part}")
                    },
                    film.bytes as f64 / 1e6,
                    escaped(&film.maker)
                ),
            ));
            if !film.line.is_empty() {
                facts.push(("film's line", code(&cluster::shell_line(&film.line))));
            }
        }
        facts.extend([
            ("command", code(&header.command)),
            ("plan", code(&self.plan.display().to_string())),
            (
                "versions",
                format!(
                    "tyndall {}, time zones {}",
                    escaped(&header.version),
                    escaped(&header.time_zones)
                ),
            ),
            ("hash of the scene", code(&header.scene_hash)),
            ("hash of the settings", code(&header.settings_hash)),
        ]);
        facts
    }

    /// All frames, or every so many.
    fn table(&self, html: &mut String) {
        let Outline {
            header: Header { frames, .. },
            lines,
            every,
            ..
        } = self.outline;
        let which = match every {
            1 => format!("{frames} frames"),
            every => format!(
                "the first of every {every} of {frames} frames, and the last; all are in <code>{}</code>",
                escaped(&self.plan.display().to_string())
            ),
        };
        let _ = write!(
            html,
            "<h2>Frames</h2>\n<details><summary>{which}</summary>\n<table class=\"frames\">\n<tr><th>number</th><th>local time</th>\
             <th>sun's azimuth</th><th>elevation</th><th>EV100</th><th>predicted [s]</th><th>key</th><th>skipped effects</th></tr>\n"
        );
        for line in lines {
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td>{}</td><td>{:.2}°</td><td>{:.2}°</td><td>{:.2}</td><td>{:.1}</td><td><code>{}</code></td>\
                 <td class=\"words\">{}</td></tr>",
                line.index,
                escaped(&line.local.replacen('T', " ", 1)),
                line.sun_azimuth_deg,
                line.sun_elevation_deg,
                line.ev100,
                line.predicted_seconds,
                escaped(line.key.get(..8).unwrap_or(&line.key)),
                escaped(&line.skipped.join(", "))
            );
        }
        *html += "</table>\n</details>\n";
    }
}

/// A text inside the quotes of an attribute.
fn attribute(text: &str) -> String {
    escaped(text).replace('"', "&quot;")
}

/// A time in the unit that people would say it in.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// The address of a file from a page beside it or elsewhere: relative where both are below one folder, with what addresses cannot hold
/// escaped.
pub fn address(page: &Path, file: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (page, file) = (absolute(page), absolute(file));
    let mut folder = page.parent().unwrap_or(Path::new("/"));
    let mut up = String::new();
    let below = loop {
        match (file.strip_prefix(folder), folder.parent()) {
            (Ok(below), _) => break below.to_owned(),
            (Err(_), Some(parent)) => {
                up += "../";
                folder = parent;
            }
            (Err(_), None) => break file.clone(),
        }
    };
    let parts = below.components().map(|part| {
        let text = part.as_os_str().to_string_lossy().into_owned();
        let mut escaped = String::new();
        for byte in text.bytes() {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => {
                    escaped.push(char::from(byte));
                }
                _ => {
                    let _ = write!(escaped, "%{byte:02X}");
                }
            }
        }
        escaped
    });
    up + &parts.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_is_found_from_its_page() {
        let from = |page: &str, film: &str| address(Path::new(page), Path::new(film));
        assert_eq!(from("out/day.html", "out/day.mp4"), "day.mp4");
        assert_eq!(from("day.html", "a b/5#1?.mp4"), "a%20b/5%231%3F.mp4");
        assert_eq!(from("pages/day.html", "films/day.mp4"), "../films/day.mp4");
    }

    #[test]
    fn times_as_people_say_them() {
        assert_eq!(duration(59.6), "60 s");
        assert_eq!(duration(3600.0), "60 min");
        assert_eq!(duration(9000.0), "2.5 h");
    }
}
