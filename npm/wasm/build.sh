#!/usr/bin/env bash
# Builds the WebAssembly modules: `bash npm/wasm/build.sh` writes npm/roughcast/roughcast.wasm, which has one thread,
# and npm/roughcast/roughcast.threads.wasm, whose memory threads share.
#
# No toolchain has a standard library for shared memory, so the library is built too. Its sources are Debian's package
# rust-web-src, with rustc-web and cargo-web, or rustup's component rust-src. zstd is C and needs a clang for
# WebAssembly: clang, or Debian's clang-14. WASM_CLANG and WASM_LINKER name others.
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
sysroot=$(rustc --print sysroot 2>/dev/null || true)
# The encoder's kernels keep tables on the stack: the default of 1 MiB is too little. lib/wasm.js has this number, too.
flags="-C link-arg=-zstack-size=8388608"

if [ -d "$sysroot/lib/rustlib/src/rust/library" ] &&
    rustup target list --installed 2>/dev/null | grep -qx wasm32-unknown-unknown; then
    cargo=cargo
elif [ -x /usr/bin/cargo ] && [ -d /usr/lib/rustlib/src/rust/library ]; then
    cargo=/usr/bin/cargo
    export RUSTC=/usr/bin/rustc
    # Debian's package has no linker for WebAssembly; rustup's toolchains and Debian's package lld have one.
    rustup_lld=$(find "$sysroot" -name rust-lld 2>/dev/null | head -n 1)
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=${WASM_LINKER:-${rustup_lld:-$(first_of wasm-ld wasm-ld-14)}}
    flags+=" -C linker-flavor=wasm-ld"
else
    echo "$0: expected the sources of the standard library, found none; run rustup target add wasm32-unknown-unknown" \
        "and rustup component add rust-src, or install Debian's rustc-web, cargo-web and rust-web-src" >&2
    exit 1
fi
target=$("$cargo" metadata --locked --no-deps --format-version 1 | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')

# Builds a module: `build FILE FEATURES CFLAGS [LINKER FLAG]...`.
build() {
    local file=$1 features=$2 cflags=$3 arguments=()
    shift 3
    # Both builds keep their own artifacts, so that a second run has nothing to do.
    arguments=(--locked --package roughcast-wasm --profile wasm --target wasm32-unknown-unknown)
    arguments+=(-Zbuild-std=std,panic_abort --target-dir "$target/${file%.wasm}")
    # RUSTC_BOOTSTRAP lets a stable compiler build the standard library.
    RUSTC_BOOTSTRAP=1 CC_wasm32_unknown_unknown=$clang AR_wasm32_unknown_unknown=$archiver \
        CFLAGS_wasm32_unknown_unknown=$cflags \
        CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-C target-feature=$features $flags ${*/#/-C link-arg=}" \
        "$cargo" build "${arguments[@]}"
    cp "$target/${file%.wasm}/wasm32-unknown-unknown/wasm/roughcast_wasm.wasm" "npm/roughcast/$file"
    ls -l "npm/roughcast/$file"
}

# Both at once: each ends with minutes of link-time optimisation on one core.
build roughcast.wasm +simd128 "" &
single=$!
# JavaScript makes the memory, of the sizes in lib/threads.js, and gives each thread its stack and its thread-local
# memory.
build roughcast.threads.wasm +simd128,+atomics,+bulk-memory,+mutable-globals "-matomics -mbulk-memory" \
    --shared-memory --import-memory --max-memory=4294967296 --initial-memory=16777216 \
    --export=__stack_pointer --export=__wasm_init_tls --export=__tls_size --export=__tls_align
wait "$single"
