// SPDX-License-Identifier: MIT
// The standard streams. Output that is lost is an error; a message that is lost stops nothing.
#pragma once
#include <string>
#include <string_view>

namespace isorast::cli {

// Occupies those of the descriptors 0, 1 and 2 that are closed, so that no file or driver gets
// them, with something that can be neither read nor written. Before anything else.
void occupy_closed_streams();

// On standard output. Throws Error when it cannot be written; some of it is written later, when
// flush_output() throws.
void print(std::string_view text);
void flush_output();

// On stderr, as it is.
void print_message(std::string_view text);
// One line on stderr: "isorast: note: ...", with the control characters of `text` escaped.
void note(std::string_view text);
void print_error(std::string_view text);  // "isorast: error: ..."
// As in "line one\nline \x1b[2J": in a terminal such a text could pass for others or move the
// cursor.
std::string escaped(std::string_view text);

}  // namespace isorast::cli
