#!/usr/bin/env bash
# Renders the strips of gallery.md, six frames of each scene: `docs/gallery.sh SCENE…`, from the root of a clone. `figure3`
# is a sheet of its four scenes, one in each row.
set -euo pipefail
vivify=${VIVIFY:-build/release/vivify}

render() { # scene
  local out=out/gallery/$1
  rm -rf "$out/sim" "$out/render"
  "$vivify" simulate "configs/$1.yaml" -o "$out" -q
  local last frames
  last=$(ls "$out"/sim/frames | tail -1 | sed 's/^0*//; s/\.h5//')
  frames=$(for i in 0 1 2 3 4 5; do echo $((1 + i * (last - 1) / 5)); done | paste -sd,)
  "$vivify" render "configs/$1.yaml" -o "$out" -q --frames "$frames" --spp 16
}

for scene in "$@"; do
  if [ "$scene" = figure3 ]; then
    sheet=out/gallery/figure3
    rm -rf "$sheet" && mkdir -p "$sheet"
    row=0
    for style in full cage bent compressed; do
      render "figure3_$style"
      row=$((row + 1))
      for frame in "out/gallery/figure3_$style"/render/*.exr; do
        cp "$frame" "$sheet/$row.$(basename "$frame")"
      done
    done
    "$vivify" sheet "$sheet" --columns 6 --count 24 --width 840 -q -o docs/images/figure3.png
  else
    render "$scene"
    "$vivify" sheet "out/gallery/$scene" --columns 3 --width 700 -q -o "docs/images/$scene.png"
  fi
done
