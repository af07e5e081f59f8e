#!/usr/bin/env bash
# Every check there is, in one command; all are run, and those that failed are named at the end.
# Needs an environment with `pip install -e '.[test]'`. Arguments go to pytest.
set -uo pipefail
cd "$(dirname "$0")/.."

failed=()
check() {
    local name=$1
    shift
    echo "== $name"
    "$@" || failed+=("$name")
}

check "ruff check" python -m ruff check .
check "ruff format" python -m ruff format --check .
check "mypy --strict" python -m mypy
check "lint-imports" lint-imports --no-logo
check "pytest" python -m pytest "$@"

if ((${#failed[@]})); then
    printf 'failed: %s\n' "${failed[@]}"
    exit 1
fi
echo "all checks passed"
