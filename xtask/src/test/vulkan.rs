//! Mesa's software Vulkan driver, so that the GPU's tests run on a machine without one.

use super::{apt, say};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The driver and its loader.
const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// What [`prepare`] will install.
pub fn missing() -> Option<String> {
    let wanted = cfg!(target_os = "linux") && !present();
    wanted.then(|| apt::plan(&PACKAGES)).flatten()
}

/// Installs the driver where it is missing and may be installed, else says what to do.
///
/// Without it the tests of the GPU say that they did not run, or fail when `REQUIRE_GPU=1`.
pub fn prepare() {
    if cfg!(not(target_os = "linux")) || present() {
        return;
    }
    if let Err(problem) = apt::install(&PACKAGES) {
        say(&problem);
        say(
            "Mesa's software Vulkan driver is missing; the GPU's tests use another driver if there is one, and do \
             not run otherwise. To have it: apt install mesa-vulkan-drivers libvulkan1 (Debian, Ubuntu), \
             dnf install mesa-vulkan-drivers vulkan-loader (Fedora), pacman -S vulkan-swrast (Arch)",
        );
    }
}

/// Whether the loader and the driver are there, or the user names a driver.
fn present() -> bool {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
    if named.iter().any(|name| std::env::var_os(name).is_some()) {
        return true;
    }
    let data = std::env::var_os("XDG_DATA_DIRS").filter(|folders| !folders.is_empty());
    let data = data.unwrap_or_else(|| "/usr/local/share:/usr/share".into());
    let manifests = std::env::split_paths(&data)
        .chain(["/etc".into(), "/usr/share".into()])
        .map(|folder| folder.join("vulkan/icd.d"));
    let driver = manifests
        .into_iter()
        .any(|folder| holds(&folder, |name| name.starts_with("lvp_icd")));
    driver && libraries().any(|folder| holds(&folder, |name| name == "libvulkan.so.1"))
}

/// Where the dynamic linker looks: the usual folders and those below them that are named after the architecture.
fn libraries() -> impl Iterator<Item = PathBuf> {
    let architecture = format!("{}-linux-gnu", std::env::consts::ARCH);
    ["/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/local/lib"]
        .into_iter()
        .flat_map(move |folder| {
            let folder = PathBuf::from(folder);
            [folder.join(&architecture), folder]
        })
}

fn holds(folder: &Path, wanted: impl Fn(&str) -> bool) -> bool {
    let Ok(entries) = folder.read_dir() else {
        return false;
    };
    let name = |name: &OsStr| wanted(&name.to_string_lossy());
    entries.flatten().any(|entry| name(&entry.file_name()))
}
