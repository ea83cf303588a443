// SPDX-License-Identifier: MIT
// What to measure: scenarios' settings, the volumes to draw, and the ways to draw them.
#pragma once
#include <isorast/renderer.h>

#include <nlohmann/json.hpp>

namespace isorast::bench {

using Json = nlohmann::ordered_json;

// What is empty or 0 here, the scenario decides.
struct Settings {
    std::string scenario;
    std::vector<std::string> volumes, ways;
    std::vector<std::string> sizes, sequences;
    uint32_t frames = 0;  // counted ones for each row of the results, in two rounds
    uint32_t warm_up = 10;
    double warm_up_ms = 500;
    std::vector<double> sweep{0.2, 0.9, 29};  // first, last, how many; shares of the value range
    std::vector<double> degrees{0.25, 1, 4};  // a frame, of the orbits
    double azimuth = 30, elevation = 20, zoom = 1;
    bool quick = false, shots = false;
    std::string device, output;
};

// A technique with its rasterizer, in the words of the tables: "direct hardware", "direct hardware
// forward", "raymarch compute exact", "direct hardware raster" or "hiz" (occlusion test), "direct
// compute unculled".
struct Way {
    std::string words;
    RendererOptions options;
    Shading shading = Shading::gooch;
    bool culling = true;

    Frame of(Frame frame) const;
    // A mesh that is made for each isovalue and time step: no match where they change each frame.
    bool stored() const { return options.technique == "meshlets"; }
};

Way parse_way(const std::string& words);
Size parse_size(const std::string& text);

// A volume, or one that changes in time, and the isovalue to look at.
struct Subject {
    std::string name;
    Series series;
    Volume first;  // step 0
    double isovalue = 0;
};

// "SPEC" or "SPEC@ISOVALUE" (a number, auto, pNN or Nsigma): a formula ("head:256:type=u8"), raw
// voxels whose name tells the rest (NAME_256x256x128_uint8.raw), or a folder of such files, a time
// step each.
Subject parse_subject(const std::string& text);

}  // namespace isorast::bench
