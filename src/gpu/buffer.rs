//! Typed memory on the device.

use std::marker::PhantomData;

use bytemuck::Pod;
use wgpu::BufferUsages;

use super::{Gpu, GpuError};

/// Device memory for `len` records of type `T`.
#[derive(Clone, Debug)]
pub struct Buffer<T> {
    pub(super) raw: wgpu::Buffer,
    what: String,
    len: usize,
    record: PhantomData<T>,
}

impl<T> Buffer<T> {
    /// The number of records.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    fn byte_len(&self) -> usize {
        self.len * size_of::<T>()
    }
}

impl Gpu {
    /// Device memory that holds a copy of `records`; `what` names it in errors.
    ///
    /// # Errors
    ///
    /// [`GpuError::BufferTooLarge`], [`GpuError::OutOfMemory`], or what became of the device.
    pub fn upload<T: Pod>(&self, what: &str, records: &[T]) -> Result<Buffer<T>, GpuError> {
        let buffer = self.zeros(what, records.len())?;
        self.write(&buffer, records)?;
        Ok(buffer)
    }

    /// Device memory for `len` records, all bytes zero; `what` names it in errors.
    ///
    /// # Errors
    ///
    /// [`GpuError::BufferTooLarge`], [`GpuError::OutOfMemory`], or what became of the device.
    pub fn zeros<T: Pod>(&self, what: &str, len: usize) -> Result<Buffer<T>, GpuError> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer(what, len, usage, self.device.limits().max_storage_buffer_binding_size)
    }

    /// Device memory for the one record of settings that a kernel reads.
    ///
    /// # Errors
    ///
    /// As [`upload`](Self::upload).
    pub fn uniform<T: Pod>(&self, what: &str, record: T) -> Result<Buffer<T>, GpuError> {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let buffer = self.buffer(what, 1, usage, self.device.limits().max_uniform_buffer_binding_size)?;
        self.write(&buffer, &[record])?;
        Ok(buffer)
    }

    /// Replaces a buffer's first records; takes effect before whatever is submitted next.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`] where `records` are more than the buffer holds.
    pub fn write<T: Pod>(&self, buffer: &Buffer<T>, records: &[T]) -> Result<(), GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(records);
        let whole_words = bytes.len() - bytes.len() % 4;
        self.guarded(&buffer.what, || {
            self.queue.write_buffer(&buffer.raw, 0, &bytes[..whole_words]);
            if whole_words < bytes.len() {
                let mut last = [0; 4];
                last[..bytes.len() - whole_words].copy_from_slice(&bytes[whole_words..]);
                self.queue.write_buffer(&buffer.raw, whole_words as u64, &last);
            }
        })
    }

    /// Waits for the device and copies a storage buffer back.
    ///
    /// # Errors
    ///
    /// [`GpuError::Map`], [`GpuError::Timeout`], or what became of the device.
    pub fn read<T: Pod>(&self, buffer: &Buffer<T>) -> Result<Vec<T>, GpuError> {
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let copy: Buffer<T> = self.buffer(&buffer.what, buffer.len, usage, u64::MAX)?;
        self.guarded(&buffer.what, || {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&buffer.raw, 0, &copy.raw, 0, None);
            self.queue.submit([encoder.finish()]);
            copy.raw.map_async(wgpu::MapMode::Read, .., |_| ());
        })?;
        self.wait()?;
        let unreadable = |_| GpuError::Map { what: buffer.what.clone() };
        let bytes = copy.raw.get_mapped_range(..).map_err(unreadable)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes[..buffer.byte_len()]))
    }

    fn buffer<T>(&self, what: &str, len: usize, usage: BufferUsages, bindable: u64) -> Result<Buffer<T>, GpuError> {
        // Bindings may not be empty, and copies go by whole words.
        let needed = (len as u64).saturating_mul(size_of::<T>() as u64).max(16);
        let needed = needed.checked_next_multiple_of(4).unwrap_or(u64::MAX);
        let allowed = bindable.min(self.device.limits().max_buffer_size);
        if needed > allowed {
            return Err(GpuError::BufferTooLarge { what: what.to_owned(), needed, allowed });
        }
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size: needed, usage, mapped_at_creation: false };
        let raw = self.guarded(what, || self.device.create_buffer(&descriptor))?;
        Ok(Buffer { raw, what: what.to_owned(), len, record: PhantomData })
    }
}
