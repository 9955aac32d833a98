//! The bodies of the fuzz targets, once: libFuzzer calls them through `fuzz_targets/`, and the runner of `examples/run.rs` without it.

pub mod bytes;
pub mod mutate;
pub mod seeds;
pub mod targets;

use targets as t;

/// A target: what it does with bytes. It panics where the library breaks a promise.
pub type Target = fn(&[u8]);

/// The targets by their names, which are those of the files in `fuzz_targets/`.
pub const TARGETS: [(&str, Target); 16] = [
    ("obj", t::obj),
    ("stl", t::stl),
    ("ply", t::ply),
    ("off", t::off),
    ("msh", t::msh),
    ("vtk", t::vtk),
    ("vtu", t::vtu),
    ("vtp", t::vtp),
    ("any", t::any),
    ("guides", t::guides),
    ("sizes", t::sizes),
    ("edges", t::edges),
    ("options", t::options),
    ("config", t::config),
    ("check", t::check),
    ("pipeline", t::pipeline),
];
