// SPDX-License-Identifier: MIT
// A contest: the same frames drawn in several ways. Pictures are compared first; then each way is
// measured in two rounds, the second in the opposite order, so that a drift of the clocks favours
// none.
#pragma once
#include <set>

#include "gpu/commands.h"
#include "settings.h"
#include "statistics.h"

namespace isorast::bench {

constexpr size_t NOT_COUNTED = SIZE_MAX;

// Frames in the order in which they are drawn, over and over.
struct Sequence {
    struct Shot {
        Frame frame;
        size_t row = 0;  // of the results, or NOT_COUNTED
    };
    std::string name;  // "still", "stereo", "sweep", ...
    std::vector<Json> rows{
        Json::object()};           // what tells a row from the others, e.g. {"isovalue": 0.5}
    std::vector<Shot> shots;       // the last leads back to the first
    std::vector<size_t> compared;  // shots whose pictures all ways must agree on
    bool changes = false;          // isovalue or time step differ between shots
};

class Contest {
public:
    // Ways that the device refuses are noted in report["skipped"] and left out.
    Contest(Gpu& gpu, const Subject& subject, const Settings& settings, Json& report);

    bool empty() const { return contenders_.empty(); }
    // The first way's; for cameras and value ranges.
    Renderer& first() { return renderer(contenders_.front()); }
    // Adds rows to report["rows"] and agreements to report["agreement"].
    void measure(const std::vector<Sequence>& sequences);

private:
    struct Contender {
        Way way;
        std::string lane;
        std::unique_ptr<Renderer> renderer;
        std::optional<Difference> worst{};  // from the pictures of
        std::set<std::string> others{};     // these ways: the first that draws each sequence
    };
    // What one way took for one sequence.
    struct Taken {
        std::vector<std::vector<std::vector<gpu::TimedPass>>> frames;  // by row
        std::vector<std::vector<double>> rounds_ms;  // the frame's median in each round, by row
        double wall_ms = 0;
        uint64_t wall_frames = 0;
        std::vector<FrameStats> stats;  // by row
        bool left_out = false;
    };

    Renderer& renderer(Contender& contender);
    void release(Contender& contender);
    void skip(const std::string& way, const std::string& where, const std::string& why);
    // Leaves out those whose pictures differ, or who cannot draw the sequence.
    void compare(const Sequence& sequence, std::vector<Taken>& taken);
    std::vector<Image> pictures_of(Contender& contender, const Sequence& sequence);
    void print_agreement() const;
    void take_round(Contender& contender, const Sequence& sequence, Taken& taken);
    void count(Contender& contender, const Sequence& sequence, Taken& taken);
    void add_rows(const Contender& contender, const Sequence& sequence, const Taken& taken);

    Gpu& gpu_;
    const Subject& subject_;
    const Settings& settings_;
    Json& report_;
    std::vector<Contender> contenders_;
    bool all_fit_ = true;  // all Renderers at once in the device's memory
};

}  // namespace isorast::bench
