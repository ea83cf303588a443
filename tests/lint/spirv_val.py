# SPDX-License-Identifier: MIT
# Validates the very words that the library embeds: spirv_val.py SPIRV_VAL FOLDER_OF_HEADERS
import pathlib
import re
import struct
import subprocess
import sys

# SPIR-V's version word says which Vulkan the shader was compiled for (cmake/shaders.cmake).
ENVIRONMENTS = {0x00010300: "vulkan1.1", 0x00010500: "vulkan1.2"}

validator, folder = sys.argv[1:]
headers = sorted(pathlib.Path(folder).glob("*.h"))
failures = 0
for header in headers:
    words = [int(word, 16) for word in re.findall(r"\b0x[0-9a-fA-F]{8}\b", header.read_text())]
    binary = header.with_suffix(".spv")
    binary.write_bytes(struct.pack(f"<{len(words)}I", *words))
    command = [validator, "--target-env", ENVIRONMENTS[words[1]], "--scalar-block-layout", str(binary)]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        failures += 1
        print(f"{header.stem}: {result.stdout}{result.stderr}")
print(f"{len(headers)} shaders, {failures} invalid")
sys.exit(1 if failures or not headers else 0)
