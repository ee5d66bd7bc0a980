//! Debian packages, where they may be installed without asking anyone.

use super::{quietly, say};
use std::process::{Command, Stdio};

/// Installs `packages`, or says why not.
pub fn install(packages: &[&str]) -> Result<(), String> {
    let names = packages.join(" ");
    let Some(sudo) = right() else {
        return Err(format!(
            "{names} cannot be installed here: that takes apt-get, and root or sudo without a password"
        ));
    };
    say(&format!("installing {names}"));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new(sudo[0]);
        command.args(&sudo[1..]).args(arguments);
        quietly(&mut command)
    };
    let mut install = vec![
        "install",
        "--yes",
        "--no-install-recommends",
        "-o",
        "DPkg::Lock::Timeout=120",
    ];
    install.extend(packages);
    // The lists of a fresh machine are empty, and those of an old one name files that are gone.
    apt(&install).or_else(|_| {
        apt(&["update"])?;
        apt(&install)
    })
}

/// The words before apt-get's own arguments, if it is there and may be used.
fn right() -> Option<&'static [&'static str]> {
    let works = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::null());
        command.output().is_ok_and(|o| o.status.success())
    };
    if !works("apt-get", &["--version"]) {
        return None;
    }
    let id = Command::new("id").arg("-u").output().ok()?;
    if id.stdout.trim_ascii() == b"0" {
        Some(&["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"])
    } else if works("sudo", &["-n", "true"]) {
        Some(&[
            "sudo",
            "-n",
            "env",
            "DEBIAN_FRONTEND=noninteractive",
            "apt-get",
        ])
    } else {
        None
    }
}
