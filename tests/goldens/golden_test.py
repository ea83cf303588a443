# SPDX-License-Identifier: MIT
# The README's picture, rendered again, equals the one that the README shows: golden_test.py ISORAST OUT.png
# After a change that is meant:  scripts/picture.sh ISORAST -o tests/goldens/brain.png
import json
import pathlib
import subprocess
import sys

# Drivers and CPUs round differently: a few pixels on silhouettes may be another surface's.
TOLERANCE, SHARE = 8, 0.002

isorast, picture = sys.argv[1:]
root = pathlib.Path(__file__).resolve().parents[2]
golden = root / "tests/goldens/brain.png"
subprocess.run([root / "scripts/picture.sh", isorast, "-o", picture], check=True)
result = subprocess.run([isorast, "compare", golden, picture, "--tolerance", str(TOLERANCE), "--json"],
                        capture_output=True, text=True)
print(result.stdout, result.stderr)
sys.exit(0 if json.loads(result.stdout)["share_over"] <= SHARE else 1)
