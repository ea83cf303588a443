// SPDX-License-Identifier: MIT
// Time steps and picture names; see frames.h.
#include "frames.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <set>

namespace isorast::cli {
namespace {

constexpr const char* FORM =
    "expected a time step from 0, FIRST:LAST, FIRST:LAST:STEP or all, found \"{}\"";

// The numbers between the colons; nothing for other texts.
std::optional<std::vector<int64_t>> split_steps(const std::string& text) {
    std::vector<int64_t> numbers;
    const char *at = text.data(), *const end = at + text.size();
    for (;;) {
        int64_t number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
        const bool is_stride = numbers.size() == 2;
        if (error != std::errc{} || number > UINT32_MAX || number < -int64_t{UINT32_MAX} ||
            (is_stride ? number == 0 : number < 0))
            return std::nullopt;
        numbers.push_back(number);
        if (next == end) return numbers;
        if (*next != ':' || numbers.size() == 3) return std::nullopt;
        at = next + 1;
    }
}

// Replaces {word} and {word:N} everywhere.
std::string replaced(const std::string& option, std::string text, const std::string& word,
                     uint64_t number) {
    for (size_t at = 0; (at = text.find("{" + word, at)) != std::string::npos;) {
        const size_t after = at + 1 + word.size(), close = text.find('}', after);
        if (close == std::string::npos) break;
        const std::string width = text.substr(after, close - after);
        uint32_t digits = 1;
        if (!width.empty()) {
            const char* end = width.data() + width.size();
            const auto [next, error] = std::from_chars(width.data() + 1, end, digits);
            if (width[0] != ':' || error != std::errc{} || next != end || digits > 20)
                throw CLI::ValidationError(
                    option, fmt::format("expected {{{0}}} or {{{0}:4}}, found \"{1}\"", word,
                                        text.substr(at, close + 1 - at)));
        }
        const std::string shown = fmt::format("{:0{}}", number, digits);
        text.replace(at, close + 1 - at, shown);
        at += shown.size();
    }
    return text;
}

}  // namespace

std::string check_steps(const std::string& text) {
    if (text == "all") return "";
    const auto numbers = split_steps(text);
    if (!numbers) return fmt::format(fmt::runtime(FORM), text);
    if (numbers->size() == 1) return "";
    const int64_t stride = numbers->size() == 3 ? (*numbers)[2] : 1;
    if (((*numbers)[1] - (*numbers)[0]) * stride < 0)
        return fmt::format("the steps of {} do not lead from {} to {}", text, (*numbers)[0],
                           (*numbers)[1]);
    return "";
}

std::vector<uint32_t> parse_steps(const Series& series, const std::string& text, bool all) {
    std::vector<int64_t> numbers{0};
    if (text == "all" || (text.empty() && all))
        numbers = {0, int64_t{series.steps} - 1};
    else if (!text.empty())
        numbers = split_steps(text).value();
    const int64_t first = numbers[0], last = numbers.size() > 1 ? numbers[1] : first;
    const int64_t stride = numbers.size() > 2 ? numbers[2] : 1;
    if (std::max(first, last) >= series.steps)
        throw Error(fmt::format("{}: holds {} time step{}, counted from 0; --time {} was asked for",
                                series.name, series.steps, series.steps == 1 ? "" : "s", text));
    std::vector<uint32_t> steps;
    for (int64_t step = first; stride > 0 ? step <= last : step >= last; step += stride)
        steps.push_back(static_cast<uint32_t>(step));
    return steps;
}

Series chosen_steps(const Series& series, const std::vector<uint32_t>& steps, const Volume& first) {
    Series chosen = isorast::chosen_steps(series, steps);
    const Series in_memory = series_of({&first, 1});
    chosen.load = [in_memory, load = chosen.load](uint32_t step) {
        return step == 0 ? in_memory.load(0) : load(step);
    };
    return chosen;
}

bool names_frames(const std::string& pattern) {
    return pattern.find("{frame") != std::string::npos ||
           pattern.find("{time") != std::string::npos;
}

std::vector<std::string> picture_names(const std::string& option, const std::string& pattern,
                                       const std::vector<uint32_t>& steps) {
    std::vector<std::string> names;
    for (size_t frame = 0; frame < steps.size(); ++frame)
        names.push_back(
            replaced(option, replaced(option, pattern, "frame", frame), "time", steps[frame]));
    if (std::set<std::string>(names.begin(), names.end()).size() < names.size())
        throw CLI::ValidationError(
            option, fmt::format("expected a name for each of {} pictures, found \"{}\"; put "
                                "{{frame:4}} or {{time:4}} in it",
                                names.size(), pattern));
    return names;
}

Progress::Progress(size_t total) : total_(total), shown_(total > 1 && isatty(STDERR_FILENO)) {}

Progress::~Progress() {
    if (shown_ && done_ > 0) print_message("\r\033[K");
}

void Progress::done() {
    ++done_;
    if (!shown_) return;
    constexpr size_t WIDTH = 40;
    const size_t filled = WIDTH * done_ / total_;
    print_message(
        fmt::format("\r[{:=<{}}{:<{}}] {} of {}", "", filled, "", WIDTH - filled, done_, total_));
}

}  // namespace isorast::cli
