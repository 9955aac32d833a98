//! What integration tests share: the device, the files beside the repository, and skips that are counted.

pub mod surfaces;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use quadmosaic::gpu::{Gpu, GpuError};

/// The one device of this test process, or a counted skip where there is no adapter.
///
/// With `QUADMOSAIC_REQUIRE_GPU=1` no adapter is a failure; so is, always, an adapter that cannot be opened.
#[allow(dead_code, reason = "each test binary compiles this file, and not all use the GPU")]
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Result<Gpu, GpuError>> = OnceLock::new();
    match GPU.get_or_init(|| Gpu::open(None)) {
        Ok(gpu) => {
            println!("adapter: {}", gpu.adapter());
            Some(gpu)
        }
        Err(GpuError::NoAdapter) if std::env::var("QUADMOSAIC_REQUIRE_GPU").as_deref() != Ok("1") => {
            skip("no adapter");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// A file of the `shared` folder beside the repository, or a counted skip where it is missing.
#[allow(dead_code, reason = "each test binary compiles this file, and not all use shared files")]
pub fn shared(path: &str) -> Option<PathBuf> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(path);
    if file.exists() {
        return Some(file);
    }
    skip(&format!("no ../shared/{path}"));
    None
}

/// Says that the test on this thread is skipped, in the line that `tests/run.sh` counts.
#[allow(dead_code, reason = "each test binary compiles this file, and not all skip by themselves")]
pub fn skip(reason: &str) {
    let thread = std::thread::current();
    let line = format!("SKIPPED {}: {reason}\n", thread.name().unwrap_or("a test"));
    // Straight to stderr, in one piece: the harness would swallow `eprintln!`, and other tests cut into it.
    std::io::stderr().write_all(line.as_bytes()).expect("stderr is open");
}
