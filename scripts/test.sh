#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds everything with warnings as errors, and runs every test. With --quick only
# those labelled quick, with fewer views each (under two minutes). The exit code is that of the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tests=(--output-on-failure --parallel 2)
case "${1:-}" in
    "")
        tests+=(--exclude-regex '^gpu_quick')  # gpu is all of it
        ;;
    --quick)
        export ISORAST_QUICK=1
        tests+=(--label-regex quick)
        ;;
    *)
        echo "test: expected nothing or --quick, found '$1'" >&2
        exit 2
        ;;
esac

./scripts/setup.sh test
. .cache/env.sh
cmake -S . -B build-test -G Ninja -DCMAKE_BUILD_TYPE=Release -DISORAST_WERROR=ON >.cache/cmake.log || {
    cat .cache/cmake.log
    exit 1
}
cmake --build build-test
exec ctest --test-dir build-test "${tests[@]}"
