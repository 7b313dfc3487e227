"""Checks the viewer of an installed tool: `check_view.py ROUGHCAST ASSET BAKED`.

Starts `roughcast view`, and fetches the page and all files of both documents. A tool that was built without
ROUGHCAST_VIEWER must say instead that it has no page.
"""

import json
import os
import subprocess
import sys
from urllib.error import HTTPError
from urllib.parse import urljoin
from urllib.request import Request, urlopen

# The server is on this machine, whatever proxies the environment names.
os.environ["no_proxy"] = "127.0.0.1"


def fetch(url, kind, **headers):
    """Returns the bytes at a URL, which must have the MIME type `kind`."""
    with urlopen(Request(url, headers=headers), timeout=60) as response:
        found = response.headers["content-type"]
        assert found == kind, f"{url}: expected {kind}, found {found}"
        return response.read()


def check(url, asset, baked):
    """Fetches all that the page at `url` fetches."""
    html = fetch(url, "text/html")
    for name in ["main.js", "style.css"]:
        assert name in html.decode(), f"{url}: expected a reference to {name}, found none"
    assert len(fetch(urljoin(url, "main.js"), "text/javascript")) > 100_000
    assert b"three.js" in fetch(urljoin(url, "/LICENSES.md"), "application/octet-stream")
    decoder = fetch(urljoin(url, "/three/examples/jsm/libs/basis/basis_transcoder.wasm"), "application/wasm")
    assert decoder.startswith(b"\0asm")
    variants = json.loads(fetch(urljoin(url, "/view/variants.json"), "application/json"))["variants"]
    assert list(variants) == ["original", "portable"], variants
    kinds = {".bin": "application/octet-stream", ".png": "image/png", ".ktx2": "image/ktx2"}
    for path, source in zip(variants.values(), [asset, baked]):
        text = fetch(urljoin(url, path), "model/gltf+json")
        with open(source, "rb") as file:
            assert text == file.read(), f"{path}: expected the bytes of {source}"
        document = json.loads(text)
        for part in document["buffers"] + document["images"]:
            kind = kinds[os.path.splitext(part["uri"])[1]]
            assert fetch(urljoin(urljoin(url, path), part["uri"]), kind)
    try:
        fetch(url, "text/html", Host="example.com")
        raise AssertionError("a request for another host was answered")
    except HTTPError as error:
        assert error.code == 403, error


def main(roughcast, asset, baked):
    command = [roughcast, "view", asset, baked]
    if not os.environ.get("ROUGHCAST_VIEWER"):
        result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert result.returncode == 2 and "npx roughcast view" in result.stderr, result
        print("view: no page, since ROUGHCAST_VIEWER is not set")
        return
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            check(process.stdout.readline().strip(), asset, baked)
        finally:
            process.terminate()
    print("view: page and assets were fetched")


main(*sys.argv[1:])
