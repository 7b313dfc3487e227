//! Tests of a store that is unreachable, dies, hangs or refuses: one warning, and the outputs of a bake without a
//! cache.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

use super::machine::{Bake, Machine, without_cache};
use super::moto::{Moto, URL};
use super::ports::free_port;

/// Starts a server that passes each connection to `handle`. Returns its URL.
fn server(handle: impl Fn(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    // The thread ends with the process of the tests.
    thread::spawn(move || listener.incoming().flatten().for_each(handle));
    format!("http://127.0.0.1:{port}")
}

fn assert_one_warning(bake: &Bake, part: &str) {
    let warnings = bake.warnings();
    assert!(warnings.len() == 1 && warnings[0].starts_with(&format!("warning: {URL}: ")), "{warnings:#?}");
    assert!(warnings[0].contains(part), "{warnings:#?}");
}

#[test]
fn bakes_if_the_store_is_unreachable() {
    let machine = Machine::new(&format!("http://127.0.0.1:{}", free_port()));
    let run = machine.bake(&format!("--cache cache --cache {URL}"));
    assert_eq!(run.statuses, ["baked"; 3]);
    assert_one_warning(&run, "the bake goes on without the store");
    assert_eq!(machine.outputs(), without_cache());
    assert_eq!(machine.statuses(&format!("--cache cache --cache {URL}")), ["cached"; 3], "the disk cache still works");
}

#[test]
fn bakes_on_if_the_store_dies() {
    let Some(mut moto) = Moto::start() else { return };
    let machine = Machine::new(&moto.endpoint());
    let mut command = machine.command(&format!("--cache {URL} --threads 1"));
    // Assets are baked one after the other, so most of them are still to do after the first line of output.
    for copy in 1..=6 {
        let to = machine.path().join(format!("assets/copy{copy}"));
        std::fs::create_dir(&to).expect("a folder");
        std::fs::copy(machine.path().join("assets/waves/waves.glb"), to.join(format!("waves{copy}.glb")))
            .expect("a file");
    }
    let mut bake = command.spawn().expect("the command starts");
    let mut out = BufReader::new(bake.stdout.take().expect("a pipe"));
    out.read_line(&mut String::new()).expect("a line");
    moto.kill();
    let mut rest = String::new();
    out.read_to_string(&mut rest).expect("text");
    let ended = bake.wait_with_output().expect("an exit");
    let err = String::from_utf8(ended.stderr).expect("UTF-8");
    assert_eq!(ended.status.code(), Some(0), "{err}");
    assert!(err.lines().count() == 1 && err.contains("the bake goes on without the store"), "{err}");
    let outputs = machine.outputs();
    assert!(without_cache().iter().all(|(name, hash)| outputs.get(name) == Some(hash)));
    let is_document = |name: &&String| name.ends_with(".gltf") || name.ends_with(".glb");
    assert_eq!(outputs.keys().filter(is_document).count(), 9);
}

#[test]
fn bakes_if_the_store_hangs() {
    let endpoint = server(std::mem::forget);
    let machine = Machine::new(&endpoint);
    let mut command = machine.command(&format!("--cache {URL} --json"));
    let run = Bake::from_output(command.env("AWS_TIMEOUT", "500ms").output().expect("the command starts"));
    assert_eq!(run.statuses, ["baked"; 3]);
    assert_one_warning(&run, "expected a store that answers, found: ");
    assert_eq!(machine.outputs(), without_cache());
}

#[test]
fn only_reads_from_a_store_without_write_permission() {
    let endpoint = server(|mut stream| {
        let mut head = [0; 16];
        let Ok(length) = stream.read(&mut head) else { return };
        let is_get = head[..length].starts_with(b"GET");
        let status = if is_get { "404 Not Found" } else { "403 Forbidden" };
        let body = "<Error><AWSAccessKeyId>hunter-key</AWSAccessKeyId></Error>";
        let answer = format!("HTTP/1.1 {status}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}", body.len());
        let _ = stream.write_all(answer.as_bytes());
        // Reading the rest of the request lets the client read the answer before the connection closes.
        let _ = stream.read_to_end(&mut Vec::new());
    });
    let run = Machine::new(&endpoint).bake(&format!("--cache {URL}"));
    assert_eq!(run.statuses, ["baked"; 3]);
    assert_one_warning(&run, "found: no permission; the store is only read from");
}
