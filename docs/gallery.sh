#!/usr/bin/env bash
# Renders the strips of gallery.md: six frames of each scene. `docs/gallery.sh SCENE…`, from the root of a clone.
set -euo pipefail
vivify=${VIVIFY:-build/release/vivify}
for scene in "$@"; do
  out=out/gallery/$scene
  "$vivify" simulate "configs/$scene.yaml" -o "$out" -q
  last=$(ls "$out"/sim/frames | tail -1 | sed 's/^0*//; s/\.h5//')
  frames=$(for i in 0 1 2 3 4 5; do echo $((1 + i * (last - 1) / 5)); done | paste -sd,)
  "$vivify" render "configs/$scene.yaml" -o "$out" -q --frames "$frames" --size 320x180 --spp 24
  "$vivify" sheet "$out" --columns 3 --width 800 -q -o "docs/images/$scene.png"
done
