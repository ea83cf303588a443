# SPDX-License-Identifier: MIT
# Validates the very words that the library embeds: spirv_val.py SPIRV_VAL FOLDER_OF_HEADERS
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

# SPIR-V's version word says which Vulkan the shader was compiled for (cmake/shaders.cmake).
ENVIRONMENTS = {0x00010300: "vulkan1.1", 0x00010500: "vulkan1.2"}


def is_valid(validator, name, words):
    with tempfile.NamedTemporaryFile(suffix=".spv") as binary:
        binary.write(struct.pack(f"<{len(words)}I", *words))
        binary.flush()
        command = [validator, "--target-env", ENVIRONMENTS[words[1]], "--scalar-block-layout", binary.name]
        result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        print(f"{name}: {result.stdout}{result.stderr}")
    return result.returncode == 0


validator, folder = sys.argv[1:]
results = []
for header in sorted(pathlib.Path(folder).glob("*.h")):
    for name, body in re.findall(r"uint32_t (\w+)\[\] = \{([^}]*)\}", header.read_text()):
        words = [int(word, 16) for word in re.findall(r"0x[0-9a-f]{8}", body)]
        results.append(is_valid(validator, name, words))
print(f"{len(results)} shaders, {results.count(False)} invalid")
sys.exit(0 if results and all(results) else 1)
