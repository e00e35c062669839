#!/bin/sh
# Runs the tests of sweeps on real local Ray and Dask clusters, in an environment of its own with both
# extras. Called by `make test-cluster`; PYTHON=... chooses the interpreter.
set -eu
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
"$python" -c 'import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' ||
    {
        echo "test-cluster: needs Python 3.11 to 3.13 with venv; name one: make test-cluster PYTHON=/path" >&2
        exit 2
    }
venv=build/cluster
tools/pinned.sh cluster "$python" "$venv"
echo "test-cluster: $("$venv/bin/python" --version), $("$venv/bin/python" -m pip list 2>/dev/null |
    sed -n 's/^\(ray\|distributed\|joblib\)  */\1 /p' | paste -sd ' ')"
PYTHONPATH=.:rover_metrics exec "$venv/bin/python" -m pytest tests/harness/base/workers "$@"
