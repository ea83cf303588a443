// SPDX-License-Identifier: MIT
// The standard streams; see streams.h.
#include "streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <isorast/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace isorast::cli {
namespace {

[[noreturn]] void fail_to_write() {
    throw Error(fmt::format("standard output: cannot be written: {}",
                            std::generic_category().message(errno)));
}

void print_line(std::string_view kind, std::string_view text) {
    print_message(fmt::format("isorast: {}: {}\n", kind, escaped(text)));
}

}  // namespace

void occupy_closed_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0) continue;
        // The wrong way round, so that using it fails. The lowest free number is this one.
        if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream)
            throw Error("/dev/null: expected it to take the place of a closed standard stream");
    }
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_to_write();
}

void flush_output() {
    if (std::fflush(stdout) != 0) fail_to_write();
}

void print_message(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void note(std::string_view text) {
    print_line("note", text);
}

void print_error(std::string_view text) {
    print_line("error", text);
}

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '\n') {
            result += "\\n";
        } else if (c == '\t') {
            result += "\\t";
        } else if (c == '\r') {
            result += "\\r";
        } else if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') {
            result += fmt::format("\\x{:02x}", c);
        } else {
            result += c;
        }
    }
    return result;
}

}  // namespace isorast::cli
