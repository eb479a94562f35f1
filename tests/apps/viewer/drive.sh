#!/usr/bin/env bash
# Uses the viewer as a person does, on a display of its own: open a sequence, step, drag it in, play, pause, change a
# setting, save, quit. drive.sh PROGRAM DROP SEQUENCE OUT [ARGUMENTS]; DROP: the program of drop.cpp, or empty; the files left
# in OUT are looked at by test_viewer.cpp.
set -euo pipefail

program=$1 drop=$2 sequence=$3 out=$4
shift 4
mkdir -p "$out"
exec 3>"$out/display"
# -noreset: a server that starts again when its last client leaves (xdotool, below) refuses the viewer meanwhile.
Xvfb -displayfd 3 -noreset -screen 0 1280x800x24 >"$out/xvfb.log" 2>&1 &
server=$!
viewer=
cleanup() {
  [[ -z $viewer ]] || kill "$viewer" 2>/dev/null || true
  kill "$server" 2>/dev/null || true
}
trap cleanup EXIT
fail() {
  echo "drive: $*" >&2
  cat "$out/viewer.log" >&2 || true
  exit 1
}
wait_for() {  # wait_for WHAT COMMAND...: until the command succeeds
  local what=$1
  shift
  for _ in $(seq 300); do
    "$@" >/dev/null 2>&1 && return
    [[ -z $viewer ]] || kill -0 "$viewer" 2>/dev/null || fail "the viewer ended while waiting for $what"
    sleep 0.1
  done
  fail "waited in vain for $what"
}
poses() { grep -cv '^#' "$out/trajectory.txt" 2>/dev/null || true; }
title() { xdotool getwindowname "$window"; }
says() { title | grep -q -- "$1"; }  # the window's title: rosefusion - PHASE - N frames - SOURCE
holds() { grep -qs -- "$2" "$1"; }
# press KEY UNTIL...: presses it again until the command succeeds; a busy machine may take seconds for a frame.
press() {
  local key=$1 i
  shift
  xdotool key "$key"
  for i in $(seq 300); do
    "$@" >/dev/null 2>&1 && return
    kill -0 "$viewer" 2>/dev/null || fail "the viewer ended after $key"
    ((i % 50 > 0)) || xdotool key "$key"
    sleep 0.1
  done
  fail "nothing came of key $key; the window says: $(title)"
}

wait_for "the display" test -s "$out/display"
export DISPLAY=:$(<"$out/display")
"$program" --out "$out" "$@" >"$out/viewer.log" 2>&1 &
viewer=$!
wait_for "the window" xdotool search --name '^rosefusion$'
window=$(xdotool search --name '^rosefusion$' | tail -n 1)
sleep 2

# Open: the path field is at the lower left; typed once more where the window was not ready for it.
for attempt in 1 2 3; do
  xdotool mousemove 300 709 sleep 1 click 1 sleep 1 key ctrl+a sleep 0.5
  xdotool type --delay 30 "$sequence"
  xdotool sleep 1 key Return
  for _ in $(seq 100); do
    if says ' paused - 0 frames'; then break 2; fi
    sleep 0.1
  done
done
says ' paused - 0 frames' || fail "the sequence was not opened; the window says: $(title)"
xdotool mousemove 450 330

press n says ' paused - 1 frames'
press n says ' paused - 2 frames'
press t test -s "$out/trajectory.txt"
[[ $(poses) == 2 ]] || fail "two steps gave $(poses) poses"
rm "$out/trajectory.txt"
if [[ -n $drop ]]; then
  "$drop" "$window" "$sequence" || fail "the viewer did not take what was dropped on it"
  wait_for "the sequence that was dropped" says ' paused - 0 frames'
fi
press space says ' - \(playing\|finished\) - '
wait_for "two more frames" says ' - \([4-9]\|[1-9][0-9]\+\) frames'
press space says ' - \(paused\|finished\) - '

# A setting: the cursor is in the settings' filter, and Tab leads to the first row.
xdotool key g sleep 2
xdotool type --delay 60 lost_residual
xdotool sleep 1 key Tab sleep 1
xdotool type --delay 60 0.55
xdotool sleep 1 key Return sleep 2
xdotool mousemove 1235 20 sleep 1 click 1 sleep 1 mousemove 450 330 sleep 1
press t holds "$out/settings.yaml" 'lost_residual: 0.55'

xdotool key 2 sleep 1  # follow
press p test -s "$out/screenshot.png"
press m test -s "$out/mesh.ply"
rm "$out/trajectory.txt"
press t test -s "$out/trajectory.txt"
for _ in $(seq 10); do  # held down, as fingers do: both keys must be down in one frame
  xdotool keydown ctrl keydown q sleep 1.5 keyup q keyup ctrl 2>/dev/null || true
  sleep 1
  kill -0 "$viewer" 2>/dev/null || break
done
kill -0 "$viewer" 2>/dev/null && fail "the viewer does not quit"
wait "$viewer" || fail "the viewer failed"
viewer=
