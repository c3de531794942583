#!/usr/bin/env bash
# The networks on an accelerator against those on the processor, bit for bit. Any driver for OpenCL will do; where there is none, this installs
# one that runs on the processor (pocl).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_opencl
cargo test --locked --release --package edof-gpu -- --include-ignored
