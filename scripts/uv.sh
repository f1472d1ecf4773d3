#!/bin/sh
# Runs uv: the one on PATH, or else one that is put into .uv/ the first time.
# Needs Python 3 with venv and pip, and nothing else.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

# pyenv hides interpreters that are not selected; show uv its Python 3.12, if there is one.
if command -v pyenv >/dev/null 2>&1; then
    for bin in "$(pyenv root)"/versions/3.12*/bin; do
        if [ -x "$bin/python3.12" ]; then PATH="$PATH:$bin"; fi
    done
    export PATH
fi

if command -v uv >/dev/null 2>&1; then exec uv "$@"; fi
if [ ! -x "$root/.uv/bin/uv" ]; then
    echo "Fetching uv into .uv/ ..." >&2
    # From outside the checkout, whose .python-version may name an interpreter pyenv lacks.
    (cd / && python3 -m venv --clear "$root/.uv" && "$root/.uv/bin/python" -m pip install --quiet uv)
fi
exec "$root/.uv/bin/uv" "$@"
