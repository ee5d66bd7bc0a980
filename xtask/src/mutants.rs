//! `cargo xtask mutants MODULE`: cargo-mutants over one module of physics, in a package of that module, its suites and what they use.
//!
//! The whole library takes half a minute to build for each mutant, such a package a few seconds. `tests/mutants.toml` says which
//! suites belong to which module, `.cargo/mutants.toml` which mutants are left out, and why.

use crate::cut::{self, Part};
use serde::Deserialize;
use std::process::Command;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    module: Vec<Module>,
}

/// What is run for a module.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Module {
    name: String,
    /// The files that are changed, below `src`, as patterns; all of the module for none.
    #[serde(default)]
    files: Vec<String>,
    /// The suites that must notice, beside the tests of its own files.
    suites: Vec<String>,
}

/// Runs cargo-mutants for the module that the first of `arguments` names; the others are passed on.
pub fn run(arguments: Vec<String>) -> Result<bool, String> {
    let list: List = crate::list("tests/mutants.toml")?;
    let (name, others) = arguments.split_first().ok_or("which module?")?;
    let names: Vec<&str> = list.module.iter().map(|m| m.name.as_str()).collect();
    let module = list.module.iter().find(|module| module.name == *name);
    let module = module.ok_or_else(|| format!("`{name}` is not one of {}", names.join(", ")))?;

    let whole = crate::target().join("mutants");
    let folder = whole.join(name).join("tree");
    let suites: Vec<&str> = module.suites.iter().map(String::as_str).collect();
    let part = Part::Cut {
        modules: &[name.as_str()],
        suites: &suites,
    };
    cut::copy(&crate::root(), &folder, part)?;
    let mut files: Vec<String> = module.files.clone();
    if files.is_empty() {
        files.extend([format!("{name}.rs"), format!("{name}/**")]);
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut mutants = Command::new(cargo);
    mutants.args(["mutants", "--in-place", "--profile", "breaks"]);
    mutants.arg("--output").arg(whole.join(name));
    for file in files {
        mutants.arg("--file").arg(format!("src/{file}"));
    }
    // Documentation is tested elsewhere.
    let status = mutants
        .args(others)
        .args(["--", "--lib", "--tests"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", crate::target().join("breaks/target"))
        .status()
        .map_err(|e| format!("cargo does not start: {e}"))?;
    Ok(status.success())
}
