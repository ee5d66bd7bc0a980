//! Checks TOML against a JSON Schema, where line and key are still known.
//!
//! The part of JSON Schema that [`super::toml`] makes is understood: objects, arrays of fixed length, numbers with
//! ranges, strings with choices, and alternatives distinguished by a tag or by being a number or an array.

use crate::error::{Error, Result};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table that fits its schema, and where each of its keys stands.
pub(super) struct Checked {
    /// The table as JSON.
    pub value: Value,
    file: String,
    lines: BTreeMap<String, usize>,
}

impl Checked {
    /// `FILE:LINE: KEY` of a key such as `medium[0].max`, or of the nearest table around it.
    pub fn place(&self, key: &str) -> String {
        let mut around = key;
        loop {
            if let Some(line) = self.lines.get(around) {
                return format!("{}:{line}: {key}", self.file);
            }
            match around.rfind(['.', '[']) {
                Some(end) => around = &around[..end],
                None => return format!("{}: {key}", self.file),
            }
        }
    }
}

/// Removes `null` from what a schema allows: TOML has none, and a key that may be absent is not required.
pub(super) fn without_null(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::Array(types)) = map.get_mut("type") {
                types.retain(|t| t != "null");
                if let [only] = &types[..] {
                    let only = only.clone();
                    map.insert("type".into(), only);
                }
            }
            if let Some(Value::Array(any)) = map.get_mut("anyOf") {
                any.retain(|a| a.get("type").is_none_or(|t| t != "null"));
                if let [Value::Object(only)] = &any[..] {
                    let only = only.clone();
                    map.remove("anyOf");
                    map.extend(only);
                }
            }
            map.values_mut().for_each(without_null);
        }
        Value::Array(list) => list.iter_mut().for_each(without_null),
        _ => {}
    }
}

/// Parses `text`, the content of `path`, and checks it against `schema`.
pub(super) fn read(path: &Path, text: &str, schema: &Value) -> Result<Checked> {
    let file = path.display().to_string();
    let table = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_at(text, span.start));
        Error::input(
            format!("{file}:{line}"),
            e.message().trim(),
            "correct the TOML (see https://toml.io)",
        )
    })?;
    let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    let mut checker = Checker {
        file: &file,
        breaks: breaks.map(|(at, _)| at).collect(),
        root: schema,
        lines: BTreeMap::new(),
    };
    let value = checker.table(table.get_ref(), 0, schema, "")?;
    Ok(Checked {
        value,
        lines: checker.lines,
        file,
    })
}

/// The line of `text`, from 1, in which byte `at` stands.
fn line_at(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&b| b == b'\n').count()
}

struct Checker<'a> {
    file: &'a str,
    /// Where lines end: a file of many keys is not searched for each of them.
    breaks: Vec<usize>,
    root: &'a Value,
    lines: BTreeMap<String, usize>,
}

impl<'a> Checker<'a> {
    /// The line, from 1, in which byte `at` stands.
    fn line(&self, at: usize) -> usize {
        1 + self.breaks.partition_point(|end| *end < at)
    }

    fn error(
        &self,
        at: usize,
        key: &str,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Error {
        let line = self.line(at);
        let key = if key.is_empty() {
            String::new()
        } else {
            format!(": {key}")
        };
        Error::input(format!("{}:{line}{key}", self.file), problem, remedy)
    }

    /// Follows `$ref`, and chooses among alternatives for `value`.
    fn resolve(
        &self,
        mut schema: &'a Value,
        value: &DeValue,
        at: usize,
        key: &str,
    ) -> Result<&'a Value> {
        while let Some(name) = schema.get("$ref").and_then(Value::as_str) {
            schema = name
                .strip_prefix('#')
                .and_then(|pointer| self.root.pointer(pointer))
                .unwrap_or(&Value::Null);
        }
        if let Some(any) = schema.get("anyOf").and_then(Value::as_array) {
            let is_array = value.is_array();
            let fits = any
                .iter()
                .find(|a| (a.get("type").is_some_and(|t| t == "array")) == is_array);
            return Ok(fits.unwrap_or(&any[0]));
        }
        let Some(one) = schema.get("oneOf").and_then(Value::as_array) else {
            return Ok(schema);
        };
        // Alternatives that are tables carry a tag: the property that is a constant.
        let tag_of = |a: &'a Value| {
            let mut properties = a.get("properties")?.as_object()?.iter();
            properties.find_map(|(name, p)| Some((name.as_str(), p.get("const")?.as_str()?)))
        };
        let Some((tag, _)) = one.first().and_then(tag_of) else {
            return Ok(schema);
        };
        let Some(table) = value.as_table() else {
            return Err(self.wrong_type(value, at, key, &format!("a table with `{tag}`")));
        };
        let choices: Vec<&str> = one
            .iter()
            .filter_map(tag_of)
            .map(|(_, choice)| choice)
            .collect();
        let Some((name, given)) = table.iter().find(|(name, _)| name.get_ref() == tag) else {
            return Err(self.error(
                at,
                key,
                format!("`{tag}` is missing"),
                format!("add {tag} = {}", list(&choices)),
            ));
        };
        let key = join(key, tag);
        let Some(text) = given.get_ref().as_str() else {
            return Err(self.wrong_type(given.get_ref(), name.span().start, &key, "a string"));
        };
        let chosen = choices.iter().position(|c| *c == text);
        chosen
            .map(|i| &one[i])
            .ok_or_else(|| self.no_choice(text, given.span().start, &key, &choices))
    }

    fn table(&mut self, table: &DeTable, at: usize, schema: &'a Value, key: &str) -> Result<Value> {
        let empty = Map::new();
        let properties = schema
            .get("properties")
            .and_then(Value::as_object)
            .unwrap_or(&empty);
        let mut map = Map::new();
        for (name, value) in table {
            let full = join(key, name.get_ref());
            let Some(property) = schema
                .get("properties")
                .and_then(|p| p.get(name.get_ref().as_ref()))
            else {
                let known: Vec<&str> = properties.keys().map(String::as_str).collect();
                return Err(self.error(
                    name.span().start,
                    &full,
                    format!("there is no key `{}` here", name.get_ref()),
                    self.suggestion(name.get_ref(), &known),
                ));
            };
            let line = self.line(name.span().start);
            self.lines.insert(full.clone(), line);
            map.insert(
                name.get_ref().to_string(),
                self.value(value, property, &full)?,
            );
        }
        let required = schema
            .get("required")
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
            .filter_map(Value::as_str);
        for needed in required {
            if !map.contains_key(needed) {
                let what = properties
                    .get(needed)
                    .and_then(|p| p.get("description"))
                    .and_then(Value::as_str);
                let remedy = format!(
                    "add {needed} = ... ({})",
                    what.unwrap_or("required").trim_end_matches('.')
                );
                return Err(self.error(at, key, format!("`{needed}` is missing"), remedy));
            }
        }
        Ok(Value::Object(map))
    }

    fn value(&mut self, spanned: &Spanned<DeValue>, schema: &'a Value, key: &str) -> Result<Value> {
        let (value, at) = (spanned.get_ref(), spanned.span().start);
        let schema = self.resolve(schema, value, at, key)?;
        let kind = schema.get("type").and_then(Value::as_str).unwrap_or("");
        match (kind, value) {
            ("object", DeValue::Table(table)) => self.table(table, at, schema, key),
            ("array", DeValue::Array(array)) => {
                let bound =
                    |name: &str| schema.get(name).and_then(Value::as_u64).map(|n| n as usize);
                let (least, most) = (
                    bound("minItems").unwrap_or(0),
                    bound("maxItems").unwrap_or(usize::MAX),
                );
                if array.len() < least || array.len() > most {
                    let problem = format!("it has {} elements instead of {least}", array.len());
                    return Err(self.error(
                        at,
                        key,
                        problem,
                        format!("write {least} numbers in brackets"),
                    ));
                }
                let items = schema.get("items").unwrap_or(&Value::Null);
                let mut list = Vec::new();
                for (i, item) in array.iter().enumerate() {
                    let key = format!("{key}[{i}]");
                    let line = self.line(item.span().start);
                    self.lines.insert(key.clone(), line);
                    list.push(self.value(item, items, &key)?);
                }
                Ok(Value::Array(list))
            }
            ("number" | "integer", DeValue::Integer(_) | DeValue::Float(_)) => {
                self.number(value, at, schema, key)
            }
            ("boolean", DeValue::Boolean(b)) => Ok(Value::Bool(*b)),
            ("string", DeValue::String(text)) => {
                let choices = choices(schema);
                if choices.is_empty() || choices.contains(&text.as_ref()) {
                    Ok(Value::String(text.to_string()))
                } else {
                    Err(self.no_choice(text, at, key, &choices))
                }
            }
            // TOML has dates of its own; as text they read the same.
            ("string", DeValue::Datetime(date)) if choices(schema).is_empty() => {
                Ok(Value::String(date.to_string()))
            }
            _ => {
                let wanted = match kind {
                    "object" => "a table",
                    "array" if schema.get("minItems").is_some() => "numbers in brackets",
                    "array" => "an array of tables, written with double brackets",
                    "boolean" => "true or false",
                    "string" => "text in quotes",
                    _ => "a number",
                };
                Err(self.wrong_type(value, at, key, wanted))
            }
        }
    }

    fn number(&self, value: &DeValue, at: usize, schema: &Value, key: &str) -> Result<Value> {
        let integer = schema.get("type").is_some_and(|t| t == "integer");
        let whole = value
            .as_integer()
            .and_then(|i| i64::from_str_radix(i.as_str(), i.radix()).ok());
        let number = whole
            .map(|i| i as f64)
            .or_else(|| value.as_float()?.as_str().parse().ok());
        let bound = |name: &str| schema.get(name).and_then(Value::as_f64);
        let (least, most) = (bound("minimum"), bound("maximum"));
        let (above, below) = (bound("exclusiveMinimum"), bound("exclusiveMaximum"));
        let number = number.filter(|n| n.is_finite());
        let inside = number.is_some_and(|n| {
            least.is_none_or(|b| n >= b)
                && most.is_none_or(|b| n <= b)
                && above.is_none_or(|b| n > b)
                && below.is_none_or(|b| n < b)
                && (!integer || whole.is_some())
        });
        if inside {
            return Ok(match (whole, number) {
                (Some(whole), _) if integer => whole.into(),
                (_, number) => number.into(),
            });
        }
        let unit = schema
            .get("x-unit")
            .and_then(Value::as_str)
            .map_or(String::new(), |u| format!(" {u}"));
        let what = if integer {
            "whole numbers"
        } else {
            "finite numbers"
        };
        let valid = match (least.or(above), most.or(below)) {
            (Some(a), Some(b)) => format!("{a} to {b}{unit}"),
            (Some(a), None) => format!("{what} from {a}{unit}"),
            (None, Some(b)) => format!("{what} up to {b}{unit}"),
            (None, None) => what.to_owned(),
        };
        let open = match (above.is_some(), below.is_some()) {
            (true, true) => " (the ends excluded)",
            (true, false) => " (the lower end excluded)",
            (false, true) => " (the upper end excluded)",
            (false, false) => "",
        };
        let given = match value {
            DeValue::Integer(i) => i.to_string(),
            DeValue::Float(f) => f.to_string(),
            other => other.type_str().to_owned(),
        };
        Err(Error::domain(
            format!("{}:{}: {key}", self.file, self.line(at)),
            format!("{given}{unit}"),
            format!("{valid}{open}"),
            if integer {
                "write a whole number in that range"
            } else {
                "write a number in that range"
            },
        ))
    }

    fn wrong_type(&self, value: &DeValue, at: usize, key: &str, wanted: &str) -> Error {
        let given = match value {
            DeValue::String(text) => format!("the text \"{text}\""),
            DeValue::Integer(i) => format!("the number {i}"),
            DeValue::Float(f) => format!("the number {f}"),
            DeValue::Boolean(b) => format!("{b}"),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(_) => "an array".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.error(
            at,
            key,
            format!("it is {given} instead of {wanted}"),
            format!("write {wanted}"),
        )
    }

    fn no_choice(&self, given: &str, at: usize, key: &str, choices: &[&str]) -> Error {
        let near = nearest(given, choices);
        let near = near.map(|near| format!("did you mean \"{near}\"? "));
        let remedy = format!("{}There are: {}", near.unwrap_or_default(), list(choices));
        self.error(at, key, format!("there is no \"{given}\""), remedy)
    }

    /// What to write instead of an unknown key: a table that has it, or the nearest of the known ones.
    fn suggestion(&self, key: &str, known: &[&str]) -> String {
        let tables = self
            .root
            .get("properties")
            .and_then(Value::as_object)
            .into_iter()
            .flatten();
        let home = tables.filter_map(|(table, schema)| {
            let definition = schema.get("$ref")?.as_str()?.strip_prefix('#')?;
            self.root.pointer(definition)?.get("properties")?.get(key)?;
            Some(table.as_str())
        });
        match home.collect::<Vec<_>>()[..] {
            [table] => format!("`{key}` belongs in [{table}]"),
            _ => {
                let near = nearest(key, known);
                let near = near.map(|near| format!("did you mean `{near}`? "));
                let near = near.unwrap_or_default();
                format!("{near}Known here: {}", known.join(", "))
            }
        }
    }
}

/// The texts that a schema allows, empty when it allows all.
fn choices(schema: &Value) -> Vec<&str> {
    let listed = schema
        .get("enum")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .filter_map(Value::as_str);
    let alternatives = schema
        .get("oneOf")
        .and_then(Value::as_array)
        .into_iter()
        .flatten();
    listed
        .chain(alternatives.filter_map(|a| a.get("const")?.as_str()))
        .collect()
}

/// The likeliest of what is known, if two fifths of the letters or more agree.
fn nearest<'a>(given: &str, known: &[&'a str]) -> Option<&'a str> {
    let given = given.to_lowercase();
    let likeness = |known: &str| strsim::normalized_damerau_levenshtein(&given, known);
    let all = known.iter().map(|known| (likeness(known), *known));
    let best = all.max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(likeness, _)| *likeness > 0.39)
        .map(|(_, known)| known)
}

fn list(choices: &[&str]) -> String {
    choices
        .iter()
        .map(|c| format!("\"{c}\""))
        .collect::<Vec<_>>()
        .join(", ")
}

fn join(key: &str, name: &str) -> String {
    if key.is_empty() {
        name.to_owned()
    } else {
        format!("{key}.{name}")
    }
}
