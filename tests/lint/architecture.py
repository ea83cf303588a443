# SPDX-License-Identifier: MIT
# The rules of docs/architecture.md that the sources alone can show: architecture.py ROOT
import pathlib
import re
import sys

# Which folders of src/ each may include; a technique may also include itself and techniques/technique.h.
ARROWS = {
    "volume": {"volume"},
    "gpu": {"gpu"},
    "shaders": {"shaders"},
    "grid": {"grid", "volume", "gpu", "shaders"},
    "passes": {"passes", "grid", "gpu", "shaders"},
    "image": {"image", "volume", "grid", "gpu", "passes", "shaders"},
    "techniques": {"techniques", "passes", "grid", "gpu", "shaders", "image"},
}
ONLY_IN_GPU = re.compile(r"\bvk(CreateInstance|CreateDevice|AllocateMemory|FreeMemory)\b")


def broken_rules(path, text):
    """Yield a line for each rule that this file of src/ breaks; `path` is relative to src/."""
    folder = path.parts[0]
    for include in re.findall(r'^\s*#include "([^"]+)"', text, re.MULTILINE):
        parts = include.split("/")
        if len(parts) == 1 or parts[0] not in ARROWS:
            continue  # generated SPIR-V, or a neighbour
        if parts[0] not in ARROWS[folder]:
            yield f"src/{folder} must not include src/{parts[0]}: {include}"
        if parts[0] == "techniques" and len(parts) > 2 and parts[1] != path.parts[1]:
            yield f"a technique must not include another: {include}"
    if folder != "gpu" and (call := ONLY_IN_GPU.search(text)):
        yield f"only src/gpu creates devices and memory: {call[0]}"
    if not text.startswith("// SPDX-License-Identifier: MIT\n"):
        yield "the first line must be: // SPDX-License-Identifier: MIT"


def main(root):
    source = root / "src"
    endings = {".cpp", ".h", ".glsl", ".comp", ".task", ".mesh", ".vert", ".frag"}
    files = [path for path in sorted(source.rglob("*")) if path.suffix in endings]
    broken = 0
    for path in files:
        for rule in broken_rules(path.relative_to(source), path.read_text()):
            broken += 1
            print(f"{path.relative_to(root)}: {rule}")
    for folder in sorted((source / "techniques").iterdir()):
        if folder.is_dir() and not (folder / "README.md").exists():
            broken += 1
            print(f"{folder.relative_to(root)}: expected a README.md that names the paper")
    print(f"{len(files)} files, {broken} rules broken")
    return 1 if broken or not files else 0


# The rules themselves: each planted fault is found.
FAULTS = [("volume/a.cpp", '#include "gpu/device.h"'), ("grid/a.cpp", "vkAllocateMemory(device);"),
          ("techniques/direct/a.comp", '#include "techniques/raymarch/step.glsl"')]
for name, line in FAULTS:
    assert list(broken_rules(pathlib.Path(name), f"// SPDX-License-Identifier: MIT\n{line}\n")), name
sys.exit(main(pathlib.Path(sys.argv[1])))
