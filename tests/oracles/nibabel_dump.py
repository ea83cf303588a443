# SPDX-License-Identifier: MIT
"""What nibabel makes of NIfTI files, as text for the reader tests: the lines of itk_dump, but in RAS."""

import sys

import nibabel
import numpy


def fnv1a_of_words(data):
    """64-bit FNV-1a over 8-byte words, the last one padded with zeros: byte by byte, Python takes too long."""
    data += b"\0" * (-len(data) % 8)
    hash = 14695981039346656037
    for word in numpy.frombuffer(data, "<u8").tolist():
        hash = (hash ^ word) * 1099511628211 % 2**64
    return hash


def dump(path):
    image = nibabel.load(path)
    raw = numpy.asarray(image.dataobj.get_unscaled())
    native = raw.astype(raw.dtype.newbyteorder("="))
    print("file", path)
    print("dims", *image.shape)
    print("type", native.dtype.name)
    print("affine", *(f"{x:.17g}" for x in image.affine[:3].ravel()))
    print("slope", image.dataobj.slope, image.dataobj.inter)
    print("units", image.header.get_xyzt_units()[0])
    print("codes", int(image.header["qform_code"]), int(image.header["sform_code"]))
    print(f"hash {fnv1a_of_words(native.tobytes(order='F')):016x}")


if __name__ == "__main__":
    for path in sys.argv[1:]:
        dump(path)
