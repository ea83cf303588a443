# SPDX-License-Identifier: MIT
"""isorast-bench and bench/plot.py from outside, each scenario tiny. Usage: bench_test.py ISORAST_BENCH [test...]"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(sys.argv.pop(1)).resolve()
PLOT = pathlib.Path(__file__).resolve().parents[2] / "bench/plot.py"
TINY = ["--frames", "2", "--warm-up", "1", "--warm-up-ms", "0"]
SIZE = ["--sizes", "64x36"]
HEAD = ["--volumes", "head:32:type=u8"]
SCENARIOS = {
    "frames": ["--volumes", "coral:32:type=u8", *SIZE],
    "resolution": [*HEAD, "--sizes", "48x27,64x36"],
    "time-series": ["--volumes", "coral:24:type=f32:steps=4", *SIZE],
    "isovalue-sweep": ["--volumes", "bone:32:type=u16", "--sweep", "0.2,0.8,3", *SIZE],
    "stereo": [*HEAD, *SIZE],
    "motion": [*HEAD, "--degrees", "1,4", *SIZE],
    "scaling": ["--volumes", "head:16:type=u8", "head:32:type=u8", *SIZE],
}


def python_with_matplotlib():
    for python in (sys.executable, "/usr/bin/python3"):
        try:
            if subprocess.run([python, "-c", "import matplotlib"], capture_output=True).returncode == 0:
                return python
        except OSError:
            pass
    return None


class Bench(unittest.TestCase):
    temporary = tempfile.TemporaryDirectory(prefix="isorast-bench-")
    folder = pathlib.Path(temporary.name)
    known = {}

    def bench(self, *words, code=0):
        done = subprocess.run([BENCH, *words], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, f"{words}: {done.stdout}{done.stderr}")
        return done.stdout, done.stderr

    def measured(self, scenario):
        """The JSON of a scenario, and its table; each runs once."""
        if scenario not in self.known:
            (self.folder / "json").mkdir(exist_ok=True)
            self.known[scenario] = self.measured_now(scenario, *SCENARIOS[scenario], to=f"json/{scenario}.json")
        return self.known[scenario]

    def measured_now(self, scenario, *words, to="now.json"):
        out, _ = self.bench(scenario, *words, *TINY, "-o", to)
        return json.loads((self.folder / to).read_text()), out


class Scenarios(Bench):
    def check(self, scenario):
        """What every scenario writes. Returns {(way, sequence): rows}."""
        report, out = self.measured(scenario)
        self.assertEqual(report["scenario"], scenario)
        self.assertIn(f"isorast-bench {scenario}", report["command"])
        self.assertRegex(report["commit"], r"\A([0-9a-f]{7,}(-dirty)?|unknown)\Z")
        for key in ("device", "driver"):
            self.assertTrue(report[key])
            self.assertIn(report[key], out)
        found = {}
        for row in report["rows"]:
            self.check_row(row)
            found.setdefault((row["way"], row["sequence"]), []).append(row)
        ways = {way for way, _ in found}
        # The volume's pictures were compared: every way but the first was found to agree.
        agreed = {entry["way"] for entry in report["agreement"] if entry["overlap"] > 0.9}
        self.assertEqual(len(ways - agreed), 1, f"{ways} {agreed}")
        self.assertIn("raymarch compute", ways)
        for way in ways:
            self.assertIn(way, out)
        return found

    def check_row(self, row):
        self.assertIn(row["lane"], ("graphics", "compute"))
        self.assertLess(0, row["frame"]["median_ms"])
        self.assertLessEqual(row["frame"]["median_ms"], row["frame"]["p95_ms"])
        self.assertGreaterEqual(row["frame"]["frames"], 2)
        self.assertEqual(len(row["rounds_ms"]), 2)
        self.assertLess(0, row["wall_ms"])
        self.assertIn("shade", row["passes"])
        for times in row["passes"].values():
            self.assertLessEqual(0, times["median_ms"])
            self.assertLessEqual(times["median_ms"], times["p95_ms"])
        self.assertLess(0, row["volume_bytes"])
        self.assertLess(0, row["extra_bytes"])
        self.assertLess(0, row["target_bytes"])
        if row["way"].startswith("direct"):
            self.assertLess(0, row["blocks_drawn"])
            self.assertLessEqual(row["blocks_drawn"], row["blocks_active"])
            self.assertLessEqual(row["blocks_active"], row["blocks"])

    def test_frames(self):
        for (_, sequence), rows in self.check("frames").items():
            self.assertEqual(sequence, "still")
            self.assertEqual([(row["width"], row["height"]) for row in rows], [(64, 36)])

    def test_resolution(self):
        for rows in self.check("resolution").values():
            self.assertEqual([(row["width"], row["height"]) for row in rows], [(48, 27), (64, 36)])

    def test_time_series(self):
        found = self.check("time-series")
        for (_, sequence), rows in found.items():
            if sequence == "held":
                self.assertEqual([row["step"] for row in rows], [0, 1, 3])
            else:
                self.assertEqual(sequence, "series")
                self.assertEqual(rows[0]["frame"]["frames"], 8)  # four steps, two rounds
        self.assertIn(("raymarch compute", "series"), found)

    def test_isovalue_sweep(self):
        found = self.check("isovalue-sweep")
        for (_, sequence), rows in found.items():
            there_and_back = [0.2, 0.5, 0.8, 0.5] if sequence == "sweep" else [0.2, 0.5, 0.8]
            self.assertEqual([round(row["isovalue"], 6) for row in rows], there_and_back)
        # Other isovalues are other surfaces.
        directs = [rows for (way, sequence), rows in found.items() if way.startswith("direct") and sequence == "held"]
        for rows in directs:
            self.assertGreater(len({row["blocks_active"] for row in rows}), 1)

    def test_stereo(self):
        found = self.check("stereo")
        self.assertEqual({sequence for _, sequence in found}, {"mono", "stereo"})
        for (way, sequence), rows in found.items():
            one, two = found[way, "mono"][0]["target_bytes"], found[way, "stereo"][0]["target_bytes"]
            self.assertGreater(two, 1.5 * one)

    def test_motion(self):
        found = self.check("motion")
        for (_, sequence), rows in found.items():
            if sequence == "orbit":
                self.assertEqual([row["degrees"] for row in rows], [1, 4])
            if sequence == "cut":
                self.assertEqual([row["moment"] for row in rows], ["cold", "warm"])
        self.assertEqual({sequence for _, sequence in found}, {"still", "orbit", "cut"})

    def test_scaling(self):
        for rows in self.check("scaling").values():
            self.assertEqual([row["volume"] for row in rows], ["head:16:type=u8", "head:32:type=u8"])
            self.assertEqual([row["blocks"] for row in rows], [8, 64])


class Choices(Bench):
    def write_ball(self, name, radius):
        values = bytearray()
        for k in range(16):
            for j in range(16):
                for i in range(16):
                    distance = ((i - 7.5) ** 2 + (j - 7.5) ** 2 + (k - 7.5) ** 2) ** 0.5
                    values.append(max(0, min(255, int(128 + 20 * (radius - distance)))))
        (self.folder / name).write_bytes(values)

    def test_raw_files_and_folders_of_steps(self):
        self.write_ball("ball_16x16x16_uint8.raw", 5)
        report, _ = self.measured_now("frames", "--volumes", "ball_16x16x16_uint8.raw@128", *SIZE)
        self.assertEqual({row["volume"] for row in report["rows"]}, {"ball_16x16x16_uint8.raw"})
        (self.folder / "steps").mkdir()
        for step in range(3):
            self.write_ball(f"steps/{step}_16x16x16_uint8.raw", 3 + step)
        report, _ = self.measured_now("time-series", "--volumes", "steps@128", *SIZE)
        held = [row for row in report["rows"] if row["sequence"] == "held" and row["way"] == "raymarch compute"]
        self.assertEqual([row["step"] for row in held], [0, 1, 2])

    def test_an_at_sign_in_a_path_and_numbers_in_names(self):
        (self.folder / "run@home").mkdir()
        self.write_ball("run@home/t2_16x16x16_uint8.raw", 5)
        (self.folder / "run@home/t10_16x16x16_uint8.raw").write_bytes(b"not the first step")
        for volume in ("run@home", "run@home@128", "run@home@p50", "run@home@1.5sigma"):
            report, _ = self.measured_now("frames", "--volumes", volume, *SIZE, "--ways", "raymarch compute")
            self.assertEqual({row["volume"] for row in report["rows"]}, {"run@home"})

    def test_ways_that_do_not_draw_the_same_are_left_out(self):
        # Tubes thinner than a voxel: triangles and rays see different surfaces.
        report, out = self.measured_now("frames", "--volumes", "vessels:32:type=u8", *SIZE)
        timed = {row["way"] for row in report["rows"]}
        different = {entry["way"] for entry in report["agreement"] if entry["overlap"] < 0.9}
        self.assertIn("raymarch compute", different)
        self.assertFalse(timed & different)
        self.assertIn("another picture", out)

    def test_ways_that_the_device_refuses_are_left_out(self):
        report, out = self.measured_now("frames", *HEAD, *SIZE, "--ways", "raymarch compute,raymarch compute forward,nonsense")
        self.assertEqual({row["way"] for row in report["rows"]}, {"raymarch compute"})
        self.assertEqual({skip["way"] for skip in report["skipped"]}, {"raymarch compute forward", "nonsense"})
        self.assertIn("left out: nonsense", out)

    def test_shots_of_chosen_sequences(self):
        report, _ = self.measured_now("isovalue-sweep", *SCENARIOS["isovalue-sweep"], "--sequences", "sweep", "--shots")
        self.assertEqual({row["sequence"] for row in report["rows"]}, {"sweep"})
        [shots] = report["shots"]
        self.assertEqual((shots["sequence"], shots["width"], shots["height"]), ("sweep", 64, 36))
        isovalues = [shot["isovalues"][0] for shot in shots["frames"]]
        self.assertLess(isovalues[0], isovalues[1])
        self.assertEqual(isovalues[1:], isovalues[:0:-1])  # up and down again
        for shot in shots["frames"]:
            self.assertAlmostEqual(shot["fov_degrees"], 30)
            self.assertNotEqual(shot["position"], shot["target"])
        report, _ = self.measured_now("motion", *HEAD, *SIZE, "--sequences", "orbit", "--degrees", "4", "--shots")
        [shots] = report["shots"]
        self.assertNotEqual(shots["frames"][0]["position"], shots["frames"][1]["position"])
        self.assertEqual(shots["frames"][0]["target"], shots["frames"][1]["target"])

    def test_errors_are_one_line(self):
        for words, what in ([["nothing"], "expected one of frames, resolution"],
                            [["frames", "--ways", "direct sideways"], "found 'sideways'"],
                            [["frames", *HEAD, "--sizes", "64"], "WIDTHxHEIGHT"],
                            [["frames", *HEAD, *SIZE, "--sequences", "no"], "nothing could be measured"],
                            [["frames", "--volumes", "ball.raw"], "ball.raw: expected a formula"],
                            [["frames", "--volumes", "ball@home.raw"], "ball@home.raw: expected a formula"],
                            [["frames", "--volumes", "head:32@p101"], "a percentile is p0 to p100"],
                            [["frames", "--volumes", "a_9x9x9_uint8.raw"], "a_9x9x9_uint8.raw"],
                            [["frames", *HEAD, "-o", "no/such/folder.json"], "cannot be written"]):
            _, err = self.bench(*words, code=1)
            self.assertRegex(err, r"\Aisorast-bench: error: [^\n]+\n\Z")
            self.assertIn(what, err)


class Plots(Bench):
    def test_tables_and_figures(self):
        reports = {scenario: self.measured(scenario)[0] for scenario in SCENARIOS}
        done = subprocess.run([sys.executable, PLOT, "--tables", self.folder / "json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for scenario, report in reports.items():
            self.assertIn(f"### {scenario}\n", done.stdout)
            self.assertIn(report["rows"][0]["way"], done.stdout)
        medians = {row["way"]: row["frame"]["median_ms"] for row in reports["frames"]["rows"]}
        self.assertIn(f"| raymarch compute (compute), ms | {medians['raymarch compute']:.3f} |", done.stdout)
        if "direct compute" in medians:
            ratio = medians["raymarch compute"] / medians["direct compute"]
            self.assertIn(f"| raymarch / direct, compute | {ratio:.2f} |", done.stdout)
        python = python_with_matplotlib()
        if not python:
            self.skipTest("no matplotlib")
        done = subprocess.run([python, PLOT, self.folder / "json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for scenario in set(SCENARIOS) - {"frames"}:
            png = (self.folder / f"json/{scenario}.png").read_bytes()
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater(min(struct.unpack(">II", png[16:24])), 300)
            self.assertIn("<svg", (self.folder / f"json/{scenario}.svg").read_text())

    def test_each_size_has_tables_of_its_own(self):
        rows = []
        for width, height, scale in ((1280, 720, 1), (3840, 2160, 10)):
            def add(sequence, ms, **more):
                rows.append({"volume": "head:32:type=u8", "sequence": sequence, "way": "direct compute", "lane": "compute",
                             "width": width, "height": height, "frame": {"median_ms": scale * ms, "p95_ms": scale * ms}, **more})
            add("mono", 1)
            add("stereo", 1 + scale / 20)
            add("still", 1)
            add("orbit", 1 + scale / 20, degrees=4)
            add("cut", 3, moment="cold")
            add("cut", 2, moment="warm")
        head = {"device": "d", "driver": "d", "commit": "c", "command": "", "agreement": [], "skipped": []}
        (self.folder / "sizes").mkdir()
        for scenario in ("motion", "stereo"):
            (self.folder / f"sizes/{scenario}.json").write_text(json.dumps({**head, "scenario": scenario, "rows": rows}))
        done = subprocess.run([sys.executable, PLOT, "--tables", self.folder / "sizes"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for first, cells in (("head, 32\u00b3 u8, 720p: over a still picture, median (p95) | 4\u00b0 | cut", "1.05 (1.05) | 1.50 (1.50)"),
                             ("head, 32\u00b3 u8, 4K: over a still picture, median (p95) | 4\u00b0 | cut", "1.50 (1.50) | 1.50 (1.50)"),
                             ("a second eye costs | head, 32\u00b3 u8, 720p", "5 %"),
                             ("a second eye costs | head, 32\u00b3 u8, 4K", "50 %")):
            rule = "|---" * (first.count(" | ") + 1) + "|"
            self.assertIn(f"| {first} |\n{rule}\n| direct compute (compute) | {cells} |\n", done.stdout)

    def test_nothing_to_plot(self):
        done = subprocess.run([sys.executable, PLOT, self.folder / "nowhere"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"\Aplot.py: error: [^\n]+\n\Z")


if __name__ == "__main__":
    unittest.main()
