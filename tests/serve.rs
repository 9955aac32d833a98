//! The server of the page: who may ask, what is bounded, and what is meshed.

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// The most connections that the server has at the same time.
const CONNECTIONS: usize = 32;
/// The surface of the servers, and their options.
const SURFACE: &str = "example:sphere:2000";
const OPTIONS: [&str; 4] = ["--points", "300", "--backend", "cpu"];
/// A number of vertices whose run takes far longer than the requests of a test.
const MANY: &str = "400000";

/// A server that runs in a folder.
struct Server {
    program: Child,
    port: u16,
    token: String,
}

/// An answer.
struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn of(bytes: &[u8]) -> Self {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("a head ends");
        let head = text(&bytes[..end]);
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Self { status, head, body: bytes[end + 4..].to_vec() }
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).expect("it is JSON")
    }

    /// The sentence of an error.
    fn error(&self) -> String {
        self.json()["error"].as_str().expect("a sentence").to_owned()
    }
}

impl Server {
    fn start(desk: &Desk, more: &[&str]) -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_quadmosaic"));
        program.args(["serve", SURFACE]).args(OPTIONS).args(more).current_dir(desk.path(""));
        let mut program = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        let mut line = String::new();
        BufReader::new(program.stdout.as_mut().expect("it is piped")).read_line(&mut line).expect("it prints");
        let address = line.trim_end().strip_prefix("http://127.0.0.1:").expect("an address of this machine");
        let (port, path) = address.split_once('/').expect("a path");
        let token = path.strip_suffix('/').expect("a folder").to_owned();
        Self { program, port: port.parse().expect("a port"), token }
    }

    fn connect(&self) -> TcpStream {
        TcpStream::connect(("127.0.0.1", self.port)).expect("it listens")
    }

    /// What comes for some bytes.
    fn told(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.connect();
        stream.write_all(bytes).expect("it takes them");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("it answers");
        Answer::of(&answer)
    }

    /// The answer to a request with these lines in its head, below the first one.
    fn asked(&self, first: &str, lines: &[&str], body: &str) -> Answer {
        let lines = lines.iter().fold(String::new(), |mut all, line| {
            let _ = write!(all, "{line}\r\n");
            all
        });
        self.told(format!("{first} HTTP/1.1\r\n{lines}\r\n{body}").as_bytes())
    }

    fn get(&self, address: &str) -> Answer {
        self.asked(&format!("GET /{}/{address}", self.token), &["Host: localhost"], "")
    }

    fn post(&self, address: &str, body: &str) -> Answer {
        let length = format!("Content-Length: {}", body.len());
        self.asked(&format!("POST /{}/{address}", self.token), &["Host: localhost", &length], body)
    }

    /// How the last run ended.
    fn end_of_run(&self) -> Value {
        loop {
            let state = self.get("status").json();
            if state["state"] != "running" {
                return state;
            }
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Sends a signal; the exit code and what was printed on stderr.
    fn end(mut self, signal: &str) -> (Option<i32>, String) {
        let id = self.program.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().expect("kill is there").success());
        let mut said = Vec::new();
        self.program.stderr.take().expect("it is piped").read_to_end(&mut said).expect("it ends");
        (self.program.wait().expect("it ends").code(), text(&said))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn the_page_is_given_to_who_has_the_token_alone() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let page = server.get("");
    assert_eq!(page.status, 200);
    let html = text(&page.body);
    assert!(
        html.contains("id=\"mesh\"") && html.contains("connect-src 'self'"),
        "it has the button, and asks its server"
    );
    assert!(page.head.contains("Cache-Control: no-store"), "{}", page.head);
    assert_eq!(server.get("data").json()["name"], SURFACE);
    assert_eq!(server.get("other").status, 404);
    assert_eq!(server.get("run").status, 405);

    let status = |path: &str| server.asked(&format!("GET {path}"), &["Host: localhost"], "").status;
    assert_eq!(status(&format!("/{}/", server.token)), 200);
    let wrong = if server.token.starts_with('0') { "1" } else { "0" }.to_owned() + &server.token[1..];
    for path in ["/", "/status", &format!("/{wrong}/"), &format!("/{}/", &server.token[1..]), "/?token=", "*"] {
        assert_eq!(status(path), 403, "{path}");
    }
}

#[test]
fn other_hosts_and_other_sites_are_refused() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let (page, cancel) = (format!("GET /{}/", server.token), format!("POST /{}/cancel", server.token));
    let port = server.port;
    for host in ["127.0.0.1".to_owned(), format!("127.0.0.1:{port}"), "localhost:8123".to_owned()] {
        assert_eq!(server.asked(&page, &[&format!("Host: {host}")], "").status, 200, "{host}");
    }
    let evil = format!("Host: evil.example:{port}");
    for lines in [&[][..], &[&*evil], &["Host: localhost", &evil], &["Host: localhost.evil.example"]] {
        assert_eq!(server.asked(&page, lines, "").status, 403, "{lines:?}");
    }
    let from = |origin: &str| server.asked(&cancel, &["Host: localhost:8123", &format!("Origin: {origin}")], "").status;
    assert_eq!(from("http://localhost:8123"), 200);
    for origin in ["http://evil.example", "null", "http://localhost:8124", "https://localhost:8123"] {
        assert_eq!(from(origin), 403, "{origin}");
    }
}

#[test]
fn large_bodies_are_refused_before_they_come() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let run = format!("POST /{}/run", server.token);
    let head = |length: u64| server.asked(&run, &["Host: localhost", &format!("Content-Length: {length}")], "").status;
    assert_eq!(head(5_000_000_000), 413);
    // Without the token not even this is told.
    let told = server.asked("POST /run", &["Host: localhost", "Content-Length: 5000000000"], "");
    assert_eq!(told.status, 403);
    let chunked = |body: &str| server.asked(&run, &["Host: localhost", "Transfer-Encoding: chunked"], body);
    assert_eq!(chunked("12A05F200\r\n").status, 413);
    assert_eq!(chunked("4\r\nnull\r\n0\r\n\r\n").status, 400);
    let order = r#"{"options": {"points": "200"}}"#;
    let accepted = chunked(&format!("{:x}\r\n{order}\r\n0\r\n\r\n", order.len()));
    assert_eq!(accepted.status, 202, "a small one is taken");
    server.end_of_run();
    #[cfg(target_os = "linux")]
    {
        let status = std::fs::read_to_string(format!("/proc/{}/status", server.program.id())).expect("it runs");
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
        let kilobytes: u64 = peak.trim().trim_end_matches(" kB").parse().expect("a number");
        assert!(kilobytes < 1_000_000, "no memory is taken for them: {peak}");
    }
}

#[test]
fn a_run_gives_the_bytes_of_the_command_line() {
    let desk = Desk::new();
    let server = Server::start(&desk, &["-o", "served.obj"]);
    let mesh = |options: &[&str]| {
        desk.said(&[&["mesh", SURFACE, "-o", "out.obj", "-q"], options].concat());
        desk.bytes("out.obj")
    };
    let before = mesh(&["--points", "300"]);
    assert!(server.get("mesh").body == before && desk.bytes("served.obj") == before, "the first mesh is that of mesh");

    let guides = r#"{"strokes": [{"points": [[0.3, -1, 0.2], [0.5, -1, 0.6], [0.6, -1, 0.9]], "radius": 0.5}]}"#;
    let sizes = "x,y,z,size\n1,0,0,0.5\n-1,0,0,1\n0,1,0,1\n0,-1,0,1\n";
    desk.put("guides.json", guides);
    desk.put("sizes.csv", sizes);
    let order = json!({"options": {"points": "700", "layout": "quads"}, "guides": guides, "sizes": sizes});
    let accepted = server.post("run", &order.to_string());
    assert_eq!((accepted.status, &accepted.json()["state"]), (202, &json!("running")));
    assert_eq!(server.end_of_run()["state"], "done");

    let drawn = ["--guides", "guides.json", "--size-field", "sizes.csv"];
    let layout = ["--points", "700", "--layout", "quads"];
    let after = mesh(&[&layout[..], &drawn].concat());
    let answer = server.get("mesh");
    assert!(answer.body == after && desk.bytes("served.obj") == after, "a run has the bytes of mesh");
    assert!(answer.head.contains("filename=\"mesh.obj\""), "{}", answer.head);
    let vertices = after.split(|byte| *byte == b'\n').filter(|line| line.starts_with(b"v ")).count();
    let figures = server.get("data").json()["figures"].to_string();
    assert!(figures.contains(&vertices.to_string()), "the page has that mesh too: {figures}");
    // Each of the options, the strokes and the sizes counts.
    for less in [&layout[..], &[&layout[..2], &drawn].concat(), &[&layout[..], &drawn[..2]].concat()] {
        assert_ne!(mesh(less), after, "{less:?}");
    }
}

#[test]
fn one_run_at_a_time_which_can_be_cancelled() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let before = server.get("mesh").body;
    let long = json!({"options": {"points": MANY}}).to_string();
    assert_eq!(server.post("run", &long).status, 202);
    let second = server.post("run", r#"{"options": {"points": "200"}}"#);
    assert_eq!(second.status, 409);
    assert!(second.error().starts_with("a run is under way"), "{}", second.error());
    let state = server.get("status").json();
    assert_eq!(state["state"], "running");
    assert!(state["stage"].is_string() && (0.0..=1.0).contains(&state["share"].as_f64().expect("a share")), "{state}");

    assert_eq!(server.post("cancel", "").status, 200);
    assert_eq!(server.end_of_run()["state"], "cancelled");
    assert_eq!(server.get("mesh").body, before, "the mesh before stays");
    // Nothing is left of it: the next run is not refused, and not cancelled.
    assert_eq!(server.post("run", r#"{"options": {"points": "200"}}"#).status, 202);
    assert_eq!(server.end_of_run()["state"], "done");
    assert_ne!(server.get("mesh").body, before);
}

#[test]
fn what_is_wrong_is_told_as_the_command_line_tells_it() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let before = server.get("mesh").body;
    let refused = |order: &Value| {
        let answer = server.post("run", &order.to_string());
        assert_eq!(answer.status, 400, "{order}");
        answer.error()
    };
    let said = |options: &[&str]| {
        let line = desk.refusal(1, &[&["mesh", SURFACE, "-o", "out.obj"], options].concat());
        line.trim_start_matches("error: ").to_owned()
    };
    let guides =
        ["{\"strokes\": [{\"points\": [[0, 0, 0],", "0,0,0,1,0\n", "{\"strokes\": [{\"points\": [[0,0,0],[0,0,0]]}]}"];
    for guides in guides {
        desk.put("guides.json", guides);
        assert_eq!(refused(&json!({"guides": guides})), said(&["--guides", "guides.json"]));
    }
    desk.put("sizes.csv", "0,0,0,-1\n");
    assert_eq!(refused(&json!({"sizes": "0,0,0,-1\n"})), said(&["--size-field", "sizes.csv"]));
    let points = desk.refusal(2, &["mesh", SURFACE, "-o", "out.obj", "--points", "3"]);
    let told = refused(&json!({"options": {"points": "3"}}));
    let sentence = "ask for 4 to 50000000 vertices";
    assert!(points.contains(sentence) && told.contains(sentence), "{points} {told}");

    let answer = server.post("run", "{\"options\": {\"points\": ");
    assert_eq!(answer.status, 400);
    assert!(answer.error().contains("EOF while parsing a value at line 1 column"), "{}", answer.error());
    assert_eq!(server.get("status").json()["state"], "done", "no run began");
    assert_eq!(server.get("mesh").body, before);
    // What cannot be known before the run is told by its end.
    assert_eq!(server.post("run", &json!({"options": {"size_at": "boundaries:0.1"}}).to_string()).status, 202);
    let state = server.end_of_run();
    assert_eq!(state["state"], "failed");
    assert_eq!(state["message"], said(&["--points", "300", "--size-at", "boundaries:0.1"]));
}

/// Whether the server has ended a connection on which nothing was sent.
fn is_ended(mut stream: &TcpStream) -> bool {
    stream.set_nonblocking(true).expect("it can be set");
    match stream.read(&mut [0]) {
        Ok(0) => true,
        Err(error) => error.kind() == io::ErrorKind::ConnectionReset,
        Ok(_) => panic!("nothing was asked"),
    }
}

#[test]
fn silent_connections_keep_nobody_out() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let few: Vec<TcpStream> = (0..CONNECTIONS / 2).map(|_| server.connect()).collect();
    assert_eq!(server.get("status").status, 200);
    assert!(few.iter().all(|stream| !is_ended(stream)), "there is room for them");

    let many: Vec<TcpStream> = (0..4 * CONNECTIONS).map(|_| server.connect()).collect();
    // Half a request is none.
    let half = format!("GET /{}/status HTTP/1.1\r\n", server.token);
    many.iter().for_each(|mut stream| drop(stream.write_all(half.as_bytes())));
    assert_eq!(server.get("status").status, 200);
    let ended = few.iter().chain(&many).filter(|stream| is_ended(stream)).count();
    let all = few.len() + many.len();
    assert!(ended >= all - CONNECTIONS, "{ended} of {all} made room");
    // Requests that came whole are answered, however many there are at the same time.
    thread::scope(|scope| {
        let asked: Vec<_> = (0..2 * CONNECTIONS).map(|_| scope.spawn(|| server.get("status").status)).collect();
        assert!(asked.into_iter().all(|asked| asked.join().expect("it answers") == 200));
    });
}

#[test]
fn signals_end_it() {
    let desk = Desk::new();
    assert_eq!(Server::start(&desk, &[]).end("-TERM"), (Some(143), String::new()));
    assert_eq!(Server::start(&desk, &[]).end("-INT"), (Some(130), String::new()));
    assert_eq!(Server::start(&desk, &[]).end("-KILL"), (None, String::new()), "this one it cannot handle");
    // A run under way leaves no file.
    let server = Server::start(&desk, &["-o", "served.obj"]);
    let before = desk.bytes("served.obj");
    assert_eq!(server.post("run", &json!({"options": {"points": MANY}}).to_string()).status, 202);
    assert_eq!(server.end("-TERM"), (Some(143), String::new()));
    assert_eq!((desk.names(), desk.bytes("served.obj")), (vec!["served.obj".to_owned()], before));
}

#[test]
fn what_cannot_be_served_is_refused() {
    let desk = Desk::new();
    let server = Server::start(&desk, &[]);
    let port = server.port.to_string();
    let taken = desk.refusal(1, &["serve", SURFACE, "--port", &port]);
    assert!(taken.contains("choose another"), "{taken}");
    drop(server);
    assert!(desk.refusal(2, &["serve", SURFACE, "-o", "-"]).contains("standard output"));
    assert!(desk.refusal(2, &["serve", SURFACE, "-o", "mesh.txt"]).contains("\"txt\" is no format of meshes"));
    assert!(desk.refusal(1, &["serve", SURFACE, "-o", "no/mesh.obj"]).contains("no such folder"));
    assert!(desk.refusal(1, &["serve", "none.obj"]).contains("none.obj"));
}
