#!/usr/bin/env bash
# AddressSanitizer over all that is not safe Rust: the SIMD kernels of integers and floats (their crates' tests, each kernel beside its scalar
# equal), the C++ around Verilator and the models (tests of `circuits` that start, stop, trace and batch them), and the calls of OpenCL (on the
# processor). A finding ends the test that met it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_opencl
host=$(rustc -vV | sed -n 's/^host: //p')
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")/sanitize
# What lives until the end of the process is no fault. A driver of OpenCL ends threads with a stack that is not the sanitizer's.
export ASAN_OPTIONS=detect_leaks=0:use_sigaltstack=0
# The sanitizer is no part of stable Rust: RUSTC_BOOTSTRAP lets this build alone use it.
RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address \
    cargo test --locked --lib --tests --target "$host" --target-dir "$target" -p edof-golden -p edof-network
# The C++ compiler's own sanitizer. It takes the place of malloc in a program that knows nothing of it, and needs the library that throws before it.
watched="$(g++ -print-file-name=libasan.so) $(g++ -print-file-name=libstdc++.so.6)"
# The program of a package's tests of that name, started in the package's folder under the sanitizer.
watch() {
    local package=$1 name=$2 program
    shift 2
    program=$(cargo test -q --locked --workspace --test "$name" --no-run --message-format json |
        sed -n "s/.*\"name\":\"$name\".*\"executable\":\"\([^\"]*\)\".*/\1/p")
    (cd "crates/$package" && CXXFLAGS=-fsanitize=address LD_PRELOAD=$watched "$program" "$@")
}
watch edof-cosim circuits verilator:: agents:: crossing:: video:: i2c:: mid_stream::
watch edof-gpu device --include-ignored
say "no finding"
