#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The README's picture, which is also the golden tests/goldens/brain.png: picture.sh ISORAST [OPTIONS]
set -euo pipefail
isorast=$1
shift
exec "$isorast" render "$(dirname "${BASH_SOURCE[0]}")/../data/brain.nii.gz" \
    --iso 30 --azimuth 60 --elevation 15 --size 960x720 "$@"
