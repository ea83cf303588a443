// SPDX-License-Identifier: MIT
// Names of units, as headers spell them.
#pragma once
#include <string>
#include <string_view>

namespace isorast {

// The name as UTF-8 without control characters, at most 16 bytes.
std::string unit_name(std::string_view text);
// "m", "cm", "mm", "um" or "nm" for any usual spelling of these, else the name as it is.
std::string length_unit(std::string_view text);

}  // namespace isorast
