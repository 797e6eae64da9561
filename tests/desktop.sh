#!/usr/bin/env bash
# Drives the release viewer on a display of its own, as a user would: opens a sample, drags a slider,
# fits, leaves a reading out, pins curves, copies, exports, closes, and starts again; and takes the
# pictures of the README and of docs/viewer.md on the way.
#
#   tests/desktop.sh [FOLDER]      writes FOLDER/viewer-*.png (docs where none is given)
#
# Needs: xvfb xdotool imagemagick xclip (apt-get install xvfb libxcursor1 libxi6 libxkbcommon-x11-0
# xdotool imagemagick xclip).
set -euo pipefail
cd "$(dirname "$0")/.."
pictures=$(realpath "${1:-docs}")
sample=data/measured/z307_on_aluminium.csv
work=$(mktemp -d)
mkdir -p "$pictures"

cargo build --release -p brdf-viewer --bin viewer
viewer=${CARGO_TARGET_DIR:-target}/release/viewer

# A display of 1280 x 800, where the window lies at the corner; settings of its own; no dialogs.
export DISPLAY=:${DISPLAY_NUMBER:-77} XDG_CONFIG_HOME=$work LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY DBUS_SESSION_BUS_ADDRESS XDG_RUNTIME_DIR
Xvfb "$DISPLAY" -screen 0 1280x800x24 -nolisten tcp &
display=$!
trap 'kill $display 2>/dev/null || true; rm -rf "$work"' EXIT
sleep 1

start() { # the viewer with files, until it has fitted them
    "$viewer" "$@" --size 1280x800 --theme light &
    program=$!
    window=$(timeout 30 xdotool search --sync --onlyvisible --name '^brdf-viewer$' | tail -n 1)
    xdotool windowfocus "$window"
    sleep 4
}
start "$sample"

key() { xdotool key --window "$window" --clearmodifiers "$1"; sleep "${2:-0.6}"; }
picture() { xdotool mousemove 640 795; sleep 0.5; import -window root "$pictures/viewer-$1.png"; }
write() { # what is asked for by a key, to a path typed into the box
    key "$1"
    key ctrl+a
    xdotool type --window "$window" --delay 20 "$2"
    sleep 0.3
    key Return 1.5
    [ -s "$2" ] || { echo "not written: $2" >&2; exit 1; }
}

key ctrl+l                                  # logarithmic
key ctrl+d                                  # residuals
import -window root "$work/before.png"
xdotool mousemove 1028 345 mousedown 1      # the slider of k1, to the right
for _ in 1 2 3 4 5 6 7 8; do xdotool mousemove_relative -- 3 0; sleep 0.05; done
xdotool mouseup 1
sleep 0.5
import -window root "$work/dragged.png"
different=$(compare -metric AE "$work/before.png" "$work/dragged.png" null: 2>&1 || true)
[ "${different%%.*}" -gt 2000 ] || { echo "the slider moved nothing: $different pixels" >&2; exit 1; }

key F5 3                                    # fit in both stages
picture fitted
key ctrl+r                                  # choose readings: a rectangle around the brightest
xdotool mousemove 365 64 mousedown 1
for _ in 1 2 3 4 5 6; do xdotool mousemove_relative -- 10 10; sleep 0.05; done
xdotool mouseup 1
sleep 1
key ctrl+r
key F5 3
key ctrl+p                                  # pin
picture left-out
key ctrl+shift+p
key ctrl+2                                  # panels, dark
key ctrl+d
key F9
picture panels-dark
key F9
key ctrl+d
key ctrl+1
write ctrl+e "$work/figure.svg"
write ctrl+shift+e "$work/figure.png"
write ctrl+s "$work/fit.json"
write ctrl+shift+s "$work/curves.csv"
grep -q '"e_percent"' "$work/fit.json"
grep -A1 '"left_out"' "$work/fit.json" | grep -q '[0-9]' || { echo "no reading was left out" >&2; exit 1; }
key ctrl+shift+c                            # the table of parameters
xclip -o -selection clipboard | grep -q '^k1' || { echo "nothing was copied" >&2; exit 1; }
grep -q '<svg' "$work/figure.svg"
[ "$(wc -l < "$work/curves.csv")" -eq 113 ]

ticks() { awk '{print $14 + $15}' "/proc/$program/stat"; }
before=$(ticks); sleep 5; idle=$(( $(ticks) - before ))
echo "processor time in 5 s without any event: $idle ticks"
[ "$idle" -le 5 ]

key ctrl+q
wait "$program"
[ -s "$work/brdf-viewer/state.json" ]

start                                       # the session of before
write ctrl+s "$work/again.json"
numbers() { grep -E '"(k1|k2|kd|e_percent)":|"left_out"' -A1 "$1" | grep -v seconds | head -n 12; }
[ "$(numbers "$work/fit.json")" = "$(numbers "$work/again.json")" ] ||
    { echo "the session did not come back" >&2; exit 1; }
key ctrl+q
wait "$program"
echo "opened, dragged, fitted, chosen, pinned, copied, exported, closed, restored: pictures in $pictures"
