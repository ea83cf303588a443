// SPDX-License-Identifier: MIT
// Lists of blocks: active ones an isovalue, drawn ones a frame.
#include "techniques/direct/culling.h"

#include <algorithm>
#include <cmath>

#include "cull_comp.h"
#include "cull_hiz.h"
#include "cull_surfaces.h"
#include "find_active_comp.h"
#include "gpu/device.h"
#include "guess_visible_comp.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Memory = gpu::Buffer::Memory;

// Most workgroups along one axis of a dispatch that every device allows.
constexpr uint32_t MAX_ROW = 65535;
constexpr uint32_t ZERO = 0;
// Of each surface: of seen (or all), of likely, and of unseen blocks.
constexpr uint32_t LISTS = 3;

// With fewer blocks than this (a volume of 256^3), drawing in more steps costs more than drawing
// all blocks at once. A GPU's compute rasterizer draws 20000 while the last ray is waited for: more
// of them (512^3), and as MANY (half of 1024^3) to cast rays after each change.
constexpr uint32_t WORTH_A_STEP = 1 << 15, WORTH_A_STEP_IF_SOON = 1 << 18, MANY = 1 << 20;

// Groups of blocks that a workgroup of a cull pass looks at as wholes first; from so many blocks
// on, on CPUs and on GPUs (half of 2048^3).
constexpr uint32_t SIFTED = 32, WORTH_SIFTING_ON_CPU = 1 << 8, WORTH_SIFTING = 1 << 23;

// Rays that guess: how many across a block where the volume fills the picture, and after how many
// steps each gives up. More where blocks are many, or dear: the hardware rasterizer's.
constexpr uint32_t RAYS = 4, RAYS_IF_DEAR = 8, STEPS = 48, STEPS_IF_MANY = 64, STEPS_IF_DEAR = 192;

// Of the camera, from one frame to the next.
struct Motion {
    double degrees, distance;  // as a share of the distance to the target
};
// From CUT on, what the last frame saw says little. From FAST on, its holes are worth a step,
// unless blocks are drawn sooner (and rays, if blocks are the hardware rasterizer's); where blocks
// are many or dear, from ANY on.
constexpr Motion CUT{15, 0.25}, FAST{2, 0.035}, ANY{0.1, 0.002};

glm::dvec3 to_vec(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

bool has_moved(const std::optional<Camera>& from, const Camera& to, Motion most) {
    if (!from || from->orthographic != to.orthographic) return true;
    const glm::dvec3 before = to_vec(from->target) - to_vec(from->position);
    const glm::dvec3 now = to_vec(to.target) - to_vec(to.position);
    const double way = glm::length(to_vec(to.position) - to_vec(from->position));
    const double cosine = glm::dot(glm::normalize(now), glm::normalize(before));
    return cosine < std::cos(glm::radians(most.degrees)) ||
           way > most.distance * std::max(glm::length(now), glm::length(before));
}

}  // namespace

Culling::Culling(const Grid& grid, std::unique_ptr<OcclusionTest> occlusion, Workgroups workgroups)
    : grid_(grid),
      workgroups_(workgroups),
      sizes_(workgroups.for_large != 0 ? 2 : 1),
      occlusion_(std::move(occlusion)) {
    const gpu::Device& device = grid.device();
    const uint32_t groups = grid.info().groups.w;
    const uint64_t quartets = uint64_t{shared::QUARTETS} * groups;
    const uint64_t beyond = quartets - std::min<uint64_t>(quartets, workgroups.spread);
    draw_count_ = 1 + uint32_t((beyond + shared::DRAW_QUARTETS - 1) / shared::DRAW_QUARTETS);
    drawn_blocks_ = gpu::Buffer(device, 4 * quartets, Memory::device, "the list of drawn blocks");
    const uint64_t draws = uint64_t{LISTS} * shared::MAX_SURFACES * sizes_ * draw_count_;
    draws_ = gpu::Buffer(device, sizeof(shared::Draw) * draws, Memory::device, "draw arguments");
    counters_ = gpu::Buffer(device, sizeof(shared::Counters), Memory::device, "counters");
    for (gpu::Buffer& visible : visible_)
        visible = gpu::Buffer(device, uint64_t{4} * groups, Memory::device, "visible blocks");

    find_active_ = gpu::Pipeline::compute(
        device, grid.pipeline_info("find active", {Kind::buffer, Kind::buffer}, 12),
        find_active_comp);
    const uint32_t blocks = grid.info().blocks.w;
    const bool soon = !hardware() && !device.is_cpu();
    sifted_ = blocks >= (device.is_cpu() ? WORTH_SIFTING_ON_CPU : WORTH_SIFTING) ? SIFTED : 0;
    if (blocks < (soon ? WORTH_A_STEP_IF_SOON : WORTH_A_STEP)) return;
    dear_ = hardware() || blocks >= MANY;
    rays_pay_ = !soon || blocks >= MANY;
    if (occlusion_->kind() == Occlusion::hiz)
        drawn_before_ = gpu::Buffer(device, visible_[0].bytes(), Memory::device, "visible blocks");
    const uint32_t steps = hardware() ? STEPS_IF_DEAR : blocks >= MANY ? STEPS_IF_MANY : STEPS;
    const uint32_t filtered = grid.can_filter() ? 1 : 0;
    guess_visible_ = gpu::Pipeline::compute(
        device,
        grid.pipeline_info("guess visible", {Kind::buffer}, 4, {/* EXACT= */ 0, filtered, steps}),
        grid.pick(guess_visible_comp, guess_visible_comp_bricked));
}

uint64_t Culling::gpu_bytes() const {
    uint64_t bytes = occlusion_->gpu_bytes() + drawn_blocks_.bytes() + draws_.bytes() +
                     counters_.bytes() + 2 * visible_[0].bytes() + drawn_before_.bytes();
    for (const auto& list : active_groups_)
        bytes += list.bytes();
    return bytes;
}

const gpu::Pipeline& Culling::selection(Test test) {
    gpu::Pipeline& pipeline = selections_[eyes_ - 1][size_t(test)];
    if (pipeline) return pipeline;
    const auto code = test == Test::surfaces ? std::span<const uint32_t>(cull_surfaces)
                      : test == Test::hiz    ? std::span<const uint32_t>(cull_hiz)
                                             : std::span<const uint32_t>(cull_comp);
    pipeline =
        gpu::Pipeline::compute(grid_.device(),
                               grid_.pipeline_info("cull", std::vector(7, Kind::buffer), 8,
                                                   {workgroups_.for_large, eyes_, uint32_t(test),
                                                    sifted_, workgroups_.spread, workgroups_.most}),
                               code);
    return pipeline;
}

void Culling::find_active(Commands& commands, const std::vector<float>& isovalues) {
    const auto pass = commands.pass("find active");
    changed_ = true;
    const uint64_t list_bytes = 32 + uint64_t{8} * grid_.info().groups.w;
    while (active_groups_.size() < isovalues.size())
        active_groups_.emplace_back(grid_.device(), list_bytes, Memory::device,
                                    "the list of active blocks");
    commands.fill(counters_, 0);
    const std::array<uint32_t, 8> empty{0, 1, 1, 0, 0, 0, 1, 0};  // as in active_groups.glsl
    for (uint32_t i = 0; i < isovalues.size(); ++i)
        commands.update(active_groups_[i], 0, empty.data(), sizeof(empty));
    commands.barrier();
    for (uint32_t i = 0; i < isovalues.size(); ++i)
        find_active(commands, i, isovalues[i]);
    commands.barrier();
}

void Culling::find_active(Commands& commands, uint32_t surface, float isovalue) {
    struct Push {
        float isovalue;
        uint32_t groups_in_row, groups_at_once;
    };
    const uint32_t workgroups = (grid_.info().groups.w + 3) / 4;
    const uint32_t row = std::min(workgroups, MAX_ROW);
    commands.bind(find_active_, {active_groups_[surface], counters_});
    commands.push(Push{isovalue, row, sifted_ != 0 ? sifted_ : shared::CULL_GROUPS});
    commands.dispatch(row, (workgroups + row - 1) / row);
}

void Culling::begin_frame(Commands& commands, const Frame& frame, Target& target) {
    commands.update(counters_, offsetof(shared::Counters, blocks_drawn), &ZERO, sizeof(ZERO));
    commands.fill(draws_, 0);
    target.visible_blocks = nullptr;
    eyes_ = frame.eyes();
    culls_ = frame.culling && occlusion_->fit(target);
    if (!culls_) return commands.barrier();
    // What was marked last is seen now; the other set is cleared and marked next.
    seen_ = 1 - seen_;
    target.visible_blocks = &visible_[1 - seen_];
    commands.fill(visible_[1 - seen_], 0);
    const bool cut = has_moved(last_camera_, frame.camera, CUT);
    const bool fast = has_moved(last_camera_, frame.camera, FAST);
    const bool moved =
        cut || (fast && rays_pay_) || (dear_ && has_moved(last_camera_, frame.camera, ANY));
    if (cut) commands.fill(visible_[seen_], 0);
    last_camera_ = frame.camera;
    // Marks of drawn blocks are for all surfaces: likely ones can be drawn of a single one only.
    has_likely_ = drawn_before_ && frame.isovalues.size() == 1 && (changed_ || moved);
    commands.barrier();
    if (guess_visible_ && (cut || (changed_ && rays_pay_) || (fast && hardware())))
        guess_visible(commands, frame);
    changed_ = false;
}

void Culling::guess_visible(Commands& commands, const Frame& frame) const {
    const auto pass = commands.pass("guess visible");
    const glm::uvec3 blocks(grid_.info().blocks);
    const uint32_t rays = hardware() ? RAYS_IF_DEAR : RAYS;
    const uint32_t across = rays * std::max({blocks.x, blocks.y, blocks.z});
    const uint32_t shorter = std::min(frame.size.width, frame.size.height);
    const uint32_t side = std::clamp(shorter / across, 2u, 8u);
    const auto groups = [side](uint32_t pixels) { return (pixels / side + 7) / 8; };
    commands.bind(guess_visible_, {visible_[seen_]});
    commands.push(side);
    commands.dispatch(groups(frame.size.width), groups(frame.size.height), frame.eyes());
    commands.barrier();
}

void Culling::select(Commands& commands, uint32_t surface, Select which) {
    struct Push {
        uint32_t first_draw, draws_of_list;
    };
    const bool likely = which == Select::likely, unseen = which == Select::unseen;
    const bool hiz = occlusion_->kind() == Occlusion::hiz;
    pyramid_ = unseen && hiz ? &occlusion_->result() : nullptr;
    // For each Select; raster proxies have marked unseen blocks before.
    const std::array tests{Test::none, Test::seen, Test::surfaces, hiz ? Test::hiz : Test::tested};
    first_draw_ = (LISTS * surface + (likely ? 1 : unseen ? 2 : 0)) * sizes_ * draw_count_;
    commands.bind(
        selection(tests[size_t(which)]),
        {active_groups_[surface], draws_, drawn_blocks_, counters_,
         unseen ? drawn() : visible_[seen_], likely || unseen ? occlusion_->result() : drawn(),
         likely ? drawn_before_ : counters_});
    commands.push(Push{first_draw_, draw_count_});
    commands.dispatch_indirect(active_groups_[surface], 0);
}

}  // namespace isorast
