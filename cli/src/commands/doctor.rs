//! `tyndall doctor`: what this machine offers, and what to install.

use crate::machine;
use crate::tables::stdout;
use std::fmt::Write;
use tyndall::backend::gpu::adapters::{self, Adapter, Report};
use tyndall::ephemeris::civil::tz_database;

/// List graphics adapters, what each can do, and what to install
#[derive(Debug, clap::Args)]
pub struct DoctorArgs {
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// Prints what was found. That there is no adapter is no failure: the CPU reference needs none.
pub fn run(args: &DoctorArgs) -> tyndall::Result<()> {
    let report = machine::quietly(|| Ok(adapters::report()))?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if args.json {
        return stdout::print_json(&serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "cores": cores,
            "auto": adapters::automatic(&report).map_or("reference", |adapter| &adapter.name),
            "why": why(&report),
            "time_zones": tz_database(),
            "adapters": report.adapters,
            "hidden": report.hidden,
            "advice": report.advice,
        }));
    }
    stdout::print(table(&report, cores))
}

/// What `--backend auto` uses, and why.
fn why(report: &Report) -> String {
    match (adapters::automatic(report), report.adapters.first()) {
        (Some(adapter), _) => format!("uses {}: {}", adapter.name, adapter.kind.words()),
        (None, Some(software)) => format!(
            "uses the CPU reference: there is only a software adapter ({}), which `--backend gpu` accepts",
            software.name
        ),
        (None, None) => "uses the CPU reference: there is no graphics adapter".into(),
    }
}

fn table(report: &Report, cores: usize) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let mut text = format!(
        "tyndall {version}\nbackend auto  {}\ntime zones    {}\n\n",
        why(report),
        tz_database()
    );
    let _ = writeln!(text, "processor     {cores} cores\n");
    if report.adapters.is_empty() {
        text.push_str("graphics adapters  none\n");
    } else {
        text.push_str("graphics adapters\n");
    }
    for adapter in &report.adapters {
        describe(&mut text, adapter);
    }
    if !report.hidden.is_empty() {
        text.push_str(
            "\npresent, but not usable (the driver does not pass the conformance tests of its interface)\n",
        );
    }
    for adapter in &report.hidden {
        describe(&mut text, adapter);
    }
    if !report.advice.is_empty() {
        text.push_str("\nto use a GPU\n");
    }
    for advice in &report.advice {
        let _ = writeln!(text, "  {advice}");
    }
    text
}

fn describe(text: &mut String, adapter: &Adapter) {
    let limits = &adapter.limits;
    let yes = |can| if can { "yes" } else { "no" };
    let rows = [
        ("kind", adapter.kind.words().to_owned()),
        ("interface", adapter.backend.clone()),
        ("driver", adapter.driver.clone()),
        (
            "textures",
            format!(
                "{0} x {0}, {1} layers",
                limits.texture_side, limits.texture_layers
            ),
        ),
        (
            "buffers",
            format!(
                "{}, of which a shader sees {}, {} at once",
                mebibytes(limits.buffer_bytes),
                mebibytes(limits.binding_bytes),
                limits.storage_buffers
            ),
        ),
        (
            "work groups",
            format!(
                "{} invocations, {} KiB",
                limits.workgroup_invocations,
                limits.workgroup_bytes / 1024
            ),
        ),
        ("timestamps", yes(adapter.timestamps).to_owned()),
        ("unclipped depth", yes(adapter.unclipped_depth).to_owned()),
    ];
    let _ = writeln!(text, "  {}", adapter.name);
    for (name, value) in rows {
        let _ = writeln!(text, "    {name:<16}{value}");
    }
}

fn mebibytes(bytes: u64) -> String {
    match bytes >> 20 {
        // Drivers without a limit name the largest number there is.
        mebibytes if mebibytes >= 1 << 24 => "any size".into(),
        mebibytes => format!("{mebibytes} MiB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall::backend::gpu::adapters::{AdapterKind, AdapterLimits};

    #[test]
    fn the_table_tells_what_was_found() {
        let adapter = Adapter {
            name: "Some card".into(),
            kind: AdapterKind::Discrete,
            backend: "vulkan".into(),
            driver: "maker 1.2".into(),
            limits: AdapterLimits {
                texture_side: 16384,
                texture_layers: 2048,
                buffer_bytes: u64::MAX,
                binding_bytes: 128 << 20,
                storage_buffers: 8,
                workgroup_invocations: 1024,
                workgroup_bytes: 32768,
            },
            timestamps: true,
            unclipped_depth: false,
        };
        let mut report = Report {
            adapters: vec![adapter.clone()],
            hidden: vec![],
            advice: vec![],
        };
        let text = table(&report, 2);
        for words in [
            "backend auto  uses Some card: hardware, discrete",
            "time zones    IANA",
            "any size, of which a shader sees 128 MiB",
        ] {
            assert!(text.contains(words), "{text}");
        }
        assert!(!text.contains("not usable") && !text.contains("to use a GPU"));
        report.adapters.clear();
        report.hidden.push(adapter);
        report.advice.push("install something".into());
        let text = table(&report, 2);
        for words in [
            "adapters  none",
            "uses the CPU reference",
            "not usable",
            "install something",
        ] {
            assert!(text.contains(words), "{text}");
        }
    }
}
