#!/bin/sh
# Makes build/environments/NAME (or PLACE) with what tools/NAME.txt pins, apart from .venv; again only when that has
# changed: pinned.sh NAME [PYTHON [PLACE]]. Called by `make docs`, `make dist`, `make test-jazzy`, `make test-cluster`,
# `make test-clients`.
set -eu
cd "$(dirname "$0")/.."

place=${3:-build/environments/$1}
[ "$place/.ready" -nt "tools/$1.txt" ] && exit
rm -rf "$place"
"${2:-.venv/bin/python}" -m venv "$place"
for lock in build "$1"; do
    "$place/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes --requirement "tools/$lock.txt"
done
touch "$place/.ready"
