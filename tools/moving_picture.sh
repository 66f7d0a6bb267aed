#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/moving_picture.sh FILE.webp [OPTION of sandrunner ...]: makes an animated picture of three
# seconds of a run, for READMEs, papers and chats. Chromium draws the 3D view of run.html without a
# window. The README's picture:
#
#   tools/moving_picture.sh running.webp --terrain dry-sand --command 2.5,0,0
#
# Needs tools/build.sh first, and Debian's chromium-headless-shell and webp.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done
cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | -*) echo "moving_picture.sh: expected FILE.webp first; see --help" >&2; exit 2 ;;
esac
picture=$(realpath -m -- "$1")
shift
for program in chromium-headless-shell img2webp; do
  command -v "$program" >/dev/null || { echo "moving_picture.sh: found no $program, expected Debian's package of it" >&2; exit 2; }
done

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/release/bin/sandrunner --start walk --duration 7 "$@" --out "$folder" >/dev/null

# The page draws one frame after the other, the camera goes round a little, and leaves them as text.
{
  cat "$folder/run.html"
  cat <<'PAGE'
<style>#scene { position: fixed; inset: 0; width: 100vw; height: 100vh; z-index: 9 }</style>
<script type="module">
const kFrames = 60, kFrom_s = 3, kStep_s = 0.05;
while (!window.sandrunner) await new Promise((done) => setTimeout(done, 50));
const { player, view } = sandrunner, frames = [];
player.playing = false;
for (let i = 0; i < kFrames; ++i) {
  const angle = 0.75 + 0.25 * Math.cos(2 * Math.PI * i / kFrames);
  for (let pass = 0; pass < 2; ++pass) {  // the first finds where the robot is
    sandrunner.seek(kFrom_s + i * kStep_s);
    const { x, y, z } = view.focus;
    view.camera.position.set(x + 2 * Math.sin(angle), y - 2 * Math.cos(angle), z + 0.6);
  }
  sandrunner.seek(kFrom_s + i * kStep_s);
  frames.push(view.canvas.toDataURL('image/png'));
}
const text = document.createElement('pre');
text.textContent = frames.join('\n');
document.documentElement.replaceChildren(text);
</script>
PAGE
} >"$folder/film.html"
chromium-headless-shell --no-sandbox --hide-scrollbars --use-angle=swiftshader --enable-unsafe-swiftshader \
  --window-size=720,400 --virtual-time-budget=1000000 --dump-dom "file://$folder/film.html" 2>"$folder/browser.log" |
  grep -o 'data:image/png;base64,[A-Za-z0-9+/=]*' | cut -d, -f2 >"$folder/frames" ||
  { cat "$folder/browser.log" >&2; exit 1; }
count=0
while read -r frame; do
  printf -v name '%s/frame-%03d.png' "$folder" "$count"
  base64 -d <<<"$frame" >"$name"
  count=$((count + 1))
done <"$folder/frames"
img2webp -loop 0 -d 50 -lossy -q 55 -m 6 "$folder"/frame-*.png -o "$folder/film.webp" >/dev/null
mv "$folder/film.webp" "$picture"
echo "$picture: $count frames, $(stat -c %s "$picture") bytes"
