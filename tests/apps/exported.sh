#!/usr/bin/env bash
# What 'rosefusion export' and 'run' write for others, looked at by those: exported.sh PROGRAM gltf|page. Ends with 77 (skipped) and a
# word where the other program is not there: Node.js with npm's gltf-validator, or Chromium.
set -euo pipefail
program=$1 part=$2
fail() { echo "exported: $*" >&2; exit 1; }
skip() { echo "exported: skipped, $*"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

if [[ $part == gltf ]]; then
  command -v node >/dev/null && command -v npm >/dev/null || skip "there is no Node.js with npm."
  (cd "$folder" && timeout 120 npm install --silent --no-audit --no-fund gltf-validator@2.0.0-dev.3.10 >/dev/null 2>&1) ||
    skip "npm does not reach gltf-validator."
else
  chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || skip "there is no Chromium."
fi

"$program" synth "$folder/s" --frames 24 --width 320 --height 240 >/dev/null
"$program" run "$folder/s" --out "$folder/o" >/dev/null

if [[ $part == gltf ]]; then
  "$program" export "$folder/o" --to "$folder/a.glb" --max-error 0.01 --to "$folder/b.obj"
  "$program" export "$folder/o" --to "$folder/d.glb" --to "$folder/e f.obj" --max-error 0.01 --texture
  for file in "e f.obj" e_f.mtl e_f_texture.jpg; do [[ -s $folder/$file ]] || fail "there is no $file."; done
  refused() {  # WORDS ARGUMENTS...: one sentence with the words, and nothing written
    local words=$1 said code=0
    shift
    said=$("$program" export "$@" --to "$folder/no.glb" --texture 2>&1) || code=$?
    [[ $code == 2 && $said == *"$words"* && ! -e $folder/no.glb ]] || fail "export $* says with $code: $said"
  }
  mv "$folder/s" "$folder/moved"
  refused "--recording" "$folder/o"
  "$program" export "$folder/o" --to "$folder/g.glb" --texture --texture-size 512 --recording "$folder/moved"
  mv "$folder/moved" "$folder/s"
  code=0; "$program" export "$folder/o" --to "$folder/no.ply" --texture 2>/dev/null || code=$?
  [[ $code == 2 && ! -e $folder/no.ply ]] || fail "a .ply with a texture was not refused."
  "$program" synth "$folder/t" --frames 24 --width 320 --height 240 --no-colour >/dev/null
  "$program" run "$folder/t" --out "$folder/p" --no-page >/dev/null
  refused "no colour" "$folder/p"
  [[ ! -e $folder/p/view.html ]] || fail "--no-page wrote a page."
  "$program" export "$folder/p" --to "$folder/c.glb" --up z
  cat >"$folder/validate.js" <<'JS'
const validator = require('gltf-validator'), fs = require('fs');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then(({issues}) => {
  console.log(process.argv[2], JSON.stringify(issues));
  process.exit(issues.numErrors + issues.numWarnings === 0 ? 0 : 1);
});
JS
  for file in a.glb c.glb d.glb g.glb; do (cd "$folder" && node validate.js "$folder/$file") || fail "the validator finds fault with $file."; done
  "$program" export "$folder/o" --to "$folder/n" --as nerfstudio >/dev/null
  node -e 'const t = JSON.parse(require("fs").readFileSync(process.argv[1] + "/transforms.json"));
    for (const f of t.frames) for (const p of [f.file_path, f.depth_file_path]) require("fs").accessSync(process.argv[1] + "/" + p);
    if (t.frames.length < 15) throw new Error("only " + t.frames.length + " frames");' "$folder/n"
  "$program" run "$folder/s" --out "$folder/u" --no-page --max-frames 3 --depth-units-per-metre 2500 >/dev/null
  "$program" export "$folder/u" --to "$folder/n2" --as nerfstudio >/dev/null
  cmp -s "$folder/n/depth/$(ls "$folder/n/depth" | head -n 1)" "$folder/n2/depth/$(ls "$folder/n2/depth" | head -n 1)" &&
    fail "the depth's units that the run was told are forgotten."
  "$program" export "$folder/o" --to "$folder/m" --as colmap >/dev/null
  [[ $(grep -c '\.jpg$' "$folder/m/sparse/0/images.txt") -ge 15 ]] || fail "COLMAP's model lists too few images."
else
  [[ -s $folder/o/view.html ]] || fail "run wrote no view.html."
  look() {  # PAGE: its text once it is drawn, and what the console was told
    timeout 120 "$chromium" --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
      --user-data-dir="$folder/profile" --enable-logging=stderr --virtual-time-budget=30000 --timeout=90000 --dump-dom "file://$1" \
      >"$folder/dom" 2>"$folder/log" || fail "Chromium ended badly: $(tail -n 3 "$folder/log")"
  }
  look "$folder/o/view.html"
  grep 'CONSOLE' "$folder/log" | grep -iE 'error|uncaught|warn' >&2 && fail "the page complains on the console."
  grep -q 'data-drawn="1"' "$folder/dom" || fail "the page was not drawn: $(grep -o 'id="wait".*' "$folder/dom" | head -c 300)"
  grep -q '24 frames: ' "$folder/dom" || fail "the page does not count its frames."
  # And the test sees a page that does not work.
  sed -E 's|(<script id="model"[^>]*>).{40}|\1|' "$folder/o/view.html" >"$folder/damaged.html"
  look "$folder/damaged.html"
  ! grep -q 'data-drawn="1"' "$folder/dom" || fail "a damaged page counts as drawn."
fi
echo "exported: $part, all right."
