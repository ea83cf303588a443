// SPDX-License-Identifier: MIT
// Which time steps are on the GPU, and how they get there.
#include "grid/steps.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "gpu/device.h"
#include "volume/voxels.h"

namespace isorast {

namespace {

// A piece of the staging ring: large enough to copy fast, small enough that a frame which waits
// behind one on the same queue does not notice.
constexpr uint64_t PIECE_BYTES = 16u << 20;
constexpr uint64_t MIN_SHARE = 1u << 20;  // of a piece, bytes for one thread

// The size of a piece: a slice of any brick at least, and no more than the largest brick.
uint64_t piece_bytes(const StepFormat& format) {
    uint64_t slice = 0, all = 0;
    for (uint32_t i = 0; i < format.bricks.count(); ++i) {
        const glm::uvec3 size = format.bricks.extent(i);
        const uint64_t bytes = uint64_t{size.x} * size.y * format.stored.bytes();
        slice = std::max(slice, bytes);
        all = std::max(all, bytes * size.z);
    }
    return std::max(slice, std::min(all, PIECE_BYTES));
}

uint64_t step_bytes(const gpu::Device& device, const StepFormat& format) {
    uint64_t bytes = format.minmax_bytes;
    for (uint32_t i = 0; i < format.bricks.count(); ++i)
        bytes += gpu::Texture::bytes_needed(device, brick_image(format, i));
    return bytes;
}

// How many steps to keep. Two at least: one is drawn while the next arrives.
uint32_t capacity(const gpu::Device& device, const StepFormat& format, uint32_t steps,
                  uint64_t budget) {
    // A CPU driver's memory is everybody's.
    if (budget == 0) budget = device.info().memory_bytes / (device.is_cpu() ? 4 : 2);
    uint64_t fit = budget / step_bytes(device, format);
    // Devices limit the number of allocations too: half of them are for this.
    fit = std::min<uint64_t>(
        fit, device.limits().maxMemoryAllocationCount / 2 / (format.bricks.count() + 1));
    return std::min(steps, uint32_t(std::clamp<uint64_t>(fit, 2, UINT32_MAX)));
}

// Calls store(row, range) for all rows, on several threads where there is much to do: one thread
// neither reads a file nor writes memory as fast as the device takes it.
template <class StoreRow>
void store_rows(uint32_t rows, uint64_t row_bytes, StoreRow&& store, StoredRange& range) {
    const uint32_t most = std::clamp(std::thread::hardware_concurrency() / 2, 1u, 8u);
    const auto count = uint32_t(std::clamp<uint64_t>(rows * row_bytes / MIN_SHARE, 1, most));
    std::vector<StoredRange> ranges(count);
    const auto store_share = [&](uint32_t share) {
        const auto end = uint32_t(uint64_t{rows} * (share + 1) / count);
        for (auto row = uint32_t(uint64_t{rows} * share / count); row < end; ++row)
            store(row, ranges[share]);
    };
    {
        std::vector<std::jthread> threads;
        for (uint32_t share = 1; share < count; ++share)
            threads.emplace_back(store_share, share);
        store_share(0);
    }  // joins
    for (const StoredRange& found : ranges) {
        range.least = std::min(range.least, found.least);
        range.greatest = std::max(range.greatest, found.greatest);
    }
}

bool contains(const std::vector<uint32_t>& numbers, uint32_t number) {
    return std::ranges::find(numbers, number) != numbers.end();
}

}  // namespace

gpu::ImageInfo brick_image(const StepFormat& format, uint32_t brick) {
    const glm::uvec3 size = format.bricks.extent(brick);
    const VkImageUsageFlags written = format.sampled_on_gpu ? VK_IMAGE_USAGE_STORAGE_BIT : 0;
    return {.format = format.stored.format,
            .extent = {size.x, size.y, size.z},
            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | written,
            .is_3d = true,
            .uploaded = true,
            .linear = format.in_buffer};
}

Steps::Steps(const gpu::Device& device, const Series& series, const Volume& first,
             const StepFormat& format, uint64_t budget)
    : device_(device),
      series_(series),
      header_(header_of(first)),
      format_(format),
      capacity_(capacity(device, format, series.steps, budget)) {
    Step& step = add();
    load(step, first);
    step.number = 0;
    if (series_.steps == 1) staging_.reset();
}

Steps::~Steps() {
    cancelled_ = true;
    if (reading_.valid()) reading_.wait();
}

uint64_t Steps::volume_bytes() const {
    uint64_t bytes = 0;
    for (const auto& step : steps_)
        for (const gpu::Texture& brick : step->bricks)
            bytes += brick.bytes();
    return bytes;
}

Step& Steps::show(uint32_t number, std::vector<uint32_t> in_flight) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const bool here = find(number);
    if (shown_ != UINT32_MAX && shown_ != number) stride_ = int64_t{number} - shown_;
    Step& step = get(number, in_flight);
    wait_ms_ = here ? 0 : std::chrono::duration<double, std::milli>(Clock::now() - start).count();

    shown_ = number;
    in_flight.push_back(number);
    read_ahead(uint32_t((number + stride_ + series_.steps) % series_.steps), in_flight);
    return step;
}

Step* Steps::find(uint32_t number) {
    for (const auto& step : steps_)
        if (step->number == number) return step.get();
    return nullptr;
}

Step& Steps::get(uint32_t number, const std::vector<uint32_t>& in_flight) {
    if (Step* step = find(number)) return *step;
    if (reading_.valid()) {
        const bool wanted = reading_number_ == number;
        cancelled_ = !wanted;
        if (wanted) {
            Step& step = *reading_into_;
            reading_.get();  // or throws what went wrong
            step.number = number;
            return step;
        }
        settle();
        if (Step* step = find(number)) return *step;
    }
    const Volume volume = read(number);
    Step* step = make_room(number, in_flight);
    if (!step) step = &add();  // more frames are in flight than the budget holds
    cancelled_ = false;
    load(*step, volume);
    step->number = number;
    return *step;
}

void Steps::settle() {
    bool whole = false;
    try {
        whole = reading_.get();
    } catch (const std::exception&) {
        whole = false;  // nobody asked for this step; if one does, it is read once more
    }
    if (whole) reading_into_->number = reading_number_;
}

void Steps::read_ahead(uint32_t number, const std::vector<uint32_t>& in_flight) {
    // A formula is sampled by the frame that shows it.
    if (series_.steps == 1 || format_.sampled_on_gpu || !device_.can_upload_in_background()) return;
    if (reading_.valid()) {
        if (reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        if (reading_number_ == number) return;  // shown next, or throws then
        settle();
    }
    if (find(number)) return;
    Step* step = make_room(number, in_flight);
    if (!step) return;
    reading_number_ = number;
    reading_into_ = step;
    cancelled_ = false;
    reading_ =
        std::async(std::launch::async, [this, number, step] { return load(*step, read(number)); });
}

// How many steps it is from one to another, in the direction of the last move.
uint32_t Steps::steps_until(uint32_t number, uint32_t from) const {
    const uint32_t ahead = (number + series_.steps - from) % series_.steps;
    const int64_t forward = (stride_ + series_.steps) % series_.steps;
    return forward <= series_.steps / 2 || ahead == 0 ? ahead : series_.steps - ahead;
}

// The step that will be needed last (Belady 1966) makes room, as far as the last move tells: in a
// loop over more steps than fit, all others stay, where the least recently used would be the very
// one that comes next.
Step* Steps::make_room(uint32_t number, const std::vector<uint32_t>& in_flight) {
    if (Step* unused = find(UINT32_MAX)) return unused;
    if (steps_.size() < capacity_) {
        try {
            return &add();
        } catch (const Error&) {
            if (steps_.size() < 2) throw;
            capacity_ = resident();  // other programs use the device's memory too
        }
    }
    Step* last = nullptr;
    for (const auto& step : steps_) {
        if (contains(in_flight, step->number)) continue;
        if (!last || steps_until(step->number, number) > steps_until(last->number, number))
            last = step.get();
    }
    if (last) last->number = UINT32_MAX;
    return last;
}

Step& Steps::add() {
    auto step = std::make_unique<Step>();
    for (uint32_t i = 0; i < format_.bricks.count(); ++i)
        step->bricks.emplace_back(device_, brick_image(format_, i), "the volume");
    step->minmax =
        gpu::Buffer(device_, format_.minmax_bytes, gpu::Buffer::Memory::device, "min-max blocks");
    return *steps_.emplace_back(std::move(step));
}

Volume Steps::read(uint32_t number) const {
    Volume volume = series_.load(number);
    check(volume);
    check_step(volume, header_);
    return volume;
}

bool Steps::load(Step& step, const Volume& volume) {
    step.built = false;
    step.range = {};
    step.sampling.reset();
    if (volume.bytes.span().empty()) {
        if (format_.sampled_on_gpu) {
            step.sampling = field_sampling(volume);
            return true;
        }
        Volume sampled = header_of(volume);
        sample(sampled);
        return load(step, sampled);
    }
    if (!staging_) staging_ = std::make_unique<gpu::Staging>(device_, piece_bytes(format_));
    staging_->wait();  // after an error, copies into the same bricks may still run
    bool whole = true;
    for (uint32_t brick = 0; brick < format_.bricks.count() && whole; ++brick)
        whole = upload_brick(step, volume, brick);
    staging_->wait();
    return whole;
}

bool Steps::upload_brick(Step& step, const Volume& volume, uint32_t brick) {
    const glm::uvec3 origin = format_.bricks.origin(brick), extent = format_.bricks.extent(brick);
    const uint64_t row_bytes = uint64_t{extent.x} * format_.stored.bytes();
    const auto slices_at_once =
        uint32_t(std::min<uint64_t>(staging_->piece_bytes() / (row_bytes * extent.y), extent.z));
    for (uint32_t z = 0; z < extent.z; z += slices_at_once) {
        if (cancelled_) return false;
        const uint32_t slices = std::min(slices_at_once, extent.z - z);
        std::byte* out = staging_->next();
        const auto store_row = [&](uint32_t row, StoredRange& range) {
            const uint64_t k = origin.z + z + row / extent.y, j = origin.y + row % extent.y;
            store_voxels(volume, format_.stored,
                         (k * volume.dims[1] + j) * volume.dims[0] + origin.x, extent.x,
                         out + row * row_bytes, range);
        };
        store_rows(slices * extent.y, row_bytes, store_row, step.range);
        staging_->copy_to(step.bricks[brick], z, slices);
    }
    return true;
}

}  // namespace isorast
