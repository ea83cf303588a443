// SPDX-License-Identifier: MIT
// The command line. Exit codes: 0 done, 1 an error or a failed comparison, 2 wrong usage.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "options.h"

namespace isorast::cli {
namespace {

constexpr int WRONG_USAGE = 2;

// The number of single-letter edits between two words (Levenshtein).
size_t edits(const std::string& a, const std::string& b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        size_t diagonal = std::exchange(row[0], i);
        for (size_t j = 1; j <= b.size(); ++j) {
            const size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = std::exchange(row[j], std::min({row[j], row[j - 1], diagonal}) + 1);
            row[j] = std::min(row[j], replaced);
        }
    }
    return row.back();
}

// ", did you mean X?" for the closest of `words`, or nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
    std::string best;
    size_t fewest = 3;
    for (const std::string& candidate : words) {
        if (const size_t n = edits(word, candidate); n < fewest) {
            fewest = n;
            best = candidate;
        }
    }
    return best.empty() ? "" : fmt::format("; did you mean {}?", best);
}

int wrong_usage(const std::string& message, const std::string& command) {
    print_error(message);
    print_message(fmt::format("Try: isorast {}--help\n", command.empty() ? "" : command + " "));
    return WRONG_USAGE;
}

int unexpected(const CLI::App& command) {
    const std::string word = command.remaining().empty() ? "" : command.remaining().front();
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    }
    const std::string name = word.substr(0, word.find('='));
    return wrong_usage(fmt::format("{} was not expected{}", word, did_you_mean(name, names)),
                       command.get_name());
}

// Options may stand before the command's name: move the name to the front. False where there is
// none.
bool command_first(std::vector<std::string>& arguments, const std::vector<std::string>& names) {
    const auto is_command = [&](const std::string& word) {
        return std::ranges::find(names, word) != names.end();
    };
    const auto at = std::ranges::find_if(arguments, is_command);
    if (at == arguments.end()) return false;
    std::rotate(arguments.begin(), at, at + 1);
    return true;
}

int no_command(const std::vector<std::string>& arguments, const std::vector<std::string>& names) {
    const std::string list = fmt::format("{}", fmt::join(names, ", "));
    const auto word = std::ranges::find_if(
        arguments, [](const std::string& argument) { return !argument.starts_with('-'); });
    if (word == arguments.end()) return wrong_usage("expected a command: " + list, "");
    if (is_procedural(*word) || std::filesystem::exists(*word)) {
        return wrong_usage(
            fmt::format("expected a command: {}; to see this volume: isorast render {}", list,
                        shell_word(*word)),
            "");
    }
    const std::string hint = did_you_mean(*word, names);
    return wrong_usage(fmt::format("\"{}\" is no command{}", *word,
                                   hint.empty() ? "; expected one of " + list : hint),
                       "");
}

// CLI11 would take the next word as the value of "--name=". Empty where no argument is like that.
std::string option_without_value(const std::vector<std::string>& arguments) {
    for (const std::string& word : arguments) {
        if (word == "--") break;
        if (word.starts_with("--") && word.find('=') == word.size() - 1)
            return word.substr(0, word.size() - 1);
    }
    return "";
}

// CLI11's help without the lists of excluded options, which the error messages give.
struct Help : CLI::Formatter {
    std::string make_option_opts(const CLI::Option* option) const override {
        std::string text = option->get_type_name();
        if (!option->get_default_str().empty()) text += "=" + option->get_default_str();
        return text.empty() ? "" : " " + text;
    }
};

// The help of the command that was named, or the version.
int print_help(const CLI::App& app, const CLI::ParseError& error) {
    std::ostringstream text;
    const int code = app.exit(error, text, text);
    print(text.str());
    return code;
}

int run(std::vector<std::string> arguments) {
    CLI::App app("isorast: isosurfaces straight from voxels to pixels", "isorast");
    app.footer("Example: isorast render head.nrrd --iso 300 -o head.png");
    app.formatter(std::make_shared<Help>());  // as CLI11 wants it
    app.set_help_flag("-h,--help", "Show this help");
    app.set_version_flag("--version", "isorast " ISORAST_VERSION);
    const std::array commands = {make_render(app), make_mesh(app), make_info(app),
                                 make_devices(app), make_compare(app)};
    std::vector<std::string> names(commands.size());
    std::ranges::transform(commands, names.begin(),
                           [](const auto& command) { return command->app.get_name(); });

    if (arguments.empty()) {
        print_message(app.help());
        return WRONG_USAGE;
    }
    const bool help = std::ranges::any_of(arguments, [](const std::string& word) {
        return word == "--help" || word == "-h" || word == "--version";
    });
    const bool named = command_first(arguments, names);
    if (const std::string option = option_without_value(arguments); !option.empty())
        return wrong_usage(option + ": expected a value after '='", named ? arguments[0] : "");
    if (!named && !help) return no_command(arguments, names);

    const Command* chosen = nullptr;
    try {
        std::ranges::reverse(arguments);  // as CLI11 wants them
        app.parse(arguments);
        for (const auto& command : commands) {
            if (!command->app.parsed()) continue;
            chosen = command.get();
            return command->run();
        }
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return print_help(app, error);
        for (const auto& command : commands) {
            if (command->app.parsed()) chosen = command.get();
        }
        if (chosen && dynamic_cast<const CLI::ExtrasError*>(&error)) return unexpected(chosen->app);
        return wrong_usage(error.what(), chosen ? chosen->app.get_name() : "");
    }
    return WRONG_USAGE;
}

}  // namespace
}  // namespace isorast::cli

int main(int count, char** words) {
    try {
        isorast::cli::occupy_closed_streams();
        const int code = isorast::cli::run({words + 1, words + count});
        isorast::cli::flush_output();
        return code;
    } catch (const std::bad_alloc&) {
        isorast::cli::print_error("out of memory; choose a smaller volume or picture");
    } catch (const std::exception& error) {
        isorast::cli::print_error(error.what());
    }
    return 1;
}
