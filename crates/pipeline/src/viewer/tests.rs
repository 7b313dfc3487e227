use std::collections::BTreeMap;
use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::thread;

use tempfile::{TempDir, tempdir};

use super::{Chosen, Events, PageFile, Server, Site, Variant, ViewerError, choose, reports_outputs};

const PAGE: &[PageFile] = &[
    PageFile { path: "page/index.html", bytes: b"<title>page</title>" },
    PageFile { path: "three/decoder.wasm", bytes: b"\0asm" },
];

const ORIGINAL: &str = r#"{ "asset": { "version": "2.0" } }"#;
const PORTABLE: &str = r#"{ "asset": { "version": "2.0", "extras": { "roughcast": {} } } }"#;
const PYRAMID: &str = r#"{
    "asset": { "version": "2.0", "extras": { "roughcast": {} } },
    "extensionsUsed": ["ROUGHCAST_materials_roughness_pyramid"]
}"#;

/// Writes files into a new folder.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    folder
}

/// A server of a page and of an asset with a space in its name, whose folder has a file above it.
struct Fixture {
    folder: TempDir,
    /// The address and the port.
    host: String,
    events: Events,
}

impl Fixture {
    fn new() -> Self {
        let folder = folder(&[("secret.txt", "secret"), ("a/my model.gltf", ORIGINAL), ("a/maps/normal.png", "png")]);
        let files = BTreeMap::from([(Variant::Original, folder.path().join("a/my model.gltf"))]);
        let events = Events::default();
        let site = Site::new(PAGE, &files).expect("a site");
        let server = Server::bind(site, Some(events.clone())).expect("a port");
        let url = server.url();
        let host = url.strip_prefix("http://").and_then(|url| url.strip_suffix("/page/index.html"));
        let host = host.expect("the address of the page").to_owned();
        assert!(host.starts_with("127.0.0.1:"), "{host}");
        thread::spawn(move || server.serve());
        Self { folder, host, events }
    }

    /// Sends a request, and returns the whole response.
    fn ask(&self, method: &str, target: &str, host: &str) -> String {
        self.send(&format!("{method} {target} HTTP/1.1\r\nHost: {host}\r\nAccept: */*\r\n\r\n"))
    }

    fn send(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(&self.host).expect("a connection");
        stream.write_all(request.as_bytes()).expect("a request");
        let mut response = Vec::new();
        stream.read_to_end(&mut response).expect("a response");
        String::from_utf8(response).expect("UTF-8")
    }

    fn get(&self, target: &str) -> String {
        self.ask("GET", target, &self.host)
    }

    /// Expects that `target` is not found.
    fn refuses(&self, target: &str) {
        let response = self.get(target);
        assert!(response.starts_with("HTTP/1.1 404 ") && !response.contains("secret"), "{target}: {response}");
    }
}

fn body(response: &str) -> &str {
    response.split_once("\r\n\r\n").expect("a head").1
}

#[test]
fn the_page_is_served() {
    let server = Fixture::new();
    let response = server.get("/page/index.html?left=original#top");
    let head = "HTTP/1.1 200 OK\r\ncontent-type: text/html\r\ncontent-length: 19\r\ncache-control: no-store\r\n\
                x-content-type-options: nosniff\r\ncross-origin-resource-policy: same-origin\r\nconnection: close\r\n";
    assert_eq!(response, format!("{head}\r\n<title>page</title>"));
    assert_eq!(server.ask("HEAD", "/page/index.html", &server.host), format!("{head}\r\n"));
    let decoder = server.get("/three/decoder.wasm");
    assert!(decoder.contains("content-type: application/wasm\r\n") && body(&decoder) == "\0asm", "{decoder}");
    assert!(server.ask("GET", "/page/index.html", "localhost").starts_with("HTTP/1.1 200 "));
    for target in ["/", "/page", "/page/", "/page/nothing.js", "/three/../page/index.html"] {
        server.refuses(target);
    }
}

#[test]
fn an_asset_is_served_with_its_files() {
    let server = Fixture::new();
    let list = server.get("/view/variants.json");
    assert!(list.contains("content-type: application/json\r\n"), "{list}");
    assert_eq!(body(&list), r#"{"variants":{"original":"/asset-original/my%20model.gltf"},"subject":"asset"}"#);
    let document = server.get("/asset-original/my%20model.gltf");
    assert!(document.contains("content-type: model/gltf+json\r\n") && body(&document) == ORIGINAL, "{document}");
    assert_eq!(body(&server.get("/asset-original/maps/normal.png")), "png");
    for target in ["/asset-original", "/asset-original/", "/asset-original/maps", "/asset-portable/my%20model.gltf"] {
        server.refuses(target);
    }
}

#[test]
fn paths_out_of_a_folder_are_not_found() {
    let server = Fixture::new();
    for target in [
        "/asset-original/../secret.txt",
        "/asset-original/%2e%2e/secret.txt",
        "/asset-original/..%2fsecret.txt",
        "/asset-original/..%5csecret.txt",
        "/asset-original/maps/../../secret.txt",
        "/asset-original//secret.txt",
        "/asset-original/my%20model.gltf%00",
        "/asset-original/%ff",
        "secret.txt",
    ] {
        server.refuses(target);
    }
    server.refuses(&format!("/asset-original/{}", server.folder.path().join("secret.txt").display()));
}

#[cfg(unix)]
#[test]
fn links_out_of_a_folder_are_not_found() {
    use std::os::unix::fs::symlink;
    let server = Fixture::new();
    let asset = server.folder.path().join("a");
    symlink("../secret.txt", asset.join("out.txt")).expect("a link");
    symlink("..", asset.join("up")).expect("a link");
    symlink("maps/normal.png", asset.join("inside.png")).expect("a link");
    server.refuses("/asset-original/out.txt");
    server.refuses("/asset-original/up/secret.txt");
    assert_eq!(body(&server.get("/asset-original/inside.png")), "png");
}

#[test]
fn foreign_hosts_and_other_methods_are_refused() {
    let server = Fixture::new();
    let foreign = ["example.com", "127.0.0.1.example.com", "example.com:80", "127.0.0.1:80@example.com", ""];
    for host in foreign {
        let response = server.ask("GET", "/page/index.html", host);
        assert!(response.starts_with("HTTP/1.1 403 Forbidden\r\n"), "{host}: {response}");
    }
    let host = &server.host;
    let twice = format!("GET /page/index.html HTTP/1.1\r\nHost: {host}\r\nHost: example.com\r\n\r\n");
    assert!(server.send(&twice).starts_with("HTTP/1.1 403 "));
    assert!(server.send("GET /page/index.html HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 403 "));
    let body = "x".repeat(100_000);
    let post = format!("POST /page/index.html HTTP/1.1\r\nHost: {host}\r\nContent-Length: 100000\r\n\r\n{body}");
    assert!(server.send(&post).starts_with("HTTP/1.1 405 Method Not Allowed\r\nallow: GET, HEAD\r\n"));
    for broken in ["\r\n\r\n", "GET /\r\n\r\n", "GET / SPDY/3\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n"] {
        assert!(server.send(broken).starts_with("HTTP/1.1 400 "), "{broken:?}");
    }
    let endless = format!("GET / HTTP/1.1\r\nHost: {host}\r\nX: {}", "x".repeat(20_000));
    assert!(server.send(&endless).starts_with("HTTP/1.1 400 "));
}

#[test]
fn pages_reload_when_a_bake_is_reported() {
    let server = Fixture::new();
    let mut page = TcpStream::connect(&server.host).expect("a connection");
    write!(page, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", server.host).expect("a request");
    let mut text = String::new();
    let mut read_until = |end: &str| {
        while !text.ends_with(end) {
            let mut byte = [0];
            page.read_exact(&mut byte).expect("a byte");
            text.push(char::from(byte[0]));
        }
        text.clone()
    };
    assert!(read_until("\r\n\r\n").contains("content-type: text/event-stream\r\n"));
    // The page is in the list shortly after it got the head.
    while !server.events.has_pages() {
        thread::yield_now();
    }
    server.events.report_bake();
    assert!(read_until("\n\n").ends_with("\r\n\r\ndata: baked\n\n"));

    assert!(reports_outputs(r#"{"event":"baked","input":"a"}"#) && reports_outputs(r#"{"event":"removed"}"#));
    assert!(!reports_outputs(r#"{"event":"idle"}"#) && !reports_outputs("baked") && !reports_outputs("[]"));
}

fn paths(folder: &Path, names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| folder.join(name)).collect()
}

#[test]
fn folders_show_the_asset_with_the_most_variants() {
    let folder = folder(&[
        ("assets/a.gltf", ORIGINAL),
        ("assets/b.gltf", ORIGINAL),
        ("assets/b.bin", "no document"),
        ("out/portable/b.GLTF", PORTABLE),
        ("out/pyramid/b.gltf", PYRAMID),
        ("out/pyramid/c.gltf", PYRAMID),
    ]);
    let file = |name: &str| folder.path().join(name);
    let chosen = choose(&paths(folder.path(), &["assets", "out"]), None).expect("documents");
    let files = [
        (Variant::Original, file("assets/b.gltf")),
        (Variant::Portable, file("out/portable/b.GLTF")),
        (Variant::Pyramid, file("out/pyramid/b.gltf")),
    ];
    assert_eq!(chosen, Chosen { files: files.into(), others: 2 });
    // A named file decides instead, and so does --original.
    let inputs = paths(folder.path(), &["out/pyramid/b.gltf", "out/pyramid/c.gltf"]);
    let twice = choose(&inputs, None).expect_err("two files of one kind").to_string();
    assert!(
        twice.contains("expected one file of each kind") && twice.contains("\u{201c}Pyramid bake\u{201d}"),
        "{twice}"
    );
    let original = file("out/portable/b.GLTF");
    let chosen = choose(&paths(folder.path(), &["assets/a.gltf", "out"]), Some(&original)).expect("documents");
    assert_eq!(chosen, Chosen { files: [(Variant::Original, original)].into(), others: 3 });
    assert_eq!(choose(&[], None).expect("an empty page"), Chosen::default());
    // A file that is named and lies in a named folder counts once.
    let chosen = choose(&paths(folder.path(), &["assets", "assets/a.gltf", "assets"]), None).expect("documents");
    assert_eq!(chosen.files, [(Variant::Original, file("assets/a.gltf"))].into());
}

#[test]
fn what_cannot_be_shown_is_named() {
    let folder = folder(&[("broken.gltf", "{"), ("empty/readme.txt", ""), ("a:b.gltf", ORIGINAL)]);
    let complaint = |name: &str| {
        let chosen = choose(&paths(folder.path(), &[name]), None);
        let site = chosen.and_then(|chosen| Site::new(PAGE, &chosen.files));
        site.map_err(|error: ViewerError| error.to_string()).expect_err("an error")
    };
    for (name, expected) in [
        ("missing.glb", "expected a .gltf or .glb file or a folder, found:"),
        ("broken.gltf", "cannot be shown: JSON: "),
        ("empty", "expected .gltf or .glb files below this folder, found none"),
        ("a:b.gltf", "expected a file name that a URL can hold"),
    ] {
        let text = complaint(name);
        assert!(text.contains(name) && text.contains(expected), "{text}");
    }
    for (name, found) in [("missing.glb", ""), ("empty", "a folder")] {
        let text = choose(&[], Some(&folder.path().join(name))).expect_err("an error").to_string();
        assert!(text.contains(&format!("{name}: expected a .gltf or .glb file, found: {found}")), "{text}");
    }
}
