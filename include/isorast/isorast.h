// SPDX-License-Identifier: MIT
// isorast: isosurfaces straight from voxels to pixels. Everything for most programs.
#pragma once
#include <isorast/camera.h>
#include <isorast/error.h>
#include <isorast/gpu.h>
#include <isorast/image.h>
#include <isorast/load.h>
#include <isorast/mesh.h>
#include <isorast/renderer.h>
#include <isorast/series.h>
#include <isorast/volume.h>
