#!/usr/bin/env bash
# Makes viewer.bundle.js, the script of the pages that 'rosefusion run' and 'export' write: viewer.js with what it uses of
# three.js (MIT) in one file. Only for those who change viewer.js; needs Node.js with npm. The versions are in package-lock.json,
# so that the same bytes come out; with --check it says whether they do.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp package.json package-lock.json viewer.js "$folder"
(cd "$folder" && npm ci --silent --no-audit --no-fund && npx --no-install esbuild viewer.js --bundle --minify --target=es2020 \
  --format=iife --charset=ascii --legal-comments=inline --log-level=warning --outfile=viewer.bundle.js)
if [[ ${1:-} == --check ]]; then
  cmp "$folder/viewer.bundle.js" viewer.bundle.js || { echo "bundle: viewer.bundle.js is not what viewer.js gives; run $0." >&2; exit 1; }
else
  cp "$folder/viewer.bundle.js" viewer.bundle.js
fi
