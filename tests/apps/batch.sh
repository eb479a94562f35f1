#!/usr/bin/env bash
# apps/batch/Snakefile over a good recording and one that cannot be read: batch.sh PROGRAM SNAKEFILE. Ends with 77 (skipped) and a word
# where snakemake is not there.
set -euo pipefail
program=$1 snakefile=$2
fail() { echo "batch: $*" >&2; exit 1; }
command -v snakemake >/dev/null || { echo "batch: skipped, there is no snakemake."; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/in/broken 1"
echo nothing >"$folder/in/broken 1/readme.txt"
"$program" synth "$folder/in/room" --frames 24 --width 320 --height 240 >"$folder/synth.log" 2>&1
cd "$folder"
batch() { snakemake -s "$snakefile" --cores 2 --config recordings=in out=out program="$program" >snakemake.log 2>&1 || { tail -n 30 snakemake.log >&2; fail "snakemake failed."; }; }
batch
grep -q '2 recordings, 1 failed' out/summary.html || fail "the summary does not count what failed."
[[ $(grep -ob 'broken_1' out/summary.html | head -n 1 | cut -d: -f1) -lt $(grep -ob "'room/" out/summary.html | head -n 1 | cut -d: -f1) ]] ||
  fail "the worst is not first."
[[ -s out/room/mesh.glb && -s out/room/result/view.html ]] || fail "the good one has no mesh or page."
# What is missing alone is done again.
rm out/room/run.code
stamp=$(stat -c %Y out/broken_1/run.code)
batch
[[ $(stat -c %Y out/broken_1/run.code) == "$stamp" ]] || fail "what was done is done again."
echo "batch: all right."
