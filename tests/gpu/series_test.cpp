// SPDX-License-Identifier: MIT
// Time steps: each frame of a series is the picture of its step alone, whichever steps fit on the
// GPU, in whichever order they come, and whoever reads them; and reading ahead does happen.
#include <isorast/embed.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <random>
#include <thread>

#include "gpu/commands.h"
#include "gpu/device.h"
#include "gpu/gpu_fixture.h"
#include "image/state.h"

namespace {

using namespace isorast;

constexpr uint64_t TWO_STEPS = 1;  // bytes: fewer than two steps are never kept
constexpr uint64_t ALL_STEPS = 0;

// The steps of a formula as voxels in memory.
std::vector<Volume> sampled_steps(const std::string& name) {
    std::vector<Volume> volumes;
    for (uint32_t step = 0; step < make_procedural(name).time_steps; ++step) {
        volumes.push_back(make_procedural(name, step));
        sample(volumes.back());
        volumes.back().field.reset();
        volumes.back().name += fmt::format(", step {}", step);
    }
    return volumes;
}

bool same_bits(const Image& a, const Image& b) {
    return a.rgba == b.rgba && a.depth.size() == b.depth.size() &&
           std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

Frame small_frame(const Frame& frame, uint32_t step) {
    Frame f = frame;
    f.size = {120, 90};
    f.time_step = step;
    return f;
}

class SeriesTest : public GpuTest {
protected:
    // Forwards, around the end, backwards and at random, with two steps on the GPU and with all,
    // each frame is that of its step alone.
    void expect_each_step_alone(const Series& series, RendererOptions options = {}) {
        const Volume first = series.load(0);
        const Frame f = frame(orbit(first, 30, 20), parse_isovalues("auto", first));
        const std::vector<std::pair<std::string, Rasterizer>> ways{
            {"direct", Rasterizer::hardware},
            {"direct", Rasterizer::compute},
            {"meshlets", Rasterizer::hardware},
            {"raymarch", Rasterizer::compute}};
        for (const auto& [technique, rasterizer] : ways) {
            if (rasterizer == Rasterizer::hardware &&
                (GRAPHICS_CRASHES || !gpu.info().why_not_hardware.empty()))
                continue;
            options.technique = technique;
            options.rasterizer = rasterizer;
            std::vector<Image> alone;
            for (uint32_t step = 0; step < series.steps; ++step)
                alone.push_back(
                    Renderer(gpu, series.load(step), options).render(small_frame(f, 0)));
            EXPECT_FALSE(same_bits(alone.at(0), alone.at(1)));
            for (const uint64_t bytes : {TWO_STEPS, ALL_STEPS}) {
                options.step_bytes = bytes;
                play(series, options, f, alone);
            }
        }
    }

private:
    void play(const Series& series, const RendererOptions& options, const Frame& f,
              const std::vector<Image>& alone) {
        const uint32_t count = series.steps;
        std::vector<uint32_t> order;
        for (uint32_t i = 0; i < count + 2; ++i)
            order.push_back(i % count);
        for (uint32_t i = 0; i < count; ++i)
            order.push_back(count - 1 - i);
        std::mt19937 random(5);
        for (uint32_t i = 0; i < 2 * count; ++i)
            order.push_back(uint32_t(random() % count));
        Renderer renderer(gpu, series, options);
        for (const uint32_t step : order) {
            ASSERT_TRUE(same_bits(renderer.render(small_frame(f, step)), alone[step]))
                << fmt::format("{}, {} {}, step {}", series.name, options.technique,
                               name_of(options.rasterizer), step);
            EXPECT_LE(renderer.stats().resident_steps, options.step_bytes == TWO_STEPS ? 2 : count);
        }
        if (options.step_bytes == ALL_STEPS) {
            EXPECT_EQ(renderer.stats().resident_steps, count);
            EXPECT_EQ(renderer.stats().wait_ms, 0);
        }
    }
};

TEST_F(SeriesTest, EachStepIsThatStepAlone) {
    for (const std::string name :
         {"noise:32:octaves=3:type=u8:steps=4", "coral:28x32x24:steps=3"}) {
        const auto volumes = sampled_steps(name);
        expect_each_step_alone(series_of(volumes));
    }
}

TEST_F(SeriesTest, EachStepOfAFormulaIsThatStepAlone) {
    expect_each_step_alone(procedural_series("coral:32:type=u16:steps=4"));
}

TEST_F(SeriesTest, EachStepIsThatStepAloneInBricks) {
    if (!gpu.device().features().nonuniform_textures) GTEST_SKIP();
    const auto volumes = sampled_steps("noise:32:octaves=3:type=u8:steps=3");
    expect_each_step_alone(series_of(volumes), {.max_brick_side = 19});
}

TEST_F(SeriesTest, TheRangeIsThatOfTheStepShown) {
    std::vector<Volume> volumes;
    for (const float scale : {1.0f, 3.0f}) {
        volumes.push_back(reference::volume_of<float>(
            {20, 20, 20}, VoxelType::f32, [&](double i, double j, double k) {
                const bool hole = i == 3 && j == 4;
                return hole ? std::numeric_limits<float>::quiet_NaN()
                            : scale * float(10 - std::hypot(i - 9, j - 9, k - 9));
            }));
    }
    Renderer renderer(gpu, series_of(volumes), {.technique = "raymarch"});
    for (const uint32_t step : {0u, 1u, 0u, 1u}) {
        const Frame f = small_frame(frame(orbit(volumes[0], 30, 20), {4.0}), step);
        const Image alone =
            Renderer(gpu, volumes[step], {.technique = "raymarch"}).render(small_frame(f, 0));
        EXPECT_TRUE(same_bits(renderer.render(f), alone)) << step;
        const Statistics expected = statistics(volumes[step]);
        EXPECT_EQ(renderer.value_range(), (std::array{expected.minimum, expected.maximum}));
    }
}

// Which thread asked for which step.
class Witness {
public:
    explicit Witness(const std::vector<Volume>& volumes) : inner_(series_of(volumes)) {}
    Series series() {
        return {"witness", inner_.steps, [this](uint32_t step) {
                    const std::lock_guard lock(mutex_);
                    if (std::this_thread::get_id() != main_) ++loads_elsewhere;
                    ++loads;
                    return inner_.load(step);
                }};
    }
    std::atomic<int> loads = 0, loads_elsewhere = 0;

private:
    Series inner_;
    std::mutex mutex_;
    std::thread::id main_ = std::this_thread::get_id();
};

TEST_F(SeriesTest, TheNextStepIsReadByAnotherThread) {
    const auto volumes = sampled_steps("sphere:24:steps=6");
    Witness witness(volumes);
    Renderer renderer(gpu, witness.series(), {.technique = "raymarch", .step_bytes = TWO_STEPS});
    const Frame f = frame(orbit(volumes[0], 30, 20), {0.25});
    for (const uint32_t step : {0, 1, 2, 3, 4, 5, 0, 1})
        renderer.render(small_frame(f, step));
    // Each once, as it was shown, and step 2, ahead of time: perhaps not yet.
    for (int i = 0; i < 1000 && witness.loads < 9; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(witness.loads, 9);
    EXPECT_EQ(witness.loads_elsewhere, 8);
}

// In a loop over more steps than fit, those that fit do stay.
TEST_F(SeriesTest, ALoopReadsOnlyWhatDoesNotFit) {
    const auto volumes = sampled_steps("sphere:24:steps=8");
    uint64_t bytes = 0;
    {
        const Renderer one(gpu, volumes[0], {.technique = "raymarch"});
        bytes =
            one.state().grid().steps().volume_bytes() + one.state().grid().steps().minmax_bytes();
    }
    Witness witness(volumes);
    Renderer renderer(gpu, witness.series(), {.technique = "raymarch", .step_bytes = 6 * bytes});
    const Frame f = frame(orbit(volumes[0], 30, 20), {0.25});
    for (uint32_t i = 0; i < 16; ++i)
        renderer.render(small_frame(f, i % 8));
    EXPECT_EQ(renderer.stats().resident_steps, 6u);
    const int before = witness.loads;
    for (uint32_t i = 0; i < 8; ++i)
        renderer.render(small_frame(f, i % 8));
    EXPECT_GE(witness.loads - before, 2);
    EXPECT_LE(witness.loads - before, 4);
}

TEST_F(SeriesTest, FramesInFlightKeepTheirSteps) {
    const auto volumes = sampled_steps("noise:40:octaves=3:type=u8:steps=5");
    const Series series = series_of(volumes);
    Renderer renderer(gpu, series, {.technique = "raymarch", .step_bytes = TWO_STEPS});
    const Frame f = frame(orbit(volumes[0], 30, 20), {0.5});
    std::vector<Frame> frames;
    for (uint32_t i = 0; i < 20; ++i)
        frames.push_back(small_frame(f, 3 * i % 5));
    EXPECT_EQ(renderer.state().run(frames).size(), 20u);
    for (uint32_t step = 0; step < 5; ++step)
        EXPECT_TRUE(same_bits(
            renderer.render(small_frame(f, step)),
            Renderer(gpu, volumes[step], {.technique = "raymarch"}).render(small_frame(f, 0))))
            << step;
}

TEST_F(SeriesTest, AnErrorIsThatOfTheFrameThatNeedsTheStep) {
    auto volumes = sampled_steps("sphere:24:steps=6");
    volumes[4] = reference::sampled("sphere:20");
    const Series inner = series_of(volumes);
    bool broken = true;
    const Series series{"test", 6, [&](uint32_t step) {
                            if (step == 2 && broken) throw Error("disk: step 2 is gone");
                            return inner.load(step);
                        }};
    Renderer renderer(gpu, series, {.technique = "raymarch"});
    const Frame f = frame(orbit(volumes[0], 30, 20), {0.25});
    const auto error_at = [&](uint32_t step) -> std::string {
        try {
            renderer.render(small_frame(f, step));
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(error_at(0), "");
    EXPECT_EQ(error_at(1), "");  // meanwhile step 2 fails in the background
    EXPECT_EQ(error_at(2), "disk: step 2 is gone");
    EXPECT_EQ(error_at(2), "disk: step 2 is gone");
    EXPECT_EQ(error_at(3), "");
    EXPECT_NE(error_at(4).find("sphere:20: expected the dimensions of sphere:24:steps=6, step 0, "
                               "24x24x24, found 20x20x20"),
              std::string::npos)
        << error_at(4);
    EXPECT_NE(error_at(6).find("time step from 0 to 5, found 6"), std::string::npos) << error_at(6);
    broken = false;
    EXPECT_EQ(error_at(2), "");
    EXPECT_EQ(error_at(5), "");
}

// A host with one queue, and one that gives a second one for uploads.
TEST_F(SeriesTest, AHostRecordsTheStepsOfASeries) {
    const gpu::Device& device = gpu.device();
    HostDevice host;
    host.physical_device = device.physical();
    host.device = device.handle();
    host.queue = device.queue();
    host.queue_family = device.queue_family();
    host.storage_16bit = true;
    if (device.upload_queue() != device.queue()) {
        host.upload_queue = device.upload_queue();
        host.upload_queue_family = device.upload_family();
    }
    const auto volumes = sampled_steps("noise:40:octaves=3:type=u8:steps=5");
    const Frame f = frame(orbit(volumes[0], 30, 20), {0.5});
    std::vector<Image> alone;  // made before: the host's queues are nobody else's
    std::vector<std::array<double, 2>> ranges;
    std::vector<VoxelPoints> hulls;
    for (const Volume& volume : volumes) {
        Renderer renderer(gpu, volume, {.technique = "raymarch"});
        alone.push_back(renderer.render(small_frame(f, 0)));
        ranges.push_back(renderer.value_range());
        hulls.push_back(renderer.surface_hull({0.5}));
    }
    Gpu adopted(host);
    Renderer renderer(adopted, series_of(volumes),
                      {.technique = "raymarch", .step_bytes = TWO_STEPS});
    const uint64_t bytes = uint64_t{4} * 120 * 90;
    std::array<gpu::Buffer, 2> pixels;
    for (auto& buffer : pixels)
        buffer = gpu::Buffer(device, bytes, gpu::Buffer::Memory::host, "a test");
    // Two in flight at once, of different steps.
    for (const auto& steps : {std::array{0u, 1u}, {2u, 4u}, {3u, 3u}, {0u, 4u}}) {
        std::vector<std::unique_ptr<gpu::Submission>> submissions;
        for (uint32_t slot = 0; slot < 2; ++slot) {
            submissions.push_back(std::make_unique<gpu::Submission>(device));
            gpu::Commands commands = submissions.back()->begin();
            const RecordedFrame recorded =
                record(renderer, commands.handle(), small_frame(f, steps[slot]), slot);
            // What the step holds, also before the host submits what builds its pyramid.
            EXPECT_EQ(renderer.value_range(), ranges[steps[slot]]);
            EXPECT_EQ(renderer.surface_hull({0.5}), hulls[steps[slot]]);
            const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                           .imageExtent = {120, 90, 1}};
            vkCmdCopyImageToBuffer(commands.handle(), recorded.color, VK_IMAGE_LAYOUT_GENERAL,
                                   pixels[slot].handle(), 1, &region);
            submissions.back()->submit();
        }
        for (auto& submission : submissions)
            submission->wait();
        for (uint32_t slot = 0; slot < 2; ++slot) {
            EXPECT_EQ(
                std::memcmp(pixels[slot].data<uint8_t>(), alone[steps[slot]].rgba.data(), bytes), 0)
                << steps[slot];
        }
    }
    // Two recorded frames of a step that is not here yet, and none submitted.
    std::array<std::unique_ptr<gpu::Submission>, 2> both;
    for (uint32_t slot = 0; slot < 2; ++slot) {
        both[slot] = std::make_unique<gpu::Submission>(device);
        record(renderer, both[slot]->begin().handle(), small_frame(f, 2), slot);
    }
    EXPECT_EQ(renderer.value_range(), ranges[2]);
    EXPECT_EQ(renderer.surface_hull({0.5}), hulls[2]);
    for (auto& submission : both)
        submission->submit();
    for (auto& submission : both)
        submission->wait();
}

}  // namespace
