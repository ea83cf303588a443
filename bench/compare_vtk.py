#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""isorast against VTK on the CPU: the same file, the same cameras, the same isovalues, in one run.

    bench/compare_vtk.py                                     a formula, 256^3 u8
    bench/compare_vtk.py bonsai_256x256x256_uint8.raw@40     raw files that tell their size by their names
    bench/compare_vtk.py --frames 6 --sizes 1280x720         fewer

Two cases: a new isovalue each frame ("sweep") and a moving camera ("orbit"), as isorast-bench draws them.
VTK draws its frames in two ways: vtkFlyingEdges3D and a draw, where only a new isovalue costs an extraction;
and vtkGPUVolumeRayCastMapper's isosurfaces, on llvmpipe. A picture whose silhouette is another than isorast's
is not timed. Then isorast, VTK, isorast again; times are wall clocks, means over the same frames. Markdown is
printed; FOLDER (-o) gets the JSON, the pictures and the formula's file.
"""
import argparse
import atexit
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError:
    vtk = None

WAYS = "direct compute,direct hardware,raymarch compute"
CASES = {"sweep": "new isovalue", "orbit": "moving camera"}
LEAST_OVERLAP = 0.98
LEAST_FRAMES, WARM_UP = 5, 2
BACKGROUND = (255, 0, 255)  # no light makes this of a grey surface


def fail(text):
    sys.exit(f"compare_vtk.py: error: {text}")


def run(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    if done.returncode:
        fail(f"{pathlib.Path(words[0]).name} failed: {(done.stderr or done.stdout).strip()}")


def start_display():
    """VTK's windows want an X server, even those off screen. One that resets when a window goes may hang the next."""
    missing = [] if vtk else ["python3-vtk9", "python3-numpy"]
    missing += [] if shutil.which("Xvfb") else ["xvfb"]
    if missing:
        fail(f"needs {' and '.join(missing)}, for {sys.executable}")
    reader, writer = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writer), "-noreset", "-nolisten", "tcp"], pass_fds=[writer],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    atexit.register(lambda: (server.terminate(), server.wait()))
    os.close(writer)
    number = os.read(reader, 16).decode().strip()
    if not number:
        fail("Xvfb does not start")
    os.environ.update(DISPLAY=f":{number}", LIBGL_ALWAYS_SOFTWARE="1", GALLIUM_DRIVER="llvmpipe")


# --- The volume -------------------------------------------------------------------------------------


def write_coral(folder, side):
    """A gyroid carved into a ball, like isorast's coral, with a bite taken out, so that no two sides look alike."""
    x = np.linspace(-1, 1, side, dtype=np.float32)
    z, y, x = np.meshgrid(x, x, x, indexing="ij", sparse=True)
    a, b, c = 14 * (x + 1), 14 * (y + 1), 14 * (z + 1)
    gyroid = np.sin(a) * np.cos(b) + np.sin(b) * np.cos(c) + np.sin(c) * np.cos(a)
    bite = 0.5 * np.sqrt((x - 0.5) ** 2 + (y + 0.6) ** 2 + (z - 0.4) ** 2) - 0.25
    steep = 3 * np.minimum(0.42 - 0.6 * np.sqrt(x * x + y * y + z * z), bite)
    value = 0.5 + np.minimum(steep, 0) + 0.22 * (0.6 * gyroid + np.clip(steep, 0, 0.35))
    path = folder / f"coral_{side}x{side}x{side}_uint8.raw"
    np.rint(255 * np.clip(value, 0, 1)).astype(np.uint8).tofile(path)
    return f"{path}@128"


def read_raw(path):
    sides = next((word.split("x") for word in path.stem.split("_") if word.count("x") == 2), None)
    if not sides or not path.stem.endswith("_uint8"):
        fail(f"{path}: expected a name such as bonsai_256x256x256_uint8.raw")
    image = vtk.vtkImageData()
    image.SetDimensions(*map(int, sides))
    image.GetPointData().SetScalars(numpy_to_vtk(np.fromfile(path, np.uint8), deep=True))
    return image


# --- isorast ----------------------------------------------------------------------------------------


def measure_isorast(options, volume, name):
    """What isorast-bench says of both cases: {(case, size, way): mean wall ms}, and the shots of each case."""
    counts = {"sweep": ["isovalue-sweep", "--sweep", f"0.2,0.8,{options.frames // 2 + 1}", "--frames", 4],
              "orbit": ["motion", "--degrees", 4, "--frames", 2 * options.frames]}
    times, shots, reports = {}, {}, {}
    for case, words in counts.items():
        path = options.output / f"{name}-{case}.json"
        run(options.build / "isorast-bench", *words, "--volumes", volume, "--sizes", options.sizes, "--sequences", case,
            "--ways", options.ways, "--warm-up", WARM_UP, "--warm-up-ms", 0, "--device", "cpu", "--shots", "-o", path)
        reports[case] = json.loads(path.read_text())
        for row in reports[case]["rows"]:
            times[case, f"{row['width']}x{row['height']}", row["way"]] = row["wall_ms"]
        for found in reports[case]["shots"]:
            shots[case, f"{found['width']}x{found['height']}"] = found["frames"]
    return times, shots, reports


def isorast_silhouette(options, path, size, shot, name):
    words = [f"--{option}={','.join(map(repr, shot[key]))}"
             for option, key in (("camera-position", "position"), ("camera-target", "target"),
                                 ("camera-up", "up"), ("iso", "isovalues"))]
    picture = options.output / f"{name}-isorast.png"
    run(options.build / "isorast", "render", path, *words, "--fov", shot["fov_degrees"], "--size", size,
        "--device", "cpu", "--transparent", "-o", picture)
    reader = vtk.vtkPNGReader()
    reader.SetFileName(str(picture))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, 3] > 0


# --- VTK --------------------------------------------------------------------------------------------


class Vtk:
    """A window off screen, and one way to draw frames into it."""

    def __init__(self, way, image, size):
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(*(channel / 255 for channel in BACKGROUND))
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*map(int, size.split("x")))
        self.window.AddRenderer(self.renderer)
        self.set_isovalue = getattr(self, way)(image)

    def flying_edges(self, image):
        contour = vtk.vtkFlyingEdges3D()
        contour.SetInputData(image)
        contour.ComputeNormalsOn()  # as smooth as isorast's
        contour.ComputeGradientsOff()
        contour.ComputeScalarsOff()
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(contour.GetOutputPort())
        mapper.ScalarVisibilityOff()
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        self.renderer.AddActor(actor)
        return lambda isovalue: contour.SetValue(0, isovalue)

    def ray_cast(self, image):
        mapper = vtk.vtkGPUVolumeRayCastMapper()
        mapper.SetInputData(image)
        mapper.SetBlendModeToIsoSurface()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.SetSampleDistance(0.5)  # voxels: their spacing is 1
        color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
        color.AddRGBPoint(0, 1, 1, 1)
        opacity.AddPoint(0, 1)
        volume = vtk.vtkVolume()
        volume.SetMapper(mapper)
        look = volume.GetProperty()
        look.SetColor(color)
        look.SetScalarOpacity(opacity)
        look.SetInterpolationTypeToLinear()
        look.ShadeOn()
        self.renderer.AddVolume(volume)
        return lambda isovalue: look.GetIsoSurfaceValues().SetValue(0, isovalue)

    def draw(self, shot):
        self.set_isovalue(shot["isovalues"][0])
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(shot["position"])
        camera.SetFocalPoint(shot["target"])
        camera.SetViewUp(shot["up"])
        camera.SetViewAngle(shot["fov_degrees"])
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        self.window.WaitForCompletion()

    def silhouette(self, shot, picture):
        self.draw(shot)
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        writer = vtk.vtkPNGWriter()
        writer.SetInputConnection(grab.GetOutputPort())
        writer.SetFileName(str(picture))
        writer.Write()
        return np.any(vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()) != BACKGROUND, axis=1)

    def measure(self, shots, seconds):
        """Milliseconds of each shot; of some of them only, evenly spread, where all would take too long."""
        def timed(shot):
            start = time.perf_counter()
            self.draw(shot)
            return 1000 * (time.perf_counter() - start)

        warm = [timed(shot) for shot in shots[:WARM_UP]]
        count = min(len(shots), max(LEAST_FRAMES, int(1000 * seconds / warm[-1])))
        return [timed(shots[i * len(shots) // count]) for i in range(count)]

    def driver(self):
        told = dict(line.split(":  ", 1) for line in self.window.ReportCapabilities().splitlines() if ":  " in line)
        return f"{told['OpenGL renderer string']}, {told['OpenGL version string']}"


VTK_WAYS = {"VTK flying edges": "flying_edges", "VTK ray cast": "ray_cast"}


def overlap(a, b):
    return float(np.sum(a & b) / max(1, np.sum(a | b)))


def measure_vtk(options, path, shots, name):
    """{(case, size, way): [ms of each frame]} for the ways whose pictures agree, and how well all do."""
    image = read_raw(path)
    times, agreement, driver = {}, {}, ""
    for (case, size), frames in shots.items():
        # The first and the last of the way there: both ends of the isovalues, and of the orbit.
        compared = [0, len(frames) // 2]
        pictures = [f"{name}-{case}-{size}-{at}" for at in compared]
        truth = [isorast_silhouette(options, path, size, frames[at], picture)
                 for at, picture in zip(compared, pictures)]
        for way in options.vtk_ways.split(","):
            method = VTK_WAYS[way]
            scene = Vtk(method, image, size)
            agreement[case, size, way] = min(
                overlap(true, scene.silhouette(frames[at], options.output / f"{picture}-{method}.png"))
                for true, at, picture in zip(truth, compared, pictures))
            if agreement[case, size, way] >= LEAST_OVERLAP:
                times[case, size, way] = scene.measure(frames, options.seconds)
            driver = scene.driver()
            scene.window.Finalize()
    return times, agreement, driver


# --- The comparison ---------------------------------------------------------------------------------


def rows_of(first, times, agreement, second):
    rows = []
    for case, size, way in [*agreement, *first]:
        row = {"case": case, "size": size, "way": way}
        if (case, size, way) in agreement:
            ms = times.get((case, size, way), [])
            row.update(overlap=agreement[case, size, way], frames=len(ms))
            if ms:
                row.update(mean_ms=float(np.mean(ms)), median_ms=float(np.median(ms)))
        else:
            rounds = [found[case, size, way] for found in (first, second) if (case, size, way) in found]
            row.update(rounds_ms=rounds, mean_ms=float(np.mean(rounds)))
        rows.append(row)
    for row in rows:
        best = [other["mean_ms"] for other in rows if other["way"] in VTK_WAYS and "mean_ms" in other
                and (other["case"], other["size"]) == (row["case"], row["size"])]
        if best and "mean_ms" in row:
            row["faster"] = min(best) / row["mean_ms"]
    return rows


def print_table(volume, rows, sizes):
    columns = [(case, size) for case in CASES for size in sizes]
    print(f"\n| {pathlib.Path(volume).name} | " + " | ".join(f"{CASES[case]}, {size}" for case, size in columns) + " |")
    print("|---" * (1 + len(columns)) + "|")
    for way in dict.fromkeys(row["way"] for row in rows):
        found = {(row["case"], row["size"]): row for row in rows if row["way"] == way}
        cells = [f"{row['mean_ms']:.0f} ms, {row['faster']:.2f}" if "faster" in row else "-"
                 for row in (found.get(column, {}) for column in columns)]
        print(f"| {way} | " + " | ".join(cells) + " |")
    checked = [row for row in rows if "overlap" in row]
    drawn = [row["frames"] for row in checked if row["frames"]] or [0]
    print(f"\nSilhouettes overlap by {min(row['overlap'] for row in checked):.4f} or more; VTK drew {min(drawn)} to"
          f" {max(drawn)} frames a cell.")
    drift = max(max(row["rounds_ms"]) / min(row["rounds_ms"]) - 1 for row in rows if "rounds_ms" in row)
    print(f"isorast's two rounds differ by {100 * drift:.0f} % at most.")
    for row in checked:
        if row["overlap"] < LEAST_OVERLAP:
            print(f"Left out: {row['way']}, {CASES[row['case']]}, {row['size']}: another picture than isorast's,"
                  f" silhouettes overlap by {row['overlap']:.3f}.")


def compare(options, volume):
    path = pathlib.Path(volume.rsplit("@", 1)[0])
    name = path.stem
    first, shots, reports = measure_isorast(options, volume, name)
    times, agreement, driver = measure_vtk(options, path, shots, name)
    second = measure_isorast(options, volume, name)[0]
    rows = rows_of(first, times, agreement, second)
    bench = reports["sweep"]
    return {"volume": path.name, "vtk": vtk.vtkVersion().GetVTKVersion(), "vtk_driver": driver,
            "threads": vtk.vtkSMPTools.GetEstimatedNumberOfThreads(), "device": bench["device"],
            "driver": bench["driver"], "commit": bench["commit"], "rows": rows}


def main():
    parser = argparse.ArgumentParser(description="isorast against VTK on the CPU.")
    here = pathlib.Path(__file__).resolve().parents[1]
    parser.add_argument("volumes", nargs="*", metavar="FILE[@ISOVALUE]",
                        help="NAME_WxHxD_uint8.raw; default: a formula")
    parser.add_argument("--sizes", default="1280x720,3840x2160")
    parser.add_argument("--ways", default=WAYS, help="isorast's, as for isorast-bench")
    parser.add_argument("--vtk-ways", default=",".join(VTK_WAYS),
                        help="the ray cast takes a minute a frame at 3840x2160")
    parser.add_argument("--side", type=int, default=256, help="of the formula's volume")
    parser.add_argument("--frames", type=int, default=20, help="of each case, even")
    parser.add_argument("--seconds", type=float, default=120, help="a VTK row that takes longer has fewer frames, "
                        f"at least {LEAST_FRAMES}")
    parser.add_argument("--build", type=pathlib.Path, default=here / "build",
                        help="where isorast and isorast-bench are")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=here / "out/vtk", metavar="FOLDER")
    options = parser.parse_args()
    start_display()
    for program in ("isorast", "isorast-bench"):
        if not (options.build / program).exists():
            fail(f"{options.build / program}: not there; build it, or say where with --build")
    options.output.mkdir(parents=True, exist_ok=True)
    found = []
    for volume in options.volumes or [write_coral(options.output, options.side)]:
        found.append(compare(options, volume))
        head = found[-1]
        if len(found) == 1:
            print(f"isorast {head['commit']} on {head['device']}, {head['driver']}; VTK {head['vtk']} on"
                  f" {head['vtk_driver']}, {head['threads']} threads. In cells: mean wall clock of a frame, and how"
                  " many times faster than VTK's best.")
        print_table(volume, head["rows"], options.sizes.split(","))
        (options.output / "compare_vtk.json").write_text(json.dumps(found, indent=1) + "\n")


main()
