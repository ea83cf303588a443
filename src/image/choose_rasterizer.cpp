// SPDX-License-Identifier: MIT
// Which of direct's rasterizers suits a device: first whether the compute rasterizer is right there
// (a sphere against its formula), then which one is faster; remembered in the user's cache.
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/renderer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "gpu/device.h"
#include "image/state.h"

namespace isorast {

namespace {

namespace fs = std::filesystem;

constexpr uint32_t SIDE = 24, PICTURE = 96;
constexpr double MIDDLE = (SIDE - 1) / 2.0, RADIUS = 9, DISTANCE = 40;

// 128 at the sphere's surface, 16 more for each voxel inwards.
template <class Voxel>
std::vector<std::byte> sphere_bytes() {
    std::vector<Voxel> voxels;
    for (uint32_t k = 0; k < SIDE; ++k)
        for (uint32_t j = 0; j < SIDE; ++j)
            for (uint32_t i = 0; i < SIDE; ++i) {
                const double distance = std::hypot(i - MIDDLE, j - MIDDLE, k - MIDDLE);
                const double value = std::round(128 + 16 * (RADIUS - distance));
                voxels.push_back(Voxel(std::clamp(value, 0.0, 255.0)));
            }
    const auto bytes = std::as_bytes(std::span(voxels));
    return {bytes.begin(), bytes.end()};
}

// In voxels that the GPU stores as it stores `type`.
Volume sphere(VoxelType type) {
    Volume volume;
    volume.name = "the self-test";
    volume.dims = {SIDE, SIDE, SIDE};
    const size_t bytes = bytes_of(type);
    volume.type = bytes == 1 ? VoxelType::u8 : bytes == 2 ? VoxelType::u16 : VoxelType::f32;
    volume.bytes = VoxelBytes::own(bytes == 1   ? sphere_bytes<uint8_t>()
                                   : bytes == 2 ? sphere_bytes<uint16_t>()
                                                : sphere_bytes<float>());
    return volume;
}

// Draws depth by direct's compute rasterizer; not through a Renderer, whose shading pass takes time
// to compile.
class SelfTest {
public:
    SelfTest(const gpu::Device& device, const Volume& volume)
        : grid_(device, series_of({&volume, 1}), 0, 0),
          placement_{volume.affine, volume.dims},
          depth_(device, sizeof(float) * PICTURE * PICTURE, gpu::Buffer::Memory::host,
                 "the self-test") {
        const RendererOptions options{.technique = "direct", .rasterizer = Rasterizer::compute};
        technique_ = make_technique({grid_, options});
    }

    // Pixels whose hit is not on the sphere, of an orthographic picture `height` voxels high.
    uint32_t wrong_pixels(double height) {
        const std::array<double, 3> towards{0.48, -0.6, 0.64};  // from sphere to eye, length 1
        Frame frame{.isovalues = {128}, .size = {PICTURE, PICTURE}, .culling = false};
        frame.camera = {.up = {0, 0, 1}, .orthographic = true, .height = height};
        for (int axis = 0; axis < 3; ++axis) {
            frame.camera.target[axis] = MIDDLE;
            frame.camera.position[axis] = MIDDLE + DISTANCE * towards[axis];
        }
        const auto info = make_frame_info(frame, placement_, grid_.stored());
        gpu::run_once(grid_.device(), [&](gpu::Commands& commands) {
            target_.fit(grid_.device(), commands, frame, /* hardware= */ false);
            commands.barrier();
            grid_.begin_frame(commands, info);
            technique_->prepare(commands, {info.surfaces[0].w});
            technique_->record(commands, frame, target_);
            commands.copy_to_buffer(target_.depth, depth_);
        });
        const double unit = world_unit(placement_);
        const double near = info.depth_range.x * unit, far = info.depth_range.y * unit;
        uint32_t wrong = 0;
        for (uint32_t i = 0; i < PICTURE * PICTURE; ++i) {
            const uint32_t column = i % PICTURE, row = i / PICTURE;
            const double x = ((column + 0.5) / PICTURE - 0.5) * height;
            const double y = ((row + 0.5) / PICTURE - 0.5) * height;
            const double aside = std::hypot(x, y), reversed = double(depth_.data<float>()[i]);
            const double above = DISTANCE - (far - reversed * (far - near));  // the middle
            if (reversed > 0)
                wrong += std::abs(std::hypot(aside, above) - RADIUS) > 0.15 || above < -0.5;
            else
                wrong += aside < RADIUS - 0.15;
        }
        return wrong;
    }

private:
    Grid grid_;
    Placement placement_;
    gpu::Buffer depth_;
    Target target_;
    std::unique_ptr<Technique> technique_;
};

// Empty if the compute rasterizer draws what it should: triangles of some pixels, and such as are
// larger than the picture. `failed`: if it could not draw, which may be this moment's fault, such
// as memory that other programs have.
std::string problem_of_compute(const Gpu& gpu, VoxelType type, bool& failed) {
    try {
        const Volume volume = sphere(type);
        SelfTest test(gpu.device(), volume);
        const uint32_t wrong = test.wrong_pixels(24) + test.wrong_pixels(1.2);
        if (wrong == 0) return "";
        return fmt::format("{} of {} pixels of a sphere are wrong", wrong, 2 * PICTURE * PICTURE);
    } catch (const Error& error) {
        failed = true;
        return error.what();
    }
}

// The fastest of some frames, milliseconds on the clock: waits included, as they are in use, but
// not those for other programs, which have the device at times.
double frame_ms(Gpu& gpu, Rasterizer rasterizer, Occlusion occlusion) {
    using Clock = std::chrono::steady_clock;
    const Volume volume = make_procedural("noise:128:type=u8");
    Renderer renderer(gpu, volume,
                      {.technique = "direct", .rasterizer = rasterizer, .occlusion = occlusion});
    const Frame frame{.isovalues = {0.5}, .camera = orbit(volume, 30, 20), .size = {1920, 1080}};
    renderer.state().run(std::vector<Frame>(3, frame));
    double fastest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 10; ++i) {
        const auto start = Clock::now();
        renderer.state().run({frame});
        const std::chrono::duration<double, std::milli> time = Clock::now() - start;
        fastest = std::min(fastest, time.count());
    }
    return fastest;
}

RasterizerChoice find_choice(Gpu& gpu, VoxelType type, bool hardware, bool& failed) {
    RasterizerChoice choice{.problem = problem_of_compute(gpu, type, failed)};
    const bool compute = choice.problem.empty();
    // A CPU has no rasterizer to spare: mesh shaders there cost seconds to compile and always lose.
    if (hardware && !gpu.device().is_cpu()) {
        choice.hardware_ms = frame_ms(gpu, Rasterizer::hardware, Occlusion::hiz);
        if (gpu.device().features().fragment_stores) {
            const double raster_ms = frame_ms(gpu, Rasterizer::hardware, Occlusion::raster);
            // What proxies cost grows faster with pixels and eyes: they must win clearly.
            if (raster_ms < 0.9 * choice.hardware_ms) {
                choice.occlusion = Occlusion::raster;
                choice.hardware_ms = raster_ms;
            }
        }
        if (compute) choice.compute_ms = frame_ms(gpu, Rasterizer::compute, Occlusion::hiz);
    }
    if (compute && choice.compute_ms <= choice.hardware_ms)
        choice.rasterizer = Rasterizer::compute;
    else if (hardware)
        choice.rasterizer = Rasterizer::hardware;
    return choice;
}

// One line: what the answer holds for.
std::string key_of(const Gpu& gpu, bool hardware) {
    const DeviceInfo& info = gpu.info();
    return fmt::format("isorast {}, {}, {}, Vulkan {}, subgroup {}, {}", ISORAST_VERSION, info.name,
                       info.driver, info.api_version, info.subgroup_size,
                       !hardware ? "no mesh shaders"
                       : gpu.device().features().fragment_stores
                           ? "mesh shaders"
                           : "mesh shaders, no raster proxies");
}

// Empty: nowhere.
fs::path cache_file(const std::string& key) {
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    fs::path folder = cache && *cache ? fs::path(cache) : fs::path(home ? home : "") / ".cache";
    if (!folder.is_absolute()) return {};
    uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    for (const char c : key)
        hash = (hash ^ uint8_t(c)) * 0x100000001b3u;
    return folder / "isorast" / fmt::format("rasterizer-{:016x}", hash);
}

// The key, the rasterizer, its problem, the times and the occlusion test: a line each. Anything
// else counts as nothing.
std::optional<RasterizerChoice> read_choice(const fs::path& path, const std::string& key) {
    std::ifstream file(path);
    std::string found, word, occlusion;
    RasterizerChoice choice;
    if (!std::getline(file, found) || !std::getline(file, word) ||
        !std::getline(file, choice.problem) ||
        !(file >> choice.hardware_ms >> choice.compute_ms >> occlusion))
        return std::nullopt;
    const auto rasterizer = parse_rasterizer(word);
    const auto test = parse_occlusion(occlusion);
    if (found != key || !rasterizer || !test) return std::nullopt;
    choice.rasterizer = *rasterizer;
    choice.occlusion = *test;
    return choice;
}

// Written beside and renamed, so that nobody reads half a file. A cache that cannot be written is
// no error: the next program finds out for itself.
void write_choice(const fs::path& path, const std::string& key, const RasterizerChoice& choice) {
    std::error_code ignored;
    fs::create_directories(path.parent_path(), ignored);
    fs::path beside = path;
    beside += fmt::format(".{:x}", std::chrono::steady_clock::now().time_since_epoch().count());
    {
        std::ofstream file(beside);
        file << fmt::format("{}\n{}\n{}\n{} {} {}\n", key, name_of(choice.rasterizer),
                            choice.problem, choice.hardware_ms, choice.compute_ms,
                            name_of(choice.occlusion));
        if (!file.flush()) return;
    }
    fs::rename(beside, path, ignored);
}

}  // namespace

RasterizerChoice choose_rasterizer(Gpu& gpu, VoxelType type) {
    auto& known = gpu.device().rasterizer_choice;
    if (known) return *known;
    const bool hardware = gpu.info().why_not_hardware.empty();
    const std::string key = key_of(gpu, hardware);
    const fs::path file = cache_file(key);
    if (!file.empty()) known = read_choice(file, key);
    if (!known) {
        bool failed = false;
        const RasterizerChoice found = find_choice(gpu, type, hardware, failed);
        if (failed) return found;  // for now
        known = found;
        if (!file.empty()) write_choice(file, key, *known);
    }
    return *known;
}

}  // namespace isorast
