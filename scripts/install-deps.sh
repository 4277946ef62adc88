#!/bin/sh
# Installs what building, testing and running hydrotin needs on Debian 12. Does nothing where all of it is there.
set -eu

packages="
  g++ cmake ninja-build git ca-certificates
  libcgal-dev libtbb-dev libhdf5-dev libgdal-dev gdal-bin libdeflate-dev coinor-libclp-dev
  libcli11-dev libyaml-cpp-dev libfmt-dev nlohmann-json3-dev
  libgtest-dev libbenchmark-dev
"

missing=""
for package in $packages; do
  status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing="$missing $package"
done
if [ -z "$missing" ]; then
  echo "install-deps: everything is installed" >&2
  exit 0
fi

if [ "$(id -u)" -eq 0 ]; then
  as_root=""
elif command -v sudo >/dev/null; then
  as_root="sudo"
else
  echo "install-deps: root or sudo is needed to install:$missing" >&2
  exit 1
fi

export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -q
# shellcheck disable=SC2086  # a list of words
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
