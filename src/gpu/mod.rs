//! The GPU, through wgpu: Vulkan, Metal, Direct3D 12. No other module names wgpu.
//!
//! [`Gpu`] runs the passes of a plan's effects, which are plain data ([`crate::effect::Pass`]): it compiles and allocates what
//! they name when it is made, once, and nothing for an effect that the plan leaves out. The picture is worked off in tiles, so
//! that any size fits an adapter's limits and no submit is long. An effect without passes is done on the CPU by its reference,
//! from the surfaces that the GPU found.

pub mod adapters;
pub mod device;
mod light;
mod pipeline;
mod render;
mod scene;
mod shared;
pub mod sky_map;
mod timer;

pub use device::{Choice, Device, Traffic};
pub use render::{Gpu, PassTime, Rendered};
