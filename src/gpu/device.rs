//! Adapters, and the device that the kernels run on.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use super::GpuError;

/// The longest wait for a batch. Batches take seconds even on a software adapter; a longer wait means a hung driver.
const PATIENCE: Duration = Duration::from_secs(120);

/// Creating two devices at once crashes lavapipe (gfx-rs/wgpu#10234).
static CREATION: Mutex<()> = Mutex::new(());

/// The description of a GPU before it is opened.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct AdapterSummary {
    /// The adapter's name as its driver gives it.
    pub name: String,
    /// The interface it is driven by: `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// The driver and its version.
    pub driver: String,
    /// What it is: a discrete, integrated or virtual GPU, or a CPU.
    pub kind: &'static str,
    /// Whether it is more than a program on the CPU; llvmpipe/lavapipe is not.
    pub hardware: bool,
}

impl AdapterSummary {
    fn of(info: &wgpu::AdapterInfo) -> Self {
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "CPU",
            wgpu::DeviceType::Other => "unknown",
        };
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            kind,
            hardware: info.device_type != wgpu::DeviceType::Cpu,
        }
    }
}

impl std::fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}, {}, {})", self.name, self.kind, self.backend, self.driver)
    }
}

/// All adapters of this machine, the best first: hardware before software, discrete before integrated.
pub fn adapters() -> Vec<AdapterSummary> {
    let _alone = CREATION.lock().unwrap_or_else(PoisonError::into_inner);
    ranked_adapters().iter().map(|adapter| AdapterSummary::of(&adapter.get_info())).collect()
}

/// The files by which Linux drives GPUs: the kernel's own interface, NVIDIA's, WSL's, Mali's, Adreno's.
const NODES: [&str; 5] = ["/dev/dri", "/dev/nvidiactl", "/dev/dxg", "/dev/mali0", "/dev/kgsl-3d0"];

/// Whether this machine can have a hardware GPU. To list its adapters takes a tenth of a second, even where there is none.
pub fn can_have_hardware() -> bool {
    !cfg!(target_os = "linux") || NODES.iter().any(|node| Path::new(node).exists())
}

fn ranked_adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// An open device. It may be shared between threads; a clone is the same device.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    adapter: AdapterSummary,
    /// The first fault that no call caused; the device cannot be trusted after it.
    fault: Arc<OnceLock<GpuError>>,
}

impl Gpu {
    /// Opens the best adapter whose name contains `wanted` (any case), or the best of all.
    ///
    /// The device gets `wgpu`'s default limits and no features, whatever the adapter offers, so that what runs on one
    /// machine runs on all.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`], [`GpuError::NoMatch`] or [`GpuError::Request`].
    pub fn open(wanted: Option<&str>) -> Result<Self, GpuError> {
        let _alone = CREATION.lock().unwrap_or_else(PoisonError::into_inner);
        let adapters = ranked_adapters();
        let wanted = wanted.unwrap_or("");
        let adapter = pick(&adapters, wanted, |adapter| adapter.get_info().name)?;
        let summary = AdapterSummary::of(&adapter.get_info());
        let descriptor = wgpu::DeviceDescriptor { label: Some("quadmosaic"), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::Request { adapter: summary.name.clone(), reason: error.to_string() })?;

        let fault = Arc::new(OnceLock::new());
        let (stray, lost) = (fault.clone(), fault.clone());
        device.on_uncaptured_error(Arc::new(move |error| {
            let _ = stray.set(blame(error, "an unguarded command"));
        }));
        device.set_device_lost_callback(move |why, message| {
            let _ = lost.set(GpuError::Lost { reason: format!("{why:?}: {message}") });
        });
        Ok(Self { device, queue, adapter: summary, fault })
    }

    /// The adapter this device was opened on.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// Runs `work`, and turns the driver's complaints into an error; `wgpu` alone would panic.
    pub(super) fn guarded<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let filters = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal];
        let [memory, validation, internal] = filters.map(|filter| self.device.push_error_scope(filter));
        let done = work();
        let complaints = [internal, validation, memory].map(|scope| pollster::block_on(scope.pop()));
        let complaint = complaints.into_iter().flatten().next().map(|error| blame(error, what));
        // A lost device makes every call complain: the loss is the cause to report.
        match self.fault().or(complaint) {
            Some(error) => Err(error),
            None => Ok(done),
        }
    }

    /// Waits for everything submitted so far.
    ///
    /// # Errors
    ///
    /// [`GpuError::Timeout`], or what became of the device meanwhile.
    pub fn wait(&self) -> Result<(), GpuError> {
        let until_done = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        // `poll` panics where the driver reports a lost device; by then `wgpu` has left its own state consistent.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(until_done)));
        match (polled, self.fault()) {
            (_, Some(fault)) => Err(fault),
            (Ok(Ok(_)), None) => Ok(()),
            (Ok(Err(wgpu::PollError::Timeout)), None) => Err(GpuError::Timeout { seconds: PATIENCE.as_secs() }),
            (Ok(Err(error)), None) => Err(GpuError::Rejected { what: "a wait".into(), reason: error.to_string() }),
            (Err(_), None) => Err(GpuError::Lost { reason: "the driver gave no reason".into() }),
        }
    }

    fn fault(&self) -> Option<GpuError> {
        self.fault.get().cloned()
    }
}

/// The first of `candidates`, which are sorted best first, whose name contains `wanted`.
fn pick<'a, T>(candidates: &'a [T], wanted: &str, name: impl Fn(&T) -> String) -> Result<&'a T, GpuError> {
    if candidates.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let lowered = wanted.to_lowercase();
    let found = candidates.iter().find(|candidate| name(candidate).to_lowercase().contains(&lowered));
    found.ok_or_else(|| GpuError::NoMatch { wanted: wanted.to_owned(), found: candidates.iter().map(name).collect() })
}

fn blame(error: wgpu::Error, what: &str) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory { what: what.to_owned() },
        wgpu::Error::Validation { description: reason, .. } | wgpu::Error::Internal { description: reason, .. } => {
            GpuError::Rejected { what: what.to_owned(), reason }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn a_lost_device_is_an_error_not_a_panic() {
        // The one device of this process; the integration tests share another in theirs.
        let gpu = match Gpu::open(None) {
            Err(GpuError::NoAdapter) if std::env::var("QUADMOSAIC_REQUIRE_GPU").as_deref() != Ok("1") => {
                return std::io::stderr().write_all(b"SKIPPED a_lost_device: no adapter\n").unwrap();
            }
            opened => opened.unwrap(),
        };
        let buffer = gpu.upload("a test", &[1_u32, 2, 3]).unwrap();
        assert_eq!(gpu.read(&buffer).unwrap(), [1, 2, 3]);
        gpu.device.destroy();
        assert!(matches!(gpu.wait(), Err(GpuError::Lost { .. })));
        assert!(matches!(gpu.upload("a test", &[1_u32]), Err(GpuError::Lost { .. })));
        assert!(matches!(gpu.read(&buffer), Err(GpuError::Lost { .. })));
    }

    #[test]
    fn a_machine_without_the_files_of_gpus_lists_no_hardware() {
        assert!(can_have_hardware() || adapters().iter().all(|adapter| !adapter.hardware));
    }

    #[test]
    fn picks_by_name_and_says_what_there_is() {
        let names = ["NVIDIA H200", "llvmpipe (LLVM 15)"];
        let pick = |names: &[&'static str], wanted| pick(names, wanted, |name| name.to_string()).copied();
        assert_eq!(pick(&names, "").unwrap(), names[0]);
        assert_eq!(pick(&names, "LLVM").unwrap(), names[1]);
        let message = pick(&names, "radeon").unwrap_err().to_string();
        assert!(message.contains("radeon") && names.iter().all(|name| message.contains(name)), "{message}");
        assert!(pick(&[], "").unwrap_err().to_string().contains("apt-get install mesa-vulkan-drivers"));
    }
}
