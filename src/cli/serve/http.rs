//! HTTP/1.1 as far as the server needs it: one request of bounded size on a connection, and one answer (RFC 9112).

use serde::Serialize;
use std::io::{self, BufRead, BufReader, Cursor, Read, Write};
use std::sync::Arc;
use thiserror::Error;

/// The largest head of a request, in bytes.
const MOST_HEAD: usize = 16 << 10;
/// The most fields of a head.
const MOST_FIELDS: usize = 64;
/// The largest body of a request, in bytes: sizes at more than a million places.
pub const MOST_BODY: u64 = 64 << 20;
/// The longest line before a chunk of a body, in bytes.
const MOST_CHUNK_LINE: u64 = 256;

/// A status, with its number and its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u16, pub &'static str);

impl Status {
    pub const OK: Self = Self(200, "OK");
    pub const ACCEPTED: Self = Self(202, "Accepted");
    pub const BAD_REQUEST: Self = Self(400, "Bad Request");
    pub const FORBIDDEN: Self = Self(403, "Forbidden");
    pub const NOT_FOUND: Self = Self(404, "Not Found");
    pub const METHOD_NOT_ALLOWED: Self = Self(405, "Method Not Allowed");
    pub const TIMEOUT: Self = Self(408, "Request Timeout");
    pub const CONFLICT: Self = Self(409, "Conflict");
    pub const BODY_TOO_LARGE: Self = Self(413, "Content Too Large");
    pub const UNAVAILABLE: Self = Self(503, "Service Unavailable");
    pub const HEAD_TOO_LARGE: Self = Self(431, "Request Header Fields Too Large");
}

/// What a request does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Get,
    Post,
}

/// How the length of a body is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Length {
    Known(u64),
    Chunked,
}

/// The head of a request.
#[derive(Debug)]
pub struct Head {
    pub method: Method,
    /// Its address without the host.
    pub path: String,
    /// The host that it is meant for; none where the head names none, or more than one.
    pub host: Option<String>,
    /// The site whose page made it, where a browser tells that.
    pub origin: Option<String>,
    length: Length,
    /// Whether the body is sent only after an interim answer.
    is_waiting: bool,
}

/// Why there is no request.
#[derive(Debug, Error)]
pub enum RequestError {
    #[error("this is no request of HTTP/1.1: {0}")]
    Malformed(&'static str),
    #[error("the server takes GET and POST only")]
    Method,
    #[error("the head of the request is larger than {MOST_HEAD} bytes")]
    HeadTooLarge,
    #[error("the body of the request is larger than {MOST_BODY} bytes")]
    BodyTooLarge,
    #[error("the request did not come in time")]
    Slow,
    /// The connection ended.
    #[error("the connection ended before the request did")]
    Lost,
}

impl RequestError {
    /// The status of the answer; none where nobody waits for it.
    pub fn status(&self) -> Option<Status> {
        match self {
            Self::Malformed(_) => Some(Status::BAD_REQUEST),
            Self::Method => Some(Status::METHOD_NOT_ALLOWED),
            Self::HeadTooLarge => Some(Status::HEAD_TOO_LARGE),
            Self::BodyTooLarge => Some(Status::BODY_TOO_LARGE),
            Self::Slow => Some(Status::TIMEOUT),
            Self::Lost => None,
        }
    }
}

impl From<io::Error> for RequestError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => Self::Slow,
            _ => Self::Lost,
        }
    }
}

impl From<httparse::Error> for RequestError {
    fn from(error: httparse::Error) -> Self {
        match error {
            httparse::Error::TooManyHeaders => Self::HeadTooLarge,
            httparse::Error::HeaderName | httparse::Error::HeaderValue => Self::Malformed("a field is wrong"),
            httparse::Error::Version => Self::Malformed("the version is another one"),
            _ => Self::Malformed("the first line is wrong"),
        }
    }
}

/// Reads the head of a request, and what came behind it.
///
/// # Errors
/// Where it is none, too large, or does not come.
pub fn read_head(stream: &mut impl Read) -> Result<(Head, Vec<u8>), RequestError> {
    let mut bytes = Vec::new();
    let mut part = [0; 4096];
    loop {
        let mut fields = [httparse::EMPTY_HEADER; MOST_FIELDS];
        let mut request = httparse::Request::new(&mut fields);
        if let httparse::Status::Complete(end) = request.parse(&bytes)? {
            let head = Head::new(&request)?;
            return Ok((head, bytes.split_off(end)));
        }
        if bytes.len() >= MOST_HEAD {
            return Err(RequestError::HeadTooLarge);
        }
        let room = part.len().min(MOST_HEAD - bytes.len());
        match stream.read(&mut part[..room])? {
            0 => return Err(RequestError::Lost),
            count => bytes.extend_from_slice(&part[..count]),
        }
    }
}

impl Head {
    fn new(request: &httparse::Request) -> Result<Self, RequestError> {
        let method = match request.method {
            Some("GET") => Method::Get,
            Some("POST") => Method::Post,
            _ => return Err(RequestError::Method),
        };
        let all = |name: &str| -> Result<Vec<&str>, RequestError> {
            let named = request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
            let text = |value| str::from_utf8(value).map_err(|_| RequestError::Malformed("a field is no text"));
            named.map(|field| text(field.value)).collect()
        };
        let length = match (all("Content-Length")?.as_slice(), all("Transfer-Encoding")?.as_slice()) {
            ([], []) => Length::Known(0),
            ([digits], []) if !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()) => {
                // What is no number of 64 bits is too large.
                Length::Known(digits.parse().unwrap_or(u64::MAX))
            }
            ([], [coding]) if coding.eq_ignore_ascii_case("chunked") => Length::Chunked,
            _ => return Err(RequestError::Malformed("the length of its body is not told, or twice")),
        };
        Ok(Self {
            method,
            path: request.path.unwrap_or_default().to_owned(),
            // Of several, none is believed.
            host: <[&str; 1]>::try_from(all("Host")?).ok().map(|[host]| host.to_owned()),
            origin: all("Origin")?.into_iter().reduce(|_, _| "null").map(str::to_owned),
            length,
            is_waiting: all("Expect")?.iter().any(|value| value.eq_ignore_ascii_case("100-continue")),
        })
    }

    /// Reads the body of the request; `begun` is what came behind the head.
    ///
    /// # Errors
    /// Where it is too large, wrong, or does not come. One whose told length is too large is not read at all.
    pub fn read_body(&self, begun: Vec<u8>, stream: &mut (impl Read + Write)) -> Result<Vec<u8>, RequestError> {
        if let Length::Known(length) = self.length
            && length > MOST_BODY
        {
            return Err(RequestError::BodyTooLarge);
        }
        if self.is_waiting && begun.is_empty() {
            stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n")?;
        }
        let mut reader = BufReader::new(Cursor::new(begun).chain(stream));
        let mut body = Vec::new();
        match self.length {
            Length::Known(length) => append(&mut reader, length, &mut body)?,
            Length::Chunked => read_chunks(&mut reader, &mut body)?,
        }
        Ok(body)
    }
}

/// Appends so many bytes; memory grows as they come.
fn append(reader: &mut impl Read, length: u64, body: &mut Vec<u8>) -> Result<(), RequestError> {
    let count = reader.take(length).read_to_end(body)?;
    if count as u64 == length { Ok(()) } else { Err(RequestError::Lost) }
}

/// Reads a body in chunks, up to the last one; fields behind it are passed over.
fn read_chunks(reader: &mut impl BufRead, body: &mut Vec<u8>) -> Result<(), RequestError> {
    const WRONG: RequestError = RequestError::Malformed("a chunk of its body is wrong");
    loop {
        let mut line = Vec::new();
        reader.take(MOST_CHUNK_LINE).read_until(b'\n', &mut line)?;
        let Ok(httparse::Status::Complete((_, size))) = httparse::parse_chunk_size(&line) else {
            return Err(if line.is_empty() { RequestError::Lost } else { WRONG });
        };
        if size == 0 {
            return Ok(());
        }
        if size > MOST_BODY - body.len() as u64 {
            return Err(RequestError::BodyTooLarge);
        }
        append(reader, size, body)?;
        let mut end = [0; 2];
        reader.read_exact(&mut end)?;
        if end != *b"\r\n" {
            return Err(WRONG);
        }
    }
}

/// Bytes that an answer shares with others.
pub type Shared = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// An answer.
pub struct Response {
    status: Status,
    kind: &'static str,
    /// The name of the file that a browser is to save it as.
    file: Option<String>,
    body: Shared,
}

/// The fields of every answer: no other site may use it, and nothing keeps it.
const FIELDS: &str = "Connection: close\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
                      Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
                      Content-Security-Policy: frame-ancestors 'none'\r\n";

impl Response {
    pub fn new(status: Status, kind: &'static str, body: Shared) -> Self {
        Self { status, kind, file: None, body }
    }

    pub fn json(status: Status, value: &impl Serialize) -> Self {
        let text = serde_json::to_string(value).expect("numbers and text are JSON");
        Self::new(status, "application/json", Arc::new(text))
    }

    /// A sentence that says what is wrong, as JSON.
    pub fn error(status: Status, sentence: &str) -> Self {
        #[derive(Serialize)]
        struct Refusal<'a> {
            error: &'a str,
        }
        Self::json(status, &Refusal { error: sentence })
    }

    /// The same answer as a file to save.
    pub fn saved_as(self, file: String) -> Self {
        Self { file: Some(file), ..self }
    }

    /// Writes the answer.
    ///
    /// # Errors
    /// Where the connection ends, or takes nothing in time.
    pub fn write(&self, stream: &mut impl Write) -> io::Result<()> {
        let Self { status: Status(number, name), kind, file, body } = self;
        let body = (**body).as_ref();
        let mut head =
            format!("HTTP/1.1 {number} {name}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
        if *number == Status::METHOD_NOT_ALLOWED.0 {
            head.push_str("Allow: GET, POST\r\n");
        }
        if let Some(file) = file {
            head.push_str(&format!("Content-Disposition: attachment; filename=\"{file}\"\r\n"));
        }
        head.push_str(FIELDS);
        head.push_str("\r\n");
        stream.write_all(head.as_bytes())?;
        stream.write_all(body)?;
        stream.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A connection that gives a text in pieces of some length.
    struct Pieces<'a>(&'a [u8], usize);

    impl Read for Pieces<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.0.len().min(self.1).min(buffer.len());
            let (now, later) = self.0.split_at(count);
            buffer[..count].copy_from_slice(now);
            self.0 = later;
            Ok(count)
        }
    }

    impl Write for Pieces<'_> {
        fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
            Ok(buffer.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn body(text: &str, piece: usize) -> Result<Vec<u8>, RequestError> {
        let mut stream = Pieces(text.as_bytes(), piece);
        let (head, begun) = read_head(&mut stream)?;
        head.read_body(begun, &mut stream)
    }

    fn status(text: &str) -> Option<u16> {
        body(text, 4096).err().map(|error| error.status().map_or(0, |status| status.0))
    }

    #[test]
    fn a_request_is_the_same_in_any_pieces() {
        let known = "POST /a HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhello, and more";
        let chunked = "POST /a HTTP/1.1\r\nTransfer-Encoding: Chunked\r\n\r\n2\r\nhe\r\n3;a=b\r\nllo\r\n0\r\n\r\n";
        for text in [known, chunked] {
            for piece in [1, 2, 7, 4096] {
                assert_eq!(body(text, piece).unwrap_or_default(), b"hello", "{piece}: {text}");
            }
        }
        let mut stream = Pieces(known.as_bytes(), 3);
        let (head, _) = read_head(&mut stream).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((head.method, head.path.as_str(), head.host.as_deref()), (Method::Post, "/a", Some("x")));
    }

    #[test]
    fn what_is_no_request_or_too_large_is_refused() {
        let with = |fields: &str, rest: &str| status(&format!("POST / HTTP/1.1\r\n{fields}\r\n{rest}"));
        assert_eq!(with("Content-Length: 2\r\n", "ab"), None);
        assert_eq!(with("Content-Length: 3\r\n", "ab"), Some(0), "it is cut off");
        assert_eq!(with("Content-Length: 5000000000\r\n", ""), Some(413));
        assert_eq!(with("Content-Length: 99999999999999999999999\r\n", ""), Some(413));
        for length in ["-1", "+2", "2, 2", "", "two"] {
            assert_eq!(with(&format!("Content-Length: {length}\r\n"), "ab"), Some(400), "{length}");
        }
        assert_eq!(with("Content-Length: 2\r\nContent-Length: 2\r\n", "ab"), Some(400));
        assert_eq!(with("Content-Length: 2\r\nTransfer-Encoding: chunked\r\n", "ab"), Some(400));
        assert_eq!(with("Transfer-Encoding: gzip\r\n", "ab"), Some(400));
        assert_eq!(with("Transfer-Encoding: chunked\r\n", "12A05F200\r\n"), Some(413));
        assert_eq!(with("Transfer-Encoding: chunked\r\n", "2\r\nabc\r\n"), Some(400));
        assert_eq!(with("Transfer-Encoding: chunked\r\n", "two\r\n"), Some(400));
        assert_eq!(with(&format!("A: {}\r\n", "a".repeat(MOST_HEAD)), ""), Some(431));
        assert_eq!(with(&"A: a\r\n".repeat(MOST_FIELDS + 1), ""), Some(431));
        assert_eq!(status("PUT / HTTP/1.1\r\n\r\n"), Some(405));
        assert_eq!(status("hello\r\n\r\n"), Some(400));
        assert_eq!(status("GET / HTTP/1.1\r\n"), Some(0));
    }

    #[test]
    fn chunks_are_bounded_together() {
        // A sixteenth of the bound each, and one more.
        let chunk = format!("{:x}\r\n{}\r\n", MOST_BODY / 16, "a".repeat(MOST_BODY as usize / 16));
        let sent = |count: usize| {
            status(&format!("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n{}0\r\n\r\n", chunk.repeat(count)))
        };
        assert_eq!((sent(16), sent(17)), (None, Some(413)));
    }

    #[test]
    fn two_hosts_are_none_and_two_origins_are_another_site() {
        let head = |fields: &str| {
            let text = format!("GET / HTTP/1.1\r\n{fields}\r\n");
            read_head(&mut Pieces(text.as_bytes(), 4096)).unwrap_or_else(|error| panic!("{error}")).0
        };
        assert_eq!(head("Host: a\r\n").host.as_deref(), Some("a"));
        assert_eq!(head("Host: a\r\nHost: a\r\n").host, None);
        assert_eq!(head("Origin: http://a\r\n").origin.as_deref(), Some("http://a"));
        assert_eq!(head("Origin: http://a\r\nOrigin: http://a\r\n").origin.as_deref(), Some("null"));
    }
}
