// SPDX-License-Identifier: MIT
// Small pieces of text parsing that headers, file names and isovalues share.
#pragma once
#include <fmt/format.h>
#include <isorast/error.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace isorast {

// "FILE: what is wrong with it".
template <class... Args>
[[noreturn]] void fail(std::string_view file, fmt::format_string<Args...> format, Args&&... args) {
    throw Error(fmt::format("{}: {}", file, fmt::format(format, std::forward<Args>(args)...)));
}

std::string_view trimmed(std::string_view text);
std::string lowercase(std::string_view text);
// Words between any of the separators; no empty ones.
std::vector<std::string_view> split(std::string_view text, std::string_view separators = " \t");
// In quotes, at most 60 characters, none of them unprintable: foreign text for a one-line message.
std::string quoted(std::string_view text);
// An order in which numbers in names count as numbers: t2 comes before t10.
bool comes_before(std::string_view a, std::string_view b);

// The whole word is a number of type T, in range; NaN and infinities pass for floating-point types.
template <class T>
std::optional<T> parse_number(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    T number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return number;
}

// The lines of a text, without their ends (\n or \r\n).
class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {}
    std::optional<std::string_view> next();
    size_t consumed() const { return at_; }  // bytes, line ends included

private:
    std::string_view text_;
    size_t at_ = 0;
};

}  // namespace isorast
