// SPDX-License-Identifier: MIT
// isorast compare: how much two pictures differ; exit 1 where a pixel differs by more than allowed.
#include "options.h"

namespace isorast::cli {
namespace {

struct Compare : Command {
    std::string first, second, output;
    double tolerance = 0;
    bool json = false;

    explicit Compare(CLI::App& parent)
        : Command(*parent.add_subcommand("compare", "Compare two PNG files")) {
        app.add_option("A.png", first, "One picture")->type_name("")->required();
        app.add_option("B.png", second, "The other, of the same size")->type_name("")->required();
        app.add_option("--tolerance", tolerance, "Allowed difference of a channel, 0 to 255")
            ->type_name("T")
            ->check(CLI::Range(0.0, 255.0).description(""))
            ->capture_default_str();
        app.add_option("-o,--output", output, "Write the difference picture here")
            ->type_name("FILE");
        app.add_flag("--json", json, "Print JSON");
        app.footer(
            "Example: isorast compare a.png b.png --tolerance 2 -o difference.png\n"
            "Exit code: 0 when no pixel differs by more than the tolerance, else 1");
    }

    int run() override {
        const Image a = read_png(first), b = read_png(second);
        const Difference difference = compare(a, b, tolerance);
        if (!output.empty()) write_png(output, difference_picture(a, b, tolerance));
        print(json ? text_of(json_of(difference, tolerance))
                   : text_of(difference, a.size, tolerance) + "\n");
        return difference.pixels_over == 0 ? 0 : 1;
    }
};

}  // namespace

std::unique_ptr<Command> make_compare(CLI::App& parent) {
    return std::make_unique<Compare>(parent);
}

}  // namespace isorast::cli
