//! An empty folder, and the program run in it.
#![allow(dead_code, reason = "each test binary compiles this file, and not all use all of it")]

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A temporary folder.
pub struct Desk {
    folder: TempDir,
}

impl Desk {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("it can be written");
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        self.fed(arguments, b"")
    }

    /// The program with these arguments, in the folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut program = Command::new(env!("CARGO_BIN_EXE_quadmosaic"));
        program.args(arguments);
        // What the machine has must not decide what is tested; drivers print messages of their own, too.
        if matches!(arguments.first(), Some(&("mesh" | "field" | "mosaic" | "study"))) {
            program.args(["--backend", "cpu"]);
        }
        program.current_dir(self.folder.path());
        program
    }

    /// Runs it with these bytes on its standard input.
    pub fn fed(&self, arguments: &[&str], input: &[u8]) -> Output {
        let mut program = self.command(arguments);
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = program.spawn().expect("the program starts");
        // It need not read it.
        let _ = program.stdin.take().expect("it is piped").write_all(input);
        program.wait_with_output().expect("the program ends")
    }

    /// What it prints, where it succeeds.
    pub fn said(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names in the folder, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("the folder can be listed");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs what must fail with this exit code, and returns the first line of what it says: the only one where it is not
    /// clap that speaks. Nothing may be left behind.
    pub fn refusal(&self, code: i32, arguments: &[&str]) -> String {
        let before = self.names();
        let output = self.run(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert_eq!(self.names(), before, "{arguments:?} left something");
        let (first, rest) = message.split_once('\n').expect("a message has a line");
        assert!(first.starts_with("error: "), "{message}");
        assert!(code == 2 || rest.is_empty(), "{arguments:?}: more than a line: {message}");
        first.to_owned()
    }
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program prints UTF-8")
}
