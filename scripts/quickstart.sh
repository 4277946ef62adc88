#!/bin/sh
# From a bare Debian 12 to a terrain: installs, builds, makes a seeded point cloud, runs configs/quickstart.yaml.
set -eu
cd "$(dirname "$0")/.."

scripts/install-deps.sh
cmake --preset release -DHYDROTIN_TESTS=OFF -DHYDROTIN_BENCHMARKS=OFF
cmake --build --preset release --target hydrotin -j "$(scripts/jobs.sh)"
hydrotin=build/release/src/app/hydrotin

echo "== making about 1 M points of fluvial terrain in 2 x 2 tiles: quickstart/points" >&2
"$hydrotin" synth quickstart/points --kind fluvial --points 1e6 --tiles 2x2 --seed 1 --noise 0.05 --voids --rivers

echo "== running configs/quickstart.yaml" >&2
"$hydrotin" run configs/quickstart.yaml

echo
echo "The results are in quickstart/out (open them in QGIS):"
for result in dem.tif hillshade.png layers.gpkg mesh terrain report.txt report.json; do
  [ ! -e "quickstart/out/$result" ] || echo "  quickstart/out/$result"
done
