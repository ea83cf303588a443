// SPDX-License-Identifier: MIT
// The scenarios: which frames are drawn, of which volumes, at which sizes.
#pragma once
#include "measure.h"

namespace isorast::bench {

// What is drawn unless the user says otherwise, and what with --quick.
struct Choice {
    std::vector<std::string> full, quick;
};

struct Scenario {
    std::string name, what;
    Choice volumes, sizes;
    uint32_t frames = 40;  // see Settings
    bool stored = true;    // ways that store a mesh take part unless asked otherwise
    std::vector<Sequence> (*sequences)(Contest&, const Subject&, const Settings&) = nullptr;
};

const std::vector<Scenario>& scenarios();

// What the user left open; small where `quick`. Throws Error for words that do not parse.
Settings with_defaults(Settings settings, const Scenario& scenario);

}  // namespace isorast::bench
