// SPDX-License-Identifier: MIT
// From a camera and a volume's place in the world to what shaders need of a frame.
#pragma once
#include <isorast/renderer.h>

#include "grid/stored.h"
#include "shaders/shared.h"

namespace isorast {

// The volume's place in the world: all that a Renderer keeps of a Volume beside the Grid.
struct Placement {
    Affine affine;
    std::array<uint32_t, 3> dims{1, 1, 1};
};

// Throws Error for a frame that cannot be drawn: sizes, isovalues, cameras.
void check(const Frame& frame);
// What shaders have for a unit of length in the world, so that floats hold its powers whatever the
// data's unit is: the power of two below the volume's longest extent along an
// axis.
double world_unit(const Placement& placement);
shared::FrameInfo make_frame_info(const Frame& frame, const Placement& placement,
                                  const Stored& stored);

}  // namespace isorast
