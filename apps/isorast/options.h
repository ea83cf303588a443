// SPDX-License-Identifier: MIT
// What the commands share: how a command looks, the options that say how to read a volume, and
// words turned into values and back.
#pragma once
#include <isorast/isorast.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "streams.h"

namespace isorast::cli {

using Json = nlohmann::ordered_json;

// One command: its constructor adds its options to `app`, run() returns the exit code (0 or 1).
struct Command {
    explicit Command(CLI::App& its_app) : app(its_app) {}
    virtual ~Command() = default;
    virtual int run() = 0;

    CLI::App& app;
};

std::unique_ptr<Command> make_render(CLI::App& parent);
std::unique_ptr<Command> make_mesh(CLI::App& parent);
std::unique_ptr<Command> make_info(CLI::App& parent);
std::unique_ptr<Command> make_devices(CLI::App& parent);
std::unique_ptr<Command> make_compare(CLI::App& parent);

// INPUT, the options of LoadOptions, and which time steps.
struct VolumeArguments {
    std::vector<std::string> inputs;
    LoadOptions load;
    std::string time;      // "3", "all", "2:10", "0:30:5"; see frames.h
    std::string as_typed;  // all of this once more, for a command line to copy

    void add_to(CLI::App& app);
};

// --iso, as typed; and what the words mean in a volume.
void add_isovalues(CLI::App& app, std::vector<std::string>& words);
std::vector<double> isovalues_of(const std::vector<std::string>& words, const Volume& volume);

// "1280x720", "0.5,0.5,2": `count` numbers between 'x' or ','. Throws CLI::ValidationError.
std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count);
std::vector<uint32_t> parse_counts(const std::string& option, const std::string& text,
                                   size_t count);
// "#rgb", "#rrggbb", or one of a few names; throws CLI::ValidationError that lists them.
Color parse_color(const std::string& option, const std::string& text);

std::string human_bytes(uint64_t bytes);
// `text` as the shell wants it, quoted if need be.
std::string shell_word(const std::string& text);
// "max 3  rms 0.12  1234 of 921600 pixels (0.13 %) differ by more than 2"
std::string text_of(const Difference& difference, Size size, double tolerance);
Json json_of(const Difference& difference, double tolerance);
std::string text_of(const Json& json);  // indented; bytes that are no UTF-8 are replaced

}  // namespace isorast::cli
