//! The adapters of this machine, as far as every machine has to agree.

mod common;

use tyndall::backend::gpu::adapters::{AdapterKind, report};

#[test]
fn adapters_have_what_webgpu_promises() {
    if !common::gpu("adapters::adapters_have_what_webgpu_promises") {
        return;
    }
    let report = report();
    for adapter in &report.adapters {
        let limits = &adapter.limits;
        // The defaults of the WebGPU specification, section 3.6.2, which every adapter reaches.
        assert!(limits.texture_side >= 8192, "{adapter:?}");
        assert!(limits.binding_bytes >= 128 << 20, "{adapter:?}");
        assert!(limits.buffer_bytes >= 256 << 20, "{adapter:?}");
        assert!(limits.storage_buffers >= 8, "{adapter:?}");
        assert!(!adapter.name.is_empty());
        assert!(["vulkan", "metal", "dx12"].contains(&adapter.backend.as_str()));
        // Mesa's software driver is called what it is.
        if adapter.name.contains("llvmpipe") {
            assert_eq!(adapter.kind, AdapterKind::Software);
        }
        assert!(!report.hidden.contains(adapter));
    }
    let kinds: Vec<AdapterKind> = report.adapters.iter().map(|a| a.kind).collect();
    assert!(kinds.is_sorted(), "{kinds:?}");
    let hardware = report.adapters.iter().any(|a| a.is_hardware());
    assert_eq!(report.advice.is_empty(), hardware);
}
