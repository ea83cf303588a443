// SPDX-License-Identifier: MIT
// What a rasterizer wants of the lists of blocks.
#pragma once
#include <cstdint>

namespace isorast {

// How workgroups share the blocks of a list, which holds quartets of them.
struct Workgroups {
    // For a block that is large in the picture; such blocks get a list of their own. 0: they do
    // not, and each block of any quartet has a workgroup.
    uint32_t for_large;
    // The first quartets of a list, which have a workgroup for each block. The others, drawn before
    // those, have one for all four: half of four would find nothing to do. But such a workgroup
    // takes long; many short ones at the end keep a GPU busy until the last is done.
    uint32_t spread;
    // If not 0, no more than so many take all quartets, each in turn.
    uint32_t most;
};

}  // namespace isorast
