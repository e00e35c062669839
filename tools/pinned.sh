#!/bin/sh
# Makes build/environments/NAME with what tools/NAME.txt pins, apart from .venv; again only when that has
# changed. Called by `make docs` and `make dist`.
set -eu
cd "$(dirname "$0")/.."

place=build/environments/$1
[ "$place/.ready" -nt "tools/$1.txt" ] && exit
rm -rf "$place"
.venv/bin/python -m venv "$place"
"$place/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes --requirement "tools/$1.txt"
touch "$place/.ready"
