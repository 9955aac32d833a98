# For scripts that need programs which are not ours: sourced by them.

# Ends with a sentence: a skip (77), but on CI a failure.
missing() {
    echo "$1" >&2
    if [ "${CI-}" = true ]; then exit 1; else exit 77; fi
}

# Installs packages of Debian.
install_packages() {
    local root=()
    if [ "$(id -u)" -ne 0 ]; then root=(sudo -n); fi
    { "${root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends "$@"; } >/dev/null
}

# The program: that of QUADMOSAIC_PROGRAM, or one that is built. Cargo builds it again, with all below it, where it was built for the tests:
# their own dependencies ask for more of some crates.
program() {
    if [ -n "${QUADMOSAIC_PROGRAM-}" ]; then
        echo "$QUADMOSAIC_PROGRAM"
    else
        cargo build --release --quiet && echo target/release/quadmosaic
    fi
}
