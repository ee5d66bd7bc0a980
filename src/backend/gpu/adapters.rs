//! Which graphics adapters there are, what each can do, and what to install where there is none.

use crate::error::{Error, Result};
use serde::Serialize;
use wgpu::{
    Adapter as Handle, Backends, DeviceType, Features, Instance, InstanceDescriptor, InstanceFlags,
};

/// What a machine can compute with beside its processor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// All adapters that can be used, best first.
    pub adapters: Vec<Adapter>,
    /// Adapters that the system has and wgpu does not offer, since their driver does not pass the tests of its own API.
    pub hidden: Vec<Adapter>,
    /// What to do to have an adapter, one sentence each; empty when there is one of hardware.
    pub advice: Vec<String>,
}

/// An adapter, under one of the interfaces that reach it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Adapter {
    /// Its own name.
    pub name: String,
    /// What it is.
    pub kind: AdapterKind,
    /// `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// Name and version of its driver.
    pub driver: String,
    /// How much of everything it takes.
    pub limits: AdapterLimits,
    /// Whether it has a clock of its own, by which passes are timed; software is timed by the wall clock.
    pub timestamps: bool,
    /// Whether casters behind the near plane of a shadow map can be kept.
    pub unclipped_depth: bool,
}

/// What an adapter is. The order is that of preference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AdapterKind {
    /// A card of its own.
    Discrete,
    /// Part of the processor's chip, with its memory.
    Integrated,
    /// A share of a card, in a virtual machine.
    Virtual,
    /// The driver does not say.
    Unknown,
    /// The processor, playing a GPU.
    Software,
}

/// The limits of an adapter that decide how large a picture fits and how it must be cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AdapterLimits {
    /// Side of a 2D texture [texels].
    pub texture_side: u32,
    /// Layers of a texture array.
    pub texture_layers: u32,
    /// A buffer [bytes].
    pub buffer_bytes: u64,
    /// The part of a buffer that a shader sees at once [bytes].
    pub binding_bytes: u64,
    /// Storage buffers that a shader sees at once.
    pub storage_buffers: u32,
    /// Invocations of a work group.
    pub workgroup_invocations: u32,
    /// Memory that a work group shares [bytes].
    pub workgroup_bytes: u32,
}

impl Adapter {
    /// Whether it takes a scene of so many triangles and texels, to be asked before any of it is copied.
    ///
    /// # Errors
    /// [`Error::Failed`] when one of the scene's buffers would be larger than what a shader sees at once.
    pub fn takes(&self, triangles: usize, texels: usize) -> Result<()> {
        // Per triangle three corners of three numbers, and three times what a shader's `Attributes` hold.
        const CORNERS: u64 = 3 * 12;
        const ATTRIBUTES: u64 =
            3 * <super::shared::Attributes as encase::ShaderSize>::SHADER_SIZE.get();
        const TEXEL: u64 = 4;
        let most = self.limits.buffer_bytes.min(self.limits.binding_bytes);
        for (what, count, bytes) in [
            ("triangles", triangles as u64, CORNERS.max(ATTRIBUTES)),
            ("texels of textures", texels as u64, TEXEL),
        ] {
            if count.saturating_mul(bytes) > most {
                return Err(Error::failed(
                    format!(
                        "the scene has {count} {what}, and {} takes {} at once",
                        self.name,
                        most / bytes
                    ),
                    "use `--backend reference`, another adapter, or a smaller scene",
                ));
            }
        }
        Ok(())
    }

    /// Whether it is more than the processor itself.
    pub fn is_hardware(&self) -> bool {
        self.kind != AdapterKind::Software
    }
}

impl AdapterKind {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            AdapterKind::Discrete => "hardware, discrete",
            AdapterKind::Integrated => "hardware, integrated",
            AdapterKind::Virtual => "hardware, virtual",
            AdapterKind::Unknown => "unknown",
            AdapterKind::Software => "software",
        }
    }
}

/// Asks the system for its adapters. One without any graphics library has none; that is no error.
pub fn report() -> Report {
    let adapters = list(InstanceFlags::empty());
    let mut hidden = list(InstanceFlags::ALLOW_UNDERLYING_NONCOMPLIANT_ADAPTER);
    hidden.retain(|adapter| !adapters.contains(adapter));
    let advice = match adapters.iter().any(Adapter::is_hardware) {
        true => Vec::new(),
        false => System::this().advice(!adapters.is_empty()),
    };
    Report {
        adapters,
        hidden,
        advice,
    }
}

/// The adapter that is preferred, of software only when `software` allows it.
pub(super) fn best(software: bool) -> Option<(Handle, Adapter)> {
    let mut all = handles(InstanceFlags::empty());
    all.sort_by_key(|(_, adapter)| adapter.kind);
    all.into_iter()
        .find(|(_, adapter)| software || adapter.is_hardware())
}

/// What `--backend auto` takes: the hardware adapter, or `None` for the reference.
pub fn automatic(report: &Report) -> Option<&Adapter> {
    report.adapters.iter().find(|adapter| adapter.is_hardware())
}

fn list(flags: InstanceFlags) -> Vec<Adapter> {
    let mut adapters: Vec<Adapter> = handles(flags).into_iter().map(|(_, a)| a).collect();
    adapters.sort_by_key(|adapter| adapter.kind);
    adapters
}

fn handles(flags: InstanceFlags) -> Vec<(Handle, Adapter)> {
    let backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    descriptor.flags = flags;
    let instance = Instance::new(descriptor);
    pollster::block_on(instance.enumerate_adapters(backends))
        .into_iter()
        .map(|handle| {
            let description = describe(&handle);
            (handle, description)
        })
        .collect()
}

pub(super) fn describe(handle: &Handle) -> Adapter {
    let info = handle.get_info();
    let limits = handle.limits();
    let features = handle.features();
    let driver = format!("{} {}", info.driver, info.driver_info);
    Adapter {
        name: info.name,
        kind: match info.device_type {
            DeviceType::DiscreteGpu => AdapterKind::Discrete,
            DeviceType::IntegratedGpu => AdapterKind::Integrated,
            DeviceType::VirtualGpu => AdapterKind::Virtual,
            DeviceType::Cpu => AdapterKind::Software,
            DeviceType::Other => AdapterKind::Unknown,
        },
        backend: info.backend.to_str().to_owned(),
        driver: driver.trim().to_owned(),
        limits: AdapterLimits {
            texture_side: limits.max_texture_dimension_2d,
            texture_layers: limits.max_texture_array_layers,
            buffer_bytes: limits.max_buffer_size,
            binding_bytes: limits.max_storage_buffer_binding_size,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            workgroup_invocations: limits.max_compute_invocations_per_workgroup,
            workgroup_bytes: limits.max_compute_workgroup_storage_size,
        },
        timestamps: features.contains(Features::TIMESTAMP_QUERY),
        unclipped_depth: features.contains(Features::DEPTH_CLIP_CONTROL),
    }
}

/// Operating systems that get their drivers in different ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum System {
    Debian,
    Fedora,
    Arch,
    OtherUnix,
    MacOs,
    Windows,
}

impl System {
    fn this() -> Self {
        match std::env::consts::OS {
            "macos" => System::MacOs,
            "windows" => System::Windows,
            _ => Self::of(&std::fs::read_to_string("/etc/os-release").unwrap_or_default()),
        }
    }

    /// The family that a Linux distribution counts itself to, from its os-release file.
    fn of(os_release: &str) -> Self {
        let lines = os_release.lines().filter_map(|line| line.split_once('='));
        let names: Vec<&str> = lines
            .filter(|(key, _)| *key == "ID" || *key == "ID_LIKE")
            .flat_map(|(_, value)| value.trim_matches(['"', '\'']).split_whitespace())
            .collect();
        let is = |known: &[&str]| names.iter().any(|name| known.contains(name));
        if is(&["debian", "ubuntu"]) {
            System::Debian
        } else if is(&["fedora", "rhel", "centos"]) {
            System::Fedora
        } else if is(&["arch"]) {
            System::Arch
        } else {
            System::OtherUnix
        }
    }

    /// What to install for a GPU that is there, and for a software adapter unless there is one.
    fn advice(self, software: bool) -> Vec<String> {
        let nvidia = "For an NVIDIA card install NVIDIA's own driver";
        let (hardware, mesa) = match self {
            System::Debian => (
                format!(
                    "For an AMD or Intel GPU: sudo apt install mesa-vulkan-drivers libvulkan1. {nvidia}: \
                     package nvidia-driver on Debian (non-free), `ubuntu-drivers install` on Ubuntu"
                ),
                "sudo apt install mesa-vulkan-drivers libvulkan1",
            ),
            System::Fedora => (
                format!(
                    "For an AMD or Intel GPU: sudo dnf install mesa-vulkan-drivers vulkan-loader. {nvidia}: \
                     package akmod-nvidia of RPM Fusion"
                ),
                "sudo dnf install mesa-vulkan-drivers vulkan-loader",
            ),
            System::Arch => (
                format!(
                    "sudo pacman -S vulkan-icd-loader, and vulkan-radeon (AMD) or vulkan-intel (Intel). {nvidia}: \
                     package nvidia-utils"
                ),
                "sudo pacman -S vulkan-icd-loader vulkan-swrast",
            ),
            System::OtherUnix => (
                format!(
                    "Install the Vulkan loader (libvulkan) and Mesa's Vulkan drivers. {nvidia}"
                ),
                "install the Vulkan loader and Mesa's lavapipe",
            ),
            System::MacOs => {
                let metal = "Metal comes with macOS; a Mac without an adapter is a virtual machine without \
                             a graphics device";
                return vec![metal.to_owned()];
            }
            System::Windows => {
                let dx12 = "Install the newest driver of the GPU's maker: it brings Direct3D 12 and Vulkan";
                return vec![dx12.to_owned()];
            }
        };
        let mut advice = vec![hardware];
        if !software {
            advice.push(format!(
                "For a software adapter (slow; `--backend gpu` takes it): {mesa}"
            ));
        }
        advice
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_of_linux() {
        for (text, system) in [
            ("NAME=x\nID=debian\n", System::Debian),
            ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", System::Debian),
            ("ID=fedora", System::Fedora),
            (
                "ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"",
                System::Fedora,
            ),
            ("ID=arch", System::Arch),
            ("ID=nixos\nVARIANT_ID=debian", System::OtherUnix),
            ("", System::OtherUnix),
        ] {
            assert_eq!(System::of(text), system, "{text}");
        }
    }

    #[test]
    fn advice_names_packages() {
        assert!(System::Debian.advice(false)[1].contains("mesa-vulkan-drivers"));
        assert_eq!(System::Debian.advice(true).len(), 1);
        assert!(System::Arch.advice(false)[1].contains("vulkan-swrast"));
    }

    #[test]
    fn a_scene_that_does_not_fit_is_refused_by_what_is_too_much() {
        let adapter = Adapter {
            name: "a card".into(),
            kind: AdapterKind::Discrete,
            backend: "vulkan".into(),
            driver: String::new(),
            limits: AdapterLimits {
                texture_side: 16_384,
                texture_layers: 256,
                buffer_bytes: 1 << 30,
                binding_bytes: 128 << 20,
                storage_buffers: 8,
                workgroup_invocations: 256,
                workgroup_bytes: 16_384,
            },
            timestamps: true,
            unclipped_depth: true,
        };
        let most = (128 << 20) / 108;
        assert!(adapter.takes(most, 32 << 20).is_ok());
        let error = adapter.takes(most + 1, 0).unwrap_err().problem();
        assert!(
            error.contains("1242757 triangles") && error.contains("takes 1242756"),
            "{error}"
        );
        let error = adapter.takes(0, (32 << 20) + 1).unwrap_err().problem();
        assert!(error.contains("texels"), "{error}");
        assert!(adapter.takes(usize::MAX, 0).is_err());
    }

    #[test]
    fn hardware_comes_first() {
        let mut kinds = [
            AdapterKind::Software,
            AdapterKind::Integrated,
            AdapterKind::Discrete,
        ];
        kinds.sort();
        assert_eq!(
            kinds,
            [
                AdapterKind::Discrete,
                AdapterKind::Integrated,
                AdapterKind::Software
            ]
        );
    }
}
