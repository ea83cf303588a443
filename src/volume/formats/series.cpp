// SPDX-License-Identifier: MIT
// Headers that spread the voxels over several files: by a numbered pattern, or by a list of names.
#include <cstdlib>

#include "volume/formats/data.h"

namespace isorast {
namespace {

constexpr size_t MOST_FILES = 1 << 16;

// The text around a pattern's one %d, and how that is to be printed: "%d", "%4d", "%03d".
struct Pattern {
    std::string_view before, after;
    size_t width = 0;
    char fill = ' ';
};

std::optional<Pattern> parse_pattern(std::string_view text) {
    const size_t percent = text.find('%');
    if (percent == std::string_view::npos) return std::nullopt;
    Pattern pattern;
    pattern.before = text.substr(0, percent);
    std::string_view rest = text.substr(percent + 1);
    if (rest.starts_with('0')) {
        pattern.fill = '0';
        rest.remove_prefix(1);
    }
    const size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    if (digits > 0) {
        const auto width = parse_number<uint32_t>(rest.substr(0, digits));
        if (!width || *width > 20) return std::nullopt;
        pattern.width = *width;
        rest.remove_prefix(digits);
    }
    if (!rest.starts_with('d') && !rest.starts_with('i') && !rest.starts_with('u'))
        return std::nullopt;
    pattern.after = rest.substr(1);
    if (pattern.after.find('%') != std::string_view::npos) return std::nullopt;
    return pattern;
}

std::string file_name(const Pattern& pattern, int64_t number) {
    std::string digits = std::to_string(number);
    if (digits.size() < pattern.width)
        digits.insert(0, pattern.width - digits.size(), pattern.fill);
    return fmt::format("{}{}{}", pattern.before, digits, pattern.after);
}

}  // namespace

std::vector<std::string> numbered_files(const std::string& header,
                                        const std::vector<std::string_view>& words) {
    const auto pattern = parse_pattern(words[0]);
    if (!pattern)
        fail(header, "the file pattern {} must hold one number, like %d or %03d", quoted(words[0]));
    int64_t numbers[3] = {0, 0, 1};
    if (words.size() < 3 || words.size() > 4)
        fail(header, "the file pattern {} needs its first and last number, and perhaps a step",
             quoted(words[0]));
    for (size_t i = 1; i < words.size(); ++i) {
        const auto number = parse_number<int32_t>(words[i]);
        if (!number)
            fail(header, "expected a whole number after the file pattern, found {}",
                 quoted(words[i]));
        numbers[i - 1] = *number;
    }
    const auto [first, last, step] = numbers;
    if (step == 0 || (step > 0 ? last < first : last > first))
        fail(header, "the file pattern's step {} does not lead from {} to {}", step, first, last);
    const int64_t count = (last - first) / step + 1;
    if (count > static_cast<int64_t>(MOST_FILES))
        fail(header, "{} data files; at most {} are read", count, MOST_FILES);
    std::vector<std::string> files;
    for (int64_t i = 0; i < count; ++i)
        files.push_back(beside(header, file_name(*pattern, first + i * step)));
    return files;
}

std::vector<std::string> listed_files(const std::string& header, Lines& lines) {
    std::vector<std::string> files;
    while (const auto line = lines.next()) {
        const std::string_view name = trimmed(*line);
        if (name.empty()) continue;
        if (files.size() == MOST_FILES) fail(header, "more than {} data files", MOST_FILES);
        files.push_back(beside(header, name));
    }
    return files;
}

}  // namespace isorast
