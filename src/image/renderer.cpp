// SPDX-License-Identifier: MIT
// The frame: begin, prepare (if the isovalues changed), the technique's passes, shade.
#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <cstring>

#include "gpu/device.h"
#include "image/state.h"
#include "image/stereo.h"

namespace isorast {

namespace {

// "auto" becomes what the device does best.
RendererOptions resolved(Gpu& gpu, VoxelType type, RendererOptions options) {
    const bool automatic = options.technique == "auto";
    if (automatic) options.technique = options.exact ? "raymarch" : "direct";
    if (options.technique != "direct" || options.rasterizer == Rasterizer::compute) return options;
    if (options.occlusion == Occlusion::raster) options.rasterizer = Rasterizer::hardware;
    const bool choose_test =
        options.occlusion == Occlusion::automatic && !gpu.device().is_cpu();  // HiZ there
    if (options.rasterizer == Rasterizer::hardware && !choose_test) return options;
    const RasterizerChoice choice = choose_rasterizer(gpu, type);
    if (options.rasterizer == Rasterizer::automatic) options.rasterizer = choice.rasterizer;
    if (options.rasterizer == Rasterizer::hardware && choose_test)
        options.occlusion = choice.occlusion;
    if (options.rasterizer != Rasterizer::automatic) return options;
    if (!automatic)
        throw Error(
            fmt::format("direct: {} has no hardware rasterizer ({}) and fails the compute "
                        "rasterizer's self-test ({}); use --technique raymarch",
                        gpu.info().name, gpu.info().why_not_hardware, choice.problem));
    options.technique = "raymarch";
    return options;
}

}  // namespace

std::unique_ptr<Technique> make_technique(const TechniqueContext& context) {
    std::string known;
    for (const TechniqueEntry& entry : technique_registry()) {
        if (entry.name == context.options.technique) return entry.make(context);
        known += (known.empty() ? "" : ", ") + entry.name;
    }
    throw Error(
        fmt::format("technique: expected one of {}, found '{}'", known, context.options.technique));
}

Renderer::State::State(Gpu& gpu, const Series& series, const RendererOptions& options)
    : device_(gpu.device()),
      grid_(device_, series, options.max_brick_side, options.step_bytes),
      options_(resolved(gpu, grid_.header().type, options)),
      placement_{grid_.header().affine, grid_.header().dims},
      technique_(make_technique({grid_, options_})),
      shade_(grid_, options_.exact) {
    for (uint32_t i = 0; i < std::max(options.frames_in_flight, 1u); ++i)
        submissions_.push_back(std::make_unique<gpu::Submission>(device_));
    steps_in_flight_.resize(submissions_.size());
    host_steps_in_flight_.resize(submissions_.size());
    if (options.occlusion != Occlusion::automatic && technique_->occlusion() != options.occlusion)
        throw Error(fmt::format("culling: {} has no {} occlusion test; use --culling auto",
                                options_.technique, name_of(options.occlusion)));
    counters_readback_ =
        gpu::Buffer(device_, sizeof(shared::Counters), gpu::Buffer::Memory::host, "counters");
}

Renderer::State::~State() {
    for (auto& submission : submissions_)
        submission->wait();
}

void Renderer::State::record(gpu::Commands& commands, const Frame& frame,
                             std::optional<uint32_t>& step) {
    check(frame);
    if (frame.time_step >= grid_.steps().count())
        throw Error(fmt::format("{}: expected a time step from 0 to {}, found {}",
                                grid_.header().name, grid_.steps().count() - 1, frame.time_step));
    if (frame.shading == Shading::forward && !technique_->can_shade_forward())
        throw Error(
            fmt::format("shading: {} with the {} rasterizer cannot shade forward; use gooch",
                        options_.technique, name_of(technique_->rasterizer())));
    // These commands' last use is over, and with it its step's.
    step.reset();
    std::vector<uint32_t> in_flight;
    for (const auto* steps : {&steps_in_flight_, &host_steps_in_flight_})
        for (const std::optional<uint32_t>& other : *steps)
            if (other) in_flight.push_back(*other);
    grid_.show(frame.time_step, std::move(in_flight));
    step = frame.time_step;
    or_forget([&] { record_passes(commands, frame); });
}

// If that throws, the commands will not run: what they would have prepared is not there.
template <class Rest>
void Renderer::State::or_forget(Rest&& rest) {
    try {
        rest();
    } catch (...) {
        grid_.forget_pyramid();
        prepared_step_.reset();
        target_.size = {0, 0};
        depth_image_lost_ = true;
        throw;
    }
}

void Renderer::State::record_passes(gpu::Commands& commands, const Frame& frame) {
    if (!target_.fits(frame)) {
        for (auto& submission : submissions_)
            submission->wait();
        target_.fit(device_, commands, frame, technique_->rasterizer() == Rasterizer::hardware);
    }
    commands.barrier();
    grid_.begin_frame(commands, make_frame_info(frame, placement_, grid_.stored()));
    std::vector<float> isovalues;
    for (double isovalue : frame.isovalues)
        isovalues.push_back(grid_.stored().from_value(isovalue));
    if (prepared_step_ != frame.time_step || prepared_isovalues_ != isovalues) {
        technique_->prepare(commands, isovalues);
        prepared_isovalues_ = std::move(isovalues);
        prepared_step_ = frame.time_step;
    }
    technique_->record(commands, frame, target_);
    shade_.record(commands, frame, target_);
}

Image Renderer::State::render(const Frame& frame) {
    gpu::Submission& submission = *submissions_.front();
    gpu::Commands commands = submission.begin();
    record(commands, frame, steps_in_flight_.front());
    or_forget([&] {
        fit_readback(frame);
        commands.copy_to_buffer(target_.color, color_readback_);
        if (frame.want_depth) commands.copy_to_buffer(target_.distances, depth_readback_);
        if (technique_->counters())
            commands.copy(*technique_->counters(), 0, counters_readback_, 0,
                          sizeof(shared::Counters));
        submission.submit();
    });
    submission.wait();
    grid_.have_run();
    steps_in_flight_.front().reset();
    collect_stats(submission.slot());
    return read_back(frame);
}

std::vector<std::vector<gpu::TimedPass>> Renderer::State::run(const std::vector<Frame>& frames) {
    std::vector<std::vector<gpu::TimedPass>> times(frames.size());
    const size_t in_flight = submissions_.size();
    for (size_t i = 0; i < frames.size() + in_flight; ++i) {
        gpu::Submission& submission = *submissions_[i % in_flight];
        submission.wait();
        if (i >= in_flight) times[i - in_flight] = submission.slot().times();
        if (i >= frames.size()) continue;
        gpu::Commands commands = submission.begin();
        record(commands, frames[i], steps_in_flight_[i % in_flight]);
        or_forget([&] { submission.submit(); });
    }
    grid_.have_run();
    return times;
}

// Into depth_buffer_; from there into a D32 image, as no command turns one format into the other.
void Renderer::State::copy_depth(gpu::Commands& commands, bool as_image) {
    const VkExtent3D extent = target_.depth.extent();
    const uint32_t layers = target_.depth.layers();
    const uint64_t bytes = uint64_t{4} * extent.width * extent.height * layers;
    if (depth_buffer_.bytes() != bytes)
        depth_buffer_ =
            gpu::Buffer(device_, bytes, gpu::Buffer::Memory::device, "a copy of the depth");
    commands.copy_to_buffer(target_.depth, depth_buffer_);
    commands.barrier();
    if (!as_image) return;
    const VkExtent3D old = depth_image_ ? depth_image_.extent() : VkExtent3D{};
    if (depth_image_lost_ || old.width != extent.width || old.height != extent.height ||
        depth_image_.layers() != layers) {
        depth_image_ = gpu::Texture(
            device_,
            {.format = VK_FORMAT_D32_SFLOAT,
             .extent = extent,
             .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                      VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
             .layers = layers},
            "a copy of the depth");
        commands.discard_to_general(depth_image_);
        depth_image_lost_ = false;
    }
    commands.copy_to_image(depth_buffer_, depth_image_);
    commands.barrier();
}

RecordedFrame Renderer::State::record_for_host(VkCommandBuffer handle, const Frame& frame,
                                               uint32_t slot, const DepthCopies& copies) {
    if (slot >= submissions_.size())
        throw Error(fmt::format("record: expected a slot below {} (frames_in_flight), found {}",
                                submissions_.size(), slot));
    if (copies.image && !device_.has_graphics())
        throw Error("record: depth as a D32 image needs a queue with graphics; take the buffer");
    while (host_slots_.size() <= slot)
        host_slots_.push_back(std::make_unique<gpu::Slot>(device_));
    host_slots_[slot]->reset();
    gpu::Commands commands(device_, handle, *host_slots_[slot]);
    record(commands, frame, host_steps_in_flight_[slot]);
    const bool as_image = copies.image && target_.depth.format() != VK_FORMAT_D32_SFLOAT;
    if (as_image || copies.buffer) or_forget([&] { copy_depth(commands, as_image); });
    const auto view = [&](const gpu::Texture& texture) {
        return target_.eyes == 1 ? texture.layer_view(0) : texture.view();
    };
    const gpu::Texture& depth = as_image ? depth_image_ : target_.depth;
    return {target_.color.handle(), view(target_.color),
            depth.handle(),         view(depth),
            depth.format(),         copies.buffer ? depth_buffer_.handle() : VK_NULL_HANDLE};
}

void Renderer::State::fit_readback(const Frame& frame) {
    const uint64_t bytes = uint64_t{4} * frame.size.width * frame.size.height * frame.eyes();
    const auto fit = [&](gpu::Buffer& buffer) {
        if (buffer.bytes() != bytes)
            buffer =
                gpu::Buffer(device_, bytes, gpu::Buffer::Memory::host, "reading the picture back");
    };
    fit(color_readback_);
    if (frame.want_depth) fit(depth_readback_);
}

Image Renderer::State::read_back(const Frame& frame) const {
    Image image{.size = {frame.size.width, frame.size.height * frame.eyes()}};
    const size_t pixels = size_t{image.size.width} * image.size.height;
    image.rgba.resize(4 * pixels);
    std::memcpy(image.rgba.data(), color_readback_.data<uint8_t>(), image.rgba.size());
    if (frame.want_depth) {
        image.depth.resize(pixels);
        const double unit = world_unit(placement_);
        std::transform(depth_readback_.data<float>(), depth_readback_.data<float>() + pixels,
                       image.depth.begin(), [=](float t) { return float(t * unit); });
    }
    return frame.eyes() == 1 ? image : arrange(std::move(image), frame.stereo.mode);
}

void Renderer::State::collect_stats(const gpu::Slot& slot) {
    stats_ = {};
    const auto times = slot.times();
    for (const gpu::TimedPass& pass : times) {
        // Surfaces repeat passes: one line each, summed.
        auto known = std::ranges::find(stats_.passes, pass.name, &PassTime::name);
        if (known == stats_.passes.end()) known = stats_.passes.insert(known, {pass.name, 0});
        known->milliseconds += pass.end_ms - pass.begin_ms;
    }
    if (!times.empty()) stats_.total_ms = times.back().end_ms;
    stats_.blocks = grid_.info().blocks.w;
    if (technique_->counters()) {
        const auto& counters = *counters_readback_.data<shared::Counters>();
        stats_.blocks_active = counters.blocks_active;
        stats_.blocks_drawn = counters.blocks_drawn;
    }
    stats_.wait_ms = grid_.steps().wait_ms();
    stats_.resident_steps = grid_.steps().resident();
    stats_.volume_bytes = grid_.steps().volume_bytes();
    stats_.extra_bytes = grid_.extra_bytes() + technique_->gpu_bytes();
    stats_.target_bytes = target_.bytes();
    stats_.bricks = grid_.bricks().count();
}

Renderer::Renderer(Gpu& gpu, const Volume& volume, const RendererOptions& options)
    : Renderer(gpu, series_of({&volume, 1}), options) {}
Renderer::Renderer(Gpu& gpu, const Series& series, const RendererOptions& options)
    : state_(std::make_unique<State>(gpu, series, options)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;
Image Renderer::render(const Frame& frame) {
    return state_->render(frame);
}
const FrameStats& Renderer::stats() const {
    return state_->stats();
}
std::array<double, 2> Renderer::value_range() const {
    return state_->grid().value_range();
}
VoxelPoints Renderer::surface_hull(const std::vector<double>& isovalues) const {
    std::vector<float> stored;
    for (double isovalue : isovalues)
        stored.push_back(state_->grid().stored().from_value(isovalue));
    return state_->grid().crossed_hull(stored);
}
std::string Renderer::technique() const {
    return state_->options().technique;
}
Rasterizer Renderer::rasterizer() const {
    return state_->technique().rasterizer();
}
Occlusion Renderer::occlusion() const {
    return state_->technique().occlusion();
}

RecordedFrame record(Renderer& renderer, VkCommandBuffer commands, const Frame& frame,
                     uint32_t slot, const DepthCopies& copies) {
    return renderer.state().record_for_host(commands, frame, slot, copies);
}

std::vector<std::string> techniques() {
    std::vector<std::string> names;
    for (const TechniqueEntry& entry : technique_registry())
        names.push_back(entry.name);
    return names;
}

std::string what_does_not_fit(const Gpu& gpu, const Volume& volume, const RendererOptions& options,
                              uint32_t time_steps) {
    const gpu::Device& device = gpu.device();
    const GridPlan plan = plan_grid(device, volume, options.max_brick_side);
    // Two time steps: one is drawn while the next arrives.
    const uint32_t steps = std::min(time_steps, 2u);
    const uint64_t needed = steps * (plan.volume_bytes + plan.minmax_bytes) + plan.minmax_bytes;
    const uint64_t has = device.info().memory_bytes;
    const auto gib = [](uint64_t bytes) { return double(bytes) / double(1 << 30); };
    const std::string needs =
        fmt::format("{}: needs {:.2f} GiB{} on {}", volume.name, gib(needed),
                    steps > 1 ? " for two time steps" : "", device.info().name);
    if (needed > has)
        return fmt::format(
            "{}, {:.2f} GiB more than its {:.2f} GiB; use another device or a smaller volume",
            needs, gib(needed - has), gib(has));
    if (plan.bricks.count() > shared::MAX_BRICKS)
        return fmt::format(
            "{} in {} bricks, {} more than fit; use another device or a smaller volume", needs,
            plan.bricks.count(), plan.bricks.count() - shared::MAX_BRICKS);
    return "";
}

}  // namespace isorast
