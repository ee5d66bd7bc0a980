//! A device and its queue: opened with everything that the adapter has, errors turned into ours, bytes counted.

use super::adapters::{self, Adapter};
use crate::backend::rendering::Traffic;
use crate::error::{Error, Result};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, DeviceDescriptor, ExperimentalFeatures, Extent3d,
    Features, MapMode, MemoryHints, PollType, TexelCopyBufferLayout, Texture, TextureDescriptor,
    TextureDimension, TextureFormat, TextureUsages, Trace,
};

/// Storage buffers that a pass sees at most: those that core WebGPU guarantees.
const STORAGE_BUFFERS: u32 = 8;

/// Which adapter is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// One of hardware only.
    Hardware,
    /// The best that there is, of software too.
    Any,
}

/// An open device.
pub struct Device {
    /// What it runs on.
    pub adapter: Adapter,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    limits: wgpu::Limits,
    failure: Arc<Mutex<Option<Error>>>,
    traffic: Mutex<Traffic>,
}

impl Device {
    /// Opens the best adapter of a choice, with all its limits.
    ///
    /// # Errors
    /// [`Error::Failed`] when there is none, or when the driver refuses; it says what to install or to use instead.
    pub fn open(choice: Choice) -> Result<Self> {
        Self::open_if_any(choice)?.ok_or_else(|| {
            let advice = adapters::report().advice.join("; ");
            Error::failed(
                "there is no graphics adapter that could be used",
                format!("use `--backend reference`, or see `tyndall doctor`. {advice}"),
            )
        })
    }

    /// The same, but for nothing where there is no adapter of the choice.
    ///
    /// # Errors
    /// [`Error::Failed`] when the driver refuses.
    pub fn open_if_any(choice: Choice) -> Result<Option<Self>> {
        let Some((handle, adapter)) = adapters::best(choice == Choice::Any) else {
            return Ok(None);
        };
        let wanted = Features::TIMESTAMP_QUERY;
        let limits = handle.limits();
        let request = handle.request_device(&DeviceDescriptor {
            label: Some("tyndall"),
            required_features: handle.features() & wanted,
            required_limits: limits.clone(),
            experimental_features: ExperimentalFeatures::disabled(),
            memory_hints: MemoryHints::default(),
            trace: Trace::Off,
        });
        let (device, queue) = pollster::block_on(request).map_err(|error| {
            Error::failed(
                format!("the adapter {} could not be opened: {error}", adapter.name),
                "use `--backend reference`, or update the graphics driver",
            )
        })?;
        Ok(Some(Self::over(adapter, limits, device, queue)))
    }

    /// Over a device that somebody else has opened, a viewer say, on an adapter of wgpu; errors that nobody captures on it come out
    /// of the calls here.
    ///
    /// # Errors
    /// [`Error::Failed`] for a device whose shaders see fewer storage buffers at once than passes bind.
    pub fn from_wgpu(
        handle: &wgpu::Adapter,
        device: wgpu::Device,
        queue: wgpu::Queue,
    ) -> Result<Self> {
        let limits = device.limits();
        let (has, needs) = (limits.max_storage_buffers_per_shader_stage, STORAGE_BUFFERS);
        if has < needs {
            return Err(Error::failed(
                format!(
                    "the device takes {has} storage buffers at once, and passes bind up to {needs}"
                ),
                "open it with wgpu's default limits or those of the adapter, not with downlevel ones",
            ));
        }
        Ok(Self::over(
            adapters::describe(handle),
            limits,
            device,
            queue,
        ))
    }

    fn over(
        adapter: Adapter,
        limits: wgpu::Limits,
        device: wgpu::Device,
        queue: wgpu::Queue,
    ) -> Self {
        let failure = Arc::new(Mutex::new(None));
        let first = failure.clone();
        device.on_uncaptured_error(Arc::new(move |error| keep(&first, ours(error))));
        let lost = failure.clone();
        device.set_device_lost_callback(move |reason, text| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                keep(&lost, device_lost(&text));
            }
        });
        Device {
            adapter,
            device,
            queue,
            limits,
            failure,
            traffic: Mutex::default(),
        }
    }

    /// The first thing that went wrong on the device, if anything has.
    ///
    /// # Errors
    /// That.
    pub fn check(&self) -> Result<()> {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.take().map_or(Ok(()), Err)
    }

    /// Bytes allocated and moved so far.
    pub fn traffic(&self) -> Traffic {
        *self.traffic.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn count(&self, add: impl FnOnce(&mut Traffic)) {
        add(&mut self.traffic.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// The adapter's limits.
    pub(super) fn limits(&self) -> &wgpu::Limits {
        &self.limits
    }

    pub(super) fn timestamps(&self) -> bool {
        self.device.features().contains(Features::TIMESTAMP_QUERY)
    }

    /// A buffer of at least one vector's size. `what` names it to the user when it is too large.
    pub(super) fn buffer(&self, what: &str, bytes: u64, usage: BufferUsages) -> Result<Buffer> {
        let size = bytes.max(64).next_multiple_of(16);
        let most = if usage.contains(BufferUsages::STORAGE) {
            self.limits
                .max_storage_buffer_binding_size
                .min(self.limits.max_buffer_size)
        } else {
            self.limits.max_buffer_size
        };
        if size > most {
            return Err(Error::failed(
                format!(
                    "{what} need {} MiB, and {} takes {} MiB at once",
                    size >> 20,
                    self.adapter.name,
                    most >> 20
                ),
                "use `--backend reference`, another adapter, or a smaller scene",
            ));
        }
        self.count(|traffic| traffic.allocated += size);
        Ok(self.device.create_buffer(&BufferDescriptor {
            label: Some(what),
            size,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// A buffer with contents.
    pub(super) fn filled(&self, what: &str, bytes: &[u8], usage: BufferUsages) -> Result<Buffer> {
        let buffer = self.buffer(what, bytes.len() as u64, usage | BufferUsages::COPY_DST)?;
        self.write(&buffer, bytes);
        Ok(buffer)
    }

    /// A texture of four numbers a texel, in rows of `width`. `what` names it to the user when it is too large.
    pub(super) fn texels<T: bytemuck::Pod + Default>(
        &self,
        what: &str,
        width: u32,
        format: TextureFormat,
        mut values: Vec<T>,
    ) -> Result<Texture> {
        let height = values.len().div_ceil(width as usize).max(1);
        let most = self.limits.max_texture_dimension_2d;
        if height > most as usize {
            return Err(Error::failed(
                format!(
                    "{what} fill {height} rows of a texture, and {} takes {most}",
                    self.adapter.name
                ),
                "use `--backend reference`, another adapter, or a smaller scene",
            ));
        }
        values.resize(width as usize * height, T::default());
        let size = Extent3d {
            width,
            height: height as u32,
            depth_or_array_layers: 1,
        };
        let bytes: &[u8] = bytemuck::cast_slice(&values);
        self.count(|traffic| {
            traffic.allocated += bytes.len() as u64;
            traffic.uploaded += bytes.len() as u64;
        });
        let texture = self.device.create_texture(&TextureDescriptor {
            label: Some(what),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        self.queue.write_texture(
            texture.as_image_copy(),
            bytes,
            TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(16 * width),
                rows_per_image: None,
            },
            size,
        );
        Ok(texture)
    }

    /// Writes to the start of a buffer.
    pub(super) fn write(&self, buffer: &Buffer, bytes: &[u8]) {
        self.count(|traffic| traffic.uploaded += bytes.len() as u64);
        self.queue.write_buffer(buffer, 0, bytes);
    }

    /// Reads the first bytes of a buffer that can be mapped, once all that was submitted is done.
    pub(super) fn read(&self, buffer: &Buffer, bytes: u64) -> Result<Vec<u8>> {
        let range = 0..bytes;
        buffer.map_async(MapMode::Read, range.clone(), |_| {});
        self.wait()?;
        let view = buffer.get_mapped_range(range).map_err(|error| {
            Error::failed(
                format!(
                    "nothing could be read back from {}: {error}",
                    self.adapter.name
                ),
                "try again, or use `--backend reference`",
            )
        })?;
        let copy = view.to_vec();
        drop(view);
        buffer.unmap();
        self.count(|traffic| traffic.downloaded += bytes);
        Ok(copy)
    }

    /// Waits for all that was submitted.
    pub(super) fn wait(&self) -> Result<()> {
        let polled = self.device.poll(PollType::wait_indefinitely());
        self.check()?;
        polled
            .map(|_| ())
            .map_err(|error| device_lost(&error.to_string()))
    }
}

/// Keeps the first error: those after it are its consequences.
fn keep(place: &Mutex<Option<Error>>, error: Error) {
    place
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .get_or_insert(error);
}

fn device_lost(text: &str) -> Error {
    Error::failed(
        format!("the graphics device was lost ({})", text.trim()),
        "try again; if it happens again, lower --size or --quality (the driver stops long work), update the driver, \
         or use `--backend reference`",
    )
}

/// An error of wgpu in our words.
fn ours(error: wgpu::Error) -> Error {
    match error {
        wgpu::Error::OutOfMemory { .. } => Error::failed(
            "the graphics device has no memory left",
            "lower shadow.resolution with --set, leave effects out with --without, or use `--backend reference`",
        ),
        wgpu::Error::Validation { description, .. } => Error::failed(
            format!(
                "the graphics interface refused a command: {}",
                plain(&description)
            ),
            "this is a defect of tyndall: please report it with the scene and the command, and use `--backend reference`; in the \
             shader of an effect of your own, mend it there (lines are counted with the text that is put before it)",
        ),
        wgpu::Error::Internal { description, .. } => Error::failed(
            format!("the graphics driver failed: {}", plain(&description)),
            "update the graphics driver, or use `--backend reference`",
        ),
    }
}

/// A message of several lines, headed "Validation Error" and "Caused by", in one.
fn plain(description: &str) -> String {
    let lines = description.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && *line != "Validation Error" && *line != "Caused by:")
        .collect::<Vec<_>>()
        .join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_unwrapped_for_users() {
        let description = "Validation Error\n\nCaused by:\n  In Device::create_bind_group\n    Buffer is too large\n";
        let error = ours(wgpu::Error::Validation {
            source: "x".into(),
            description: description.into(),
        });
        assert_eq!(
            error.problem(),
            "the graphics interface refused a command: In Device::create_bind_group: Buffer is too large"
        );
        assert!(!error.is_input());
        let error = ours(wgpu::Error::OutOfMemory { source: "x".into() });
        assert!(error.remedy().contains("shadow.resolution"));
        assert!(device_lost("gone").remedy().contains("--backend reference"));
    }

    #[test]
    fn the_first_error_is_kept() {
        let place = Mutex::new(None);
        keep(&place, Error::failed("first", ""));
        keep(&place, Error::failed("second", ""));
        let kept = place.into_inner().unwrap_or_else(PoisonError::into_inner);
        assert_eq!(kept.map(|e| e.problem()).as_deref(), Some("first"));
    }
}
