#!/bin/sh
# Builds the Python wheel; scripts/dist.sh calls it and sets its variables.
#
# The wheel carries the command with the shipped tasks inside, and all licences. It needs no library besides glibc,
# which `auditwheel` confirms and names in the wheel's tag.
# The tools come from PyPI (requirements.txt), into an environment of their own.
set -eu
root=$(pwd)
build=$FABC_DIST/build
stage=$build/wheel

if ! cmp -s scripts/dist/requirements.txt "$build/tools/installed.txt"; then
    python3 -m venv --clear "$build/tools"
    "$build/tools/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: \
        -r scripts/dist/requirements.txt
    cp scripts/dist/requirements.txt "$build/tools/installed.txt"
fi
PATH=$build/tools/bin:$PATH
export PATH

rm -rf "$stage"
mkdir -p "$stage"
sed "s|@ROOT@|$root|" scripts/dist/pyproject.toml >"$stage/pyproject.toml"
cp README.md "$stage/README.md"
cp -r "$build/share/licences" "$stage/licences"

# maturin only builds here, tagged for this machine's Linux; auditwheel finds the widest tag that is true.
(cd "$stage" && maturin build --profile dist --features tags --locked --target x86_64-unknown-linux-gnu \
    --target-dir "$build" --compatibility linux --out "$stage/built")

rm -f "$FABC_DIST"/fabc-*.whl
auditwheel repair --only-plat --wheel-dir "$FABC_DIST" "$stage/built"/*.whl >"$stage/repair.log" 2>&1 || {
    cat "$stage/repair.log" >&2
    exit 1
}
auditwheel show "$FABC_DIST"/fabc-*.whl
rm -rf "$stage"
