// SPDX-License-Identifier: MIT
// UTF-8, which the files that we write ask for, and foreign text that may be something else.
#pragma once
#include <string>
#include <string_view>

namespace isorast {

bool is_utf8(std::string_view text);
// The text as it is where that is UTF-8, else read as Latin-1, in which each byte is a character.
std::string as_utf8(std::string_view text);

}  // namespace isorast
