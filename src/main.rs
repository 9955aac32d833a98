mod cli;

use clap::Parser;
use std::process::ExitCode;

/// The exit code where `--strict` refuses a mesh.
const UNSOUND: u8 = 3;

fn main() -> ExitCode {
    hush_the_vulkan_loader();
    match cli::run(cli::Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Wrong usage that clap could not see by itself exits as all wrong usage does, with code 2.
            if let Some(usage) = error.downcast_ref::<clap::Error>() {
                usage.exit();
            }
            eprintln!("error: {}", sentence(&error));
            if error.is::<cli::Unsound>() { ExitCode::from(UNSOUND) } else { ExitCode::FAILURE }
        }
    }
}

/// On a server without a desktop, a layer that Mesa puts before the driver looks for one and complains on stderr at every
/// start; it can be left out there.
fn hush_the_vulkan_loader() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread runs yet that could read the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// The error and its causes on one line; a cause that the error tells already is not repeated.
fn sentence(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |told, cause| match told.as_str() {
        "" => cause,
        _ if told.contains(&cause) => told,
        _ => format!("{told}: {cause}"),
    })
}
