//! What integration tests share: the files beside the repository, skips that are counted, and surfaces.

pub mod surfaces;

use std::io::Write;
use std::path::{Path, PathBuf};

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
fn skip(reason: &str) {
    let thread = std::thread::current();
    let line = format!("SKIPPED {}: {reason}\n", thread.name().unwrap_or("a test"));
    // Straight to stderr, in one piece: the harness would swallow `eprintln!`, and other tests cut into it.
    std::io::stderr().write_all(line.as_bytes()).expect("stderr is open");
}
