// SPDX-License-Identifier: MIT
// The one exception type: a single line that says what, where, expected, found, and what to do.
#pragma once
#include <stdexcept>

namespace isorast {

struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace isorast
