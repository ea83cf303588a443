# SPDX-License-Identifier: MIT
"""The command line from outside: exit codes, messages, help, files. Usage: cli_test.py ISORAST [test...]"""
import gzip
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ISORAST = os.path.abspath(sys.argv.pop(1))
SMALL = ["--size", "96x64"]


def png(width, height, rgba):
    """The bytes of a PNG of one color."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = (b"\0" + bytes(rgba) * width) * height
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def size_of(data):
    """Width and height of a PNG."""
    return struct.unpack(">II", data[16:24])


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="isorast-cli-")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def isorast(self, *words, code=0, binary=False):
        """Runs the program in the temporary folder; checks its exit code and the form of its errors."""
        done = subprocess.run([ISORAST, *words], cwd=self.folder.name, capture_output=True, timeout=300)
        err = done.stderr.decode()
        self.assertEqual(done.returncode, code, f"{words}: {err}")
        if code == 2 and words:
            self.assertRegex(err, r"\Aisorast: error: [^\n]+\nTry: isorast [^\n]*--help\n\Z")
            self.assertEqual(done.stdout, b"")
        return done.stdout if binary else done.stdout.decode(), err


    def shell(self, command, *words):
        """Runs the program as "$@" in a shell's command; returns what it did."""
        return subprocess.run(["sh", "-c", command, "sh", ISORAST, *words], cwd=self.folder.name,
                              capture_output=True, timeout=300)


class Usage(CommandLine):
    def test_no_arguments_print_the_help(self):
        out, err = self.isorast(code=2)
        self.assertEqual(out, "")
        self.assertIn("Subcommands:", err)

    def test_help(self):
        self.assertIn("isorast render", self.isorast("--help")[0])
        for command in ["render", "mesh", "info", "devices", "compare"]:
            out, err = self.isorast(command, "--help")
            self.assertIn("Example", out)
            self.assertEqual(err, "")
            self.assertEqual(self.isorast("--help", command)[0], out)
            self.assertLess(max(map(len, out.splitlines())), 140)

    def test_unknown_command(self):
        self.assertIn("did you mean render?", self.isorast("rendr", "x.raw", code=2)[1])
        self.assertIn("info, devices, compare", self.isorast("frobnicate", code=2)[1])
        self.assertIn("isorast render sphere:64", self.isorast("sphere:64", code=2)[1])
        for later in ["view", "bench"]:
            self.isorast(later, code=2)

    def test_unknown_option(self):
        self.assertIn("did you mean --azimuth?", self.isorast("render", "sphere:8", "--azimut", "3", code=2)[1])
        self.isorast("devices", "--frobnicate", code=2)
        self.isorast("compare", "a.png", "b.png", "c.png", code=2)

    def test_wrong_values(self):
        wrong = {
            "--size": ["10", "0x10", "10x-3", "10x10x10", "axb", "10x", "", "99999999999x1"],
            "--iso": ["abc", "1:2", "p101", "1:2:0", "sigma", "1,,2", "nan"],
            "--technique": ["frobnicate", ""],
            "--rasterizer": ["cpu"],
            "--shading": ["goch"],
            "--culling": ["yes"],
            "--clip": ["x", "x=1", "w>1", "x>", "x>1e", "x>nan", "x>1%%"],
            "--stereo": ["both"],
            "--eye-separation": ["0", "-1"],
            "--convergence": ["near"],
            "--color": ["#12345", "#ggg", "rde", "#1234567"],
            "--background": ["nocolor"],
            "--view": ["x", "front", "+w", "a"],
            "--azimuth": ["north"],
            "--zoom": ["0", "-1", "big"],
            "--fov": ["0", "180"],
            "--camera-position": ["1,2", "1,2,3,4", "a,b,c", "1,2,nan"],
            "--dims": ["1x2", "0x1x1", "1x2x3x4", "4294967296x1x1"],
            "--type": ["u9", "complex"],
            "--endian": ["middle"],
            "--spacing": ["1,2", "0,1,1", "-1,1,1"],
            "--offset": ["-1", "1k"],
            "--time": ["-1", "1.5", "4294967296", "some", "0:", "0:1:0", "2:1", "0:5:-1", "0:1:2:3", "3:x"],
            "--repeat": ["0", "x"],
            "--output": ["a.jpg", "a.exr"],
        }
        for option, values in wrong.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    _, err = self.isorast("render", "sphere:8", f"{option}={value}", code=2)
                    self.assertIn(option, err)

    def test_a_length_that_is_none(self):
        for option in ["--eye-separation", "--convergence"]:
            for found in ["0", "-1", "near", "inf", "nan", "1e999", "1m"]:
                _, err = self.isorast("render", "sphere:8", option, found, code=2)
                self.assertEqual(err.splitlines()[0],
                                 f"isorast: error: {option}: expected a length greater than 0, found {found}")

    def test_a_rasterizer_that_is_none(self):
        words = "auto (default), hardware or compute"
        self.assertIn(words, self.isorast("render", "--help")[0])
        self.assertIn(f'expected {words}; found "automatic"',
                      self.isorast("render", "sphere:8", "--rasterizer", "automatic", code=2)[1])

    def test_options_that_exclude_or_need_each_other(self):
        for words in [["--view", "+x", "--azimuth", "3"], ["--camera-position", "1,2,3", "--roll", "3"],
                      ["--camera-target", "1,2,3"], ["--tolerance", "3"], ["-o", "-", "--json"],
                      ["--color", "red,blue", "--iso", "0.5"], ["--stereo", "layers", "-o", "-"],
                      ["--stereo", "layers", "--reference", "a.png"]]:
            self.isorast("render", "sphere:8", *words, code=2)

    def test_missing_values(self):
        self.assertIn("INPUT", self.isorast("render", code=2)[1])
        self.isorast("render", "sphere:8", "--iso", code=2)
        for option in ["--iso", "--time", "--color", "--view"]:
            _, err = self.isorast("render", "sphere:8", f"{option}=", "-o", "x.png", code=2)
            self.assertEqual(err, f"isorast: error: {option}: expected a value after '='\nTry: isorast render --help\n")
        self.isorast("--iso=", "sphere:8", code=2)
        self.isorast("compare", "a.png", code=2)


class Streams(CommandLine):
    def test_output_that_cannot_be_written(self):
        self.write("a.png", png(8, 4, [10, 20, 30, 255]))
        for words in [["--version"], ["--help"], ["render", "--help"], ["info", "sphere:8"],
                      ["info", "sphere:8", "--json"], ["compare", "a.png", "a.png"]]:
            for redirection, why in [(">/dev/full", "No space left on device"), (">&-", "Bad file descriptor")]:
                with self.subTest(words=words, redirection=redirection):
                    done = self.shell(f'"$@" {redirection}', *words)
                    self.assertEqual(done.returncode, 1)
                    self.assertEqual(done.stderr.decode(),
                                     f"isorast: error: standard output: cannot be written: {why}\n")

    def test_errors_that_cannot_be_written(self):
        for redirection in ["2>/dev/full", "2>&-", "<&- >&- 2>&-"]:
            self.assertEqual(self.shell(f'"$@" {redirection}', "info", "none.raw").returncode, 1)
            self.assertEqual(self.shell(f'"$@" {redirection}', "frobnicate").returncode, 2)
            self.assertEqual(self.shell(f'"$@" {redirection}').returncode, 2)

    def test_errors_are_one_line_of_text(self):
        _, err = self.isorast("info", "a\nb\x1b[31m\tü\x7f.raw", code=1)
        self.assertTrue(err.startswith(r"isorast: error: a\nb\x1b[31m\tü\x7f.raw: there is no such file"), err)
        self.assertEqual(err.count("\n"), 1)
        self.assertIn(r"a\nb", self.isorast("a\nb", code=2)[1])
        self.assertIn(r"a\rb", self.isorast("render", "sphere:8", "--color", "a\rb", code=2)[1])


class Compare(CommandLine):
    def setUp(self):
        super().setUp()
        self.write("a.png", png(8, 4, [10, 20, 30, 255]))
        self.write("b.png", png(8, 4, [10, 25, 30, 255]))
        self.write("c.png", png(4, 8, [10, 20, 30, 255]))

    def test_same_and_different(self):
        self.assertTrue(self.isorast("compare", "a.png", "a.png")[0].startswith("max 0  rms 0  0 of 32 pixels"))
        self.assertIn("max 5  rms 2.5  32 of 32", self.isorast("compare", "a.png", "b.png", code=1)[0])
        self.isorast("compare", "a.png", "b.png", "--tolerance", "4.9", code=1)
        self.isorast("compare", "a.png", "b.png", "--tolerance", "5")
        self.isorast("--tolerance", "5", "a.png", "compare", "b.png")  # in any order
        self.isorast("compare", "a.png", "b.png", "--tolerance", "nan", code=1)

    def test_json(self):
        found = json.loads(self.isorast("compare", "a.png", "b.png", "--json", code=1)[0])
        self.assertEqual((found["max"], found["pixels_over"], found["same"]), (5, 32, False))

    def test_difference_picture(self):
        self.isorast("compare", "a.png", "b.png", "-o", "difference.png", code=1)
        self.assertEqual(size_of(self.read("difference.png")), (8, 4))
        self.write("expected.png", png(8, 4, [0, 255, 0, 255]))
        self.isorast("compare", "difference.png", "expected.png")

    def test_errors(self):
        self.write("broken.png", self.read("a.png")[:40])
        self.write("text.png", b"hello")
        for first, second, message in [("a.png", "c.png", "8x4 and 4x8"), ("a.png", "none.png", "none.png"),
                                       ("broken.png", "a.png", "broken.png"), ("text.png", "a.png", "text.png"),
                                       (".", "a.png", ".")]:
            _, err = self.isorast("compare", first, second, code=1)
            self.assertRegex(err, r"\Aisorast: error: [^\n]+\n\Z")
            self.assertIn(message, err)


class Info(CommandLine):
    def test_formula(self):
        out, err = self.isorast("info", "sphere:32")
        self.assertEqual(err, "")
        for text in ["32 x 32 x 32", "f32", "▲", "█", "isorast render sphere:32 --iso"]:
            self.assertIn(text, out)

    def test_raw_file(self):
        self.write("ramp.bin", b"skip" + bytes(range(120)))
        words = ["ramp.bin", "--dims", "6x5x4", "--type", "u8", "--offset", "4", "--spacing", "1,2,0.5"]
        found = json.loads(self.isorast("info", *words, "--json")[0])
        self.assertEqual((found["dims"], found["type"], found["spacing"]), ([6, 5, 4], "u8", [1, 2, 0.5]))
        self.assertEqual((found["minimum"], found["maximum"], found["mean"]), (0, 119, 59.5))
        self.assertEqual((found["bytes"], found["mapped"], found["not_finite"]), (120, True, 0))
        self.assertEqual(sum(found["histogram"]), 120)
        # The line to copy reads the file in the same way.
        line = self.isorast("info", *words)[0].splitlines()[-1]
        self.assertTrue(line.startswith(
            "isorast render ramp.bin --dims 6x5x4 --type u8 --spacing 1,2,0.5 --offset 4 --iso "), line)

    def test_histogram_fits_the_terminal(self):
        for columns in [30, 47, 80, 120]:
            os.environ["COLUMNS"] = str(columns)
            self.addCleanup(os.environ.pop, "COLUMNS", None)
            lines = self.isorast("info", "gyroid:16")[0].splitlines()
            axis = next(line for line in lines if line.startswith("─"))
            self.assertEqual(len(axis), columns)
            first = lines.index(axis)
            self.assertTrue(all(len(line) <= columns for line in lines[first - 8:first + 4]))

    def test_odd_volumes(self):
        def floats(*values):
            return struct.pack(f"<{len(values)}f", *values)
        words = ["--dims", "2x2x2", "--type", "f32", "--endian", "little"]
        self.write("constant.raw", floats(*[7.0] * 8))
        self.assertIn("none: all voxels are equal", self.isorast("info", "constant.raw", *words)[0])
        self.write("nan.raw", floats(*[float("nan")] * 8))
        self.assertIn("none that is finite", self.isorast("info", "nan.raw", *words)[0])
        json.loads(self.isorast("info", "nan.raw", *words, "--json")[0])
        self.write("some.raw", floats(1, 2, 3, 4, 5, 6, float("inf"), float("nan")))
        self.assertIn("2 of 8 voxels", self.isorast("info", "some.raw", *words)[0])

    def test_errors(self):
        for name in ["none.raw", "sphere:x", "noise:16:octave=3", "."]:
            _, err = self.isorast("info", name, code=1)
            self.assertRegex(err, r"\Aisorast: error: [^\n]+\n\Z")


    def test_memory_that_is_not_there(self):
        limited = 'ulimit -v 250000; "$@"'
        if self.shell(limited, "--version").returncode != 0:
            self.skipTest("this build needs more memory to start")
        self.write("zeros.nrrd", b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1024 1024 256\nencoding: gzip\n\n"
                   + gzip.compress(bytes(1 << 28), 1))
        for name, size, helps in [("sphere:4096", 4 << 36, "choose a smaller size"),
                                  ("zeros.nrrd", 1 << 28, "one uncompressed little-endian file needs none")]:
            done = self.shell(limited, "info", name)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(done.stderr.decode(), f"isorast: error: {name}: expected memory for its voxels, "
                             f"{size} bytes, found less; {helps}\n")


class Devices(CommandLine):
    def test_json_and_table_agree(self):
        devices = json.loads(self.isorast("devices", "--json")[0])
        if not devices:
            self.skipTest("no Vulkan device")
        lines = self.isorast("devices")[0].splitlines()
        self.assertEqual(len(lines), len(devices) + 1)
        for device, line in zip(devices, lines[1:]):
            self.assertIn(device["name"], line)
            self.assertEqual(device["hardware"], device["why_not_hardware"] == "")


class Render(CommandLine):
    @classmethod
    def setUpClass(cls):
        done = subprocess.run([ISORAST, "devices", "--json"], capture_output=True, timeout=60)
        devices = json.loads(done.stdout) if done.returncode == 0 else []
        if not any(device["compute"] for device in devices):
            raise unittest.SkipTest("no Vulkan device")
        hardware = any(device["hardware"] for device in devices)
        cls.words = SMALL + ["--technique", "direct" if hardware else "raymarch"]

    def render(self, *words, code=0):
        return self.isorast("render", *self.words, *words, code=code)

    def test_default_output_and_summary(self):
        out, err = self.render("sphere:16")
        self.assertEqual(err, "")
        self.assertRegex(out, r"\Asphere-16\.png  96x64  iso \S+  \w+, \w+ rasterizer  .+  \d+\.\d\d s\n\Z")
        self.assertEqual(size_of(self.read("sphere-16.png")), (96, 64))
        self.assertEqual(os.listdir(self.folder.name), ["sphere-16.png"])  # nothing temporary

    def test_order_of_arguments(self):
        self.render("sphere:16", "--iso", "0.25", "-o", "a.png")
        self.isorast("--iso", "0.25", *self.words, "-o", "b.png", "sphere:16", "render")
        self.assertEqual(self.read("a.png"), self.read("b.png"))

    def test_picture_on_standard_output(self):
        self.render("sphere:16", "-o", "a.png")
        out, err = self.isorast("render", *self.words, "sphere:16", "-o", "-", binary=True)
        self.assertEqual(out, self.read("a.png"))
        self.assertIn("96x64", err)

    def test_streams_that_cannot_be_written(self):
        words = ["render", *self.words, "gyroid:16:steps=2", "--iso", "0", "-o"]
        self.isorast(*words, "good.png")
        for redirection in ["2>/dev/full", "2>&-"]:
            self.assertEqual(self.shell(f'"$@" {redirection}', *words, "out.png").returncode, 0)
            self.assertEqual(self.read("out.png"), self.read("good.png"))
            os.remove(self.path("out.png"))
            self.assertEqual(self.shell(f'"$@" {redirection}', *words, "-").stdout, self.read("good.png"))
        for redirection in [">/dev/full", ">&-"]:
            done = self.shell(f'"$@" {redirection}', *words, "-")
            self.assertEqual(done.returncode, 1)
            self.assertIn(b"isorast: error: standard output: cannot be written: ", done.stderr)

    def test_json(self):
        found = json.loads(self.render("torus:24", "--json", "--repeat", "3", "-o", "t.png")[0])
        self.assertEqual((found["output"], found["size"], found["frames"]), ("t.png", [96, 64], 3))
        self.assertGreater(len(found["passes"]), 0)
        self.assertGreater(found["blocks_active"], 0)
        table = self.render("torus:24", "--stats")[0]
        for item in found["passes"]:
            self.assertIn(item["name"], table)

    def test_background(self):
        self.write("white.png", png(96, 64, [255, 255, 255, 255]))
        self.write("blue.png", png(96, 64, [0, 0, 0x80, 255]))
        self.write("clear.png", png(96, 64, [255, 255, 255, 0]))
        for words, expected in [([], "white"), (["--background", "#000080"], "blue"), (["--transparent"], "clear")]:
            _, err = self.render("sphere:16", "--iso", "9", *words, "-o", "out.png")
            self.assertRegex(err, r"\Aisorast: note: sphere:16: no surface at 9: [^\n]+\n\Z")
            self.isorast("compare", "out.png", f"{expected}.png")

    def test_pictures_differ_by_view_color_and_isovalue(self):
        views = [[], ["--azimuth", "75"], ["--view", "-x"], ["--roll", "45"], ["--zoom", "2"], ["--orthographic"],
                 ["--camera-position", "4,1,2"], ["--color", "red"], ["--shading", "normals"], ["--iso", "0.4"],
                 ["--iso", "0.4,0.1"], ["--fov", "60"]]
        pictures = set()
        for number, words in enumerate(views):
            self.render("marschner-lobb:24", *words, "-o", f"{number}.png")
            pictures.add(self.read(f"{number}.png"))
        self.assertEqual(len(pictures), len(views))

    def test_stereo(self):
        out, _ = self.render("torus:24", "-o", "both.png", "--stereo", "side-by-side")
        self.assertIn("both.png  192x64  ", out)
        self.assertEqual(size_of(self.read("both.png")), (192, 64))
        out, _ = self.render("torus:24", "-o", "eyes.png", "--stereo", "layers", "--eye-separation", "0.3", "--convergence", "4")
        self.assertIn("2 pictures, eyes.left.png to eyes.right.png  96x64  ", out)
        self.assertNotEqual(self.read("eyes.left.png"), self.read("eyes.right.png"))
        self.render("torus:24", "-o", "glasses.png", "--stereo", "anaglyph")
        self.assertEqual(size_of(self.read("glasses.png")), (96, 64))

    def test_clip_planes(self):
        self.render("sphere:17", "-o", "whole.png")
        # The middle of 17 voxels over [-1, 1] in each of the ways to say so.
        for number, words in enumerate([["--clip", "y>0"], ["--clip", "j>8"], ["--clip", "y>50%"], ["--clip", "j>50%"]]):
            self.render("sphere:17", *words, "-o", f"{number}.png")
            self.isorast("compare", f"{number}.png", "0.png", "--tolerance", "1")
        self.isorast("compare", "0.png", "whole.png", code=1)
        self.render("sphere:17", "--clip", "y>0", "--clip", "x<0.2,z<0.2", "-o", "three.png")
        self.isorast("compare", "0.png", "three.png", code=1)

    def test_a_surface_out_of_view_is_noted(self):
        clipped = "isorast: note: sphere:16: only background: --clip leaves nothing that the camera sees\n"
        for words in [[], ["--background", "#804020"], ["--transparent"], ["--stereo", "side-by-side"],
                      ["--stereo", "anaglyph", "--background", "#804020"], ["--shading", "depth"], ["--repeat", "2"]]:
            with self.subTest(words=words):
                self.assertEqual(self.render("sphere:16", "--clip", "x>1e9", *words, "-o", "a.png")[1], clipped)
        _, err = self.render("sphere:16", "--camera-position", "9,0,0", "--camera-target", "10,0,0")
        self.assertEqual(err, "isorast: note: sphere:16: only background: the camera sees no surface\n")
        for words in [["--clip", "x>0"], ["--background", "#804020"], ["--stereo", "anaglyph"], ["--transparent"]]:
            self.assertEqual(self.render("sphere:16", *words)[1], "")
        # One reason is enough.
        _, err = self.render("sphere:16", "--clip", "x>1e9", "--iso", "9")
        self.assertRegex(err, r"\Aisorast: note: sphere:16: no surface at 9: [^\n]+\n\Z")
        # Of a series, some pictures may be empty.
        for step, value in enumerate([0, 200]):
            self.write(f"t{step}_8x8x8_uint8.raw", bytes(255 if at == 0 else value if at == 292 else 10 for at in range(512)))
        _, err = self.render("t0_8x8x8_uint8.raw", "t1_8x8x8_uint8.raw", "--time", "all", "--iso", "100",
                             "--clip", "i>2", "-o", "f{frame}.png")
        self.assertEqual(err, "")

    def test_culling_changes_no_pixel(self):
        for word in ["off", "hiz", "auto"]:
            found = json.loads(self.render("gyroid:40", "--culling", word, "--json", "-o", f"{word}.png")[0])
            if word == "hiz" or word == "off":
                self.assertEqual(found["culling"], word)
            self.isorast("compare", f"{word}.png", "off.png")

    def test_reference(self):
        self.render("sphere:16", "-o", "good.png")
        self.render("sphere:16", "-o", "again.png", "--reference", "good.png")
        self.assertFalse(os.path.exists(self.path("again.difference.png")))
        _, err = self.render("sphere:16", "--zoom", "0.5", "-o", "other.png", "--reference", "good.png", code=1)
        self.assertIn("other.difference.png", err)
        self.assertEqual(size_of(self.read("other.difference.png")), (96, 64))
        self.render("sphere:16", "--zoom", "0.5", "--reference", "good.png", "--tolerance", "255")
        self.render("sphere:16", "--reference", "none.png", code=1)

    def test_time_steps(self):
        steps = "gyroid:24:steps=6"
        found = json.loads(self.render(steps, "--iso", "0", "-o", "f{frame:3}.png", "--json")[0])
        self.assertEqual(found["outputs"], [f"f00{step}.png" for step in range(6)])
        self.assertEqual((found["time_steps"], found["resident_steps"]), ([0, 1, 2, 3, 4, 5], 6))
        self.assertEqual(len({self.read(name) for name in found["outputs"]}), 6)
        out, _ = self.render(steps, "--iso", "0", "--time", "5:1:-2", "-o", "t{time}_{frame:2}.png", "--stats")
        self.assertIn("3 pictures, t5_00.png to t1_02.png", out)
        self.assertIn("time steps 3", out)
        # The same camera for any part of the series.
        for time, picture in [(5, "t5_00.png"), (3, "t3_01.png"), (1, "t1_02.png")]:
            self.isorast("compare", picture, f"f00{time}.png")
        self.render(steps, "--iso", "0", "--time", "all")
        self.assertTrue(os.path.exists(self.path("gyroid-24-steps=6_0005.png")))
        self.render(steps, "--iso", "0", "--time", "0:2", "--repeat", "2", "-o", "r{frame:3}.png",
                    "--reference", "f{frame:3}.png")
        self.render(steps, "--iso", "0", "--time", "1:3", "-o", "r{frame:3}.png", "--reference", "f{frame:3}.png", code=1)

    def test_one_time_step(self):
        _, err = self.render("gyroid:24:steps=6", "--iso", "0", "-o", "first.png")
        self.assertRegex(err, r"time step 0 of 0 to 5; choose with --time")
        _, err = self.render("gyroid:24:steps=6", "--iso", "0", "--time", "0", "-o", "0.png")
        self.assertEqual(err, "")
        self.assertEqual(self.read("first.png"), self.read("0.png"))
        self.render("gyroid:24:steps=6", "--iso", "0", "--time", "3", "-o", "3.png")
        self.assertNotEqual(self.read("3.png"), self.read("0.png"))

    def test_a_directory_and_files(self):
        os.mkdir(self.path("run"))
        for step in [2, 10, 1]:
            self.write(f"run/t{step}_8x8x8_uint8.raw",
                       bytes(255 if (x - 4) ** 2 + (y - 4) ** 2 + (z - 4) ** 2 < 2 + step else 0
                             for z in range(8) for y in range(8) for x in range(8)))
        words = ["--iso", "128", "--shading", "normals"]
        self.render("run", *words, "-o", "d{frame}.png")
        self.render("run/t1_8x8x8_uint8.raw", "run/t2_8x8x8_uint8.raw", "run/t10_8x8x8_uint8.raw", *words,
                    "--time", "all", "-o", "f{frame}.png")
        for frame in range(3):
            self.assertEqual(self.read(f"d{frame}.png"), self.read(f"f{frame}.png"))
        self.assertEqual(len({self.read(f"d{frame}.png") for frame in range(3)}), 3)
        self.assertIn("3, this is 1 of 0 to 2", self.isorast("info", "run", "--time", "1")[0])
        self.write("run/t3_8x8x4_uint8.raw", bytes(256))
        _, err = self.render("run", *words, "--time", "all", "-o", "x{frame}.png", code=1)
        self.assertRegex(err, r"\Aisorast: error: run/t3_8x8x4_uint8.raw: expected the dimensions of "
                              r"run/t1_8x8x8_uint8.raw, 8x8x8, found 8x8x4; [^\n]+\n\Z")
        self.assertFalse(os.path.exists(self.path("x0.png")))

    def test_time_errors(self):
        for words in [["-o", "one.png"], ["-o", "-"], ["-o", "f{frame:x}.png"], ["--reference", "one.png"]]:
            self.render("sphere:8:steps=3", "--time", "all", *words, code=2)
        _, err = self.render("sphere:8:steps=3", "--time", "1:3", code=1)
        self.assertRegex(err, r"holds 3 time steps, counted from 0; --time 1:3 was asked for\n\Z")
        self.isorast("info", "sphere:8:steps=3", "--time", "all", code=2)

    def test_notes(self):
        self.assertIn("1 voxel thin along y", self.render("sphere:16x1x16")[1])

    def test_validation_layer_is_silent(self):
        words = [*self.words, "gyroid:24", "--validation"]
        done = subprocess.run([ISORAST, "render", *words], cwd=self.folder.name, capture_output=True, timeout=300)
        if done.returncode and b"VK_LAYER_KHRONOS_validation" in done.stderr:
            self.skipTest("the validation layer is not installed")
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_other_words_than_the_defaults(self):
        self.isorast("render", *SMALL, "sphere:16", "--orthographic", "--culling", "off", "--stats", "--exact",
                     "--technique", "raymarch", "--rasterizer", "compute", "--device", "0",
                     "--shading", "depth", "--max-brick-side", "64")

    def test_what_does_not_fit(self):
        _, err = self.render("sphere:600", "--max-brick-side", "35", code=1)
        self.assertRegex(err, r"\Aisorast: error: sphere:600: needs [0-9.]+ GiB on .+ in \d+ bricks, \d+ more than fit; .+\n\Z")

    def test_errors(self):
        for words in [["none.raw"], ["sphere:16", "-o", "no/such/folder.png"], ["sphere:16", "--device", "none"],
                      ["sphere:16", "--view", "A"], ["sphere:16", "--camera-position", "0,0,3", "--camera-up", "0,0,1"]]:
            _, err = self.render(*words, code=1)
            self.assertRegex(err, r"isorast: error: [^\n]+\n\Z")
        self.assertEqual([name for name in os.listdir(self.folder.name) if "tmp" in name], [])


class Mesh(CommandLine):
    @classmethod
    def setUpClass(cls):
        done = subprocess.run([ISORAST, "devices", "--json"], capture_output=True, timeout=60)
        if done.returncode or not any(device["compute"] for device in json.loads(done.stdout)):
            raise unittest.SkipTest("no Vulkan device")

    def test_summary_and_json(self):
        out, err = self.isorast("mesh", "torus:24", "--iso", "0", "-o", "t.stl")
        self.assertEqual(err, "")
        self.assertRegex(out, r"\At\.stl  iso 0  \d+ triangles  \d+ vertices  [\d.]+ KiB  "
                              r"lengths in unknown units  .+  \d+\.\d\d s\n\Z")
        self.assertEqual(os.listdir(self.folder.name), ["t.stl"])  # nothing temporary
        found = json.loads(self.isorast("--json", "-o", "t.ply", "mesh", "torus:24", "--iso", "0")[0])
        self.assertEqual((found["triangles"], found["bytes"]), (2 * found["vertices"], len(self.read("t.ply"))))
        self.assertEqual(len(self.read("t.stl")), 84 + 50 * found["triangles"])
        self.assertTrue(found["surfaces"][0]["closed"])

    def test_several_isovalues(self):
        out, _ = self.isorast("mesh", "sphere:24", "--iso", "0.25,0.5", "-o", "s.obj", "--stats")
        self.assertEqual(len(out.splitlines()), 3)
        self.assertEqual(self.read("s.obj").count(b"\no iso_"), 2)
        _, err = self.isorast("mesh", "sphere:24", "--iso", "0.25,0.5", "-o", "s.stl", code=1)
        self.assertIn("STL holds one surface", err)

    def test_errors(self):
        self.assertIn("--output", self.isorast("mesh", "sphere:8", code=2)[1])
        self.assertIn(".glb", self.isorast("mesh", "sphere:8", "-o", "a.step", code=2)[1])
        self.isorast("mesh", "sphere:8", "--iso", "abc", "-o", "a.stl", code=2)
        for words in [["none.raw", "-o", "a.stl"], ["sphere:16", "-o", "no/such/folder.stl"],
                      ["sphere:16", "--iso", "9", "-o", "a.stl"], ["sphere:16", "--device", "none", "-o", "a.stl"]]:
            _, err = self.isorast("mesh", *words, code=1)
            self.assertRegex(err, r"\Aisorast: error: [^\n]+\n\Z")
        self.assertEqual(os.listdir(self.folder.name), [])


if __name__ == "__main__":
    unittest.main()
