//! The report of an earlier run, which must not pass for that of a run that fails.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// The beginning of a report holds its program.
const HEAD: u64 = 200;

/// Removes a report of this program at a path; any other file stays.
pub fn discard(path: &Path) {
    if is_report(path) {
        // Where it cannot be removed, the run that writes there will say so.
        let _ = fs::remove_file(path);
    }
}

/// As [`discard`], for the path that arguments name which cannot be parsed.
pub fn discard_named(arguments: &[OsString]) {
    let joined = |argument: &OsString| argument.to_str()?.strip_prefix("--report=").map(OsString::from);
    let named = arguments.windows(2).filter(|pair| pair[0] == OsStr::new("--report")).map(|pair| pair[1].clone());
    arguments.iter().filter_map(joined).chain(named).for_each(|path| discard(Path::new(&path)));
}

fn is_report(path: &Path) -> bool {
    let mut head = Vec::new();
    // Reading anything else may wait forever.
    let is_file = fs::symlink_metadata(path).is_ok_and(|data| data.is_file());
    is_file
        && File::open(path).is_ok_and(|file| file.take(HEAD).read_to_end(&mut head).is_ok())
        && head.starts_with(b"{")
        && String::from_utf8_lossy(&head).contains("\"program\": \"quadmosaic ")
}
