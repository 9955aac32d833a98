#!/usr/bin/env bash
# Runs every check on a machine that has Rust and nothing else; the last line counts them.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
# Two chains run side by side, as many steps use one core: the tests here, the lints behind.
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null; rm -rf "$folder"' EXIT
log=$folder/log

# One line a check, of all chains: passed, failed or skipped, and what. A missing component of the toolchain is a skip, not a failure.
results=$folder/results
: >"$results"
check() {
    local what=$1; shift
    echo "== $what, after $SECONDS s"
    "$@"
    case $? in
        0) echo "passed $what" >>"$results" ;;
        # A script cannot install what it needs.
        77) skip "$what" "what it needs cannot be installed" ;;
        *)
            echo "FAILED $what"
            echo "failed $what" >>"$results"
            ;;
    esac
}
skip() {
    echo "SKIPPED $1: $2"
    echo "skipped $1" >>"$results"
}
count() { grep -c "^$1 " "$results"; }

# The GPU tests run on Mesa's software driver where there is no other.
if ! compgen -G "/usr/share/vulkan/icd.d/*icd*.json" >/dev/null && ! compgen -G "/etc/vulkan/icd.d/*icd*.json" >/dev/null; then
    root=()
    if [ "$(id -u)" -ne 0 ]; then root=(sudo -n); fi
    echo "== no Vulkan driver found: installing Mesa's"
    if ! { "${root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers libvulkan1; }; then
        echo "No Vulkan driver could be installed; the GPU tests need one (as root: apt-get install mesa-vulkan-drivers libvulkan1), or QUADMOSAIC_REQUIRE_GPU=0 to skip them." >&2
    fi
fi
# Where there is no desktop, Mesa's device-select layer complains on stderr at every start.
[ -n "${XDG_RUNTIME_DIR-}" ] || export NODEVICE_SELECT=1
export QUADMOSAIC_REQUIRE_GPU="${QUADMOSAIC_REQUIRE_GPU-1}"
# The random surfaces of tests/campaign; 5000 by hand.
export QUADMOSAIC_CAMPAIGN="${QUADMOSAIC_CAMPAIGN-300}"

# The library alone compiles neither the GPU's crates nor those of the command line and the charts.
library_alone() {
    ! cargo tree --edges normal --prefix none --no-default-features | grep -E '^(wgpu|clap|indicatif|plotters|png) '
}
# Public signatures name no type of the crates for vectors and for the GPU.
own_types() {
    ! grep -rlE '\b(D?Vec[234]|D?Mat[234])\b|wgpu::' "$CARGO_TARGET_DIR/doc/quadmosaic" --include='*.html'
}
# In a folder of their own: cargo locks the other one while it builds.
run_lints() {
    export CARGO_TARGET_DIR=target/lints
    if cargo fmt --version >/dev/null 2>&1; then
        check "cargo fmt" cargo fmt --check
    else
        skip "cargo fmt" "rustfmt is not installed (rustup component add rustfmt)"
    fi
    check "crates of the library alone" library_alone
    # `page` and `study` have `picture`. One profile, so that the dependencies are checked once.
    local lint=clippy denied=(-- -D warnings)
    if ! cargo clippy --version >/dev/null 2>&1; then
        skip "cargo clippy" "clippy is not installed (rustup component add clippy)"
        lint=check denied=()
    fi
    check "cargo $lint" cargo "$lint" --release --workspace --all-targets "${denied[@]}"
    for feature in "" gpu page,study; do
        check "cargo $lint, features: ${feature:-none}" \
            cargo "$lint" --release --lib --no-default-features --features "$feature" "${denied[@]}"
    done
    check "cargo doc" env RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --quiet
    check "public types" own_types
    check "cargo package" cargo package --quiet --allow-dirty --no-verify
}
run_lints >"$folder/lints" 2>&1 &
lints=$!

# Packages of others come over the network while the compiler works.
for script in formats page python; do bash "tests/$script.sh" --prepare; done >"$folder/prepared" 2>&1 &
prepared=$!

# The program that is built for the tests is the one that the scripts run, and the wheel is made of the same build: only with all of the
# workspace do the dependencies have the same features. What does not compile is told when the tests run.
cargo test --release --workspace --no-run --quiet 2>/dev/null
export QUADMOSAIC_PROGRAM=$PWD/target/release/quadmosaic
# What cannot be installed is told by the scripts themselves.
wait "$prepared"

# Programs that are not ours read the formats; a browser shows the pages, and draws on them, while the wheel is made, which is what a
# release is made of.
{
    check formats bash tests/formats.sh
    check page bash tests/page.sh
} >"$folder/scripts" 2>&1 &
scripts=$!
check python bash tests/python.sh
wait "$scripts"
cat "$folder/scripts"

# A test that skips itself says so in a line of its own, and
# cargo counts it as passed: it is taken off there.
echo "== cargo test, after $SECONDS s"
cargo test --release --workspace --no-fail-fast -- --show-output 2>&1 | tee "$log"
status=${PIPESTATUS[0]}
counts=$(awk '
    /Running|Doc-tests/ { binary = $0 }
    /^test result:/ {
        for (i = 2; i <= NF; i++) { if ($i ~ /^passed/) p += $(i-1); if ($i ~ /^failed/) f += $(i-1); if ($i ~ /^ignored/) s += $(i-1) }
    }
    match($0, /SKIPPED [^:]*(::[^:]*)*: /) {
        s++
        if (!seen[binary, substr($0, RSTART, RLENGTH)]++) p--
    }
    END { print p + 0, f + 0, s + 0 }' "$log")
read -r p f s <<<"$counts"
# A test that does not compile, or dies, is in no count of cargo's.
if [ "$status" -ne 0 ] && [ "$f" -eq 0 ]; then f=1; fi

wait "$lints"
cat "$folder/lints"
passed=$(($(count passed) + p)) failed=$(($(count failed) + f)) skipped=$(($(count skipped) + s))

# The end of a long log is what is read: each failure stands there again, with what it said.
if [ "$failed" -gt 0 ]; then
    sed -n 's/^failed /FAILED /p' "$results"
    grep -h -E -A 3 '^test .* FAILED$|panicked at|^error' "$log" "$folder/lints" "$folder/scripts"
fi
echo "$SECONDS s"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
