#!/bin/sh
# Builds the sdist, and the wheel from it, and checks what a release is made of. Called by `make dist`.
set -eu
cd "$(dirname "$0")/.."

bin=build/environments/release/bin
rm -rf build/release
"$bin/python" -m build --outdir build/release .
"$bin/twine" check --strict build/release/*
check() {
    schema=$1
    shift
    "$bin/check-jsonschema" --builtin-schema "vendor.$schema" "$@"
}
check github-workflows .github/workflows/*.yml
check github-actions action.yml
check github-issue-forms .github/ISSUE_TEMPLATE/bug.yml .github/ISSUE_TEMPLATE/feature.yml
check github-issue-config .github/ISSUE_TEMPLATE/config.yml
check citation-file-format CITATION.cff
