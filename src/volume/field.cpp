// SPDX-License-Identifier: MIT
// Procedural volumes: names such as "noise:128:octaves=6:seed=1" to a Volume, and its sampling on
// the CPU.
#include "volume/field.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <cstring>
#include <numbers>
#include <thread>

#include "volume/text.h"

namespace isorast {
namespace {

struct FieldKind {
    std::string_view name;
    Field::Kind kind;
    double isovalue;
    std::array<double, 2> range;
};

// The bounds enclose the formula over the cube [-1, 1]^3, rounded outwards where they are
// irrational.
constexpr std::array<FieldKind, 9> KINDS{{
    {"sphere", Field::Kind::sphere, 0.25, {-0.75, 1}},
    {"torus", Field::Kind::torus, 0, {-1.05, 0.25}},
    {"gyroid", Field::Kind::gyroid, 0, {-1.5, 1.5}},
    {"marschner-lobb", Field::Kind::marschner_lobb, 0.5, {0, 1}},
    {"noise", Field::Kind::noise, 0.5, {0, 1}},
    {"coral", Field::Kind::coral, 0.5, {0, 1}},
    {"head", Field::Kind::head, 0.5, {0, 1}},
    {"vessels", Field::Kind::vessels, 0.5, {0, 1}},
    {"bone", Field::Kind::bone, 0.5, {0, 1}},
}};
constexpr uint32_t MAX_SIDE = 65536, MAX_OCTAVES = 16, MAX_STEPS = 65536;

const FieldKind& kind_of(Field::Kind kind) {
    return KINDS.at(size_t(kind));
}

// Empty parts count, so that a stray separator is an error.
std::vector<std::string_view> parts_of(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

// Reads one name; every error says which part of it is wrong.
class Parser {
public:
    explicit Parser(std::string_view name) : name_(name) {}

    Volume parse(uint32_t time_step) {
        auto parts = parts_of(name_, ':');
        volume_.name = name_;
        volume_.type = VoxelType::f32;
        volume_.field = Field{};
        parse_kind(parts[0]);
        if (parts.size() < 2) fail("a size after the name, such as 64 or 64x64x32", "none");
        parse_dims(parts[1]);
        for (size_t i = 2; i < parts.size(); ++i)
            parse_option(parts[i]);
        set_time(time_step);
        place();
        check(volume_);
        return std::move(volume_);
    }

private:
    [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
        throw Error(fmt::format("{}: expected {}, found {}", name_, expected, found));
    }

    [[noreturn]] void fail_at(std::string_view expected, std::string_view word) const {
        fail(expected, quoted(word));
    }

    void parse_kind(std::string_view word) {
        for (const FieldKind& kind : KINDS) {
            if (kind.name != word) continue;
            volume_.field->kind = kind.kind;
            return;
        }
        fail_at("sphere, torus, gyroid, marschner-lobb, noise, coral, head, vessels or bone", word);
    }

    uint32_t parse_uint(std::string_view word, uint32_t lowest, uint32_t highest,
                        std::string_view what) const {
        auto number = parse_number<uint32_t>(word);
        if (number && *number >= lowest && *number <= highest) return *number;
        fail_at(fmt::format("{} from {} to {}", what, lowest, highest), word);
    }

    void parse_dims(std::string_view word) {
        auto sides = parts_of(word, 'x');
        if (sides.size() != 1 && sides.size() != 3) fail_at("a size N or WxHxD", word);
        for (size_t axis = 0; axis < 3; ++axis)
            volume_.dims[axis] =
                parse_uint(sides[sides.size() == 1 ? 0 : axis], 1, MAX_SIDE, "a side");
    }

    void parse_option(std::string_view part) {
        size_t equals = part.find('=');
        std::string_view key = part.substr(0, equals);
        std::string_view word = equals == part.npos ? "" : part.substr(equals + 1);
        bool noise = volume_.field->kind == Field::Kind::noise;
        if (equals != part.npos && key == "type") {
            parse_type(word);
        } else if (equals != part.npos && key == "spacing") {
            parse_spacing(word);
        } else if (equals != part.npos && key == "steps") {
            volume_.time_steps = parse_uint(word, 1, MAX_STEPS, "time steps");
        } else if (equals != part.npos && noise && key == "octaves") {
            volume_.field->octaves = parse_uint(word, 1, MAX_OCTAVES, "octaves");
        } else if (equals != part.npos && noise && key == "seed") {
            volume_.field->seed = parse_uint(word, 0, UINT32_MAX, "a seed");
        } else {
            fail_at(
                noise ? "octaves=, seed=, type=, spacing= or steps=" : "type=, spacing= or steps=",
                part);
        }
    }

    void parse_type(std::string_view word) {
        auto type = parse_voxel_type(word);
        if (type != VoxelType::u8 && type != VoxelType::u16 && type != VoxelType::f32)
            fail_at("type=u8, type=u16 or type=f32", word);
        volume_.type = *type;
        if (type == VoxelType::f32) return;
        auto [lowest, highest] = kind_of(volume_.field->kind).range;
        volume_.slope = (highest - lowest) / (type == VoxelType::u8 ? 255 : 65535);
        volume_.intercept = lowest;
    }

    void parse_spacing(std::string_view word) {
        auto words = parts_of(word, ',');
        for (size_t axis = 0; axis < 3; ++axis) {
            auto number = words.size() == 3 ? parse_number<double>(words[axis]) : std::nullopt;
            // A range in which no sum, square or determinant overflows.
            if (!number || !(*number >= 1e-30 && *number <= 1e30))
                fail_at("spacing=a,b,c with three positive numbers", word);
            spacing_[axis] = *number;
        }
        spacing_given_ = true;
    }

    void set_time(uint32_t step) {
        if (step >= volume_.time_steps)
            fail(fmt::format("a time step from 0 to {}", volume_.time_steps - 1),
                 std::to_string(step));
        volume_.time_step = step;
        volume_.field->time = double(step) / volume_.time_steps;
    }

    // The middle of the volume is the world's origin.
    void place() {
        uint32_t longest = std::max({volume_.dims[0], volume_.dims[1], volume_.dims[2]});
        if (!spacing_given_) spacing_.fill(longest > 1 ? 2.0 / (longest - 1) : 1.0);
        volume_.affine = Affine::scaling(spacing_[0], spacing_[1], spacing_[2]);
        for (size_t axis = 0; axis < 3; ++axis)
            volume_.affine.m[axis][3] = -0.5 * spacing_[axis] * (volume_.dims[axis] - 1);
    }

    std::string name_;
    Volume volume_;
    std::array<double, 3> spacing_{};
    bool spacing_given_ = false;
};

void sample_slice(const field::FieldSampling& s, VoxelType type, uint32_t k, std::byte* slice) {
    size_t bytes = bytes_of(type);
    for (uint32_t j = 0; j < s.dims[1]; ++j) {
        for (uint32_t i = 0; i < s.dims[0]; ++i, slice += bytes) {
            float value = field::field_sample(s, i, j, k);
            uint32_t raw = type == VoxelType::f32 ? 0 : field::field_raw(s, value);
            uint8_t raw8 = uint8_t(raw);
            uint16_t raw16 = uint16_t(raw);
            const void* voxel = bytes == 1   ? &raw8
                                : bytes == 2 ? static_cast<void*>(&raw16)
                                             : &value;
            std::memcpy(slice, voxel, bytes);
        }
    }
}

}  // namespace

double field_isovalue(const Field& field) {
    return kind_of(field.kind).isovalue;
}

std::array<double, 2> field_range(Field::Kind kind) {
    return kind_of(kind).range;
}

field::FieldSampling field_sampling(const Volume& volume) {
    const Field& field = volume.field.value();
    field::FieldSampling s{};
    s.kind = uint32_t(field.kind);
    s.octaves = field.octaves;
    s.seed = field.seed;
    const double phase = 2 * std::numbers::pi * field.time;
    s.motion = {float(phase), float(std::sin(phase)), float(1 - std::cos(phase))};
    // The longest side of the box, in world units, spans [-1, 1]: spacing changes the grid, not the
    // shape.
    auto spacing = volume.affine.spacing();
    double longest = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        longest = std::max(longest, spacing[axis] * (volume.dims[axis] - 1));
    for (size_t axis = 0; axis < 3; ++axis) {
        s.dims[axis] = volume.dims[axis];
        s.scale[axis] = longest > 0 ? float(spacing[axis] / longest) : 0.0f;
    }
    if (volume.type == VoxelType::f32) return s;
    if (volume.type != VoxelType::u8 && volume.type != VoxelType::u16)
        throw Error(fmt::format("{}: expected type u8, u16 or f32 for a formula, found {}",
                                volume.name, name_of(volume.type)));
    auto [lowest, highest] = field_range(field.kind);
    s.lowest = float(lowest);
    s.raw_maximum = volume.type == VoxelType::u8 ? 255.0f : 65535.0f;
    s.raw_per_value = float(s.raw_maximum / (highest - lowest));
    return s;
}

bool is_procedural(std::string_view name) {
    size_t colon = name.find(':');
    return colon != name.npos &&
           std::any_of(KINDS.begin(), KINDS.end(),
                       [&](const FieldKind& kind) { return kind.name == name.substr(0, colon); });
}

Volume make_procedural(std::string_view name, uint32_t time_step) {
    return Parser(name).parse(time_step);
}

void sample(Volume& volume) try {
    if (!volume.bytes.span().empty()) return;
    if (!volume.field)
        throw Error(fmt::format("{}: expected voxels or a formula, found neither", volume.name));
    check(volume);
    field::FieldSampling s = field_sampling(volume);
    std::vector<std::byte> bytes(volume.byte_count());
    size_t slice_bytes = bytes.size() / volume.dims[2];
    uint32_t workers = std::clamp(std::thread::hardware_concurrency(), 1u, volume.dims[2]);
    std::vector<std::jthread> threads;
    for (uint32_t worker = 0; worker < workers; ++worker) {
        threads.emplace_back([&, worker] {
            for (uint32_t k = worker; k < volume.dims[2]; k += workers)
                sample_slice(s, volume.type, k, bytes.data() + k * slice_bytes);
        });
    }
    threads.clear();  // joins
    volume.bytes = VoxelBytes::own(std::move(bytes));
} catch (const std::bad_alloc&) {
    throw Error(
        fmt::format("{}: expected memory for its voxels, {} bytes, found less; choose a smaller "
                    "size",
                    volume.name, volume.byte_count()));
}

}  // namespace isorast
