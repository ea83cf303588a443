// SPDX-License-Identifier: MIT
// Tables of what was measured, by lane: graphics against graphics, compute against compute, and
// the best of each technique.
#pragma once
#include "settings.h"

namespace isorast::bench {

// Of one volume: the rows from `first` on.
void print_tables(const Json& rows, size_t first);

}  // namespace isorast::bench
