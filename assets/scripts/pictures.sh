#!/usr/bin/env bash
# Makes the editor's pictures in assets/ again: those of the README, of the tutorial, and the sheet of
# all gizmos, numbered as in the README's table of systems. From the repository's root, after a build:
#     assets/scripts/pictures.sh [readme] [tutorial] [gizmos]      # all of them without a word
# Needs Xvfb, a Vulkan driver and ImageMagick (Debian: xvfb, mesa-vulkan-drivers, imagemagick).
# GLASSBOX names another program than target/release/glassbox.
set -euo pipefail
root=$PWD
program=$(realpath "${GLASSBOX:-target/release/glassbox}")
for tool in Xvfb convert montage; do
    command -v "$tool" >/dev/null || { echo "$tool is missing (Debian: xvfb, imagemagick)" >&2; exit 1; }
done
folder=$(mktemp -d)
display=$folder/display
# Without -noreset a display begins anew when its last window goes, between two scripts.
Xvfb -displayfd 3 -screen 0 1280x720x24 -nolisten tcp -noreset 3>"$display" 2>"$folder/server" &
server=$!
trap 'kill $server 2>/dev/null || true; rm -rf "$folder"' EXIT
until [[ -s $display ]]; do
    kill -0 $server 2>/dev/null || { cat "$folder/server" >&2; exit 1; }
    sleep 0.1
done
DISPLAY=:$(cat "$display")
export DISPLAY

# Each with preferences of its own, so that it finds the editor of the first day.
play() {
    GLASSBOX_CONFIG_DIR=$(mktemp -d -p "$folder") "$program" "$1" --script "$2" 2>"$folder/log" ||
        { cat "$folder/log" >&2; exit 1; }
}

# 256 colours are enough for a window, and a third of the size.
lighter() {
    local picture
    for picture in "$@"; do
        convert "$picture" -strip -dither FloydSteinberg -colors 256 "PNG8:$picture"
    done
}

sheet() {
    local scripts=$root/tests/window/gizmos
    cd "$folder"
    play "$scripts/bench.scn.ron" "$scripts/rays.ron"
    play "$scripts/balls.scn.ron" "$scripts/trees.ron"
    play "$scripts/glow.scn.ron" "$scripts/bloom.ron"
    # What passes the threshold on the left, what bloom makes of it on the right.
    convert \( s12-bright.png -crop 320x480+80+0 \) \( s12.png -crop 320x480+80+0 \) +repage +append s12-both.png
    montage -background '#1b1c20' -fill '#e0e0e0' -pointsize 20 -geometry 400x300+4+4 -tile 4x \
        -label 'S1  shading' s01.png -label 'S2  mirrors' s02.png \
        -label 'S3  hard shadows' s03.png -label 'S4  area lights' s04.png \
        -label 'S5  boxes of the tree' s05.png -label 'S6  traversal' s06.png \
        -label 'S7  normals' s07.png -label 'S8  textures' s08.png \
        -label 'S9  environment' s09.png -label 'S10  split planes' s10.png \
        -label 'S11  motion blur' s11.png -label 'S12  bloom: bright, added' s12-both.png \
        -label 'S13  a pixel'"'"'s samples' s13.png -label 'S14  glossy mirrors' s14.png \
        -label 'S15  transparency' s15.png -label 'S16  depth of field' s16.png \
        "$root/assets/gizmos.png"
    cd "$root"
    lighter assets/gizmos.png
}

for what in "${@:-readme tutorial gizmos}"; do
    for one in $what; do
        case $one in
            readme)
                play cornell-box assets/scripts/readme.ron
                lighter assets/editor.png assets/editor-split.png
                ;;
            tutorial)
                play cornell-box assets/scripts/tutorial.ron
                lighter assets/tutorial-{black,tree,noise}.png
                ;;
            gizmos) sheet ;;
            *)
                echo "$one: readme, tutorial and gizmos are known" >&2
                exit 2
                ;;
        esac
    done
done
