//! Connections: a bounded number at the same time, each with a thread and a time for every step.

use super::http::{Head, Method, RequestError, Response, read_head};
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The most connections at the same time.
pub const MOST: usize = 32;
/// A connection that is idle for so long may be ended where others wait.
const GRACE: Duration = Duration::from_secs(1);
/// The time for the head of a request.
const HEAD_TIME: Duration = Duration::from_secs(10);
/// The time for the body of a request, and for the answer: some 60 MB through a slow tunnel.
const BODY_TIME: Duration = Duration::from_secs(300);
/// The time for a client to read an answer before a connection with unread bytes is closed, and the most such bytes.
const LINGER_TIME: Duration = Duration::from_secs(2);
const MOST_LINGER: u64 = 1 << 20;
/// The pause where the operating system gives no connection.
const PAUSE: Duration = Duration::from_millis(20);

/// What answers requests.
pub trait Site: Send + Sync + 'static {
    /// The address on the site that a request asks for.
    ///
    /// # Errors
    /// The answer to a request that may not be made.
    fn admit<'a>(&self, head: &'a Head) -> Result<&'a str, Response>;

    /// The answer to a request that was admitted.
    fn answer(&self, method: Method, address: &str, body: &[u8]) -> Response;
}

/// A server that listens.
pub struct Server {
    address: SocketAddr,
    is_ended: Arc<AtomicBool>,
}

impl Server {
    /// Answers requests from now on.
    ///
    /// # Errors
    /// Where the operating system gives no thread, or the listener has no address.
    pub fn start(listener: TcpListener, site: Arc<dyn Site>) -> io::Result<Self> {
        let (address, is_ended) = (listener.local_addr()?, Arc::new(AtomicBool::new(false)));
        let (open, ended) = (Arc::new(Open::default()), is_ended.clone());
        thread::Builder::new().name("listener".to_owned()).spawn(move || {
            while !ended.load(Ordering::Acquire) {
                match listener.accept() {
                    Ok((stream, _)) => open.take(stream, &site),
                    Err(_) => thread::sleep(PAUSE),
                }
            }
        })?;
        Ok(Self { address, is_ended })
    }

    /// Takes no more connections.
    pub fn end(self) {
        self.is_ended.store(true, Ordering::Release);
        // The listener waits for one.
        let _ = TcpStream::connect_timeout(&self.address, PAUSE);
    }
}

/// The open connections.
#[derive(Default)]
struct Open {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    count: usize,
    next: u64,
    /// Those without an admitted request, or with the whole answer to it, the oldest first: any may be ended.
    idle: VecDeque<Idle>,
}

struct Idle {
    number: u64,
    since: Instant,
    stream: TcpStream,
}

impl Open {
    /// Gives a connection its thread. Where there are too many, the one that is idle for longest makes room for it.
    fn take(self: &Arc<Self>, stream: TcpStream, site: &Arc<dyn Site>) {
        let Ok(handle) = stream.try_clone() else { return };
        let mut state = self.lock();
        while state.count >= MOST {
            let left = state.idle.front().map_or(GRACE, |oldest| GRACE.saturating_sub(oldest.since.elapsed()));
            if left.is_zero()
                && let Some(oldest) = state.idle.pop_front()
            {
                let _ = oldest.stream.shutdown(Shutdown::Both);
            }
            let wait = if left.is_zero() { GRACE } else { left };
            state = self.changed.wait_timeout(state, wait).unwrap_or_else(PoisonError::into_inner).0;
        }
        let number = state.next;
        state.next += 1;
        state.count += 1;
        state.idle.push_back(Idle { number, since: Instant::now(), stream: handle });
        drop(state);
        // It is counted until it is dropped, also where its thread panics or is not started.
        let place = Place { open: self.clone(), number };
        let site = site.clone();
        let _ = thread::Builder::new().name("connection".to_owned()).spawn(move || converse(stream, &*site, &place));
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A place among the connections.
struct Place {
    open: Arc<Open>,
    number: u64,
}

impl Place {
    /// The connection has an admitted request.
    fn begin(&self) {
        self.open.lock().idle.retain(|idle| idle.number != self.number);
    }

    /// The connection has its answer.
    fn end(&self, stream: &TcpStream) {
        self.begin();
        if let Ok(stream) = stream.try_clone() {
            self.open.lock().idle.push_back(Idle { number: self.number, since: Instant::now(), stream });
            // The listener may wait for one that is idle.
            self.open.changed.notify_one();
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.begin();
        self.open.lock().count -= 1;
        self.open.changed.notify_one();
    }
}

/// Reads one request, answers it, and ends the connection.
fn converse(stream: TcpStream, site: &dyn Site, place: &Place) {
    let mut stream = Timed { stream, until: Instant::now() + HEAD_TIME };
    let answered = read_head(&mut stream).map(|(head, begun)| {
        let address = match site.admit(&head) {
            Ok(address) => address,
            Err(refusal) => return Ok(refusal),
        };
        place.begin();
        stream.until = Instant::now() + BODY_TIME;
        head.read_body(begun, &mut stream).map(|body| site.answer(head.method, address, &body))
    });
    let response = answered.flatten().or_else(|error: RequestError| {
        let status = error.status();
        status.map(|status| Response::error(status, &error.to_string())).ok_or(error)
    });
    let Ok(response) = response else { return };
    stream.until = Instant::now() + BODY_TIME;
    if response.write(&mut stream).is_ok() {
        place.end(&stream.stream);
        stream.finish();
    }
}

/// A connection whose calls end at a time.
struct Timed {
    stream: TcpStream,
    until: Instant,
}

impl Timed {
    fn left(&self) -> io::Result<Option<Duration>> {
        let left = self.until.checked_duration_since(Instant::now()).filter(|left| !left.is_zero());
        left.map(Some).ok_or(io::ErrorKind::TimedOut.into())
    }

    /// Ends the connection when the client has the answer: the operating system would take it back where bytes are unread.
    fn finish(mut self) {
        self.until = Instant::now() + LINGER_TIME;
        if self.stream.shutdown(Shutdown::Write).is_ok() {
            let _ = io::copy(&mut self.take(MOST_LINGER), &mut io::sink());
        }
    }
}

impl Read for Timed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(buffer)
    }
}

impl Write for Timed {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
