//! What the lines of an OBJ file say, before any material is looked for.

use super::text::{Faults, Line, LinesOf, number, tally};
use crate::error::{Error, Result};
use glam::{DVec2, DVec3, DVec4};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Index of what a corner of a face does not have.
pub(super) const NONE: u32 = u32::MAX;
/// Index of what is not there, and cannot be.
const NOWHERE: u32 = u32::MAX - 1;

/// What the lines of a file say. What a bad line would define is NaN, so that the numbers of the others stay.
#[derive(Default)]
pub(super) struct Model {
    pub positions: Vec<DVec3>,
    /// Empty, or as long as `positions`.
    pub colors: Vec<DVec4>,
    pub uvs: Vec<DVec2>,
    pub normals: Vec<DVec3>,
    pub faces: Vec<Face>,
    /// Position, texture coordinate and normal of the corners of all faces.
    pub corners: Vec<[u32; 3]>,
    /// Names of materials, with the first line that uses each; the first is none.
    pub names: Vec<(String, usize)>,
    /// Names of objects, each as `o` and `g` give them; the first has none.
    pub objects: Vec<Vec<String>>,
    /// Whether an `o` was there: then it is the first name of each object.
    has_object: bool,
    pub runs: Vec<Run>,
    /// What `mtllib` says.
    pub libraries: Vec<String>,
    /// Statements that are not read, with how often.
    pub statements: BTreeMap<String, usize>,
    pub faults: Faults,
}

#[derive(Clone, Copy)]
pub(super) struct Face {
    pub corners: u32,
    pub line: u32,
}

/// Faces of one material and one object.
pub(super) struct Run {
    /// Index into the names.
    pub name: usize,
    /// Index into the objects.
    pub object: usize,
    /// The last face's number plus one.
    pub end: usize,
}

impl Model {
    pub fn read(file: &str, bytes: &[u8]) -> Result<Model> {
        let mut model = Model::default();
        model.names.push((String::new(), 0));
        model.objects.push(Vec::new());
        let mut numbers: HashMap<String, usize> = HashMap::from([(String::new(), 0)]);
        let mut libraries = HashSet::new();
        let mut name = 0;
        let mut known = false;
        for line in LinesOf::new(file, bytes)? {
            let (keyword, mut words) = line.words();
            let lower;
            let keyword = if keyword.iter().any(u8::is_ascii_uppercase) {
                lower = keyword.to_ascii_lowercase();
                &lower[..]
            } else {
                keyword
            };
            known |= matches!(
                keyword,
                b"v" | b"vt" | b"vn" | b"f" | b"o" | b"g" | b"mtllib" | b"usemtl"
            );
            match keyword {
                b"" => {}
                b"v" => model.vertex(&line)?,
                b"vt" => model.uv(&line)?,
                b"vn" => model.normal(&line)?,
                b"f" | b"fo" => model.face(&line, name)?,
                b"usemtl" => {
                    let text = line.name();
                    name = *numbers.entry(text).or_insert_with_key(|text| {
                        model.names.push((text.clone(), line.number));
                        model.names.len() - 1
                    });
                }
                b"mtllib" => {
                    let text = line.name();
                    if text.is_empty() {
                        model.fault("it names no file; left out", &line);
                    } else if libraries.insert(text.clone()) {
                        model.libraries.push(text);
                    }
                }
                b"o" => model.object(line.name(), true),
                b"g" => model.object(line.name(), false),
                // Smoothing changes no picture.
                b"s" => {}
                // Colours that one program hides in comments.
                b"#mrgb" => tally(&mut model.statements, "#MRGB (colours of vertices)", 1),
                _ if keyword[0] == b'#' => {}
                _ => {
                    let can_be_off = matches!(
                        keyword,
                        b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"mg"
                    );
                    let is_off = matches!(words.next(), Some(b"off" | b"OFF" | b"0"));
                    if !(can_be_off && is_off) {
                        let shown = String::from_utf8_lossy(&keyword[..keyword.len().min(80)]);
                        tally(&mut model.statements, &shown, 1);
                    }
                }
            }
        }
        if !known {
            return Err(Error::input(
                file,
                "there is nothing of an OBJ file in it",
                "name a glTF, GLB, OBJ or TOML scene file",
            ));
        }
        if !model.colors.is_empty() {
            model.colors.resize(model.positions.len(), DVec4::ONE);
        }
        Ok(model)
    }

    fn fault(&mut self, problem: &'static str, line: &Line) {
        self.faults.add(problem, line.number, || line.shown());
    }

    /// The numbers of a line, of which there must be `least` and should be no more than `most`.
    fn numbers<const N: usize>(
        &mut self,
        line: &Line,
        least: usize,
        problem: &'static str,
    ) -> Option<([f64; N], usize)> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        for word in line.words().1 {
            if count == N {
                self.fault("more numbers than are read; the rest left out", line);
                break;
            }
            let Some(value) = number(word).or_else(|| self.decimal_comma(word, line)) else {
                self.fault(problem, line);
                return None;
            };
            numbers[count] = value;
            count += 1;
        }
        if count < least {
            self.fault(problem, line);
            return None;
        }
        Some((numbers, count))
    }

    /// Some programs write numbers as their user's language does.
    fn decimal_comma(&mut self, word: &[u8], line: &Line) -> Option<f64> {
        let comma = word.iter().position(|&b| b == b',')?;
        let mut word = word.to_owned();
        word[comma] = b'.';
        let value = number(&word)?;
        self.fault("commas in numbers, read as decimal points", line);
        Some(value)
    }

    /// Faces from now on belong to another object (`o`) or group (`g`). A group of several words is several groups or one: each word
    /// and all of it are its names.
    fn object(&mut self, name: String, is_object: bool) {
        let before = self.objects.last();
        let mut names: Vec<String> = match is_object {
            true => Vec::new(),
            false => before
                .iter()
                .flat_map(|names| names.first().cloned())
                .take(self.has_object.into())
                .collect(),
        };
        if is_object {
            self.has_object = !name.is_empty();
        }
        if !is_object && name.contains(char::is_whitespace) {
            names.extend(name.split_whitespace().map(str::to_owned));
        }
        names.extend((!name.is_empty()).then_some(name));
        // What names no face needs no place of its own.
        let is_used = self
            .runs
            .last()
            .is_some_and(|run| run.object + 1 == self.objects.len());
        match self.objects.last_mut() {
            Some(last) if !is_used => *last = names,
            _ => self.objects.push(names),
        }
    }

    fn vertex(&mut self, line: &Line) -> Result<()> {
        let problem = "a vertex needs three finite numbers; left out, with the faces that name it";
        let Some((n, count)) = self.numbers::<7>(line, 3, problem) else {
            return keep(&mut self.positions, DVec3::NAN);
        };
        match count {
            4 if n[3] != 1.0 => self.fault("the weight of a vertex; left out", line),
            5 => self.fault("more numbers than are read; the rest left out", line),
            6 | 7 => {
                self.colors.resize(self.positions.len(), DVec4::ONE);
                let alpha = if count == 7 { n[6] } else { 1.0 };
                keep(&mut self.colors, DVec4::new(n[3], n[4], n[5], alpha))?;
            }
            _ => {}
        }
        keep(&mut self.positions, DVec3::new(n[0], n[1], n[2]))
    }

    fn uv(&mut self, line: &Line) -> Result<()> {
        let problem = "a texture coordinate needs a finite number or more; left out";
        let uv = match self.numbers::<3>(line, 1, problem) {
            Some((n, _)) => DVec2::new(n[0], n[1]),
            None => DVec2::NAN,
        };
        keep(&mut self.uvs, uv)
    }

    fn normal(&mut self, line: &Line) -> Result<()> {
        let problem = "a normal needs three finite numbers; left out";
        let normal = match self.numbers::<3>(line, 3, problem) {
            Some((n, _)) => {
                let normal = DVec3::from_array(n);
                if normal.normalize_or_zero() == DVec3::ZERO {
                    self.fault(
                        "a normal without a length; the face has its own there",
                        line,
                    );
                }
                normal
            }
            None => DVec3::NAN,
        };
        keep(&mut self.normals, normal)
    }

    fn face(&mut self, line: &Line, name: usize) -> Result<()> {
        let start = self.corners.len();
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for word in line.words().1 {
            let Some(corner) = corner(word, counts) else {
                self.corners.truncate(start);
                self.fault(
                    "a corner of a face is v, v/vt, v//vn or v/vt/vn; the face left out",
                    line,
                );
                return Ok(());
            };
            keep(&mut self.corners, corner)?;
        }
        let count = self.corners.len() - start;
        match u32::try_from(count) {
            Ok(corners) if count >= 3 => {
                let line = u32::try_from(line.number).unwrap_or(u32::MAX);
                keep(&mut self.faces, Face { corners, line })?;
            }
            _ => {
                self.corners.truncate(start);
                self.fault("a face needs three corners or more; left out", line);
                return Ok(());
            }
        }
        let end = self.faces.len();
        let object = self.objects.len() - 1;
        match self.runs.last_mut() {
            Some(run) if run.name == name && run.object == object => run.end = end,
            _ => keep(&mut self.runs, Run { name, object, end })?,
        }
        Ok(())
    }
}

/// Adds to a list that may grow as large as the file is.
fn keep<T>(list: &mut Vec<T>, item: T) -> Result<()> {
    if list.len() == list.capacity() {
        list.try_reserve(1).map_err(|_| no_memory())?;
    }
    list.push(item);
    Ok(())
}

pub(super) fn no_memory() -> Error {
    Error::failed(
        "there is no memory for the scene's geometry",
        "free memory, or simplify the scene",
    )
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0; negative numbers count back from the last of the `counts` so far.
fn corner(word: &[u8], counts: [usize; 3]) -> Option<[u32; 3]> {
    let mut corner = [NONE; 3];
    let mut parts = word.split(|&b| b == b'/');
    for (kind, index) in corner.iter_mut().enumerate() {
        match parts.next() {
            None => break,
            Some(b"") if kind > 0 => {}
            Some(part) => *index = absolute(whole_number(part)?, counts[kind]),
        }
    }
    parts.next().is_none().then_some(corner)
}

fn absolute(written: i64, count: usize) -> u32 {
    let index = match written {
        1.. => written - 1,
        0 => return NOWHERE,
        _ => count as i64 + written,
    };
    u32::try_from(index).map_or(NOWHERE, |index| index.min(NOWHERE))
}

fn whole_number(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = 10 * value + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}
