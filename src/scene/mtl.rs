//! Materials of Wavefront MTL files.
//!
//! Of a material its diffuse colour, its light and its opacity count: `Kd` (RGB or XYZ, linear) and `map_Kd` with `-s`, `-o`
//! and `-clamp`; `Ke` in cd/m2; `d`, `Tr`, `map_d` and the alpha of `map_Kd`. Of the rest, what would change a picture is named in one
//! warning. A line that cannot be read costs that line.

use super::emission::MOST_LUMINANCE;
use super::text::{Faults, Line, LinesOf, number, shortened, tally};
use crate::colour::{Space, working_from_xyz};
use crate::error::Result;
use glam::{DVec2, DVec3};
use std::collections::{BTreeMap, HashMap};

/// A material of a file.
pub(super) struct Entry {
    pub name: String,
    pub look: Look,
    /// The file, by its number, and the line where it begins.
    pub library: usize,
    pub line: usize,
}

/// What counts of a material.
#[derive(Debug, PartialEq)]
pub(super) struct Look {
    /// Linear Rec. 709, 0 to 1.
    pub diffuse: Option<DVec3>,
    /// `Ke`: luminance [cd/m2], linear Rec. 709.
    pub emission: DVec3,
    /// 0 to 1.
    pub opacity: f64,
    pub diffuse_map: Option<Map>,
    pub opacity_map: Option<Map>,
}

/// A picture that a material names.
#[derive(Debug, PartialEq)]
pub(super) struct Map {
    pub name: String,
    /// `-s` and `-o`: a texture coordinate is scaled, then moved; v up.
    pub scale: DVec2,
    pub offset: DVec2,
    /// `-clamp on`: the edge goes on outside 0 to 1.
    pub clamp: bool,
    /// `-imfchan`: which number of a texel is the value.
    pub channel: Option<Channel>,
}

/// Which number of a texel is the value of a map that has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Channel {
    Red,
    Green,
    Blue,
    /// Alpha (the format says matte).
    Alpha,
    Luminance,
}

/// Materials by their names, from all files read so far.
#[derive(Default)]
pub(super) struct Shelf {
    pub entries: Vec<Entry>,
    exact: HashMap<String, usize>,
    loose: HashMap<String, usize>,
}

/// What a file holds beside its materials.
#[derive(Default)]
pub(super) struct Remarks {
    pub faults: Faults,
    /// What the renderer has no use for, and how many materials have it.
    pub left_out: BTreeMap<String, usize>,
}

/// Keys that say nothing that a Lambertian surface of this colour does not already show.
const WITHOUT_EFFECT: [&str; 5] = ["ka", "ns", "ni", "map_ns", "sharpness"];

/// Keys that have an effect unless all their numbers are these.
const NEUTRAL: [(&str, f64); 8] = [
    ("ks", 0.0),
    ("tf", 1.0),
    ("pm", 0.0),
    ("ps", 0.0),
    ("pc", 0.0),
    ("aniso", 0.0),
    ("anisor", 0.0),
    ("pcr", 0.0),
];

/// Options of a map before its name: the option, how many words follow it at least and at most, what they are where
/// they change nothing.
const OPTIONS: [(&str, usize, usize, &[&str]); 14] = [
    ("-blendu", 1, 1, &["on"]),
    ("-blendv", 1, 1, &["on"]),
    ("-bm", 1, 1, &[]),
    ("-boost", 1, 1, &["0"]),
    ("-cc", 1, 1, &["off"]),
    ("-clamp", 1, 1, &["off"]),
    ("-colorspace", 1, 1, &["srgb"]),
    ("-imfchan", 1, 1, &[]),
    ("-mm", 1, 2, &["0", "1"]),
    ("-o", 1, 3, &["0", "0", "0"]),
    ("-s", 1, 3, &["1", "1", "1"]),
    ("-t", 1, 3, &["0", "0", "0"]),
    ("-texres", 1, 1, &[]),
    ("-type", 1, 1, &[]),
];

impl Shelf {
    /// Adds the materials of a file. Of two of one name the later counts, and it is said.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when it is not text in one byte a letter or UTF-8.
    pub fn read(&mut self, file: &str, bytes: &[u8], library: usize) -> Result<Remarks> {
        let mut remarks = Remarks::default();
        let mut open: Option<Reading> = None;
        for line in LinesOf::new(file, bytes)? {
            let (keyword, words) = line.words();
            if keyword.is_empty() || keyword[0] == b'#' {
                continue;
            }
            let key = String::from_utf8_lossy(keyword).to_ascii_lowercase();
            if key == "newmtl" {
                self.close(open.take(), &mut remarks);
                open = Some(Reading::new(line.name(), library, line.number));
                continue;
            }
            let mut fault = |problem| {
                remarks.faults.add(problem, line.number, || line.shown());
            };
            let Some(open) = &mut open else {
                fault("it stands before any `newmtl`; left out");
                continue;
            };
            if words.clone().next().is_none() {
                fault("a key without a value; left out");
                continue;
            }
            open.take(&key, &line, &mut fault);
        }
        self.close(open, &mut remarks);
        Ok(remarks)
    }

    fn close(&mut self, open: Option<Reading>, remarks: &mut Remarks) {
        let Some(reading) = open else { return };
        let mut entry = reading.entry;
        let mut fault = |problem| {
            remarks
                .faults
                .add(problem, entry.line, || shortened(&entry.name));
        };
        let (d, tr) = (reading.dissolve, reading.transparency);
        let opacity = d.or(tr.map(|tr| 1.0 - tr)).unwrap_or(1.0);
        if let (Some(d), Some(tr)) = (d, tr)
            && (d + tr - 1.0).abs() > 1e-3
        {
            fault("d and Tr disagree (Tr is one less d); d counts");
        }
        if opacity == 0.0 {
            fault("a material that nothing is seen of, by its d or Tr");
        }
        entry.look.opacity = opacity;
        for what in reading.left_out {
            tally(&mut remarks.left_out, &what, 1);
        }
        let loose = loosely(&entry.name);
        match self.exact.get(&entry.name) {
            Some(&known) => {
                if self.entries[known].look != entry.look {
                    remarks.faults.add(
                        "a material of that name is already there; this one counts",
                        entry.line,
                        || shortened(&entry.name),
                    );
                }
                self.entries[known] = entry;
            }
            None => {
                let index = self.entries.len();
                self.exact.insert(entry.name.clone(), index);
                self.loose.entry(loose).or_insert(index);
                self.entries.push(entry);
            }
        }
    }

    /// The material of a name, and whether it is called exactly that; otherwise only the case of letters differs, or
    /// one of the two has a comment after it.
    pub fn find(&self, name: &str) -> Option<(usize, bool)> {
        let exact = self.exact.get(name).map(|&i| (i, true));
        exact.or_else(|| self.loose.get(&loosely(name)).map(|&i| (i, false)))
    }
}

/// A name as it may be written elsewhere.
fn loosely(name: &str) -> String {
    let is_comment = |(at, _): &(usize, &str)| {
        let after = name[at + 2..].chars().next();
        // `Material #25` is a name.
        !after.is_some_and(|c| c.is_ascii_digit())
    };
    let end = name.match_indices(" #").find(is_comment);
    let name = &name[..end.map_or(name.len(), |(at, _)| at)];
    name.trim().to_lowercase()
}

/// A material whose lines are being read.
struct Reading {
    entry: Entry,
    dissolve: Option<f64>,
    transparency: Option<f64>,
    left_out: Vec<String>,
}

impl Reading {
    fn new(name: String, library: usize, line: usize) -> Self {
        Reading {
            entry: Entry {
                name,
                look: Look {
                    diffuse: None,
                    emission: DVec3::ZERO,
                    opacity: 1.0,
                    diffuse_map: None,
                    opacity_map: None,
                },
                library,
                line,
            },
            dissolve: None,
            transparency: None,
            left_out: Vec::new(),
        }
    }

    fn leave_out(&mut self, what: &str) {
        // The least that keeps a material of a million odd keys from being a million names.
        if self.left_out.len() < 64 && !self.left_out.iter().any(|known| known == what) {
            self.left_out.push(what.to_owned());
        }
    }

    /// Takes a line whose keyword, in lower case, is `key`, and which has words after it.
    fn take(&mut self, key: &str, line: &Line, fault: &mut impl FnMut(&'static str)) {
        let (keyword, mut words) = line.words();
        let numbers = || words_as_numbers(line.words().1);
        let first = words.next().unwrap_or_default();
        match key {
            "kd" if first.eq_ignore_ascii_case(b"spectral") => self.leave_out("Kd spectral"),
            "kd" => {
                let is_xyz = first.eq_ignore_ascii_case(b"xyz");
                let values = if is_xyz {
                    words_as_numbers(words)
                } else {
                    numbers()
                };
                let color = match values.as_deref() {
                    Some(&[r]) => DVec3::splat(r),
                    Some(&[r, g, b, ..]) => DVec3::new(r, g, b),
                    _ => return fault("Kd needs one number or three; left out"),
                };
                if values.is_some_and(|v| v.len() > 3) {
                    fault("Kd has more than three numbers; the rest left out");
                }
                let color = if is_xyz {
                    Space::Rec709.from_working() * working_from_xyz(color)
                } else {
                    color
                };
                let inside = color.clamp(DVec3::ZERO, DVec3::ONE);
                if color != inside {
                    fault("Kd is outside 0 to 1; the nearest inside is taken");
                }
                let before = self.entry.look.diffuse.replace(inside);
                if before.is_some_and(|before| before != inside) {
                    fault("Kd is there again, and not the same; this one counts");
                }
            }
            "ke" if first.eq_ignore_ascii_case(b"spectral")
                || first.eq_ignore_ascii_case(b"xyz") =>
            {
                self.leave_out("Ke spectral or xyz");
            }
            "ke" => {
                let emission = match numbers().as_deref() {
                    Some(&[all]) => DVec3::splat(all),
                    Some(&[r, g, b, ..]) => DVec3::new(r, g, b),
                    _ => return fault("Ke needs one number or three; left out"),
                };
                let inside = emission.clamp(DVec3::ZERO, DVec3::splat(MOST_LUMINANCE));
                if emission != inside {
                    fault("Ke is outside 0 to 1e9 cd/m2; the nearest inside is taken");
                }
                self.entry.look.emission = inside;
            }
            "d" | "tr" => self.opacity(key, line, fault),
            "map_kd" => {
                let map = self.map(line, "map_Kd");
                if map.name.is_empty() {
                    return fault("map_Kd names no picture; left out");
                }
                if self.entry.look.diffuse_map.replace(map).is_some() {
                    fault("map_Kd is there again; this one counts");
                }
            }
            "map_d" | "map_opacity" => {
                let map = self.map(line, "map_d");
                if map.name.is_empty() {
                    return fault("map_d names no picture; left out");
                }
                if self.entry.look.opacity_map.replace(map).is_some() {
                    fault("map_d is there again; this one counts");
                }
            }
            // Reflections and glass; up to 2 the surface is as lit here as there.
            "illum" => {
                if numbers().is_some_and(|n| (3.0..=9.0).contains(&n[0])) {
                    self.leave_out("illum 3 and above");
                }
            }
            _ if WITHOUT_EFFECT.contains(&key) => {}
            _ => {
                let neutral = NEUTRAL.iter().find(|(k, _)| *k == key).map(|(_, n)| *n);
                let is_neutral = neutral
                    .is_some_and(|n| numbers().is_some_and(|all| all.iter().all(|&x| x == n)));
                if !is_neutral {
                    self.leave_out(&String::from_utf8_lossy(keyword));
                }
            }
        }
    }

    /// `d`, and `Tr`, which is one less `d`. Where both are there, `d` counts.
    fn opacity(&mut self, key: &str, line: &Line, fault: &mut impl FnMut(&'static str)) {
        let mut words = line.words().1.peekable();
        if words
            .next_if(|w| w.eq_ignore_ascii_case(b"-halo"))
            .is_some()
        {
            self.leave_out("d -halo");
        }
        let Some(&[value]) = words_as_numbers(words).as_deref() else {
            return fault("it needs one number; left out");
        };
        let inside = value.clamp(0.0, 1.0);
        if value != inside {
            fault("it is outside 0 to 1; the nearest inside is taken");
        }
        let place = if key == "d" {
            &mut self.dissolve
        } else {
            &mut self.transparency
        };
        if place.replace(inside).is_some_and(|before| before != inside) {
            fault("it is there again, and not the same; this one counts");
        }
    }

    /// A map: options, then the name of a picture, which may hold spaces. Options after the name are taken too.
    fn map(&mut self, line: &Line, key: &str) -> Map {
        let text = line.name();
        let mut map = Map {
            name: String::new(),
            scale: DVec2::ONE,
            offset: DVec2::ZERO,
            clamp: false,
            channel: None,
        };
        let rest = self.options(key, &text, false, &mut map);
        let is_option = |word: &str| OPTIONS.iter().any(|o| o.0.eq_ignore_ascii_case(word));
        let mut words = rest.split_inclusive(char::is_whitespace);
        let mut end = words.next().map_or(0, str::len);
        end += words
            .take_while(|word| !is_option(word.trim()))
            .map(str::len)
            .sum::<usize>();
        self.options(key, &rest[end..], true, &mut map);
        map.name = rest[..end].trim().trim_matches('"').to_owned();
        map
    }

    /// Reads options from the start of `text`; what stands after them. Unless they are `trailing`, a word is left.
    fn options<'t>(&mut self, key: &str, text: &'t str, trailing: bool, map: &mut Map) -> &'t str {
        let mut rest = text.trim();
        loop {
            let (word, mut after) = first_word(rest);
            let option = OPTIONS.iter().find(|o| o.0.eq_ignore_ascii_case(word));
            let Some(&(option, least, most, neutral)) = option else {
                return rest;
            };
            let mut values: Vec<&str> = Vec::new();
            while values.len() < most {
                let (value, beyond) = first_word(after);
                let is_number = number(value.as_bytes()).is_some();
                let is_last = beyond.trim().is_empty() && !trailing;
                if value.is_empty() || is_last || (most > 1 && !is_number) {
                    break;
                }
                values.push(value);
                after = beyond;
            }
            if values.len() < least {
                return rest;
            }
            rest = after.trim_start();
            let numbers = || {
                let mut numbers = values.iter().filter_map(|v| number(v.as_bytes()));
                [numbers.next(), numbers.next()]
            };
            let is_on = values[0].eq_ignore_ascii_case("on");
            let channel = match values[0].to_ascii_lowercase().as_str() {
                "r" => Some(Channel::Red),
                "g" => Some(Channel::Green),
                "b" => Some(Channel::Blue),
                "m" => Some(Channel::Alpha),
                "l" => Some(Channel::Luminance),
                _ => None,
            };
            match option {
                "-s" => {
                    let [u, v] = numbers();
                    map.scale = DVec2::new(u.unwrap_or(1.0), v.unwrap_or(1.0));
                }
                "-o" => {
                    let [u, v] = numbers();
                    map.offset = DVec2::new(u.unwrap_or(0.0), v.unwrap_or(0.0));
                }
                "-clamp" => map.clamp = is_on,
                "-imfchan" if key == "map_d" && channel.is_some() => map.channel = channel,
                _ => {
                    let same = |(value, neutral): (&&str, &&str)| match (
                        number(value.as_bytes()),
                        number(neutral.as_bytes()),
                    ) {
                        (Some(a), Some(b)) => a == b,
                        _ => value.eq_ignore_ascii_case(neutral),
                    };
                    if neutral.is_empty() || !values.iter().zip(neutral).all(same) {
                        self.leave_out(&format!("{key} {option}"));
                    }
                }
            }
        }
    }
}

/// The first word of a text, and what stands after it.
fn first_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()))
}

/// All words as numbers, if all are, and there is one.
fn words_as_numbers<'w>(words: impl Iterator<Item = &'w [u8]>) -> Option<Vec<f64>> {
    // More than any line needs.
    let numbers: Option<Vec<f64>> = words.take(8).map(number).collect();
    numbers.filter(|numbers| !numbers.is_empty())
}
