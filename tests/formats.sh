#!/usr/bin/env bash
# Reads every written format back with programs that are not ours. The exit code is 77 where they cannot be installed.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null

missing() {
    echo "$1" >&2
    if [ "${CI-}" = true ]; then exit 1; else exit 77; fi
}

# What the wheel of Gmsh links to, and CalculiX.
linked="libglu1-mesa libxrender1 libxcursor1 libxft2 libxinerama1 calculix-ccx"
if ! command -v ccx >/dev/null || ! ldconfig -p | grep -q libGLU.so.1 || ! ldconfig -p | grep -q libXft.so.2; then
    root=()
    if [ "$(id -u)" -ne 0 ]; then root=(sudo -n); fi
    # shellcheck disable=SC2086
    { "${root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends $linked; } >/dev/null ||
        missing "CalculiX and what Gmsh needs cannot be installed (as root: apt-get install $linked)"
fi

venv=target/formats/venv
if ! "$venv/bin/python" -c 'import meshio, pyvista, gmsh, trimesh' 2>/dev/null; then
    python3 -m venv "$venv" || missing "python3 makes no virtual environment (as root: apt-get install python3-venv)"
    "$venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 pyvista gmsh trimesh networkx ||
        missing "meshio, pyvista, gmsh and trimesh cannot be installed from PyPI"
fi

cargo build --release --quiet || exit 1
exec "$venv/bin/python" tests/formats.py target/release/quadmosaic
