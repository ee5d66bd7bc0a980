//! The GPU, through wgpu: Vulkan, Metal, Direct3D 12. No other module names wgpu.
//!
//! [`Gpu`] runs the passes of a plan's effects, which are plain data ([`crate::effect::Pass`]). It lasts over plans: pipelines are
//! compiled once, the scene's buffers are relative to an anchor and serve as long as the scene is the same and the eye near, what
//! effects keep serves until what it was made of changes. Nothing is compiled or allocated for an effect that the plan leaves out.
//! The picture is worked off in tiles, so that any size fits an adapter's limits and no submit is long. An effect without passes
//! is done on the CPU by its reference, from the surfaces and fields that the GPU found.
//!
//! | file | what |
//! |---|---|
//! | [`adapters`], [`device`], `timer` | which adapters there are; a device with errors and bytes; how long passes take |
//! | `shared`, `source`, `pipeline` | what Rust and WGSL share; the text of a shader; what is compiled of it |
//! | `scene`, `store`, `beams`, `maps` | what lasts: the scene, fields and products, beams with their shadow maps and where these look |
//! | `seen`, `window` | how far a picture's rays see; what lies within a rectangle along a direction |
//! | `prepare`, `schedule`, `job`, `tile`, `view` | a plan made ready, in which order, and at work; the buffers of a tile, and its camera |
//! | `draw`, `by_cpu`, `left_over`, `on_device` | one submit; what the CPU does of a tile, and of pixels that have too much to do; pictures that stay |
//! | [`sky_map`], `hemicube` | maps of the whole sky; what patches of surfaces see of each other |

pub mod adapters;
mod beams;
mod by_cpu;
pub mod device;
mod draw;
mod ends;
mod hemicube;
mod job;
mod left_over;
mod maps;
mod on_device;
mod pipeline;
mod prepare;
mod scene;
mod schedule;
mod seen;
mod shared;
pub mod sky_map;
mod source;
mod store;
mod tile;
mod timer;
mod view;
mod window;

pub use device::{Choice, Device};
pub use hemicube::Hemicubes;
pub use on_device::OnDevice;
pub use source::shader_text;

use super::rendering::{Limits, Rendered};
use crate::effect::Kept;
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::sky::Sky;
use crate::sky::map::Map;
use crate::task::Progress;
use glam::DVec3;
use job::{Job, Lent};
use pipeline::{BUFFERS_COUNTING, Pipelines};
use scene::SceneOnDevice;
use std::sync::Arc;
use std::time::Instant;
use store::Store;
use timer::Timer;

/// A device and all that lasts on it over plans.
pub struct Gpu {
    device: Arc<Device>,
    pipelines: Pipelines,
    scene: Option<SceneOnDevice>,
    store: Store,
    kept: Kept,
    /// What paints sky maps, once it was needed.
    sky_maps: Option<wgpu::ComputePipeline>,
    /// What adds tiles to pictures that stay, once it was needed.
    adder: Option<on_device::Adder>,
    timer: Option<Timer>,
}

impl Gpu {
    /// Over an open device.
    pub fn new(device: Device) -> Self {
        let device = Arc::new(device);
        Gpu {
            pipelines: Pipelines::new(&device),
            scene: None,
            store: Store::default(),
            kept: Kept::with_drawer(Arc::new(Hemicubes::new(device.clone()))),
            sky_maps: None,
            adder: None,
            timer: None,
            device,
        }
    }

    /// Over the best adapter of a choice.
    ///
    /// # Errors
    /// Those of [`Device::open`].
    pub fn open(choice: Choice) -> Result<Self> {
        Ok(Gpu::new(Device::open(choice)?))
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Drops all results and shadow maps that are kept, so that the next picture makes them anew; the scene's buffers and the
    /// pipelines stay.
    pub fn forget(&mut self) {
        if let Some(scene) = &mut self.scene {
            scene.slots.forget();
        }
        self.store.forget();
        self.kept.forget();
    }

    /// Renders a plan.
    ///
    /// With more than one sample, all pixels take the mean of as many rays, at the places of [`crate::conditions::sample_positions`];
    /// distance and normal are those of the ray nearest the pixel's centre.
    ///
    /// # Errors
    /// [`Error::Input`] when the frame would hold more than the limit's memory; [`Error::Failed`] when the scene is larger than the
    /// adapter takes, or the device fails; [`Error::Domain`] for a shadow map larger than the adapter's textures;
    /// [`Error::Stopped`] when it was stopped.
    pub fn render(&mut self, plan: &Plan, limits: &Limits, progress: Progress) -> Result<Rendered> {
        self.run(
            plan,
            limits,
            progress,
            false,
            &mut on_device::Growing::default(),
        )
    }

    /// The same with shaders that count what they read ([`crate::backend::StepTime::counted`]); times of such a rendering mean nothing. Takes
    /// one storage buffer more than every device has.
    ///
    /// # Errors
    /// Those of [`Gpu::render`]; [`Error::Failed`] on a device that has too few storage buffers.
    pub fn count(&mut self, plan: &Plan, limits: &Limits, progress: Progress) -> Result<Rendered> {
        let buffers = self.device.limits().max_storage_buffers_per_shader_stage;
        if buffers < BUFFERS_COUNTING {
            return Err(Error::failed(
                format!(
                    "counting what shaders read takes {BUFFERS_COUNTING} storage buffers, and {} takes {buffers} at once",
                    self.device.adapter.name
                ),
                "use another adapter: `tyndall doctor` lists them",
            ));
        }
        self.run(
            plan,
            limits,
            progress,
            true,
            &mut on_device::Growing::default(),
        )
    }

    /// Renders a plan and leaves the picture on the device: nothing is read back but what effects on the CPU need. Beside it what
    /// [`Gpu::render`] gives, with an empty frame.
    ///
    /// # Errors
    /// Those of [`Gpu::render`]; [`Error::Failed`] for a picture larger than a binding of the device.
    pub fn render_on_device(
        &mut self,
        plan: &Plan,
        limits: &Limits,
        progress: Progress,
    ) -> Result<(OnDevice, Rendered)> {
        let mut growing = on_device::Growing::wanted(self.adder.take());
        let rendered = self.run(plan, limits, progress, false, &mut growing);
        self.adder = growing.adder.take();
        let rendered = rendered?;
        let picture = growing.into_picture().ok_or_else(|| {
            Error::failed(
                "the picture has no pixels",
                "give it a size of at least 1 x 1",
            )
        })?;
        Ok((picture, rendered))
    }

    /// Paints a map: the sky above the horizon, `ground` [cd/m2] below, black outside the circle of a fisheye. The sun's disc is not
    /// in it: its few texels are [`Map::disc`]'s, in f64.
    ///
    /// Agrees with [`Sky::radiance`] within 1e-4 in every texel, measured against the texel's largest channel.
    ///
    /// # Errors
    /// [`Error::Failed`] when the device fails or is too small for 2 million texels at once.
    pub fn paint(&mut self, map: &Map, sky: &Sky, ground: DVec3) -> Result<sky_map::Painted> {
        let make = || sky_map::pipeline(&self.device);
        let pipeline = self.sky_maps.get_or_insert_with(make);
        sky_map::paint(&self.device, pipeline, map, sky, ground)
    }

    fn run(
        &mut self,
        plan: &Plan,
        limits: &Limits,
        progress: Progress,
        counting: bool,
        growing: &mut on_device::Growing,
    ) -> Result<Rendered> {
        let conditions = plan.conditions;
        // What a rendering that was stopped has made is not made for this one.
        self.kept.take_made();
        self.kept.take_notes();
        let mut loaded = false;
        let begin = Instant::now();
        match &mut self.scene {
            Some(scene) if scene.is_of(conditions) => scene.follow(conditions),
            slot => {
                let texels = conditions.scene.textures.iter().map(|t| t.pixels.len());
                let triangles = conditions.scene.mesh.triangles.len();
                self.device.adapter.takes(triangles, texels.sum())?;
                *slot = Some(SceneOnDevice::new(conditions));
                loaded = true;
            }
        }
        let scene = self.scene.as_mut().expect("it was just put there");
        let timer = match &mut self.timer {
            Some(timer) => timer,
            none => none.insert(Timer::new(&self.device, 0)?),
        };
        let lent = Lent {
            device: &self.device,
            pipelines: &mut self.pipelines,
            scene,
            store: &mut self.store,
            kept: &self.kept,
            timer,
            counting,
        };
        let before = begin.elapsed();
        let mut rendered =
            Job::new(plan, lent, limits.task(progress))?.render(limits.memory, growing)?;
        rendered.start_up.add(prepare::SCENE, before);
        rendered.made.scene = loaded;
        rendered.made.products.extend(self.kept.take_made());
        rendered.notes.extend(self.kept.take_notes());
        Ok(rendered)
    }
}
