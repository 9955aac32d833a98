//! What is left of files where a run is killed, the disk is full, or the output is no plain file: the old file, the whole new one, or
//! none.
#![cfg(unix)]

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use std::env;
use std::fs;
use std::hash::{BuildHasher, RandomState};
use std::os::unix::fs::{FileTypeExt, symlink};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Writes some 20 MB, most of its time.
const LARGE: [&str; 6] = ["example", "torus", "--triangles", "300000", "-o", "out.obj"];
/// Meshes, most of its time.
const MESH: [&str; 7] = ["mesh", "example:torus:2000", "--points", "3000", "-q", "-o", "out.obj"];

fn started(desk: &Desk, arguments: &[&str]) -> Child {
    let mut program = desk.command(arguments);
    program.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

fn ended(mut program: Child) -> Option<i32> {
    program.wait().expect("the program ends").code()
}

fn is_draft(name: &str) -> bool {
    name.starts_with(".quadmosaic.") && name.ends_with(".part")
}

/// A random number below `end`.
fn below(end: u64) -> u64 {
    RandomState::new().hash_one(0) % end
}

/// The program under a limit of the size of files, in blocks of half a kilobyte: what it writes beyond fails, as on a full disk.
fn on_a_full_disk(desk: &Desk, blocks: u64, arguments: &[&str]) -> Child {
    let program = desk.command(arguments);
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -f {blocks}; exec \"$0\" \"$@\"")]).arg(program.get_program());
    shell.args(program.get_args()).current_dir(desk.path(""));
    shell.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("there is a shell")
}

/// How a run is ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Signal(&'static str, Option<i32>),
    FullDisk,
}

const ENDS: [End; 4] =
    [End::Signal("INT", Some(130)), End::Signal("TERM", Some(143)), End::Signal("KILL", None), End::FullDisk];

/// Ends runs at random moments: after a random time, or, each second round, once their file is begun. QUADMOSAIC_KILLS runs, or 16.
#[test]
fn a_run_that_is_ended_leaves_the_old_file_or_the_whole_new_one() {
    let runs = env::var("QUADMOSAIC_KILLS").map_or(16, |runs| runs.parse().expect("a number of runs"));
    let whole = [&MESH[..], &LARGE].map(|arguments| {
        let (desk, start) = (Desk::new(), Instant::now());
        desk.said(arguments);
        (arguments, desk.bytes("out.obj"), start.elapsed())
    });
    let (mut absent, mut old, mut new, mut drafts) = (0, 0, 0, 0);
    for run in 0..runs {
        let (end, waits) = (ENDS[run % 4], run / 4 % 2 == 1);
        // What waits for the beginning of the file takes long to write it.
        let (arguments, bytes, time) = &whole[usize::from(waits || run / 8 % 2 == 1)];
        let desk = Desk::new();
        let has_old = below(2) == 0;
        if has_old {
            desk.put("out.obj", "old");
        }
        let code = match end {
            End::FullDisk => ended(on_a_full_disk(&desk, below(bytes.len() as u64 / 1024), arguments)),
            End::Signal(signal, _) => {
                let mut program = started(&desk, arguments);
                if waits {
                    let is_running = |program: &mut Child| program.try_wait().expect("it can be asked").is_none();
                    while is_running(&mut program) && !desk.names().iter().any(|name| is_draft(name)) {
                        thread::sleep(Duration::from_millis(1));
                    }
                } else {
                    thread::sleep(Duration::from_micros(below(time.as_micros() as u64)));
                }
                // It may have come to its end before.
                let _ = Command::new("kill").args([&format!("-{signal}"), &program.id().to_string()]).output();
                ended(program)
            }
        };
        let told = format!("run {run}: {end:?}, exit code {code:?}");
        let expected = match end {
            End::Signal(_, code) => code,
            End::FullDisk => Some(1),
        };
        let mut names = desk.names();
        if code.is_none() {
            drafts += names.iter().filter(|name| is_draft(name)).count();
            names.retain(|name| !is_draft(name));
        }
        assert!(names.is_empty() || names == ["out.obj"], "{told}: {names:?}");
        let content = names.first().map(|name| desk.bytes(name));
        let is_whole = content.as_ref() == Some(bytes);
        match content {
            _ if is_whole => new += 1,
            Some(content) => {
                assert!(has_old && content == b"old", "{told}: a part of a file");
                old += 1;
            }
            None => {
                assert!(!has_old, "{told}: the old file is lost");
                absent += 1;
            }
        }
        assert!(code == expected || code == Some(0) && is_whole && end != End::FullDisk, "{told}");
    }
    println!(
        "{runs} runs: {absent} without a file, {old} with the old one, {new} with the new one; {drafts} drafts left by KILL"
    );
    // Otherwise no run was ended while it wrote.
    assert!(runs < 8 || drafts > 0);
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let desk = Desk::new();
    desk.put("out.obj", "old");
    let small = ["example", "sphere", "--triangles", "5000", "-o", "out.obj"];
    let output = on_a_full_disk(&desk, 8, &small).wait_with_output().expect("it ends");
    assert_eq!((output.status.code(), desk.names()), (Some(1), vec!["out.obj".to_owned()]));
    assert!(text(&output.stderr).starts_with("error: out.obj cannot be written (File too large"), "{output:?}");
    assert_eq!(desk.bytes("out.obj"), b"old");
    assert_eq!(ended(on_a_full_disk(&desk, 8_000, &small)), Some(0));
    assert_ne!(desk.bytes("out.obj"), b"old");
}

/// A file system of so many kilobytes, where this machine lets it be mounted.
struct SmallDisk<'a> {
    desk: &'a Desk,
}

impl<'a> SmallDisk<'a> {
    fn mount(desk: &'a Desk, kilobytes: usize) -> Option<Self> {
        fs::create_dir(desk.path("disk")).expect("a folder");
        let size = format!("size={kilobytes}k");
        let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", &size, "none"]).arg(desk.path("disk")).output();
        mounted.is_ok_and(|output| output.status.success()).then_some(Self { desk })
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.desk.path("disk")).output();
    }
}

#[test]
fn a_small_disk_is_left_as_it_was() {
    let desk = Desk::new();
    let Some(_disk) = SmallDisk::mount(&desk, 64) else {
        println!("SKIPPED a_small_disk_is_left_as_it_was: no file system can be mounted");
        return;
    };
    let example = |triangles| ["example", "sphere", "--triangles", triangles, "-o", "disk/out.obj"];
    let names = || fs::read_dir(desk.path("disk")).expect("it is there").count();
    let output = desk.run(&example("5000"));
    assert_eq!((output.status.code(), names()), (Some(1), 0));
    assert!(text(&output.stderr).contains("disk/out.obj cannot be written (No space left"), "{output:?}");
    desk.said(&example("300"));
    assert_eq!(names(), 1);
}

#[test]
fn two_runs_on_one_file_leave_one_of_their_meshes() {
    let desk = Desk::new();
    let meshes = ["500", "700"].map(|points| {
        desk.said(&["mesh", "example:torus:2000", "--points", points, "-o", "out.obj"]);
        desk.bytes("out.obj")
    });
    assert_ne!(meshes[0], meshes[1]);
    let runs = ["500", "700"]
        .map(|points| started(&desk, &["mesh", "example:torus:2000", "--points", points, "-q", "-o", "out.obj"]));
    assert_eq!(runs.map(ended), [Some(0); 2]);
    assert!(meshes.contains(&desk.bytes("out.obj")));
    assert_eq!(desk.names(), ["out.obj"]);
}

#[test]
fn a_report_that_cannot_be_written_does_not_lose_the_mesh() {
    let desk = Desk::new();
    desk.said(&MESH);
    let mesh = desk.bytes("out.obj");
    fs::remove_file(desk.path("out.obj")).expect("it is there");
    symlink("/dev/full", desk.path("report.json")).expect("it can be linked");
    let asked = &MESH[..4];
    let output = desk.run(&[asked, &["-o", "out.obj", "--report", "report.json"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(desk.bytes("out.obj"), mesh);
    assert!(text(&output.stderr).contains("error: report.json cannot be written (No space left"), "{output:?}");
    assert!(text(&output.stdout).contains("\nvertices "), "the mesh is told of: {output:?}");
}

#[test]
fn the_input_is_never_overwritten() {
    let desk = Desk::new();
    desk.said(&["example", "sphere", "--triangles", "500", "-o", "in.obj"]);
    let input = desk.bytes("in.obj");
    symlink("in.obj", desk.path("link.obj")).expect("it can be linked");
    let said = desk.refusal(1, &["mesh", "in.obj", "--points", "200", "-o", "link.obj"]);
    assert!(said.contains("link.obj cannot be written: it is the same file as in.obj"), "{said}");
    // A hard link is a name of its own: the new file takes it, and the input keeps the other.
    fs::hard_link(desk.path("in.obj"), desk.path("hard.obj")).expect("it can be linked");
    desk.said(&["mesh", "in.obj", "--points", "200", "-o", "hard.obj"]);
    assert_eq!(desk.bytes("in.obj"), input);
    assert_ne!(desk.bytes("hard.obj"), input);
}

#[test]
fn a_name_may_be_as_long_as_the_system_allows() {
    let desk = Desk::new();
    let longest = format!("{}.obj", "n".repeat(251));
    desk.said(&["mesh", "example:sphere:500", "--points", "200", "-o", &longest]);
    assert_eq!(desk.names(), [longest.as_str()]);
    let said = desk.refusal(1, &["mesh", "example:sphere:1000000", "-o", &format!("n{longest}")]);
    assert!(said.ends_with(".obj cannot be written: the name is too long; choose a shorter one"), "{said}");
}

#[test]
fn pipes_and_devices_are_written_directly() {
    let desk = Desk::new();
    desk.said(&MESH);
    let mesh = desk.bytes("out.obj");
    let pipe = desk.path("pipe.obj");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there").success());
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).expect("it can be read")
    });
    desk.said(&[&MESH[..5], &["-o", "pipe.obj"]].concat());
    assert_eq!(reader.join().expect("no panic"), mesh);
    assert!(fs::metadata(&pipe).expect("it is there").file_type().is_fifo());

    // A surface comes through it too.
    desk.said(&["example", "torus", "--triangles", "2000", "-o", "in.obj"]);
    let surface = desk.bytes("in.obj");
    let writer = thread::spawn(move || fs::write(pipe, surface).expect("it can be written"));
    desk.said(&["mesh", "pipe.obj", "--points", "3000", "-q", "-o", "through.obj"]);
    writer.join().expect("no panic");
    assert_eq!(desk.bytes("through.obj"), mesh);

    // Nothing but the mesh goes to the standard output by its name.
    let output = desk.run(&[&MESH[..4], &["--to", "obj", "-o", "/dev/stdout"]].concat());
    assert_eq!((output.status.code(), output.stdout), (Some(0), mesh));
    assert!(text(&output.stderr).contains("\nvertices "));
}

/// After a loss of power a file has its old content or the whole new one only if it is on the disk before it gets its name.
#[cfg(target_os = "linux")]
#[test]
fn a_file_is_on_the_disk_before_it_has_its_name() {
    let desk = Desk::new();
    let program = desk.command(&["example", "sphere", "--triangles", "100", "-o", "out.obj"]);
    let mut traced = Command::new("strace");
    traced.args(["-f", "-y", "-qq", "-e", "trace=fsync,rename,renameat,renameat2", "-o", "trace"]);
    traced.arg(program.get_program()).args(program.get_args()).current_dir(desk.path(""));
    if !traced.output().is_ok_and(|output| output.status.success()) {
        println!("SKIPPED a_file_is_on_the_disk_before_it_has_its_name: there is no strace that may trace");
        return;
    }
    let trace = text(&desk.bytes("trace"));
    let calls: Vec<(&str, bool)> = trace
        .lines()
        .filter_map(|line| line.split_whitespace().nth(1))
        .map(|call| (call.split('(').next().unwrap_or_default(), call.contains(".part")))
        .collect();
    assert_eq!(calls, [("fsync", true), ("rename", true), ("fsync", false)], "{trace}");
}
