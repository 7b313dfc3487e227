//! A store that is away, dies, hangs or refuses costs one warning, and the bake is what it is without.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

use super::machine::{Bake, Machine, alone};
use super::moto::{Moto, URL};
use super::ports::free_port;

/// A server that treats each connection as `treat` does; returns where it is.
fn server(treat: impl Fn(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    // It ends with the tests.
    thread::spawn(move || listener.incoming().flatten().for_each(treat));
    format!("http://127.0.0.1:{port}")
}

fn told_once(bake: &Bake, part: &str) {
    let warnings = bake.warnings();
    assert!(warnings.len() == 1 && warnings[0].starts_with(&format!("warning: {URL}: ")), "{warnings:#?}");
    assert!(warnings[0].contains(part), "{warnings:#?}");
}

#[test]
fn away_from_the_start() {
    let machine = Machine::new(&format!("http://127.0.0.1:{}", free_port()));
    let run = machine.bake(&format!("--cache cache --cache {URL}"));
    assert_eq!(run.statuses, ["baked"; 3]);
    told_once(&run, "go on without it");
    assert_eq!(machine.outputs(), alone());
    assert_eq!(machine.statuses(&format!("--cache cache --cache {URL}")), ["cached"; 3], "the folder goes on");
}

#[test]
fn killed_midway() {
    let Some(mut moto) = Moto::start() else { return };
    let machine = Machine::new(&moto.endpoint());
    let mut command = machine.command(&format!("--cache {URL} --threads 1"));
    // One after the other; what waits for the first to be told cannot be done yet.
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
    assert!(err.lines().count() == 1 && err.contains("go on without it"), "{err}");
    let outputs = machine.outputs();
    assert!(alone().iter().all(|(name, hash)| outputs.get(name) == Some(hash)));
    assert_eq!(outputs.keys().filter(|name| name.ends_with(".gltf")).count(), 9);
}

#[test]
fn hanging() {
    let endpoint = server(std::mem::forget);
    let machine = Machine::new(&endpoint);
    let mut command = machine.command(&format!("--cache {URL} --json"));
    let run = Bake::of(command.env("AWS_TIMEOUT", "500ms").output().expect("the command starts"));
    assert_eq!(run.statuses, ["baked"; 3]);
    told_once(&run, "expected a store that answers, found: ");
    assert_eq!(machine.outputs(), alone());
}

#[test]
fn read_only() {
    let endpoint = server(|mut stream| {
        let mut head = [0; 16];
        let Ok(length) = stream.read(&mut head) else { return };
        let is_get = head[..length].starts_with(b"GET");
        let status = if is_get { "404 Not Found" } else { "403 Forbidden" };
        let body = "<Error><AWSAccessKeyId>hunter-key</AWSAccessKeyId></Error>";
        let answer = format!("HTTP/1.1 {status}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}", body.len());
        let _ = stream.write_all(answer.as_bytes());
        // Whoever still writes is not cut off before it has read.
        let _ = stream.read_to_end(&mut Vec::new());
    });
    let run = Machine::new(&endpoint).bake(&format!("--cache {URL}"));
    assert_eq!(run.statuses, ["baked"; 3]);
    told_once(&run, "found: no permission; only read from it");
}
