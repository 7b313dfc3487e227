//! Tests of headers and certificates: credentials reach the server and are never printed.

use std::fs;

use rcgen::generate_simple_self_signed;
use tonic::transport::{Certificate, Identity, Server, ServerTlsConfig};

use super::fake::Fake;
use super::scene::{Run, Scene};

const SECRET: &str = "hunter2-hunter2";

fn assert_hides_secret(run: &Run) {
    assert!(!run.out.contains(SECRET) && !run.err.contains(SECRET), "{}{}", run.out, run.err);
}

#[test]
fn headers_authenticate_and_are_never_printed() {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().header = Some(("authorization", SECRET));
    let run = scene.bake(&server.url(), "");
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("UNAUTHENTICATED"), "{}", run.err);
    // The server's error repeats the header.
    let run = scene.bake(&server.url(), &format!("--remote-header authorization={SECRET}-no"));
    assert_eq!(run.code, 2);
    assert_hides_secret(&run);
    let run = scene.baked(&server.url(), &format!("--remote-header Authorization={SECRET} --report report.json"));
    assert_hides_secret(&run);
    assert!(!fs::read_to_string(scene.path("report.json")).expect("a report").contains(SECRET));
    scene.clear();
    let mut command = scene.command(&server.url(), "");
    let run: Run =
        command.env("ROUGHCAST_REMOTE_HEADER", format!("authorization={SECRET}\n")).output().expect("a run").into();
    assert_eq!(run.code, 0, "{}", run.err);
    fs::write(scene.path("headers"), format!("x=y\nauthorization = {SECRET}\n")).expect("a file");
    assert_hides_secret(&scene.baked(&server.url(), "--remote-header-file headers"));
}

#[test]
fn invalid_headers_are_never_printed() {
    let (scene, server) = (Scene::new(), Fake::start());
    let run = scene.bake(&server.url(), &format!("--remote-header {SECRET}"));
    assert_eq!(run.code, 2);
    assert!(run.err.contains("--remote-header: expected NAME=VALUE"), "{}", run.err);
    assert_hides_secret(&run);
    let run = scene.bake(&server.url(), &format!("--remote-header a={SECRET}\u{7f}"));
    assert_eq!(run.code, 2, "{}", run.err);
    assert_hides_secret(&run);
}

#[test]
fn refuses_unsuitable_servers_before_any_upload() {
    let scene = Scene::new();
    for url in ["localhost:1", "http://localhost:1", "grpc://", "grpc://a b"] {
        let run = scene.bake(&url.replace(' ', "%20"), "");
        assert_eq!(run.code, 2, "{url}: {}", run.err);
    }
    let server = Fake::start();
    server.faults().capabilities = Some(|capabilities| capabilities.execution_capabilities = None);
    let run = scene.bake(&server.url(), "");
    assert_eq!((run.code, server.calls("FindMissingBlobs")), (2, 0));
    assert!(run.err.contains("expected a server that stores blobs and executes actions"), "{}", run.err);
}

#[test]
fn client_and_server_check_each_others_certificates() {
    let scene = Scene::new();
    let [server, client] = ["server", "client"].map(|name| {
        let made = generate_simple_self_signed(["127.0.0.1".to_owned()]).expect("a certificate");
        let (certificate, key) = (made.cert.pem(), made.signing_key.serialize_pem());
        fs::write(scene.path(&format!("{name}.pem")), &certificate).expect("a file");
        fs::write(scene.path(&format!("{name}.key")), &key).expect("a file");
        (certificate, key)
    });
    let tls = ServerTlsConfig::new().identity(Identity::from_pem(server.0, server.1));
    let tls = tls.client_ca_root(Certificate::from_pem(client.0));
    let server = Fake::start_as(Server::builder().tls_config(tls).expect("certificates"));
    let url = server.url().replace("grpc:", "grpcs:");
    let refused = [
        "",
        "--remote-ca client.pem",
        "--remote-ca server.pem",
        "--remote-ca server.pem --remote-cert server.pem --remote-key server.key",
    ];
    for options in refused {
        let run = scene.bake(&url, &format!("--remote-retries 0 {options}"));
        assert_eq!(run.code, 4, "{options}: {}", run.err);
    }
    scene.baked(&url, "--remote-ca server.pem --remote-cert client.pem --remote-key client.key");
    let run = scene.bake(&url, "--remote-ca missing.pem");
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("expected a readable file at missing.pem"), "{}", run.err);
}
