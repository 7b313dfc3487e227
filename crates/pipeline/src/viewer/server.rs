//! A read-only web server on the loopback interface.

use std::io;
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use super::error::ViewerError;
use super::events::Events;
use super::request::Request;
use super::response::{Refusal, write_content, write_no_events};
use super::site::Site;

/// How long a client may leave a connection unused.
const PATIENCE: Duration = Duration::from_secs(10);
/// The most bytes of a refused body that are read before the connection is closed.
const MAX_REFUSED_BYTES: u64 = 1 << 20;

/// A server that listens.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    site: Arc<Site>,
    events: Option<Events>,
}

impl Server {
    /// Listens on a free port. Pages that ask for `events` get them.
    ///
    /// # Errors
    /// [`ViewerError::Listen`].
    pub fn bind(site: Site, events: Option<Events>) -> Result<Self, ViewerError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).map_err(ViewerError::Listen)?;
        let address = listener.local_addr().map_err(ViewerError::Listen)?;
        Ok(Self { listener, address, site: Arc::new(site), events })
    }

    /// Returns the address of the page.
    pub fn url(&self) -> String {
        format!("http://{}/page/index.html", self.address)
    }

    /// Serves until the process ends. Each connection has a thread, since browsers open connections that they do not
    /// use yet.
    pub fn serve(&self) -> ! {
        loop {
            let accepted = self.listener.accept().and_then(|(stream, _)| {
                let (site, events) = (Arc::clone(&self.site), self.events.clone());
                let answer = move || {
                    // A client that closes its connection wants no answer.
                    let _ = answer(stream, &site, events.as_ref());
                };
                thread::Builder::new().name("viewer".to_owned()).spawn(answer)
            });
            if accepted.is_err() {
                // Files or threads have run out, and others may be closed soon.
                thread::sleep(Duration::from_millis(50));
            }
        }
    }
}

/// Answers one request, and closes the connection.
fn answer(mut stream: TcpStream, site: &Site, events: Option<&Events>) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let request = Request::read(&stream);
    match request.as_ref().map(|request| (request, request.method.as_str(), request.target.as_str())) {
        None => Refusal::BadRequest.write(&mut stream)?,
        Some((request, ..)) if !request.is_local() => Refusal::Forbidden.write(&mut stream)?,
        Some((_, "GET", "/events")) => match events {
            Some(events) => {
                events.add(stream);
                return Ok(());
            }
            None => write_no_events(&mut stream)?,
        },
        Some((_, method @ ("GET" | "HEAD"), target)) => match site.find(target) {
            Some(content) => write_content(content, method == "GET", &mut stream)?,
            None => Refusal::NotFound.write(&mut stream)?,
        },
        Some(_) => Refusal::Method.write(&mut stream)?,
    }
    // The system would discard the answer if the connection were closed before a body was read.
    stream.shutdown(Shutdown::Write)?;
    io::copy(&mut io::Read::take(&stream, MAX_REFUSED_BYTES), &mut io::sink())?;
    Ok(())
}
