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
