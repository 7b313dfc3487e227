#!/usr/bin/env bash
# Builds the WebAssembly module: `bash npm/wasm/build.sh` writes npm/roughcast/roughcast.wasm.
#
# Uses the wasm32 standard library of rustup if it is installed (`rustup target add wasm32-unknown-unknown`). Otherwise
# uses Debian's packages rustc-web, cargo-web and rust-web-src, and builds the standard library too. zstd is C and needs
# a clang for WebAssembly: clang, or Debian's clang-14. WASM_CLANG and WASM_LINKER name others.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Prints the first of the named programs that is installed.
first_of() {
    for name in "$@"; do
        command -v "$name" && return
    done
    echo "$0: expected one of the programs $*, found none; install one" >&2
    return 1
}

clang=${WASM_CLANG:-$(first_of clang clang-19 clang-16 clang-14)}
archiver=$(first_of llvm-ar llvm-ar-19 llvm-ar-16 llvm-ar-14)
arguments=(--locked --package roughcast-wasm --profile wasm --target wasm32-unknown-unknown)
# The encoder's kernels keep tables on the stack: the default of 1 MiB is too little.
flags="-C target-feature=+simd128 -C link-arg=-zstack-size=8388608"

if rustup target list --installed 2>/dev/null | grep -qx wasm32-unknown-unknown; then
    cargo=cargo
elif [ -x /usr/bin/cargo ] && [ -d /usr/lib/rustlib/src/rust/library ]; then
    cargo=/usr/bin/cargo
    export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
    # Debian's package has no linker for WebAssembly; rustup's toolchains and Debian's package lld have one.
    rustup_lld=$(find "$(rustc --print sysroot 2>/dev/null || true)" -name rust-lld 2>/dev/null | head -n 1)
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=${WASM_LINKER:-${rustup_lld:-$(first_of wasm-ld wasm-ld-14)}}
    arguments+=(-Zbuild-std=std,panic_abort)
    flags+=" -C linker-flavor=wasm-ld"
else
    echo "$0: expected the wasm32 standard library, found none; run rustup target add wasm32-unknown-unknown, or" \
        "install Debian's rustc-web, cargo-web and rust-web-src" >&2
    exit 1
fi

CC_wasm32_unknown_unknown=$clang AR_wasm32_unknown_unknown=$archiver \
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS=$flags "$cargo" build "${arguments[@]}"
target=$("$cargo" metadata --locked --no-deps --format-version 1 | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')
cp "$target/wasm32-unknown-unknown/wasm/roughcast_wasm.wasm" npm/roughcast/roughcast.wasm
ls -l npm/roughcast/roughcast.wasm
