#!/usr/bin/env bash
# Reads every written format back with programs that are not ours. The exit code is 77 where they cannot be installed. --prepare: install
# them, and no more.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null

. tests/tools.sh

# CalculiX, what the wheel of Gmsh links to, and what makes a virtual environment.
needed="calculix-ccx libgl1 libglu1-mesa libgomp1 libxrender1 libxcursor1 libxft2 libxinerama1 python3-venv"
is_complete() {
    command -v ccx >/dev/null && python3 -c '
import ctypes, ensurepip
for name in "libGL.so.1 libGLU.so.1 libgomp.so.1 libXrender.so.1 libXcursor.so.1 libXft.so.2 libXinerama.so.1".split():
    ctypes.CDLL(name)' 2>/dev/null
}
if ! is_complete; then
    # shellcheck disable=SC2086
    install_packages $needed ||
        missing "CalculiX and what Gmsh needs cannot be installed (as root: apt-get install $needed)"
fi

venv=target/formats/venv
if ! "$venv/bin/python" -c 'import meshio, pyvista, gmsh, trimesh' 2>/dev/null; then
    python3 -m venv "$venv" || missing "python3 makes no virtual environment"
    "$venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 pyvista gmsh trimesh networkx ||
        missing "meshio, pyvista, gmsh and trimesh cannot be installed from PyPI"
fi

if [ "${1-}" = --prepare ]; then exit 0; fi
program=$(program) || exit 1
exec "$venv/bin/python" tests/formats.py "$program"
