#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The published numbers, but still pictures' (the scenario frames), by one command: runs the scenarios, draws the figures,
# prints the tables for docs/results.md.
#   bench/run.sh [-o FOLDER] [--quick] [SCENARIO...]      FOLDER: docs/results; --quick: small, for drivers on the CPU
# ISORAST_BENCH names the program (build/isorast-bench), PYTHON one that has matplotlib.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bench=${ISORAST_BENCH:-$here/../build/isorast-bench}
out=$here/../docs/results
options=()
scenarios=()
while (($#)); do
    case $1 in
        -o) out=$2; shift ;;
        -*) options+=("$1") ;;
        *) scenarios+=("$1") ;;
    esac
    shift
done
((${#scenarios[@]})) || scenarios=(resolution time-series isovalue-sweep stereo motion scaling)

mkdir -p "$out"
failed=0
for scenario in "${scenarios[@]}"; do
    "$bench" "$scenario" "${options[@]}" -o "$out/$scenario.json" || failed=1
done

for python in ${PYTHON:-python3 /usr/bin/python3}; do
    if "$python" -c 'import matplotlib' 2>/dev/null; then
        "$python" "$here/plot.py" "$out"
        exit "$failed"
    fi
done
echo "run.sh: no matplotlib, no figures; elsewhere: bench/plot.py $out" >&2
exit "$failed"
