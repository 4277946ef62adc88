#!/bin/sh
# From a bare Debian 12 to passed tests: installs, builds with warnings as errors, runs the damaged-file tests under the
# sanitizers, then all tests.
set -eu
cd "$(dirname "$0")/.."

scripts/install-deps.sh
jobs=$(scripts/jobs.sh)

cmake --preset asan -DHYDROTIN_WERROR=ON
cmake --build --preset asan --target las_robustness_test -j "$jobs"
cmake --preset dev -DHYDROTIN_WERROR=ON
cmake --build --preset dev -j "$jobs"

echo "== damaged LAS and LAZ files under the address and undefined-behaviour sanitizers" >&2
ctest --preset asan -R LasRobustness --no-tests=error -j "$jobs"
echo "== all tests" >&2
ctest --preset dev --no-tests=error -j "$jobs"
