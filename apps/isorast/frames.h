// SPDX-License-Identifier: MIT
// Several pictures in one run: which time steps they show, what their files are called, and how far
// they are.
#pragma once
#include "options.h"

namespace isorast::cli {

// The time steps of `text` ("3", "all", "2:10", "0:30:5", the last one included) out of `count`;
// where it is empty, all or the first. Throws Error for steps that the series does not have.
std::vector<uint32_t> parse_steps(const Series& series, const std::string& text, bool all);
// What is wrong with the form of such a text; empty when nothing is.
std::string check_steps(const std::string& text);

// These steps, of which the first is already in memory and stays there.
Series chosen_steps(const Series& series, const std::vector<uint32_t>& steps, const Volume& first);

// True when the pattern holds {frame} or {time}.
bool names_frames(const std::string& pattern);
// A name for each picture: {frame} counts them from 0, {time} is the time step; {frame:4} has at
// least 4 digits. Throws CLI::ValidationError of
// `option` when two pictures would get the same name.
std::vector<std::string> picture_names(const std::string& option, const std::string& pattern,
                                       const std::vector<uint32_t>& steps);

// "12 of 30", on a terminal only and while there is more than one.
class Progress {
public:
    explicit Progress(size_t total);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress();
    void done();  // one more

private:
    size_t total_, done_ = 0;
    bool shown_;
};

}  // namespace isorast::cli
