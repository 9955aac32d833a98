//! Files that appear whole or not at all.
//!
//! # Practice
//! A file is written under another name in the same folder, put on the disk, and renamed: whatever ends the process or the machine, its
//! place has the file before or the whole one. What ends the process alone may leave the other name, but for signals that a program
//! answers by [`discard_drafts`].

use super::WriteError;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Writes a file by `content`, under another name in the same folder until it is complete. A link is followed; a device
/// or pipe, which cannot be replaced, is written directly.
///
/// # Errors
/// [`WriteError`]; then nothing is left behind.
pub fn atomic(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
    let failed = |source: io::Error| WriteError::System { path: path.to_owned(), source };
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if target.file_name().is_none() || target.is_dir() {
        return Err(WriteError::NotAFile { path: path.to_owned() });
    }
    if target.exists() && !target.is_file() {
        let file = File::options().write(true).open(&target);
        return file.and_then(|file| fill(&file, content)).map_err(failed);
    }
    let folder = target.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path.to_owned() });
    }
    let (draft, file) = Draft::create(folder).map_err(failed)?;
    fill(&file, content).and_then(|()| file.sync_all()).and_then(|()| draft.place(&target)).map_err(failed)?;
    // The file is there; that its name is on the disk too cannot be had everywhere.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Checks that a folder takes a new file.
///
/// # Errors
/// Where it takes none; the folder stays as it is.
pub fn expect_room(folder: &Path) -> io::Result<()> {
    Draft::create(folder).map(|_| ())
}

/// Removes the files that [`atomic`] has not completed, and lets it neither begin nor complete another one: for the end of the process by
/// a signal. A thread that writes a file waits from then on.
pub fn discard_drafts() {
    let drafts = drafts();
    drafts.iter().for_each(|path| {
        let _ = fs::remove_file(path);
    });
    mem::forget(drafts);
}

fn fill(file: &File, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    content(&mut writer)?;
    writer.flush()
}

/// The drafts of this process.
static DRAFTS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn drafts() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    DRAFTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that is not complete, removed where it does not become so.
struct Draft {
    path: PathBuf,
}

impl Draft {
    /// A new file in a folder, hidden from plain listings. Its name is short: that of the result may be as long as names can be.
    fn create(folder: &Path) -> io::Result<(Self, File)> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let mut drafts = drafts();
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!(".quadmosaic.{}-{number}.part", std::process::id()));
            match File::create_new(&path) {
                // A process of this number, on another machine or before, has left it.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                created => {
                    let file = created?;
                    drafts.insert(path.clone());
                    return Ok((Self { path }, file));
                }
            }
        }
    }

    /// Puts the complete file in its place.
    fn place(&self, target: &Path) -> io::Result<()> {
        let mut drafts = drafts();
        fs::rename(&self.path, target)?;
        drafts.remove(&self.path);
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let mut drafts = drafts();
        if drafts.remove(&self.path) {
            // What failed before is the error to report.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the folder is there");
        entries.map(|entry| entry.expect("it can be listed").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("out.obj");
        atomic(&path, |writer| writer.write_all(b"old")).expect("it can be written");
        let error = atomic(&path, |writer| {
            writer.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("no more"))
        });
        assert!(error.unwrap_err().to_string().contains("out.obj cannot be written (no more)"));
        assert_eq!(fs::read(&path).expect("still there"), b"old");
        assert_eq!(names(folder.path()), ["out.obj"]);
        atomic(&path, |writer| writer.write_all(b"new")).expect("it can be written");
        assert_eq!(fs::read(&path).expect("still there"), b"new");
        assert_eq!(names(folder.path()), ["out.obj"]);
    }

    #[test]
    fn impossible_paths_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let nothing = |_: &mut dyn Write| Ok(());
        assert!(matches!(atomic(folder.path(), nothing), Err(WriteError::NotAFile { .. })));
        assert!(matches!(atomic(Path::new(""), nothing), Err(WriteError::NotAFile { .. })));
        let lost = folder.path().join("none").join("out.obj");
        assert!(matches!(atomic(&lost, nothing), Err(WriteError::NoFolder { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [file, link] = ["file.obj", "link.obj"].map(|name| folder.path().join(name));
        fs::write(&file, "old").expect("it can be written");
        std::os::unix::fs::symlink(&file, &link).expect("it can be linked");
        atomic(&link, |writer| writer.write_all(b"new")).expect("it can be written");
        assert_eq!(fs::read(&file).expect("still there"), b"new");
        assert!(link.is_symlink());
    }
}
