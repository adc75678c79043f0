#!/usr/bin/env bash
# Makes docs/img/*.png without a display, from simulated recordings.
#
# Needs the viewer (pip install rerun-sdk==0.36.3; its Python has pillow with it or takes it by
# pip install pillow), a software Vulkan driver (Debian: mesa-vulkan-drivers libvulkan1) and Chromium.
# ARMTWIN_RERUN names the viewer where it is not on PATH, PYTHON a python3 with pillow.
set -euo pipefail
cd "$(dirname "$0")/.."
viewer=${ARMTWIN_RERUN:-rerun}
python=${PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cargo build --release --quiet
armtwin=target/release/armtwin
"$armtwin" simulate scenarios/ur5_friction.toml --out "$work"
"$armtwin" demo --out "$work/demo" >/dev/null
"$armtwin" compare "$work/check.csv" --twin scenarios/twins/ur5.toml -o "$work/compare.rrd"

# shot FILE.rrd NAME WIDTHxHEIGHT: a picture of the whole window, shrunk to 256 colours.
shot() {
    RUST_LOG=off XDG_RUNTIME_DIR=$work "$viewer" --headless --bind 127.0.0.1 --port auto \
        --renderer vulkan --hide-welcome-screen --window-size "$3" \
        --screenshot-to "$work/$2.png" "$1"
    shrink "$2" "$3"
}

# page FILE.html NAME WIDTHxHEIGHT: the first screen of a report.
page() {
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/browser" \
        --virtual-time-budget=60000 --window-size="${3/x/,}" --screenshot="$work/$2.png" \
        "file://$1" 2>/dev/null
    shrink "$2" "$3"
}

# shrink NAME WIDTHxHEIGHT
shrink() {
    "$python" - "$work/$1.png" "docs/img/$1.png" "$2" <<'PY'
import sys
from PIL import Image

source, target, size = sys.argv[1:]
picture = Image.open(source).convert("RGB")
picture = picture.resize(tuple(int(n) for n in size.split("x")), Image.Resampling.LANCZOS)
few = picture.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
few.save(target, optimize=True)
PY
}

mkdir -p docs/img
shot "$work/compare.rrd" compare 1400x900
shot "$work/demo/twin.rrd" diagnosis 1400x900
page "$work/demo/report.html" report 1100x900
ls -l docs/img
