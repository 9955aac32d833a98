#!/usr/bin/env bash
# Runs every check on a machine that has Rust and nothing else; the last line counts them.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# Lints and docs: one check each. A missing component of the toolchain is a skip, not a failure.
passed=0 failed=0 skipped=0 failures=()
fail() {
    failed=$((failed + 1))
    failures+=("FAILED $1")
    echo "FAILED $1"
}
check() {
    local what=$1; shift
    echo "== $what, after $SECONDS s"
    if "$@"; then passed=$((passed + 1)); else fail "$what"; fi
}
skip() {
    echo "SKIPPED $1: $2"
    skipped=$((skipped + 1))
}

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

if cargo fmt --version >/dev/null 2>&1; then
    check "cargo fmt" cargo fmt --check
else
    skip "cargo fmt" "rustfmt is not installed (rustup component add rustfmt)"
fi
if cargo clippy --version >/dev/null 2>&1; then
    check "cargo clippy" cargo clippy --release --workspace --all-targets -- -D warnings
else
    skip "cargo clippy" "clippy is not installed (rustup component add clippy)"
fi
# The library alone compiles neither the GPU's crates nor those of the command line and the charts.
library_alone() {
    cargo check --release --lib --no-default-features &&
        ! cargo tree --edges normal --prefix none --no-default-features | grep -E '^(wgpu|clap|indicatif|plotters|png) '
}
check "cargo check --no-default-features" library_alone
if cargo clippy --version >/dev/null 2>&1; then
    # `page` and `study` have `picture`.
    for feature in "" gpu page study; do
        check "cargo clippy, features: ${feature:-none}" \
            cargo clippy --release --lib --no-default-features --features "$feature" -- -D warnings
    done
fi
check "cargo doc" env RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --quiet
# Public signatures name no type of the crates for vectors and for the GPU.
own_types() {
    ! grep -rlE '\b(D?Vec[234]|D?Mat[234])\b|wgpu::' target/doc/quadmosaic --include='*.html'
}
check "public types" own_types

# Programs that are not ours read the formats.
echo "== formats"
bash tests/formats.sh
case $? in
    0) passed=$((passed + 1)) ;;
    77) skip "formats" "the programs that read them cannot be installed" ;;
    *) fail formats ;;
esac

# A browser shows the pages, and draws on them.
echo "== page"
bash tests/page.sh
case $? in
    0) passed=$((passed + 1)) ;;
    77) skip "page" "the browser cannot be installed" ;;
    *) fail page ;;
esac

# What a release is made of.
check "cargo package" cargo package --quiet --allow-dirty --no-verify
echo "== python"
bash tests/python.sh
case $? in
    0) passed=$((passed + 1)) ;;
    77) skip "python" "PyPI cannot be reached" ;;
    *) fail python ;;
esac

# One profile, so that the dependencies are built once. A test that skips itself says so in a line of its own, and
# cargo counts it as passed: it is taken off there.
echo "== cargo test, after $SECONDS s"
cargo test --release --no-fail-fast -- --show-output 2>&1 | tee "$log"
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
passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))

# The end of a long log is what is read: each failure stands there again, with what it said.
if [ "$failed" -gt 0 ]; then
    printf '%s\n' "${failures[@]}"
    grep -E -A 3 '^test .* FAILED$|panicked at|^error' "$log"
fi
echo "$SECONDS s"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
