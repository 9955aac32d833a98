//! `quadmosaic batch`: tables, failures beside results, and going on after an interruption.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn batch(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quadmosaic"));
    command.current_dir(folder).args(["batch", "--backend", "cpu", "-o", "meshes", "--points", "100"]).args(arguments);
    command.output().expect("the program runs")
}

fn lines(path: &Path) -> Vec<String> {
    fs::read_to_string(path).expect("it is there").lines().map(str::to_owned).collect()
}

#[test]
fn one_bad_surface_does_not_stop_the_others_and_a_second_run_repeats_it_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 x\n").expect("it can be written");
    fs::write(folder.join("list.txt"), "# more\n\nexample:torus:500\n").expect("it can be written");
    let arguments = ["example:sphere:500", "bad.obj", "--list", "list.txt", "--jobs", "2"];
    let first = batch(folder, &arguments);
    let said = String::from_utf8_lossy(&first.stderr);
    assert_eq!(first.status.code(), Some(1));
    assert!(said.contains("error: bad.obj: bad.obj, line 2: the coordinate"), "{said}");
    assert!(said.contains("of 3 surfaces 1 have no mesh, and 0 one with a fault"), "{said}");

    let (rows, table) = (folder.join("meshes/results.jsonl"), lines(&folder.join("meshes/results.csv")));
    assert_eq!((lines(&rows).len(), table.len()), (3, 4));
    assert!(table[0].starts_with("surface,mesh,status,message,vertices,quads,"), "{}", table[0]);
    let starts = ["example:sphere:500,sphere_500.obj,ok,,", "bad.obj,,failed,", "example:torus:500,torus_500.obj,ok,,"];
    assert!(table[1..].iter().zip(starts).all(|(row, start)| row.starts_with(start)), "{table:?}");
    let mesh = fs::read(folder.join("meshes/sphere_500.obj")).expect("a mesh");

    // A cut-off row is made again, and so is one whose surface has changed.
    let text = fs::read_to_string(&rows).expect("it is there");
    fs::write(&rows, &text[..text.len() - 5]).expect("it can be written");
    fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("it can be written");
    let second = batch(folder, &arguments);
    assert!(second.status.success(), "{}", String::from_utf8_lossy(&second.stderr));
    assert_eq!(lines(&rows).len(), 4);
    assert_eq!(fs::read(folder.join("meshes/sphere_500.obj")).expect("a mesh"), mesh);

    // With all done nothing is made; with other options all is.
    assert!(batch(folder, &arguments).status.success());
    assert_eq!(lines(&rows).len(), 4);
    assert!(batch(folder, &[&arguments[..], &["--quads", "all"]].concat()).status.success());
    assert_eq!(lines(&rows).len(), 7);
}

#[test]
fn wrong_usage_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (arguments, part) in [
        (&["example:torus", "example:torus"][..], "example:torus is given twice"),
        (&["-"], "not standard input"),
        (&["--list", "none.txt"], "none.txt cannot be read"),
        (&["example:torus", "--holes", "leave", "--to", "su2"], "su2 has no faces of more than four corners"),
    ] {
        let output = batch(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(part), "{said}");
    }
}
