//! HTTP: as much of it as one page needs.

use crate::{assets, gate::Visitor};
use std::{
    io::{self, ErrorKind, Write},
    net::TcpStream,
    thread,
    time::{Duration, Instant},
};

/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 8192;
/// Most lines in it.
const MOST_HEADERS: usize = 64;
/// How long somebody may take to send it.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often it is looked whether more has come.
const LOOK: Duration = Duration::from_millis(2);

/// What the page may do: load its own files, and talk to its own server.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; \
     img-src 'self' data: blob:; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A request's head.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Head {
    /// Length, bytes.
    pub(crate) length: usize,
    pub(crate) method: String,
    /// Without its query.
    pub(crate) path: String,
    pub(crate) visitor: Visitor,
    pub(crate) is_websocket: bool,
}

/// Looks at the head of a request without taking it from the stream.
pub(crate) fn peek(stream: &TcpStream) -> io::Result<Head> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let (mut bytes, started) = ([0; LONGEST_HEAD], Instant::now());
    loop {
        let length = stream.peek(&mut bytes)?;
        if length == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        if let Some(head) = parse(&bytes[..length])? {
            return Ok(head);
        }
        if length == bytes.len() || started.elapsed() > PATIENCE {
            return Err(ErrorKind::InvalidData.into());
        }
        thread::sleep(LOOK);
    }
}

/// The head in some bytes; none if it has not come to its end.
fn parse(bytes: &[u8]) -> io::Result<Option<Head>> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let parsed = request.parse(bytes).map_err(|error| io::Error::new(ErrorKind::InvalidData, error))?;
    let httparse::Status::Complete(length) = parsed else { return Ok(None) };
    let header = |name: &str| {
        let found = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name))?;
        std::str::from_utf8(found.value).ok().map(str::to_owned)
    };
    let target = request.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let token = query.split('&').find_map(|pair| pair.strip_prefix("token=")).map(str::to_owned);
    let is_websocket = header("upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"));
    Ok(Some(Head {
        length,
        method: request.method.unwrap_or_default().to_owned(),
        path: path.to_owned(),
        visitor: Visitor { host: header("host"), origin: header("origin"), token },
        is_websocket,
    }))
}

/// Answers with the file that was asked for.
pub(crate) fn serve(stream: &mut TcpStream, head: &Head) -> io::Result<()> {
    match (head.method.as_str(), assets::at(&head.path)) {
        ("GET" | "HEAD", Some(asset)) => {
            let body = if head.method == "HEAD" { &[] } else { asset.bytes };
            answer(stream, "200 OK", asset.kind, asset.bytes.len(), body)
        }
        ("GET" | "HEAD", None) => refuse(stream, "404 Not Found", "there is no such page"),
        _ => refuse(stream, "405 Method Not Allowed", "allowed: GET"),
    }
}

/// Answers with words.
pub(crate) fn refuse(stream: &mut TcpStream, status: &str, words: &str) -> io::Result<()> {
    let words = format!("{words}\n");
    answer(stream, status, "text/plain; charset=utf-8", words.len(), words.as_bytes())
}

fn answer(stream: &mut TcpStream, status: &str, kind: &str, length: usize, body: &[u8]) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-cache\r\n\
         Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Connection: close\r\n\r\n"
    );
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_is_read_when_it_is_whole() {
        let text = b"GET /?token=abc&test HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nOrigin: http://x\r\nUpgrade: WebSocket\r\n\r\n";
        for length in 0..text.len() {
            assert_eq!(parse(&text[..length]).unwrap(), None, "{length}");
        }
        let head = parse(text).unwrap().unwrap();
        let own = |text: &str| Some(text.to_owned());
        let visitor = Visitor { host: own("127.0.0.1:8765"), origin: own("http://x"), token: own("abc") };
        assert_eq!((head.path.as_str(), head.is_websocket, head.length), ("/", true, text.len()));
        assert_eq!(head.visitor, visitor);
        assert!(parse(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03").is_err(), "another protocol");
    }
}
