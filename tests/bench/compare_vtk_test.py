# SPDX-License-Identifier: MIT
"""bench/compare_vtk.py on a tiny volume. Usage: compare_vtk_test.py BUILD_FOLDER [test...]

Exit code 77 without VTK or Xvfb."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "bench/compare_vtk.py"
WAYS = {"direct compute", "raymarch compute"}
VTKS = {"VTK flying edges", "VTK ray cast"}


class Comparison(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="isorast-vtk-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def compare(self, *words, code=0):
        done = subprocess.run([sys.executable, SCRIPT, "--side", "64", "--sizes", "320x180", "--frames", "4",
                               "--ways", ",".join(WAYS), "-o", self.folder, *words],
                              capture_output=True, text=True, timeout=200)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def rows(self):
        return json.loads((self.folder / "compare_vtk.json").read_text())[0]["rows"]

    def test_all_ways_draw_the_same_and_are_timed(self):
        out, _ = self.compare("--build", BUILD)
        rows = self.rows()
        self.assertEqual(sorted((row["case"], row["way"]) for row in rows),
                         sorted((case, way) for case in ("sweep", "orbit") for way in VTKS | WAYS))
        for row in rows:
            self.assertLess(0, row["mean_ms"])
            best = min(other["mean_ms"] for other in rows if other["case"] == row["case"] and other["way"] in VTKS)
            self.assertAlmostEqual(row["faster"], best / row["mean_ms"])
            self.assertIn(f"{row['mean_ms']:.0f} ms, {row['faster']:.2f}", out)
            if row["way"] in VTKS:
                self.assertGreater(row["overlap"], 0.98)
                self.assertEqual(row["frames"], 4)
            else:
                self.assertEqual(len(row["rounds_ms"]), 2)
        self.assertNotIn("Left out", out)

    def test_another_picture_is_not_timed(self):
        # An isorast that looks from the other side.
        (self.folder / "build").mkdir()
        (self.folder / "build/isorast-bench").symlink_to(BUILD / "isorast-bench")
        liar = self.folder / "build/isorast"
        liar.write_text(f"""#!/bin/sh
shift
exec {BUILD}/isorast render $(echo "$@" | sed -E 's/(--camera-position=)/\\1-/; s/=--/=/')
""")
        liar.chmod(0o755)
        out, _ = self.compare("--build", self.folder / "build", "--ways", "direct compute")
        for row in self.rows():
            if row["way"] in VTKS:
                self.assertLess(row["overlap"], 0.98)
            self.assertNotIn("faster", row)
        self.assertIn("Left out: VTK ray cast, moving camera, 320x180: another picture", out)

    def test_errors_are_one_line(self):
        for words, what in ([["--build", self.folder], "isorast: not there"],
                            [["--build", BUILD, "ball.raw"], "ball.raw: expected"]):
            _, err = self.compare(*words, code=1)
            self.assertRegex(err, r"\Acompare_vtk.py: error: [^\n]+\n\Z")
            self.assertIn(what, err)


if __name__ == "__main__":
    known = subprocess.run([sys.executable, "-c", "import vtk, numpy"], capture_output=True).returncode == 0
    if not known or not shutil.which("Xvfb"):
        sys.exit(77)
    unittest.main()
