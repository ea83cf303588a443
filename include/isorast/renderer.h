// SPDX-License-Identifier: MIT
// Renderer: one volume, or one that changes in time, on one device; each render() is one frame,
// straight from the voxels.
#pragma once
#include <isorast/camera.h>
#include <isorast/gpu.h>
#include <isorast/image.h>
#include <isorast/series.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isorast {

enum class Shading : uint8_t { gooch, phong, normals, depth, blocks, forward };

// Two eyes: both pictures beside each other, twice as wide; red-cyan in one picture; or, for those
// who show them otherwise, the left eye's picture above the right eye's, twice as high.
enum class StereoMode : uint8_t { off, side_by_side, anaglyph, layers };

std::string_view name_of(Rasterizer rasterizer);
std::string_view name_of(Shading shading);
std::string_view name_of(Occlusion occlusion);
std::string_view name_of(StereoMode mode);
std::optional<Rasterizer> parse_rasterizer(std::string_view word);
std::optional<Shading> parse_shading(std::string_view word);
std::optional<Occlusion> parse_occlusion(std::string_view word);
std::optional<StereoMode> parse_stereo(std::string_view word);

struct RendererOptions {
    // One of techniques(); "auto": direct, or raymarch where direct cannot be had or with `exact`.
    std::string technique = "auto";
    Rasterizer rasterizer = Rasterizer::automatic;
    Occlusion occlusion = Occlusion::automatic;
    // raymarch: solve each cell's cubic instead of stepping. direct and meshlets throw Error.
    bool exact = false;
    uint32_t max_brick_side = 0;  // largest side of a 3D image in voxels; 0: what the device allows
    uint32_t frames_in_flight = 2;  // slots of record() in <isorast/embed.h>; 0 counts as 1
    // Most bytes on the device for the time steps of a series: those that fit stay there. At least
    // two stay. 0: half of the device's memory, a quarter on CPU drivers.
    uint64_t step_bytes = 0;
};

struct Color {
    float r = 0, g = 0, b = 0, a = 1;  // sRGB, 0 to 1
};

// Keeps the points p of the surface with dot(normal, p) >= offset, world coordinates. Both finite;
// the normal has any length but 0.
struct ClipPlane {
    std::array<double, 3> normal{1, 0, 0};
    double offset = 0;
};

// Two eyes that look the same way, to the left and right of the camera's position: their frusta are
// sheared so that what lies at the distance of convergence shows no parallax.
struct Stereo {
    StereoMode mode = StereoMode::off;
    // World units, positive. By default the eyes converge at the camera's target, and are a 30th of
    // the distance of convergence apart: the usual limit for comfort.
    std::optional<double> separation{}, convergence{};
};

struct Frame {
    // Data units, finite; at most MAX_SURFACES (32) opaque surfaces.
    std::vector<double> isovalues{};
    std::vector<Color>
        colors{};  // one for each isovalue; the default palette fills up what is missing
    Camera camera{};
    Size size{};                     // of one eye's picture; sides of 1 to 16384 pixels
    std::vector<ClipPlane> clips{};  // at most MAX_CLIPS (8)
    Stereo stereo{};
    uint32_t time_step = 0;  // of a series, below Series::steps
    // forward: direct with the hardware rasterizer only.
    Shading shading = Shading::gooch;
    Color background{1, 1, 1, 1};  // alpha 0: transparent
    bool culling = true;  // frustum culling (and occlusion culling where the technique has it)
    bool want_depth = false;

    uint32_t eyes() const { return stereo.mode == StereoMode::off ? 1 : 2; }
};

struct PassTime {
    std::string name;
    double milliseconds = 0;
};

struct FrameStats {
    std::vector<PassTime> passes;  // in the order of the frame; GPU time
    double total_ms = 0;           // from the first to the last timestamp
    // Blocks of the grid; those that hold surface, and of these drawn (meshlets: meshlets).
    uint64_t blocks = 0, blocks_active = 0, blocks_drawn = 0;
    double wait_ms = 0;           // until the time step was read and uploaded; 0: it was there
    uint32_t resident_steps = 1;  // time steps on the GPU
    uint64_t volume_bytes = 0;    // voxels on the GPU, brick aprons included, of all these steps
    // Of the grid and the technique, whatever the picture's size: min-max blocks, lists, meshes.
    uint64_t extra_bytes = 0;
    // The frame's images. In neither: the depth pyramid, copies of the depth, and host memory.
    uint64_t target_bytes = 0;
    uint32_t bricks = 0;
};

// What does not fit the device, before anything is allocated: empty when all fits, else one line
// that says what and by how much.
std::string what_does_not_fit(const Gpu& gpu, const Volume& volume,
                              const RendererOptions& options = {}, uint32_t time_steps = 1);

std::vector<std::string> techniques();

// The rasterizer that direct uses on this device unless told otherwise. The first time, the compute
// rasterizer draws a sphere that is compared with the formula, and where there is a choice, both
// draw a small scene (the hardware rasterizer with either occlusion test) and the faster one wins.
// The answer is kept in the user's cache directory (XDG_CACHE_HOME or ~/.cache), for this device,
// driver and version of isorast; where that cannot be written, for the life of the Gpu; not at all
// if the sphere could not be drawn, for want of memory for one. `type`: of the volume to be drawn,
// if there is one; the sphere has the same, so that its shaders are compiled only once.
RasterizerChoice choose_rasterizer(Gpu& gpu, VoxelType type = VoxelType::u8);

class Renderer {
public:
    // Uploads the volume (or samples its formula) and builds the min-max blocks. The volume may be
    // freed afterwards; the Gpu must outlive the Renderer. Throws Error when the device or the
    // technique cannot do it.
    Renderer(Gpu& gpu, const Volume& volume, const RendererOptions& options = {});
    // The same for the first step. The others are read and uploaded when a frame shows them, or
    // before, by a thread of the Renderer: then the step that will probably be next, as far again
    // as the last one was, around the end. series.load must work as long as the Renderer lives.
    Renderer(Gpu& gpu, const Series& series, const RendererOptions& options = {});
    Renderer(Renderer&&) noexcept;
    ~Renderer();

    // Waits for the frame's time step if it is not there; throws its Error if it cannot be read.
    // Throws Error too for what Frame, Camera and Stereo do not allow, and when memory runs out.
    Image render(const Frame& frame);

    // The frame's GPU times and counts, of the last render().
    const FrameStats& stats() const;
    // The range of the finite voxels, in data units, of the time step that was shown last, at first
    // step 0; as found on the GPU; NaN if there are none. This and surface_hull() may submit
    // to the device's queue and wait.
    std::array<double, 2> value_range() const;
    // Corners of the outermost blocks that the surfaces at these isovalues (data units) cross;
    // empty when there is no surface. For cameras that fit the object and not the empty space
    // around it: OrbitOptions::shown. Of the time step that was shown last, too.
    VoxelPoints surface_hull(const std::vector<double>& isovalues) const;
    std::string technique() const;  // what "auto" became
    Rasterizer rasterizer() const;  // what `automatic` became
    // What `automatic` became; still automatic if the technique has no occlusion culling.
    Occlusion occlusion() const;

    class State;
    State& state() const { return *state_; }

private:
    std::unique_ptr<State> state_;
};

}  // namespace isorast
