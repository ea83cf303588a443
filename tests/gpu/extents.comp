#version 460
#extension GL_GOOGLE_include_directive : require
// Thread: a box in voxel space. Out: what project() (frustum.glsl) says that it can touch.
#include "shaders/scene.glsl"
#include "shaders/frustum.glsl"

layout(local_size_x = 64) in;

struct Box {
    vec4 low, high;  // w of `low`: 1 if project() finds it before the near plane nowhere
    vec4 pixels;     // least, greatest
    vec4 nearest;    // x
};
layout(set = 1, binding = 0, std430) buffer Boxes { Box boxes[]; };

void main() {
    Box box = boxes[gl_GlobalInvocationID.x];
    Extent extent;
    box.low.w = project(0, box.low.xyz, box.high.xyz, extent) ? 1.0 : 0.0;
    box.pixels = vec4(extent.least, extent.greatest);
    box.nearest.x = extent.nearest;
    boxes[gl_GlobalInvocationID.x] = box;
}
