#!/bin/bash
# Makes the pictures of docs/gallery.md, and the page, from the built-in examples. `bash docs/gallery.sh` builds the program first;
# QUADMOSAIC names a built one.
set -euo pipefail
cd "$(dirname "$0")"
if [ -z "${QUADMOSAIC:-}" ]; then
    cargo build --release --quiet
    QUADMOSAIC=$(cargo metadata --format-version 1 --no-deps | sed 's/.*"target_directory":"\([^"]*\)".*/\1/')/release/quadmosaic
fi
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
rm -rf gallery
mkdir gallery
page=gallery.md
{
    echo "# Gallery"
    echo
    echo "Meshes of the built-in examples; \`docs/gallery.sh\` makes the pictures and this page."
} > $page

# A picture by its name, its caption, the options of mesh, and those of picture.
mesh() {
    local name=$1 caption=$2 options=$3 view=$4
    # shellcheck disable=SC2086
    "$QUADMOSAIC" mesh $options -o "$scratch/mesh.obj" --quiet
    # shellcheck disable=SC2086
    "$QUADMOSAIC" picture "$scratch/mesh.obj" $view --size 720x480 -o "gallery/$name.png" > /dev/null
    show "$name" "$caption" "quadmosaic mesh $options -o $name.obj"
}

# A picture of a surface's field or mosaic.
stage() {
    local name=$1 caption=$2 options=$3
    # shellcheck disable=SC2086
    "$QUADMOSAIC" picture $options --size 720x480 -o "gallery/$name.png" > /dev/null
    show "$name" "$caption" "quadmosaic picture $options -o $name.png"
}

show() {
    printf '\n%s:\n\n    %s\n\n![%s](gallery/%s.png)\n' "$2" "$3" "$2" "$1" >> $page
}

wing="--view 0.3,-0.6,1"
stage field "The cross field of the ONERA M6 wing" "example:m6 --points 1500 --field $wing"
stage mosaic "Its mosaic of equal square tiles" "example:m6 --points 1500 --mosaic $wing"
mesh mesh "Its mesh; triangles are orange" "example:m6 --points 1500" "$wing"
mesh below "The same wing from below" "example:m6 --points 1500" "--view 0.3,-0.6,-1"
mesh nose "A fine leading edge" "example:m6 --points 1500 --size-at ridges:0.015" "$wing"
mesh quads "Quads alone, rows that never end" "example:torus --layout quads --points 1000" ""
mesh aspect "Rectangles along a guide" "example:plate --points 900 --aspect 3 --guide 0.1,0.1,0,1,0,0" "--view top"
mesh holes "About 32 edges round the hole" "example:plate --points 600 --around-holes 32" "--view top"
mesh part "A machine part with the preset for it" "example:block --preset fem --points 1500" ""
mesh symmetric "Symmetric bit for bit" "example:sphere --points 800 --symmetry x" "--view front"
mesh shape "The shape of the faces by colour" "example:block --points 1500" "--colour quality --view 1,-0.6,-0.5"
