//! A year as a picture: days from left to right, hours from bottom to top, colours by illuminance.

use std::fmt::Write;

/// What colours stand for: from so many lux on.
const CLASSES: [(f64, &str); 9] = [
    (0.0, "#0d0a1c"),
    (10.0, "#2b1a4f"),
    (50.0, "#53206a"),
    (100.0, "#8a2a68"),
    (300.0, "#c63f56"),
    (500.0, "#ec6a3f"),
    (1000.0, "#f9a13a"),
    (3000.0, "#fbd665"),
    (10_000.0, "#fdf8d0"),
];

/// Size of an hour of a day, and where the first one begins.
const CELL: [f64; 2] = [2.4, 9.0];
const ORIGIN: [f64; 2] = [40.0, 12.0];

/// Days of the months, and their names.
const MONTHS: [(&str, usize); 12] = [
    ("Jan", 31),
    ("Feb", 28),
    ("Mar", 31),
    ("Apr", 30),
    ("May", 31),
    ("Jun", 30),
    ("Jul", 31),
    ("Aug", 31),
    ("Sep", 30),
    ("Oct", 31),
    ("Nov", 30),
    ("Dec", 31),
];

/// The class of an illuminance [lx].
fn class(lux: f64) -> usize {
    CLASSES
        .iter()
        .rposition(|(from, _)| lux >= *from)
        .unwrap_or(0)
}

/// An SVG of the illuminance of all hours of a year [lx], 24 a day; `what` says what it is of.
pub fn svg(hours: &[f64], what: &str) -> String {
    let days = hours.len().div_ceil(24);
    let [width, height] = [CELL[0] * days as f64, CELL[1] * 24.0];
    let [left, top] = ORIGIN;
    let (whole, tall) = (left + width + 12.0, top + height + 62.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {whole:.0} {tall:.0}\" width=\"{whole:.0}\" height=\"{tall:.0}\" \
         font-family=\"sans-serif\" font-size=\"11\" role=\"img\">\n<title>{what}</title>\n\
         <rect x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{}\"/>\n",
        CLASSES[0].1
    );
    for (number, (_, colour)) in CLASSES.iter().enumerate().skip(1) {
        let mut path = String::new();
        for day in 0..days {
            let of = |hour: usize| hours.get(24 * day + hour).map_or(0, |lux| class(*lux));
            let mut hour = 0;
            while hour < 24 {
                let run = (hour..24).take_while(|h| of(*h) == number).count();
                if run > 0 {
                    // The first hour lies at the bottom.
                    let x = left + CELL[0] * day as f64;
                    let y = top + height - CELL[1] * (hour + run) as f64;
                    let tall = CELL[1] * run as f64;
                    let _ = write!(path, "M{x:.1} {y:.1}h{}v{tall:.1}h-{}z", CELL[0], CELL[0]);
                }
                hour += run.max(1);
            }
        }
        if !path.is_empty() {
            let _ = writeln!(
                text,
                "<path d=\"{path}\" fill=\"{colour}\" shape-rendering=\"crispEdges\"/>"
            );
        }
    }
    for hour in (0..=24).step_by(6) {
        let y = top + height - CELL[1] * f64::from(hour);
        let _ = writeln!(
            text,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{hour}:00</text><path d=\"M{left} {y:.1}h-4\" stroke=\"#444\"/>",
            left - 6.0,
            y + 4.0
        );
    }
    let mut first = 0;
    for (month, (name, count)) in MONTHS.into_iter().enumerate() {
        let count = count + usize::from(month == 1 && days == 366);
        let x = left + CELL[0] * first as f64;
        let middle = x + 0.5 * CELL[0] * count as f64;
        let y = top + height;
        let _ = writeln!(
            text,
            "<path d=\"M{x:.1} {y:.1}v5\" stroke=\"#444\"/><text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{name}</text>",
            y + 15.0
        );
        first += count;
    }
    let y = top + height + 28.0;
    let step = width / CLASSES.len() as f64;
    for (i, (from, colour)) in CLASSES.iter().enumerate() {
        let x = left + step * i as f64;
        let label = match CLASSES.get(i + 1) {
            Some((to, _)) if i == 0 => format!("below {to} lx"),
            Some((to, _)) => format!("{from} to {to}"),
            None => format!("{from} and more"),
        };
        let _ = writeln!(
            text,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{step:.1}\" height=\"10\" fill=\"{colour}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"9.5\">{label}</text>",
            x + 0.5 * step,
            y + 22.0
        );
    }
    text + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_cover_the_hours_that_they_stand_for() {
        // 400 lx from 8 to 12 o'clock on the first day, 4 000 lx in the last hour of the year.
        let mut hours = vec![0.0; 8760];
        hours[8..12].fill(400.0);
        hours[8759] = 4000.0;
        let text = svg(&hours, "a test");
        let path = |colour: &str| {
            let line = text
                .lines()
                .find(|l| l.starts_with("<path d=\"M") && l.contains(colour));
            line.map(|line| line.split('"').nth(1).expect("a path").to_owned())
        };
        let [left, top] = ORIGIN;
        let bottom = top + 24.0 * CELL[1];
        let y = bottom - 12.0 * CELL[1];
        assert_eq!(
            path(CLASSES[4].1).as_deref(),
            Some(&*format!("M{left:.1} {y:.1}h2.4v36.0h-2.4z"))
        );
        let x = left + 364.0 * CELL[0];
        assert_eq!(
            path(CLASSES[7].1).as_deref(),
            Some(&*format!("M{x:.1} {top:.1}h2.4v9.0h-2.4z"))
        );
        assert_eq!(path(CLASSES[6].1), None);
        assert_eq!([9.9, 10.0, 299.9, 300.0, 1e9].map(class), [0, 1, 3, 4, 8]);
    }
}
