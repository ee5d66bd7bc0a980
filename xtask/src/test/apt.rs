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

/// What of `packages` is to be installed, with what it takes; nothing where that is not allowed here, which [`install`] tells.
pub fn plan(packages: &[&str]) -> Option<String> {
    right()?;
    let mut command = Command::new("apt-get");
    command.args([
        "install",
        "--yes",
        "--no-install-recommends",
        "--print-uris",
    ]);
    let output = command.args(packages).stdin(Stdio::null()).output().ok()?;
    let size = sizes(&String::from_utf8_lossy(&output.stdout));
    let size = size.unwrap_or_else(|| "size unknown until the package lists are fetched".into());
    Some(format!("{} ({size})", packages.join(" ")))
}

/// The two sizes that apt-get tells.
fn sizes(said: &str) -> Option<String> {
    let between = |from: &str, to: &str| {
        let rest = &said[said.find(from)? + from.len()..];
        Some(rest[..rest.find(to)?].to_owned())
    };
    let fetch = between("Need to get ", " of archives")?;
    let fetch = fetch
        .split('/')
        .next()
        .unwrap_or_default()
        .trim()
        .to_owned();
    let disk = between("After this operation, ", " of additional")?;
    Some(format!("{fetch} to fetch, {disk} on the disk"))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_those_that_apt_get_tells() {
        let said = "Reading package lists...\nNeed to get 8,116 kB/45.3 MB of archives.\n\
                    After this operation, 189 MB of additional disk space will be used.\n'http://x/a.deb' a.deb 1 SHA256:0\n";
        assert_eq!(
            sizes(said).as_deref(),
            Some("8,116 kB to fetch, 189 MB on the disk")
        );
        assert_eq!(sizes("E: Unable to locate package"), None);
    }
}
