#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From a fresh clone to a picture: installs what is missing, builds, renders the README's picture into
# out/demo.png, and says what each step took. On a machine that has it all, only the last two count.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

now() { date +%s.%N; }
seconds() { awk -v from="$1" -v to="$2" 'BEGIN { printf "%.1f s", to - from }'; }

start=$(now)
./scripts/setup.sh build
. .cache/env.sh
installed=$(now)

cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DISORAST_TESTS=OFF >.cache/cmake.log || {
    cat .cache/cmake.log
    exit 1
}
cmake --build build --target isorast_cli
built=$(now)

mkdir -p out
./scripts/picture.sh ./build/isorast -o out/demo.png
rendered=$(now)

echo
echo "picture  $PWD/out/demo.png"
echo "install  $(seconds "$start" "$installed")"
echo "build    $(seconds "$installed" "$built")"
echo "render   $(seconds "$built" "$rendered"), from file to picture"
echo
echo "Your own volume:  . .cache/env.sh && ./build/isorast render FILE -o picture.png"
