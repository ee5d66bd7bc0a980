//! The shape of the project: which module may use which, what belongs together, what no file may contain.
//!
//! Every check is a function from texts to complaints, and is shown something bad beside what there is.

#[path = "../xtask/src/paths.rs"]
mod paths;

use paths::{code, paths_after};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use tyndall::backend::gpu;
use tyndall::conditions::{Conditions, Request};
use tyndall::effect::{self, Over};
use wgpu::naga;

/// The modules of the library: each uses only those before it. The documentation of the crate lists them in the same order.
const ORDER: [&str; 25] = [
    "split_mix",
    "units",
    "error",
    "memory",
    "file",
    "task",
    "warning",
    "beam",
    "colour",
    "ephemeris",
    "sky",
    "photometry",
    "medium",
    "scene",
    "frame",
    "accuracy",
    "conditions",
    "radiosity",
    "effect",
    "plan",
    "backend",
    "output",
    "studies",
    "timelapse",
    "daylight",
];

/// Paths from the root with `/`, and what stands there.
type Files = BTreeMap<String, String>;

/// All texts below `folder` of the repository that end in one of `endings` (all of them for none).
fn texts(folder: &str, endings: &[&str]) -> Files {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Files::new();
    let mut folders = vec![root.join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = folder.read_dir() else {
            continue;
        };
        for path in entries.map(|e| e.expect("the repository can be listed").path()) {
            let name = path.strip_prefix(root).expect("it is below the root");
            let parts: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
            let name = parts.join("/");
            if path.is_dir() {
                folders.push(path);
            } else if endings.is_empty() || endings.iter().any(|e| name.ends_with(e)) {
                // What is not UTF-8 is no text: pictures, meshes.
                files.extend(fs::read_to_string(&path).ok().map(|text| (name, text)));
            }
        }
    }
    files
}

fn made_up(files: &[(&str, &str)]) -> Files {
    let own = |(name, text): &(&str, &str)| (name.to_string(), text.to_string());
    files.iter().map(own).collect()
}

/// The module of the library that a file of `src` belongs to.
fn module(path: &str) -> &str {
    let path = path.strip_prefix("src/").unwrap_or(path);
    path.split(['/', '.']).next().unwrap_or_default()
}

/// Whether a statement is `pub use` of any visibility.
fn is_passing_on(statement: &str) -> bool {
    let statement = statement.trim();
    statement.starts_with("pub use ")
        || (statement.starts_with("pub(") && statement.contains(") use "))
}

/// What a file passes on under its own name, and from which module.
fn passed_on(root: &str) -> BTreeMap<String, String> {
    let code = code(root);
    let uses = code.split(';').filter(|s| is_passing_on(s));
    let uses = uses.filter_map(|s| Some(s.split_once("use ")?.1));
    let mut names = BTreeMap::new();
    for path in uses {
        let path = path.trim_start_matches("crate::");
        let (module, rest) = path.split_once("::").unwrap_or((path, ""));
        for name in rest.split(|c: char| !c.is_alphanumeric() && c != '_') {
            names.insert(name.to_owned(), module.to_owned());
        }
    }
    names
}

/// Who uses a module that stands later, or that has no place in the order.
fn against_the_order(files: &Files) -> Vec<String> {
    let rank = |module: &str| ORDER.iter().position(|line| *line == module);
    let names = passed_on(files.get("src/lib.rs").map_or("", String::as_str));
    let mut complaints = Vec::new();
    for (path, text) in files.iter().filter(|(path, _)| *path != "src/lib.rs") {
        let user = module(path);
        let Some(user_rank) = rank(user) else {
            complaints.push(format!("{path}: `{user}` has no place in the order"));
            continue;
        };
        for used in paths_after(&code(text), "crate::") {
            let used = names.get(&used).unwrap_or(&used);
            match rank(used) {
                None => complaints.push(format!("{path} uses `{used}`, which is no module")),
                Some(rank) if used != user && rank >= user_rank => {
                    complaints.push(format!("{path} uses `{used}`, which stands later"));
                }
                Some(_) => {}
            }
        }
    }
    complaints
}

#[test]
fn modules_use_what_stands_before_them() {
    let files = texts("src", &[".rs"]);
    assert!(files.len() > 5, "the library was not found");
    assert_eq!(against_the_order(&files), [""; 0]);

    let lib = "pub mod units;\npub use error::{Error, Result};\npub use plan::Plan;";
    let good = [
        ("src/lib.rs", lib),
        (
            "src/sky/mod.rs",
            "//! [`crate::plan`]\nuse crate::units::DEG; // crate::scene",
        ),
        (
            "src/sky/perez.rs",
            "use crate::{Error, colour::{Xyz, plan}, sky};",
        ),
        (
            "src/backend/gpu/mod.rs",
            "use wgpu::crate_like; fn f() { crate::effect::g() }",
        ),
    ];
    assert_eq!(against_the_order(&made_up(&good)), [""; 0]);
    for bad in [
        ("src/sky/perez.rs", "use crate::plan::Plan;"),
        (
            "src/sky/perez.rs",
            "use crate::{Error,\n    units, scene::{A, B}};",
        ),
        ("src/sky/perez.rs", "fn f() { let x = crate::scene::g(); }"),
        (
            "src/sky/perez.rs",
            "macro_rules! m { () => { $crate::scene::g() } }",
        ),
        ("src/effect/shafts.rs", "use crate::Plan;"),
        ("src/plan.rs", "use crate::backend::gpu;"),
        ("src/accuracy/mod.rs", "use crate::plan::Plan;"),
        ("src/helpers.rs", ""),
        ("src/sky/perez.rs", "use crate::helpers;"),
    ] {
        let complaints = against_the_order(&made_up(&[("src/lib.rs", lib), bad]));
        assert_eq!(complaints.len(), 1, "{bad:?}: {complaints:?}");
    }
}

/// What the compiler reads of a file outside its unit tests, which stand at its end.
fn code_without_tests(text: &str) -> String {
    code(text.split("#[cfg(test)]").next().unwrap_or_default())
}

/// The file that holds a folder's own items, relative to which its files say `super`.
fn owner(folder: &str, files: &Files) -> Option<String> {
    ["mod.rs", "lib.rs", "main.rs"]
        .map(|name| format!("{folder}/{name}"))
        .into_iter()
        .chain([format!("{folder}.rs")])
        .find(|path| files.contains_key(path))
}

/// Which part of a folder uses which: its files and subfolders by name, its owner by its whole path.
///
/// The owner is used for what it defines itself, not for what it passes on, and passing on is no use.
fn imports(folder: &str, files: &Files) -> BTreeMap<String, BTreeSet<String>> {
    let owner = owner(folder, files);
    let own = owner.as_ref().map_or("", |path| files[path].as_str());
    let part = |path: &str| {
        let rest = path.strip_prefix(folder)?.strip_prefix('/')?;
        let name = rest.split(['/', '.']).next().unwrap_or_default();
        (Some(path) != owner.as_deref()).then(|| name.to_owned())
    };
    let parts: BTreeSet<String> = files.keys().filter_map(|path| part(path)).collect();
    let passed_on = passed_on(own);
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, text) in files {
        let code = code_without_tests(text);
        let Some(user) = part(path) else {
            if owner.as_ref() == Some(path) {
                let uses = code.split(';').filter(|s| !is_passing_on(s));
                let code = uses.collect::<Vec<_>>().join(";");
                let names = |name: &&String| {
                    ["", "self::"]
                        .iter()
                        .any(|prefix| !paths_after(&code, &format!("{prefix}{name}::")).is_empty())
                };
                let used = parts.iter().filter(names).cloned();
                graph.entry(path.clone()).or_default().extend(used);
            }
            continue;
        };
        let below = &path[folder.len() + 1..];
        // A file of a subfolder says `super` once more, except for the one that owns the subfolder.
        let depth = below.matches('/').count() + usize::from(!below.ends_with("/mod.rs"));
        let root = folder.split_once("src").map_or("", |(_, rest)| rest);
        let absolute = format!("crate{}::", root.replace('/', "::"));
        for prefix in ["super::".repeat(depth), absolute] {
            for name in paths_after(&code, &prefix) {
                let name = passed_on.get(&name).unwrap_or(&name);
                let used = match (parts.contains(name), &owner) {
                    (true, _) => name,
                    (false, Some(owner)) if name != "super" => owner,
                    _ => continue,
                };
                if *used != user {
                    graph.entry(user.clone()).or_default().insert(used.clone());
                }
            }
        }
    }
    graph
}

/// All that a part uses, directly or through others.
fn reached<'g>(graph: &'g BTreeMap<String, BTreeSet<String>>, from: &'g str) -> BTreeSet<&'g str> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(part) = open.pop() {
        let used = graph.get(part).into_iter().flatten();
        open.extend(used.map(String::as_str).filter(|part| found.insert(*part)));
    }
    found
}

/// Folders of which some files use each other, directly or through others.
fn import_cycles(files: &Files) -> Vec<String> {
    let folder = |path: &String| path.rsplit_once('/').map(|(folder, _)| folder.to_owned());
    let folders: BTreeSet<String> = files.keys().filter_map(folder).collect();
    let mut complaints = Vec::new();
    for folder in folders {
        let graph = imports(&folder, files);
        let reached: BTreeMap<_, _> = graph
            .keys()
            .map(|part| (part.as_str(), reached(&graph, part)))
            .collect();
        let mut said = BTreeSet::new();
        for (part, there) in &reached {
            let back = |other: &&str| reached.get(*other).is_some_and(|all| all.contains(part));
            let circle: Vec<&str> = there.iter().copied().filter(back).collect();
            if !circle.is_empty() && said.insert(circle.clone()) {
                complaints.push(format!("{folder}: {} use each other", circle.join(", ")));
            }
        }
    }
    complaints
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let mut files = texts("src", &[".rs"]);
    files.extend(texts("cli/src", &[".rs"]));
    assert_eq!(import_cycles(&files), [""; 0]);

    let owner = (
        "src/sky/mod.rs",
        "mod day;\npub use day::{Day, Form};\nuse perez::Bins;",
    );
    let good = [
        owner,
        (
            "src/sky/day.rs",
            "use super::perez;\nuse crate::sky::sun::Disc;",
        ),
        (
            "src/sky/perez.rs",
            "use super::sun;\n#[cfg(test)]\nmod tests { use super::super::day::Day; }",
        ),
        (
            "src/sky/sun.rs",
            "//! [`super::Sky`]\nuse crate::units::DEG;",
        ),
        ("src/sky/sun/disc.rs", "use super::Limb;"),
        ("cli/src/main.rs", "mod sun;\nfn main() { sun::run() }"),
        ("cli/src/sun.rs", "use crate::stdout::Out;"),
        ("cli/src/stdout.rs", "use tyndall::sun;"),
    ];
    assert_eq!(import_cycles(&made_up(&good)), [""; 0]);
    for bad in [
        // Two files, three files, a file and a subfolder, a file and the owner.
        ("src/sky/perez.rs", "use super::{day, sun};"),
        ("src/sky/sun.rs", "fn f() { crate::sky::day::g() }"),
        ("src/sky/sun/disc.rs", "use super::super::perez::Bins;"),
        ("src/sky/perez.rs", "use super::{Form, sun};"),
        ("src/sky/perez.rs", "use super::Sky;"),
        ("cli/src/stdout.rs", "use crate::sun::Columns;"),
        ("cli/src/sun.rs", "use crate::Settings;"),
    ] {
        let mut files = made_up(&good);
        files.extend(made_up(&[bad]));
        assert_eq!(import_cycles(&files).len(), 1, "{bad:?}");
    }
}

/// The modules that the table of the crate's documentation lists, in its order, and those that the crate declares.
fn documented(lib: &str) -> (Vec<String>, BTreeSet<String>) {
    let rows = lib.lines().filter(|line| line.starts_with("//! | [`"));
    let first = rows.filter_map(|row| row.split('|').nth(1));
    let names = first.flat_map(|cell| cell.split(','));
    let name = |text: &str| text.trim().trim_matches(['[', ']', '`']).to_owned();
    let declared = lib.lines().filter_map(|l| l.strip_prefix("pub mod "));
    (
        names.map(name).collect(),
        declared
            .map(|l| l.trim_end_matches(';').to_owned())
            .collect(),
    )
}

#[test]
fn the_order_is_documented_and_every_module_is_there() {
    let files = texts("src", &[".rs"]);
    let lib = files.get("src/lib.rs").expect("the crate has a root");
    let (listed, declared) = documented(lib);
    assert_eq!(listed, ORDER);
    let order: BTreeSet<String> = ORDER.iter().map(|name| name.to_string()).collect();
    assert_eq!(declared, order);
    let docs = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/structure.md"));
    let docs = docs.expect("the structure has its page");
    let rows = docs.lines().filter_map(|line| line.strip_prefix("| `"));
    let listed: Vec<&str> = rows
        .filter_map(|row| row.split_once("` |"))
        .map(|(name, _)| name)
        .filter(|name| order.contains(*name))
        .collect();
    assert_eq!(listed, ORDER, "docs/structure.md");

    let bad = "//! | [`units`], [`error`] | what |\n//! | `x` | y |\npub mod error;\n";
    let (listed, declared) = documented(bad);
    assert_eq!(listed, ["units", "error"]);
    assert_eq!(declared.len(), 1);
}

/// Who names a crate that belongs to others: `crates` lists each with the places that may.
fn out_of_place(files: &Files, crates: &[(&str, &[&str])]) -> Vec<String> {
    let mut complaints = Vec::new();
    for (path, text) in files {
        let code = code(text);
        for (name, places) in crates {
            let allowed = places.iter().any(|place| path.starts_with(place));
            if !allowed && !paths_after(&code, &format!("{name}::")).is_empty() {
                complaints.push(format!("{path} names `{name}`"));
            }
        }
    }
    complaints
}

#[test]
fn crates_stay_in_their_place() {
    let crates: [(&str, &[&str]); 5] = [
        ("wgpu", &["src/backend/gpu", "tests/"]),
        ("clap", &["cli/"]),
        ("miette", &["cli/"]),
        ("indicatif", &["cli/"]),
        ("thiserror", &["src/"]),
    ];
    let mut files = texts("src", &[".rs"]);
    files.extend(texts("cli", &[".rs"]));
    assert_eq!(out_of_place(&files, &crates), [""; 0]);
    for bad in [
        ("src/effect/shafts.rs", "fn f(device: &wgpu::Device) {}"),
        ("src/plan.rs", "use indicatif::ProgressBar;"),
        ("cli/src/main.rs", "use wgpu::{Adapter, Instance};"),
    ] {
        assert_eq!(out_of_place(&made_up(&[bad]), &crates).len(), 1, "{bad:?}");
    }
}

/// What a library must not do to its user: print, exit, give up.
fn bad_manners(files: &Files) -> Vec<String> {
    let forbidden = [
        "println!(",
        "eprintln!(",
        "print!(",
        "eprint!(",
        "dbg!(",
        "process::exit",
    ];
    let mut complaints = Vec::new();
    for (path, text) in files {
        // Unit tests stand at the end of a file.
        let text = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code(text);
        let found = forbidden.iter().filter(|word| code.contains(**word));
        complaints.extend(found.map(|word| format!("{path}: {word}")));
    }
    complaints
}

#[test]
fn the_library_is_silent() {
    assert_eq!(bad_manners(&texts("src", &[".rs"])), [""; 0]);
    let bad = made_up(&[("src/sky/mod.rs", "fn f() { std::process::exit(1) }")]);
    assert_eq!(bad_manners(&bad).len(), 1);
    let test = made_up(&[(
        "src/a.rs",
        "#[cfg(test)]\nmod tests { fn f() { println!(\"a\") } }",
    )]);
    assert_eq!(bad_manners(&test), [""; 0]);
}

/// Shaders without the effect, or the file of the GPU's, of the same stem.
fn orphans(shaders: &Files, owners: &Files) -> Vec<String> {
    let own = shaders
        .keys()
        .filter(|path| !path.starts_with("shaders/common/"));
    let stem = |path: &str| {
        let name = path.strip_prefix("shaders/").unwrap_or(path);
        name.strip_suffix(".wgsl").unwrap_or(name).to_owned()
    };
    own.map(|path| stem(path))
        .filter(|stem| {
            ["effect", "backend/gpu"]
                .iter()
                .all(|folder| !owners.contains_key(&format!("src/{folder}/{stem}.rs")))
        })
        .map(|stem| format!("shaders/{stem}.wgsl has no src/effect/{stem}.rs"))
        .collect()
}

#[test]
fn a_shader_has_its_effect() {
    let mut owners = texts("src/effect", &[".rs"]);
    owners.extend(texts("src/backend/gpu", &[".rs"]));
    assert_eq!(orphans(&texts("shaders", &[".wgsl"]), &owners), [""; 0]);
    let effects = made_up(&[("src/effect/shafts_march.rs", "")]);
    let shaders = made_up(&[
        ("shaders/shafts_march.wgsl", ""),
        ("shaders/common/phase.wgsl", ""),
        ("shaders/shaft_march.wgsl", ""),
    ]);
    let found = orphans(&shaders, &effects);
    assert_eq!(
        found,
        ["shaders/shaft_march.wgsl has no src/effect/shaft_march.rs"]
    );
}

/// What is wrong with shaders, whole texts by their names.
fn invalid(shaders: &Files) -> Vec<String> {
    let mut validator = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::default(),
    );
    let mut complaints = Vec::new();
    for (path, source) in shaders {
        match naga::front::wgsl::parse_str(source) {
            Err(error) => complaints.push(error.emit_to_string_with_path(source, path)),
            Ok(module) => {
                if let Err(error) = validator.validate(&module) {
                    complaints.push(error.emit_to_string_with_path(source, path));
                }
            }
        }
    }
    complaints
}

/// What is wrong with an entry point that runs over pixels: groups of another size than the backend dispatches, or pixels outside
/// the tile that are not left alone. What is no WGSL is told elsewhere.
fn over_pixels(text: &str, entry: &str) -> Option<String> {
    let module = naga::front::wgsl::parse_str(text).ok()?;
    let found = module.entry_points.iter().find(|e| e.name == entry);
    let Some(found) = found else {
        return Some(format!("there is no `{entry}`"));
    };
    if found.workgroup_size != [8, 8, 1] {
        return Some(format!(
            "`{entry}` has groups of {:?}",
            found.workgroup_size
        ));
    }
    let body = text.split(&format!("fn {entry}(")).nth(1)?;
    let body = body.split("\n}").next()?;
    let asks = body.contains("inside_tile(id)");
    (!asks).then(|| format!("`{entry}` does not ask whether a pixel is inside_tile"))
}

#[test]
fn shaders_are_valid() {
    let scene = tyndall::scene::Scene::builtin("nave").expect("it is built in");
    let conditions = Conditions::new(scene, &Request::default()).expect("it is sound");
    let mut shaders = Files::new();
    for effect in effect::ALL {
        let file = format!("src/effect/{}.rs", effect.name);
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert!(root.join(&file).is_file(), "there is no {file}");
        let values: Vec<_> = effect.knobs.iter().map(|k| (k.name, k.values[1])).collect();
        let settings = effect::Settings {
            effect: effect.name,
            values: &values,
        };
        for pass in effect.passes {
            for counting in [false, true] {
                let name = format!("{}.{} {counting}", effect.name, pass.entry);
                let text = gpu::shader_text(effect, pass, &conditions, &settings, counting);
                assert!(text.contains(pass.entry), "{name}");
                // The backend dispatches as many groups of 8 by 8 as cover the tile.
                if matches!(pass.over, Over::Pixels | Over::Fields(_)) {
                    let wrong = over_pixels(&text, pass.entry);
                    assert_eq!(wrong, None, "{name}");
                }
                shaders.insert(name, text);
            }
        }
    }
    assert!(shaders.len() > 40);
    assert_eq!(invalid(&shaders), [""; 0]);

    let entry =
        "@compute @workgroup_size(8, 8) fn glow(@builtin(global_invocation_id) id: vec3u) {";
    let tile = "fn inside_tile(id: vec3u) -> bool { return true; }";
    let good = format!("{tile}\n{entry}\n if !inside_tile(id) {{ return; }}\n}}");
    assert_eq!(over_pixels(&good, "glow"), None);
    assert!(over_pixels(&good.replace("8, 8", "64"), "glow").is_some());
    assert!(over_pixels(&good.replace("if !inside_tile(id)", "if false"), "glow").is_some());

    let with = |body: &str| {
        let common = "fn twice(x: f32) -> f32 { return 2.0 * x; }\n";
        let text = format!("{common}@compute @workgroup_size(1) fn main() {{ {body} }}");
        invalid(&made_up(&[("b", &text)]))
    };
    assert_eq!(with("let y = twice(1.0);"), [""; 0]);
    // Not a word of the language; a type that does not fit; parsed, and invalid; a name that is taken.
    for bad in [
        "let y == 1;",
        "let y = twice(vec2f(1.0));",
        "return 1.0;",
        "} fn twice() {",
    ] {
        assert_eq!(with(bad).len(), 1, "{bad}");
    }
}

/// The declarations of bindings and of constants in shaders, which are printed for them instead: numbers that Rust knows too
/// stand in Rust alone.
fn declared_by_hand(shaders: &Files) -> Vec<String> {
    let mut complaints = Vec::new();
    for (path, text) in shaders {
        let lines = text.lines().filter(|line| line.contains("@group(1)"));
        complaints.extend(lines.map(|line| format!("{path}: {line}")));
    }
    complaints
}

#[test]
fn bindings_are_printed() {
    let mut shaders = texts("shaders", &[".wgsl"]);
    assert_eq!(declared_by_hand(&shaders), [""; 0]);
    shaders.insert(
        "shaders/a.wgsl".into(),
        "@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;".into(),
    );
    assert_eq!(declared_by_hand(&shaders).len(), 1);
}

/// Where a text says what belongs on one machine, or that something is left to do.
fn leftovers(files: &Files) -> Vec<String> {
    // Put together here, so that this file passes.
    let paths = ["/wo_rk/", "/ro_ot/", "/ho_me/", ".lib_rary", "/Us_ers/"];
    let words = ["TO_DO", "FIX_ME", "XX_X", "unimple_mented!", "to_do!"];
    let whole = |text: &str, at: usize, length: usize| {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        !text[..at].ends_with(is_name) && !text[at + length..].starts_with(is_name)
    };
    let mut complaints = Vec::new();
    for (path, text) in files {
        for (number, line) in text.lines().enumerate() {
            let place = format!("{path}:{}", number + 1);
            for found in paths.map(|word| word.replace('_', "")) {
                // A path of a machine begins there: a/root/b is somebody's folder.
                let starts = |(at, _): (usize, &str)| {
                    !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '.' || c == '}')
                };
                if line.match_indices(&found).any(starts) {
                    complaints.push(format!("{place}: {found}"));
                }
            }
            for found in words.map(|word| word.replace('_', "")) {
                let whole = |(at, _)| whole(line, at, found.len());
                if line.match_indices(&found).any(whole) {
                    complaints.push(format!("{place}: {found}"));
                }
            }
        }
    }
    complaints
}

/// What stands in a page for a number that was still to come: capitals with an underscore, which nobody writes outside of code.
fn placeholders(page: &str) -> Vec<&str> {
    // Blocks first, then what stands between backticks.
    let prose = page.split("```").step_by(2);
    let prose = prose.flat_map(|text| text.split('`').step_by(2));
    let words = prose.flat_map(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_'));
    let is_loud = |word: &&str| {
        let capitals = word.matches(|c: char| c.is_ascii_uppercase()).count();
        word.contains('_') && capitals > 1 && !word.contains(char::is_lowercase)
    };
    // A command in a comment may set a variable of the tests.
    let is_ours = |word: &&str| word.starts_with("TYNDALL_");
    words
        .filter(is_loud)
        .filter(|word| !is_ours(word))
        .collect()
}

#[test]
fn nothing_is_left_over() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Files::new();
    for folder in [
        ".cargo", ".ci", "benches", "cli", "data", "docs", "examples", "shaders", "src", "tests",
        "xtask",
    ] {
        files.extend(texts(folder, &[]));
    }
    let top = root.read_dir().expect("the repository can be listed");
    let top: Vec<PathBuf> = top.map(|e| e.expect("an entry").path()).collect();
    for path in top.iter().filter(|path| path.is_file()) {
        let name = path
            .file_name()
            .expect("a file has a name")
            .to_string_lossy();
        let known = name.starts_with("LICENSE") || name == "NOTICE" || name == ".gitignore";
        if known || name.ends_with(".md") || name.ends_with(".toml") {
            files.extend(
                fs::read_to_string(path)
                    .ok()
                    .map(|text| (name.into(), text)),
            );
        }
    }
    assert!(files.contains_key("Cargo.toml") && files.contains_key(".ci/run"));
    assert_eq!(leftovers(&files), [""; 0]);
    for (path, page) in files.iter().filter(|(path, _)| path.ends_with(".md")) {
        assert_eq!(placeholders(page), [""; 0], "{path}");
    }
    let good = "`COPY_SRC`, snake_case\n```sh\nexport CARGO_HOME=1\n```\nthen";
    assert_eq!(placeholders(good), [""; 0]);
    for bad in ["took BEFORE_CPU s", "| AFTER_MB |", "`a` TIME_2 `b`"] {
        assert_eq!(placeholders(bad).len(), 1, "{bad}");
    }

    for good in [
        "a/root/b",
        "mastodon",
        "the FIXMEs",
        "todo!x",
        "src/wo_rk/",
        "${X}/wo_rk/",
    ] {
        let good = made_up(&[("a.rs", &good.replace('_', ""))]);
        assert_eq!(leftovers(&good), [""; 0]);
    }
    for bad in [
        "\"/ro_ot/.cargo\"",
        "// TO_DO: more",
        "to_do!()",
        "cd /wo_rk/x",
        "(FIX_ME)",
        "~/.lib_rary",
    ] {
        let bad = made_up(&[("a.rs", &bad.replace('_', ""))]);
        assert_eq!(leftovers(&bad).len(), 1, "{bad:?}");
    }
}

/// The lines that a file should not be longer than; one concept is one file.
const LONGEST: usize = 800;

fn too_long(files: &Files) -> Vec<String> {
    let long = files
        .iter()
        .map(|(path, text)| (path, text.lines().count()));
    long.filter(|(_, lines)| *lines > LONGEST)
        .map(|(path, lines)| format!("{path} has {lines} lines"))
        .collect()
}

#[test]
fn one_concept_is_one_file() {
    for folder in ["src", "cli", "xtask", "tests", "shaders"] {
        assert_eq!(too_long(&texts(folder, &[".rs", ".wgsl", ".py"])), [""; 0]);
    }
    let long = "\n".repeat(LONGEST + 1);
    assert_eq!(too_long(&made_up(&[("src/a.rs", &long)])).len(), 1);
}

/// A break of tests/breaks.toml, as `cargo xtask breaks` reads it.
#[derive(serde::Deserialize)]
struct Break {
    name: String,
    file: String,
    from: String,
    to: String,
    test: String,
}

/// What is wrong with a break: its text must stand in its file once, and its test must be there.
fn stale(one: &Break, text: Option<&str>, tests: Option<&str>) -> Option<String> {
    let found = text.map(|text| text.matches(&one.from).count());
    let part = one.test.split_whitespace().nth(1);
    let is_there =
        |tests: &str| part.is_none_or(|part| tests.contains(&format!("#[test]\nfn {part}")));
    let wrong = match found {
        _ if one.from == one.to => "it changes nothing".into(),
        None => format!("there is no {}", one.file),
        Some(1) if one.test.starts_with("lib") || tests.is_some_and(is_there) => return None,
        Some(1) => format!("there is no test {}", one.test),
        Some(found) => format!("its text stands {found} times in {}", one.file),
    };
    Some(format!("`{}`: {wrong}", one.name))
}

#[test]
fn breaks_are_of_what_there_is() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| fs::read_to_string(root.join(name)).ok();
    let list = read("tests/breaks.toml").expect("it is there");
    let list: BTreeMap<String, Vec<Break>> = toml::from_str(&list).expect("it is a list");
    let breaks = &list["break"];
    assert!(breaks.len() >= 60);
    let complaint = |one: &Break| {
        let binary = one.test.split_whitespace().next().unwrap_or_default();
        let tests = read(&format!("tests/{binary}.rs"));
        stale(one, read(&one.file).as_deref(), tests.as_deref())
    };
    let complaints: Vec<String> = breaks.iter().filter_map(complaint).collect();
    assert_eq!(complaints, [""; 0]);

    let one = &breaks[0];
    for (text, tests) in [
        (None, Some("")),
        (Some("another text"), Some("")),
        (Some(one.from.repeat(2).as_str()), Some("")),
        (Some(one.from.as_str()), None),
    ] {
        assert!(stale(one, text, tests).is_some());
    }
}
