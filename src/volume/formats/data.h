// SPDX-License-Identifier: MIT
// From "where the header says the voxels lie" to voxels in memory, the same way for all formats.
#pragma once
#include <isorast/load.h>

#include <memory>

#include "volume/text.h"

namespace isorast {

enum class Encoding {
    raw,
    compressed,
    ascii
};  // compressed: gzip or zlib, told apart by their first bytes

struct DataSource {
    std::vector<std::string> files;  // each holds an equal share of the voxels of all time steps
    Encoding encoding = Encoding::raw;
    bool big_endian = false;
    uint64_t offset = 0;         // where in each file the data begin,
    uint64_t skip_lines = 0;     // so many lines later,
    uint64_t skip_bytes = 0;     // and so many bytes,
    bool at_end = false;         // or, instead of all these, the last bytes of the file
    uint64_t skip_inflated = 0;  // bytes to skip in the inflated stream
};

// The size of a regular file that is not empty; else throws Error that says what it is instead.
uint64_t file_size(const std::string& path);

// Sets time_steps and time_step. Throws Error when the step that was asked for does not exist.
void set_time(Volume& volume, uint64_t steps, const LoadOptions& options);

// Fills volume.bytes for its dims, type and time step: mapped where the file holds just these
// bytes, else decoded. Throws Error unless the files hold exactly the voxels of all time steps.
void read_voxels(Volume& volume, const DataSource& source);

class InflateStream;

// Reads the time steps of a file in any order, each as read_voxels() does. Where they lie in one
// compressed stream it goes on behind the last one, and only for an earlier step begins at the
// start again. A copy begins at the start, too.
class StepReader {
public:
    StepReader(const Volume& header, DataSource source);
    StepReader(const StepReader& other);
    StepReader(StepReader&&) noexcept;
    ~StepReader();
    Volume operator()(uint32_t step);

private:
    void inflate_step(Volume& volume);
    Volume header_;
    DataSource source_;
    std::unique_ptr<InflateStream> stream_;
};

// The path of a data file that a header names: relative to the header's folder.
std::string beside(const std::string& header, std::string_view name);
// Slices by number: "slice%03d.raw", first, last and (1 when left out) step, as words.
std::vector<std::string> numbered_files(const std::string& header,
                                        const std::vector<std::string_view>& words);
// The names in the remaining lines of a header, one each.
std::vector<std::string> listed_files(const std::string& header, Lines& lines);

// Turn world coordinates around: LPS to RAS is (-1, -1, 1).
void flip_world(Affine& affine, std::array<double, 3> signs);

}  // namespace isorast
