#!/bin/sh
# Regenerates constraints.txt: every package that pyproject.toml and its extras pull in, pinned for
# all supported Pythons (3.11 to 3.13) at once. Called by `make lock`.
set -eu
cd "$(dirname "$0")/.."
exec "${PYTHON:-.venv/bin/python}" -m uv pip compile --quiet --universal --python-version 3.11 \
    --all-extras --no-annotate --custom-compile-command "make lock" "$@" \
    pyproject.toml -o constraints.txt
