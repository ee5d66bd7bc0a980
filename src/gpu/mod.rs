//! The GPU, through wgpu: Vulkan, Metal, Direct3D 12. No other module names wgpu.

pub mod adapters;
