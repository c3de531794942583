#!/usr/bin/env bash
# The networks on an accelerator against those on the processor, bit for bit. Any driver for OpenCL will do; where there is none, this installs
# one that runs on the processor (pocl).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
# A driver that was removed may leave its name.
if ! ldconfig -p | grep 'libOpenCL\.so' >/dev/null || [ -z "$(ls /etc/OpenCL/vendors/*.icd 2>/dev/null)" ]; then
    install_packages ocl-icd-libopencl1 pocl-opencl-icd
fi
cargo test --locked --release --package edof-gpu -- --include-ignored
