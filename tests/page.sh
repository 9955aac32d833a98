#!/usr/bin/env bash
# Opens pages in Chromium, draws on them with the mouse, and meshes with what was drawn. The exit code is 77 where it cannot be
# installed. --prepare: install it, and no more.
set -uo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
. tests/tools.sh

browser() { command -v chromium || command -v chromium-browser || command -v google-chrome; }
if ! browser >/dev/null || ! python3 -c 'import ensurepip' 2>/dev/null; then
    install_packages chromium python3-venv || missing "Chromium cannot be installed (as root: apt-get install chromium python3-venv)"
fi

venv=target/page/venv
if ! "$venv/bin/python" -c 'import websocket' 2>/dev/null; then
    python3 -m venv "$venv" || missing "python3 makes no virtual environment"
    "$venv/bin/pip" install --quiet --disable-pip-version-check websocket-client ||
        missing "websocket-client cannot be installed from PyPI"
fi

if [ "${1-}" = --prepare ]; then exit 0; fi
program=$(program) || exit 1
exec "$venv/bin/python" tests/page.py "$program" "$(browser)"
