use std::process::ExitCode;

fn main() -> ExitCode {
    hush_the_vulkan_loader();
    ExitCode::from(quadmosaic::cli::main(std::env::args_os()))
}

/// On a server without a desktop, a layer that Mesa puts before the driver looks for one and complains on stderr at every
/// start; it can be left out there.
#[expect(unsafe_code, reason = "other threads may read the environment meanwhile; there are none yet")]
fn hush_the_vulkan_loader() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread runs yet that could read the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
