// SPDX-License-Identifier: MIT
// Renderer: one volume on one device; each render() is one frame, straight from the voxels.
#pragma once
#include <isorast/camera.h>
#include <isorast/gpu.h>
#include <isorast/image.h>
#include <isorast/volume.h>

#include <memory>
#include <string>
#include <vector>

namespace isorast {

enum class Shading : uint8_t { gooch, phong, normals, depth, blocks, forward };

std::string_view name_of(Rasterizer rasterizer);
std::string_view name_of(Shading shading);
std::optional<Rasterizer> parse_rasterizer(std::string_view word);
std::optional<Shading> parse_shading(std::string_view word);

struct RendererOptions {
    // One of techniques(); "auto": direct, or raymarch where direct cannot be had.
    std::string technique = "auto";
    Rasterizer rasterizer = Rasterizer::automatic;
    bool exact = false;           // raymarch: solve each cell's cubic instead of stepping
    uint32_t max_brick_side = 0;  // largest side of a 3D image in voxels; 0: what the device allows
    uint32_t frames_in_flight = 2;
};

struct Color {
    float r = 0, g = 0, b = 0, a = 1;  // sRGB, 0 to 1
};

struct Frame {
    std::vector<double> isovalues{};  // data units; at most MAX_SURFACES (32) opaque surfaces
    std::vector<Color>
        colors{};  // one for each isovalue; the default palette fills up what is missing
    Camera camera{};
    Size size{};
    Shading shading = Shading::gooch;
    Color background{1, 1, 1, 1};  // alpha 0: transparent
    bool culling = true;  // frustum culling (and occlusion culling where the technique has it)
    bool want_depth = false;
};

struct PassTime {
    std::string name;
    double milliseconds = 0;
};

struct FrameStats {
    std::vector<PassTime> passes;  // in the order of the frame; GPU time
    double total_ms = 0;           // from the first to the last timestamp
    uint64_t blocks = 0, blocks_active = 0, blocks_drawn = 0;
    uint64_t volume_bytes = 0;  // voxels on the GPU, brick aprons included
    uint64_t extra_bytes = 0;   // everything else on the GPU but the frame's targets
    uint64_t target_bytes = 0;
    uint32_t bricks = 0;
};

// What does not fit the device, before anything is allocated: empty when all fits, else one line
// that says what and by how much.
std::string what_does_not_fit(const Gpu& gpu, const Volume& volume,
                              const RendererOptions& options = {});

std::vector<std::string> techniques();

// The rasterizer that direct uses on this device unless told otherwise. The first time, the compute
// rasterizer draws a sphere that is compared with the formula, and where there is a choice, both
// draw a small scene and the faster one wins. The answer is kept in the user's cache directory
// (XDG_CACHE_HOME or ~/.cache), for this device, driver and version of isorast; where that cannot
// be written, for the life of the Gpu. `type`: of the volume to be drawn, if there is one; the
// sphere has the same, so that its shaders are compiled only once.
RasterizerChoice choose_rasterizer(Gpu& gpu, VoxelType type = VoxelType::u8);

class Renderer {
public:
    // Uploads the volume (or samples its formula) and builds the min-max blocks. The volume may be
    // freed afterwards. Throws Error when the device or the technique cannot do it.
    Renderer(Gpu& gpu, const Volume& volume, const RendererOptions& options = {});
    Renderer(Renderer&&) noexcept;
    ~Renderer();

    Image render(const Frame& frame);

    // The frame's GPU times and counts, of the last render().
    const FrameStats& stats() const;
    // The range of the finite voxels, in data units, as found on the GPU.
    std::array<double, 2> value_range() const;
    // Corners of the outermost blocks that the surfaces at these isovalues (data units) cross;
    // empty when there is no surface. For cameras that fit the object and not the empty space
    // around it: OrbitOptions::shown.
    VoxelPoints surface_hull(const std::vector<double>& isovalues) const;
    std::string technique() const;  // what "auto" became
    Rasterizer rasterizer() const;  // what `automatic` became

    class State;
    State& state() const { return *state_; }

private:
    std::unique_ptr<State> state_;
};

}  // namespace isorast
