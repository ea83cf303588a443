// SPDX-License-Identifier: MIT
// Steps: the time steps of a series on the GPU. Those that fit a budget stay; while one is drawn,
// the one that will probably be next is read and uploaded by a thread of its own.
#pragma once
#include <isorast/series.h>

#include <atomic>
#include <future>
#include <memory>
#include <vector>

#include "gpu/resources.h"
#include "gpu/staging.h"
#include "grid/bricks.h"
#include "grid/stored.h"
#include "volume/field.h"

namespace isorast {

namespace gpu {
class Device;
}

// One time step on the GPU.
struct Step {
    uint32_t number = UINT32_MAX;  // UINT32_MAX: none
    std::vector<gpu::Texture> bricks;
    gpu::Buffer minmax;
    bool built = false;     // minmax, and the bricks of a formula that is sampled on the GPU
    bool may_wait = false;  // for commands that build it: recorded, and perhaps not run
    std::optional<field::FieldSampling> sampling;  // of that formula
    StoredRange range;                             // of floats that came from the CPU
};

// What all steps share.
struct StepFormat {
    BrickPlan bricks;
    Stored stored;
    uint64_t minmax_bytes = 0;
    bool sampled_on_gpu = false;  // formulas
    bool in_buffer = false;       // one brick, linear: shaders fetch voxels from Texture::buffer
};

class Steps {
public:
    // Uploads step 0: `first`, as series.load made it. `budget` is in bytes, 0: a share of the
    // device's memory; two steps are always kept.
    Steps(const gpu::Device& device, const Series& series, const Volume& first,
          const StepFormat& format, uint64_t budget);
    Steps(const Steps&) = delete;
    Steps& operator=(const Steps&) = delete;
    ~Steps();

    // The step: as it is here, or else waited for. Then begins to read the one that will probably
    // be next: as far again as from the last one to this, around the end. `in_flight`: steps of
    // frames that may be unfinished, which stay as they are. Throws what series.load threw.
    Step& show(uint32_t number, std::vector<uint32_t> in_flight);
    Step& first() { return *steps_.front(); }
    double wait_ms() const { return wait_ms_; }  // of the last show()
    uint32_t count() const { return series_.steps; }
    uint32_t resident() const { return uint32_t(steps_.size()); }
    uint64_t volume_bytes() const;
    uint64_t minmax_bytes() const { return resident() * format_.minmax_bytes; }

private:
    Step& get(uint32_t number, const std::vector<uint32_t>& in_flight);
    void read_ahead(uint32_t number, const std::vector<uint32_t>& in_flight);
    Step* find(uint32_t number);
    // A step to overwrite, for `number`, while nothing is being read; null when all are in flight.
    Step* make_room(uint32_t number, const std::vector<uint32_t>& in_flight);
    Step& add();
    uint32_t steps_until(uint32_t number, uint32_t from) const;
    // Waits for what is being read; it becomes resident unless it failed or was cancelled.
    void settle();

    Volume read(uint32_t number) const;
    // False if cancelled. These two run in the background too: all that they touch is theirs.
    bool load(Step& step, const Volume& volume);
    bool upload_brick(Step& step, const Volume& volume, uint32_t brick);

    const gpu::Device& device_;
    Series series_;
    Volume header_;  // of the first step
    StepFormat format_;
    std::vector<std::unique_ptr<Step>> steps_;
    uint32_t capacity_ = 1;
    uint32_t shown_ = UINT32_MAX;  // UINT32_MAX: none yet
    int64_t stride_ = 1;
    double wait_ms_ = 0;

    std::unique_ptr<gpu::Staging> staging_;
    std::future<bool> reading_;
    uint32_t reading_number_ = 0;
    Step* reading_into_ = nullptr;
    std::atomic<bool> cancelled_ = false;
};

// The 3D image of a brick.
gpu::ImageInfo brick_image(const StepFormat& format, uint32_t brick);

}  // namespace isorast
