#!/usr/bin/env bash
# Builds the wheel, installs it in a clean virtual environment, and runs the Python package's tests and type checks there. The exit
# code is 77 where PyPI cannot be reached. --prepare: make the environment, and no more; the next call uses it.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null

. tests/tools.sh

folder=$PWD/target/python
tools=$folder/tools
python3 -c 'import ensurepip' 2>/dev/null || missing "python3 makes no virtual environment (apt-get install python3-venv)"
if ! "$tools/bin/maturin" --version >/dev/null 2>&1; then
    python3 -m venv "$tools" || missing "python3 makes no virtual environment"
    "$tools/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.16,<2' ||
        missing "maturin cannot be installed from PyPI"
fi

if [ ! -e "$folder/venv/prepared" ]; then
    rm -rf "$folder/venv"
    python3 -m venv "$folder/venv" || exit 1
    "$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy pytest mypy trimesh meshio pyvista distributed ||
        missing "numpy, pytest, mypy, trimesh, meshio, pyvista and distributed cannot be installed from PyPI"
    touch "$folder/venv/prepared"
fi
if [ "${1-}" = --prepare ]; then exit 0; fi
rm "$folder/venv/prepared"

rm -rf "$folder/wheels"
(cd python && "$tools/bin/maturin" build --release --quiet --out "$folder/wheels") || exit 1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-index "$folder"/wheels/*.whl || exit 1

# The installed package is tested, not the folder beside the tests.
cd python/tests || exit 1
"$folder/venv/bin/python" -m pytest -q -p no:cacheprovider -c ../pyproject.toml --rootdir . . &&
    "$folder/venv/bin/mypy" --config-file ../pyproject.toml --cache-dir "$folder/mypy" -p quadmosaic &&
    "$folder/venv/bin/mypy" --config-file ../pyproject.toml --cache-dir "$folder/mypy" \
        test_quadmosaic.py test_cluster.py ../examples/cluster.py ../examples/cluster_ray.py
