#!/bin/sh
# Regenerates the locks, each for all supported Pythons at once and with the hash of every file: what
# `make setup` installs in requirements.txt, the part that `make run` needs in tools/run.txt, what builds
# it in tools/build.txt, and the environments of `make test-jazzy`, `make test-cluster`, `make test-clients`,
# `make audit`, `make docs` and `make dist` in tools/{jazzy,cluster,clients,audit,docs,release}.txt. Called by `make lock`.
set -eu
cd "$(dirname "$0")/.."

# The index is always PyPI: what this machine has configured beside it must not end up in a lock.
lock() {
    "${PYTHON:-.venv/bin/python}" -m uv pip compile --quiet --no-config --universal --generate-hashes \
        --default-index https://pypi.org/simple --no-annotate --custom-compile-command "make lock" "$@"
}

lock --python-version 3.10 "$@" tools/build.in -o tools/build.txt
lock --python-version 3.11 "$@" --extra ros --extra dev --constraint tools/build.txt \
    pyproject.toml -o requirements.txt
lock --python-version 3.11 "$@" --extra ros --constraint requirements.txt pyproject.toml -o tools/run.txt
lock --python-version 3.10 "$@" tools/jazzy.in -o tools/jazzy.txt
lock --python-version 3.11 "$@" --extra ray --extra dask --constraint requirements.txt \
    pyproject.toml tools/cluster.in -o tools/cluster.txt
lock --python-version 3.11 "$@" --constraint requirements.txt tools/clients.in -o tools/clients.txt
for name in audit docs release; do
    lock --python-version 3.11 "$@" "tools/$name.in" -o "tools/$name.txt"
done
