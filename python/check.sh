#!/usr/bin/env bash
# Builds the wheel as its users get it, installs it into a clean environment, and tests it there: pytest, types
# (mypy on the examples, stubs against the engine) and the notebooks. With --sdist the wheel is built from the
# source distribution, which shows that that is complete; it then compiles everything once more.
set -euo pipefail
cd "$(dirname "$0")"

target=$(cd .. && cargo metadata --no-deps --format-version 1 | python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
env=$target/python-env
wheels=$target/wheels
rm -rf "$env" "$wheels"
python3 -m venv "$env"
"$env/bin/pip" -q install 'maturin>=1.9,<2'

if [ "${1:-}" = --sdist ]; then
    "$env/bin/maturin" sdist --out "$wheels"
    PATH=$env/bin:$PATH "$env/bin/pip" -q wheel --no-deps --no-build-isolation --wheel-dir "$wheels" "$wheels"/armtwin-*.tar.gz
else
    "$env/bin/maturin" build --release --out "$wheels"
fi
rm -rf "$env"
python3 -m venv "$env"
"$env/bin/pip" -q install "$(echo "$wheels"/armtwin-*.whl)[test]"

"$env/bin/python" -m pytest -q tests
"$env/bin/mypy" --strict examples/typed.py
# pickle's hooks and what numpy adds are no part of the interface.
"$env/bin/stubtest" armtwin._engine armtwin_program --mypy-config-file pyproject.toml
"$env/bin/python" examples/run.py
