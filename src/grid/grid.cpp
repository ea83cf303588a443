// SPDX-License-Identifier: MIT
// The resident volume and its min-max pyramid.
#include "grid/grid.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <cmath>

#include "gpu/device.h"
#include "gpu/vulkan_check.h"
#include "minmax_blocks_comp.h"
#include "minmax_level_comp.h"
#include "sample_field_comp.h"
#include "volume/field.h"
#include "volume/voxels.h"

namespace isorast {

namespace {

using shared::uvec4;

struct SamplePush {
    field::FieldSampling sampling;
    glm::uvec3 origin;
};

glm::uvec3 divide_up(glm::uvec3 a, glm::uvec3 b) {
    return (a + b - 1u) / b;
}

uint32_t product(glm::uvec3 v) {
    return v.x * v.y * v.z;
}

shared::GridInfo make_info(const BrickPlan& plan) {
    shared::GridInfo info{};
    const glm::uvec3 cells = glm::max(plan.voxels, 1u) - 1u;
    glm::uvec3 nodes = glm::max(divide_up(cells, glm::uvec3(shared::BLOCK)), glm::uvec3(1));
    const glm::uvec3 groups = divide_up(nodes, {shared::GROUP_X, shared::GROUP_Y, shared::GROUP_Z});
    info.voxels = uvec4(plan.voxels, 0);
    info.blocks = uvec4(nodes, product(nodes));
    info.groups = uvec4(groups, product(groups));
    info.brick_cells = uvec4(plan.brick_cells, 0);
    info.bricks = uvec4(plan.bricks, 0);
    // Level 0 holds the blocks; each level above halves the sides, rounding up, up to the one root.
    for (uint32_t first = 0;; nodes = (nodes + 1u) / 2u) {
        info.levels[info.bricks.w++] = uvec4(nodes, first);
        first += product(nodes);
        if (product(nodes) == 1) return info;
    }
}

uint64_t minmax_bytes(const shared::GridInfo& info, const Stored& stored) {
    // Two values a node, up to the root; whole words.
    return ((uint64_t{info.levels[info.bricks.w - 1].w} + 1) * 2 * stored.bytes() + 3) &
           ~uint64_t{3};
}

bool can_sample_on_gpu(const gpu::Device& device, const Stored& stored) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device.physical(), stored.format, &properties);
    return device.features().storage_without_format &&
           (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT);
}

BrickPlan plan_for(const gpu::Device& device, const Volume& volume, const Stored& stored,
                   uint32_t max_brick_side) {
    const uint32_t device_side = device.limits().maxImageDimension3D;
    const uint32_t side = max_brick_side ? std::min(max_brick_side, device_side) : device_side;
    const glm::uvec3 voxels(volume.dims[0], volume.dims[1], volume.dims[2]);
    // Drivers pad images: leave an eighth of the largest allocation for that.
    return plan_bricks(voxels, stored.bytes(), side, device.max_allocation() / 8 * 7);
}

// Where the CPU draws, a texture unit is a call, and images lie in rows anyway: shaders fetch
// voxels from the image's memory if it is one.
void use_buffer(const gpu::Device& device, StepFormat& format, shared::GridInfo& info) {
    if (!device.is_cpu() || !format.bricks.one()) return;
    const auto layout = gpu::Texture::linear_layout(device, brick_image(format, 0));
    if (!layout) return;
    format.in_buffer = true;
    const uint32_t voxels_in_word = 4 / format.stored.bytes();
    info.voxels.w = voxels_in_word * layout->row_words;
    info.brick_cells.w = voxels_in_word * layout->slice_words;
}

void check_bricks(const gpu::Device& device, const Volume& volume, const BrickPlan& plan,
                  uint32_t max_brick_side) {
    if (plan.count() > shared::MAX_BRICKS)
        throw Error(
            fmt::format("{}: needs {} bricks of at most {} voxels a side, at most {} fit; use a "
                        "device with larger 3D images, or a smaller volume",
                        volume.name, plan.count(),
                        max_brick_side ? max_brick_side : device.limits().maxImageDimension3D,
                        shared::MAX_BRICKS));
    if (!plan.one() && !device.features().nonuniform_textures)
        throw Error(
            fmt::format("{}: does not fit one 3D image of {}, which cannot index several "
                        "(shaderSampledImageArrayNonUniformIndexing); use another device or a "
                        "smaller volume",
                        volume.name, device.info().name));
}

}  // namespace

GridPlan plan_grid(const gpu::Device& device, const Volume& volume, uint32_t max_brick_side) {
    // Only the width of a voxel matters here, not the origin of stored values.
    const size_t bytes = std::min<size_t>(bytes_of(volume.type), 4);
    const Stored stored{.format = bytes == 1   ? VK_FORMAT_R8_UNORM
                                  : bytes == 2 ? VK_FORMAT_R16_UNORM
                                               : VK_FORMAT_R32_SFLOAT,
                        .bits = uint32_t(8 * bytes)};
    const StepFormat format{.bricks = plan_for(device, volume, stored, max_brick_side),
                            .stored = stored};
    GridPlan plan{.bricks = format.bricks};
    plan.volume_bytes = volume.voxel_count() * stored.bytes();
    if (plan.bricks.count() <= shared::MAX_BRICKS) {
        plan.volume_bytes = 0;
        for (uint32_t i = 0; i < plan.bricks.count(); ++i)
            plan.volume_bytes += gpu::Texture::bytes_needed(device, brick_image(format, i));
    }
    plan.minmax_bytes = minmax_bytes(make_info(plan.bricks), stored);
    return plan;
}

Grid::Grid(const gpu::Device& device, const Series& series, uint32_t max_brick_side,
           uint64_t step_bytes)
    : Grid(device, Nothing()) {  // which makes nothing: should this throw, ~Grid() runs
    const Volume first = series.load(0);
    check(first);
    header_ = header_of(first);
    format_.stored = stored_as(first);
    format_.bricks = plan_for(device, first, format_.stored, max_brick_side);
    check_bricks(device, first, format_.bricks, max_brick_side);
    info_ = make_info(format_.bricks);
    format_.minmax_bytes = minmax_bytes(info_, format_.stored);
    format_.sampled_on_gpu =
        first.field && first.bytes.span().empty() && can_sample_on_gpu(device, format_.stored);
    use_buffer(device, format_, info_);
    steps_ = std::make_unique<Steps>(device, series, first, format_, step_bytes);

    using Memory = gpu::Buffer::Memory;
    info_buffer_ = gpu::Buffer(device, sizeof(info_), Memory::device, "the grid's description");
    frame_buffer_ =
        gpu::Buffer(device, sizeof(shared::FrameInfo), Memory::device, "the frame's description");
    make_scene_layout();
    make_pipelines();
    step_ = &steps_->first();
    gpu::run_once(device_, [&](gpu::Commands& commands) { begin_frame(commands, {}); });
    have_run();
}

Grid::~Grid() {
    vkDestroyDescriptorSetLayout(device_.handle(), scene_layout_, nullptr);
}

bool Grid::can_filter() const {
    return !device_.is_cpu();
}

uint64_t Grid::extra_bytes() const {
    return steps_->minmax_bytes() + info_buffer_.bytes() + frame_buffer_.bytes();
}

std::array<double, 2> Grid::value_range() const {
    // The root of the pyramid holds the range, except that floats' least value may stand for voxels
    // that are not finite: for these, reading the voxels found it.
    StoredRange range = step_->range;
    if (range.least > range.greatest) {
        const auto [least, greatest] = read_level(info_.bricks.w - 1).front();
        if (greatest == NOT_FINITE) return {std::nan(""), std::nan("")};
        range = {least, greatest};
    }
    const double a = stored().value(double(range.least));
    const double b = stored().value(double(range.greatest));
    return {std::min(a, b), std::max(a, b)};
}

gpu::PipelineInfo Grid::pipeline_info(const char* name, std::vector<gpu::Kind> bindings,
                                      uint32_t push_bytes, std::vector<uint32_t> more) const {
    std::vector<uint32_t> constants{stored().bits +
                                    (format_.in_buffer ? shared::VOXELS_IN_BUFFER : 0)};
    constants.insert(constants.end(), more.begin(), more.end());
    return {name, scene_layout_, std::move(bindings), push_bytes, std::move(constants)};
}

void Grid::make_pipelines() {
    minmax_blocks_ = gpu::Pipeline::compute(device_, pipeline_info("minmax blocks", {}, 0),
                                            pick(minmax_blocks_comp, minmax_blocks_comp_bricked));
    minmax_level_ =
        gpu::Pipeline::compute(device_, pipeline_info("minmax level", {}, 4), minmax_level_comp);
    if (format_.sampled_on_gpu)
        sample_field_ = gpu::Pipeline::compute(
            device_, pipeline_info("sample field", {gpu::Kind::image}, sizeof(SamplePush)),
            sample_field_comp);
}

void Grid::make_scene_layout() {
    const VkShaderStageFlags all = VK_SHADER_STAGE_ALL;
    const std::array bindings{
        VkDescriptorSetLayoutBinding{shared::BIND_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, all,
                                     nullptr},
        VkDescriptorSetLayoutBinding{shared::BIND_GRID, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, all,
                                     nullptr},
        VkDescriptorSetLayoutBinding{shared::BIND_BRICKS, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                                     shared::MAX_BRICKS, all, nullptr},
        VkDescriptorSetLayoutBinding{shared::BIND_SAMPLER, VK_DESCRIPTOR_TYPE_SAMPLER, 1, all,
                                     nullptr},
        VkDescriptorSetLayoutBinding{shared::BIND_MINMAX, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, all,
                                     nullptr},
        VkDescriptorSetLayoutBinding{shared::BIND_VOXELS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, all,
                                     nullptr}};
    const VkDescriptorSetLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = uint32_t(bindings.size()),
        .pBindings = bindings.data()};
    VK_CHECK(vkCreateDescriptorSetLayout(device_.handle(), &info, nullptr, &scene_layout_));
}

void Grid::show(uint32_t step, std::vector<uint32_t> in_flight) {
    step_ = &steps_->show(step, std::move(in_flight));
}

void Grid::begin_frame(gpu::Commands& commands, const shared::FrameInfo& frame) {
    // Voxels that are not finite count as the least finite value: only floats from the CPU have
    // such.
    const bool known = step_->range.least <= step_->range.greatest;
    info_.range.x = known ? step_->range.least : NOT_FINITE;
    commands.update(info_buffer_, 0, &info_, sizeof(info_));
    commands.update(frame_buffer_, 0, &frame, sizeof(frame));
    commands.barrier();
    commands.set_scene(make_set(commands));
    if (step_->built) return;
    build_step(commands);
    step_->built = step_->may_wait = true;
}

void Grid::begin_alone(gpu::Commands& commands) const {
    commands.update(info_buffer_, 0, &info_, sizeof(info_));
    commands.barrier();
    commands.set_scene(make_set(commands));
    if (step_->may_wait) build_step(commands);
}

void Grid::build_step(gpu::Commands& commands) const {
    if (step_->sampling) sample_formula(commands);
    build_minmax(commands);
}

VkDescriptorSet Grid::make_set(gpu::Commands& commands) const {
    const VkDescriptorSet set = commands.allocate_set(scene_layout_);
    const std::array uniforms{VkDescriptorBufferInfo{frame_buffer_.handle(), 0, VK_WHOLE_SIZE},
                              VkDescriptorBufferInfo{info_buffer_.handle(), 0, VK_WHOLE_SIZE}};
    const VkDescriptorBufferInfo minmax{step_->minmax.handle(), 0, VK_WHOLE_SIZE};
    const VkDescriptorBufferInfo voxels{
        format_.in_buffer ? step_->bricks[0].buffer() : minmax.buffer, 0, VK_WHOLE_SIZE};
    const VkDescriptorImageInfo sampler{.sampler = sampler_.handle()};
    // Every slot of the array must hold an image: those without a brick repeat the first.
    std::array<VkDescriptorImageInfo, shared::MAX_BRICKS> images;
    for (size_t i = 0; i < images.size(); ++i)
        images[i] = {VK_NULL_HANDLE, step_->bricks[i < step_->bricks.size() ? i : 0].view(),
                     VK_IMAGE_LAYOUT_GENERAL};
    const auto write = [&](uint32_t binding, uint32_t count, VkDescriptorType type,
                           const VkDescriptorBufferInfo* buffer,
                           const VkDescriptorImageInfo* image) {
        return VkWriteDescriptorSet{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                    .dstSet = set,
                                    .dstBinding = binding,
                                    .descriptorCount = count,
                                    .descriptorType = type,
                                    .pImageInfo = image,
                                    .pBufferInfo = buffer};
    };
    const std::array writes{
        write(shared::BIND_FRAME, 1, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, &uniforms[0], nullptr),
        write(shared::BIND_GRID, 1, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, &uniforms[1], nullptr),
        write(shared::BIND_BRICKS, shared::MAX_BRICKS, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, nullptr,
              images.data()),
        write(shared::BIND_SAMPLER, 1, VK_DESCRIPTOR_TYPE_SAMPLER, nullptr, &sampler),
        write(shared::BIND_MINMAX, 1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, &minmax, nullptr),
        write(shared::BIND_VOXELS, 1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, &voxels, nullptr)};
    vkUpdateDescriptorSets(device_.handle(), uint32_t(writes.size()), writes.data(), 0, nullptr);
    return set;
}

void Grid::build_minmax(gpu::Commands& commands) const {
    const auto pass = commands.pass("min-max blocks");
    commands.bind(minmax_blocks_, {});
    commands.dispatch(info_.blocks.x, info_.blocks.y, info_.blocks.z);
    commands.barrier();
    for (uint32_t level = 1; level < info_.bricks.w; ++level) {
        commands.bind(minmax_level_, {});
        commands.push(level);
        const glm::uvec3 groups = divide_up(info_.levels[level], glm::uvec3(4));
        commands.dispatch(groups.x, groups.y, groups.z);
        commands.barrier();
    }
}

void Grid::sample_formula(gpu::Commands& commands) const {
    const auto pass = commands.pass("sample formula");
    for (const gpu::Texture& brick : step_->bricks)
        commands.discard_to_general(brick);
    for (uint32_t i = 0; i < format_.bricks.count(); ++i) {
        const glm::uvec3 groups = divide_up(format_.bricks.extent(i), glm::uvec3(8, 8, 1));
        commands.bind(sample_field_, {step_->bricks[i]});
        commands.push(SamplePush{*step_->sampling, format_.bricks.origin(i)});
        commands.dispatch(groups.x, groups.y, groups.z);
    }
    commands.barrier();
}

std::vector<std::array<float, 2>> Grid::read_level(uint32_t level) const {
    const uvec4 nodes = info_.levels[level];
    const uint32_t count = product(nodes);
    // Copies begin and end at whole words.
    const uint64_t node_bytes = 2 * stored().bytes(), skip = nodes.w * node_bytes & 3;
    const uint64_t bytes = (count * node_bytes + skip + 3) & ~uint64_t{3};
    gpu::Buffer host(device_, bytes, gpu::Buffer::Memory::host, "reading min-max blocks");
    gpu::run_once(device_, [&](gpu::Commands& commands) {
        if (step_->may_wait) begin_alone(commands);
        commands.copy(step_->minmax, nodes.w * node_bytes - skip, host, 0, bytes);
    });
    std::vector<std::array<float, 2>> ranges(count);
    const auto read = [&](auto zero) {
        using T = decltype(zero);
        const T* values = reinterpret_cast<const T*>(host.data<std::byte>() + skip);
        for (size_t i = 0; i < ranges.size(); ++i)
            ranges[i] = {float(values[2 * i]), float(values[2 * i + 1])};
    };
    if (stored().bits == 8)
        read(uint8_t{});
    else if (stored().bits == 16)
        read(uint16_t{});
    else
        read(float{});
    return ranges;
}

VoxelPoints Grid::crossed_hull(const std::vector<float>& isovalues) const {
    // The finest level with at most 2^18 nodes: enough for a camera, and quick to read.
    uint32_t level = 0;
    while (product(info_.levels[level]) > 1u << 18)
        ++level;
    const auto ranges = read_level(level);
    const glm::uvec3 nodes = info_.levels[level];
    const glm::dvec3 side(shared::BLOCK << level), last = glm::dvec3(info_.voxels) - 1.0;
    VoxelPoints points;
    for (uint32_t row = 0; row < nodes.y * nodes.z; ++row) {
        uint32_t first = nodes.x, end = 0;
        for (uint32_t x = 0; x < nodes.x; ++x) {
            const auto& [low, high] = ranges[row * nodes.x + x];
            if (std::ranges::none_of(isovalues,
                                     [&](float iso) { return low < iso && high >= iso; }))
                continue;
            first = std::min(first, x);
            end = x + 1;
        }
        for (int c = 0; c < 8 && end > 0; ++c) {
            const glm::uvec3 corner(c & 1 ? end : first, row % nodes.y + (c >> 1 & 1),
                                    row / nodes.y + (c >> 2));
            const glm::dvec3 p = glm::min(glm::dvec3(corner) * side, last);
            points.push_back({p.x, p.y, p.z});
        }
    }
    return points;
}

}  // namespace isorast
