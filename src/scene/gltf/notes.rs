//! What a glTF file holds and the scene does not, gathered while it is read.

use crate::scene::text::cut;
use crate::warning::Warning;
use glam::DQuat;
use std::collections::BTreeMap;

/// What is said of a file that is read all the same.
#[derive(Default)]
pub(super) struct Notes {
    materials: BTreeMap<String, usize>,
    others: BTreeMap<String, usize>,
    warnings: Vec<Warning>,
}

impl Notes {
    /// A property of a material that has no use here.
    pub fn of_material(&mut self, what: impl Into<String>) {
        *self.materials.entry(what.into()).or_default() += 1;
    }

    /// Anything else that is left out, or stands for less than it says.
    pub fn leave_out(&mut self, what: impl Into<String>) {
        *self.others.entry(what.into()).or_default() += 1;
    }

    /// As many things of one kind that are left out; none is nothing to say.
    pub fn leave_out_all(&mut self, what: &str, count: usize) {
        if count > 0 {
            *self.others.entry(what.to_owned()).or_default() += count;
        }
    }

    /// A rotation that is not of unit length beyond rounding, and is made so.
    pub fn leave_out_length(&mut self, rotation: DQuat) {
        if (rotation.length() - 1.0).abs() > 1e-3 {
            self.leave_out("length of a rotation that is not 1");
        }
    }

    /// A part of the file that is wrong, and what is there instead.
    pub fn mend(&mut self, problem: impl Into<String>, instead: impl Into<String>) {
        self.warn(Warning::Mended {
            problem: problem.into(),
            instead: instead.into(),
        });
    }

    pub fn warn(&mut self, warning: Warning) {
        self.warnings.push(warning);
    }

    /// All of it, the tables first.
    pub fn into_warnings(self, file: &str) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if !self.materials.is_empty() {
            warnings.push(Warning::IgnoredMaterialProperties {
                file: file.to_owned(),
                properties: self.materials,
            });
        }
        if !self.others.is_empty() {
            warnings.push(Warning::LeftOut {
                file: file.to_owned(),
                things: self.others,
            });
        }
        warnings.extend(self.warnings);
        warnings
    }
}

/// A text of the user's for a message: its first words, if it is long, without control characters.
pub(super) fn shown(text: &str) -> String {
    let start = text.trim_start().get(..5).unwrap_or_default();
    // Of a `data:` URI, its kind: the rest is for machines.
    let most = if start.eq_ignore_ascii_case("data:") {
        40
    } else {
        80
    };
    cut(text, most)
}

/// A number for a message: as it is written, or with an exponent where that would be long.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || (1e-6..1e9).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}
