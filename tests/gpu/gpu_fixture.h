// SPDX-License-Identifier: MIT
// What every GPU test needs: a device under the validation layer, whose every message is a failure;
// all lanes (a technique with one of its rasterizers); and frames turned into what reference
// renderers make.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isorast/error.h>
#include <isorast/renderer.h>

#include <cstdlib>
#include <set>

#include "gpu/device.h"
#include "reference/agreement.h"
#include "reference/scenes.h"

// The width that lavapipe is asked for, in bits; 0 without that setting.
inline const int VECTOR_BITS = [] {
    const char* bits = std::getenv("LP_NATIVE_VECTOR_WIDTH");
    return bits ? std::atoi(bits) : 0;
}();
// At 512 bits lavapipe (22.3 and 25.0, with LLVM 15) crashes on every fragment shader: compute
// only.
inline const bool GRAPHICS_CRASHES = VECTOR_BITS >= 512;

// What is found out about a device under validation stays out of the user's cache. A folder for
// each width: lavapipe's own cache does not know the width and would hand out code made for another
// one.
inline const bool OWN_CACHE =
    setenv("XDG_CACHE_HOME",
           fmt::format("{}/test-cache/{}", ISORAST_BINARY_DIR, VECTOR_BITS).c_str(),
           /* overwrite= */ 1) == 0;

struct Lane {
    std::string name;
    isorast::RendererOptions options;
    isorast::Renderer renderer;
};

class GpuTest : public testing::Test {
protected:
    static constexpr isorast::Size SIZE{320, 240};

    // ISORAST_DEVICE in the environment picks the device, as --device does.
    GpuTest()
        : gpu({.device = std::getenv("ISORAST_DEVICE") ? std::getenv("ISORAST_DEVICE") : "",
               .validation = true}) {}

    void TearDown() override {
        auto messages = gpu.validation_messages();
        for (const auto& message : std::set<std::string>(messages.begin(), messages.end()))
            ADD_FAILURE() << message;
    }

    // A renderer for each technique and rasterizer that the device has. Every technique must have
    // one, unless only graphics can draw it and that is not there. RendererOptions::exact goes to
    // those that know it.
    std::vector<Lane> lanes(const isorast::Volume& volume, isorast::RendererOptions options = {}) {
        std::vector<Lane> result;
        for (const std::string& technique : isorast::techniques()) {
            std::string refusals;
            size_t before = result.size();
            for (auto rasterizer : {isorast::Rasterizer::hardware, isorast::Rasterizer::compute}) {
                if (GRAPHICS_CRASHES && rasterizer == isorast::Rasterizer::hardware) continue;
                options.technique = technique;
                options.rasterizer = rasterizer;
                if (!add_lane(volume, options, result, refusals) && options.exact) {
                    isorast::RendererOptions stepping = options;
                    stepping.exact = false;
                    add_lane(volume, stepping, result, refusals);
                }
            }
            EXPECT_TRUE(result.size() > before || GRAPHICS_CRASHES ||
                        !gpu.info().why_not_hardware.empty())
                << technique << " refuses:" << refusals;
        }
        EXPECT_FALSE(result.empty());
        return result;
    }

    // GPUs filter voxels with weights of 1/256, and 16-bit ones to whole steps: raymarch (unless
    // exact) and the shading of 8-bit voxels sample through that filter, and are only as exact.
    bool filters() const { return !gpu.device().is_cpu(); }
    bool marches_filtered(const Lane& lane) const {
        return filters() && lane.options.technique == "raymarch" && !lane.options.exact;
    }

    // A frame that holds all that a comparison needs: depth, normals, and alpha 0 where nothing is.
    static isorast::Frame frame(const isorast::Camera& camera, std::vector<double> isovalues) {
        isorast::Frame frame;
        frame.isovalues = std::move(isovalues);
        frame.camera = camera;
        frame.size = SIZE;
        frame.shading = isorast::Shading::normals;
        frame.background = {0, 0, 0, 0};
        frame.want_depth = true;
        return frame;
    }

    // Depth and normals of an image of frame(); colour and depth must agree on what is covered.
    static reference::Picture picture(const isorast::Image& image) {
        reference::Picture result{image.size, {}};
        uint64_t disagreements = 0;
        for (size_t i = 0; i < image.depth.size(); ++i) {
            const uint8_t* rgba = &image.rgba[4 * i];
            bool hit = std::isfinite(image.depth[i]);
            disagreements += hit ? rgba[3] != 255 : rgba[3] != 0;
            auto& out = result.hits.emplace_back();
            if (!hit) continue;
            out.depth = image.depth[i];
            out.normal = glm::normalize(glm::dvec3(rgba[0], rgba[1], rgba[2]) / 127.5 - 1.0);
        }
        EXPECT_EQ(image.depth.size(), size_t{image.size.width} * image.size.height);
        EXPECT_EQ(disagreements, 0u) << "pixels where colour and depth disagree";
        return result;
    }

    isorast::Gpu gpu;

private:
    bool add_lane(const isorast::Volume& volume, const isorast::RendererOptions& options,
                  std::vector<Lane>& result, std::string& refusals) {
        try {
            result.push_back({fmt::format("{} {}", options.technique, name_of(options.rasterizer)),
                              options, isorast::Renderer(gpu, volume, options)});
            return true;
        } catch (const isorast::Error& error) {
            refusals += fmt::format("\n{}", error.what());
            return false;
        }
    }
};
