// SPDX-License-Identifier: MIT
// Two eyes' pictures in one.
#pragma once
#include <isorast/renderer.h>

namespace isorast {

// From the left eye's picture above the right eye's to what `mode` says.
Image arrange(Image layers, StereoMode mode);

}  // namespace isorast
