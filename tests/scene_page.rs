//! The page on the scene file: its tables are the schema's, and its examples are scenes.

use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tyndall::scene::load;

const PAGE: &str = "docs/scene.md";
const BEGIN: &str =
    "<!-- From the schema: TYNDALL_WRITE=1 cargo test --release --test scene_page -->\n";

fn page() -> (PathBuf, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(PAGE);
    let text = std::fs::read_to_string(&path).expect("the page is there");
    (path, text)
}

/// What a `$ref` means, or the value itself; and the name of what it refers to.
fn resolved<'a>(schema: &'a Value, value: &'a Value) -> (Option<&'a str>, &'a Value) {
    let name = value["$ref"].as_str().and_then(|to| to.rsplit('/').next());
    match name {
        Some(name) => (Some(name), &schema["$defs"][name]),
        None => (None, value),
    }
}

/// What a key takes, in words.
fn takes(schema: &Value, value: &Value) -> String {
    let (_, value) = resolved(schema, value);
    if let Some(all) = value["enum"].as_array() {
        let all: Vec<String> = all.iter().map(|one| format!("`{one}`")).collect();
        return match all.len() > 6 {
            true => format!("{}, ... {}", all[..4].join(", "), all[all.len() - 1]),
            false => all.join(", "),
        };
    }
    if let Some(any) = value["anyOf"].as_array() {
        let any: Vec<String> = any.iter().map(|one| takes(schema, one)).collect();
        return any.join(", or ");
    }
    let range = |value: &Value| {
        let number = |key: &str| value[key].as_f64();
        let low = match (number("minimum"), number("exclusiveMinimum")) {
            (Some(low), _) => format!(" from {low}"),
            (_, Some(low)) => format!(" above {low}"),
            _ => String::new(),
        };
        let high = match (number("maximum"), number("exclusiveMaximum")) {
            (Some(high), _) => format!(" to {high}"),
            (_, Some(high)) => format!(", below {high}"),
            _ => String::new(),
        };
        low + &high
    };
    match value["type"].as_str() {
        Some("number") => format!("a number{}", range(value)),
        Some("integer") => format!("a whole number{}", range(value)),
        Some("string") => "text".into(),
        Some("boolean") => "`true`, `false`".into(),
        Some("array") => {
            let of = takes(schema, &value["items"]);
            match value["minItems"].as_u64() {
                Some(count) => format!("{count} times {of}"),
                None => format!("a list of {of}"),
            }
        }
        _ => "a table".into(),
    }
}

/// The tables of a definition and of those that it uses, each once.
struct Writer<'a> {
    schema: &'a Value,
    text: String,
    done: Vec<&'a str>,
}

impl<'a> Writer<'a> {
    fn section(&mut self, title: &str, description: Option<&str>, table: &'a Value) {
        write!(self.text, "\n### {title}\n\n").expect("text can be written");
        if let Some(description) = description {
            write!(self.text, "{description}\n\n").expect("text can be written");
        }
        let mut later = Vec::new();
        match table["oneOf"].as_array() {
            None => self.rows(table, None, &mut later),
            Some(variants) => {
                for variant in variants {
                    self.rows(variant, variant["description"].as_str(), &mut later);
                }
            }
        }
        for (title, name) in later {
            if !self.done.contains(&name) {
                self.done.push(name);
                let of = &self.schema["$defs"][name];
                self.section(&title, of["description"].as_str(), of);
            }
        }
    }

    /// The keys of one table, and the tables that they hold.
    fn rows(
        &mut self,
        table: &'a Value,
        description: Option<&str>,
        later: &mut Vec<(String, &'a str)>,
    ) {
        let keys = table["properties"].as_object().expect("a table has keys");
        let tag = keys.iter().find(|(_, value)| value["const"].is_string());
        if let Some((key, value)) = tag {
            let description = description.unwrap_or_default();
            let more = if keys.len() > 1 { "\n" } else { "" };
            writeln!(
                self.text,
                "`{key} = {}`: {description}\n{more}",
                value["const"]
            )
            .expect("text can be written");
            if keys.len() == 1 {
                return;
            }
        }
        self.text += "| key | what | takes |\n|---|---|---|\n";
        let required = table["required"].as_array();
        for (key, value) in keys.iter().filter(|(_, value)| !value["const"].is_string()) {
            let needed = required.is_some_and(|all| all.iter().any(|one| one == key));
            let (name, of) = resolved(self.schema, value);
            let (name, title) = match resolved(self.schema, &value["items"]) {
                (Some(name), _) => (Some(name), format!("`[[{key}]]`")),
                _ if of["type"] == "object" => (name, format!("`[{key}]`")),
                _ => (name, format!("`{key}`")),
            };
            let description = value["description"].as_str().or(of["description"].as_str());
            let what = description.unwrap_or_default().replace('\n', " ");
            let mark = if needed { "**needed** " } else { "" };
            let takes = takes(self.schema, value);
            writeln!(self.text, "| `{key}` | {mark}{what} | {takes} |")
                .expect("text can be written");
            if let Some(name) = name {
                let (_, of) = (name, &self.schema["$defs"][name]);
                if of["properties"].is_object() || of["oneOf"][0]["properties"].is_object() {
                    later.push((title, name));
                }
            }
        }
        self.text += "\n";
    }
}

#[test]
fn the_tables_of_the_page_are_those_of_the_schema() {
    let schema = tyndall::scene::schema();
    let mut writer = Writer {
        schema: &schema,
        text: String::new(),
        done: Vec::new(),
    };
    writer.section("Top level", None, &schema);
    while writer.text.contains("\n\n\n") {
        writer.text = writer.text.replace("\n\n\n", "\n\n");
    }
    let (path, text) = page();
    let (own, _) = text
        .split_once(BEGIN)
        .expect("the page has a mark where tables begin");
    let whole = format!("{own}{BEGIN}{}\n", writer.text.trim_end());
    if std::env::var_os("TYNDALL_WRITE").is_some() {
        std::fs::write(path, whole).expect("the page can be written");
        return;
    }
    assert!(
        text == whole,
        "{PAGE} is not what the schema says: write it anew as its mark tells"
    );
}

#[test]
fn every_key_stands_in_an_example_which_is_a_scene() {
    let (_, text) = page();
    let examples: Vec<&str> = text
        .split("```toml\n")
        .skip(1)
        .map(|rest| rest.split("```").next().expect("an example ends"))
        .collect();
    assert!(examples.len() >= 5);
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let room = "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl glass\nf 1/1 2/2 3/3\nusemtl housing\n\
                f 3/3 2/2 1/1\n";
    std::fs::write(folder.join("room.obj"), room).expect("there is room");
    std::fs::write(
        folder.join("room.mtl"),
        "newmtl glass\nnewmtl housing\nnewmtl plaster\nnewmtl carpet\n",
    )
    .expect("there is room");
    let gltf = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "Lamp.003"}, {"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    std::fs::write(folder.join("room.gltf"), gltf).expect("there is room");
    let ies = "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 60\n0 45 90\n0\n100 80 0\n";
    std::fs::write(folder.join("lamp.ies"), ies).expect("there is room");
    image::RgbImage::from_pixel(2, 2, image::Rgb([200, 90, 30]))
        .save(folder.join("window.png"))
        .expect("there is room");
    for (number, example) in examples.iter().enumerate() {
        let path = folder.join(format!("{number}.toml"));
        std::fs::write(&path, example).expect("there is room");
        if let Err(error) = load(&path) {
            panic!("example {number}: {error} ({})\n{example}", error.remedy());
        }
    }
    // Keys and variants by name.
    let all = examples.concat();
    let schema = tyndall::scene::schema();
    let mut missing = Vec::new();
    let mut tables: Vec<&Value> = vec![&schema];
    tables.extend(
        schema["$defs"]
            .as_object()
            .expect("it has definitions")
            .values(),
    );
    while let Some(table) = tables.pop() {
        tables.extend(table["oneOf"].as_array().into_iter().flatten());
        for (key, value) in table["properties"].as_object().into_iter().flatten() {
            let holds = match value["const"].as_str() {
                Some(name) => all.contains(&format!("\"{name}\"")),
                None => all.contains(&format!("{key} =")) || all.contains(&format!("[{key}]")),
            };
            if !holds {
                missing.push(format!("{key} {}", value["const"]));
            }
        }
    }
    assert!(missing.is_empty(), "no example has {missing:?}");
}
