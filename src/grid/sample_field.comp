#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// Workgroup: 8x8 voxels of a slice of a brick. Thread: one voxel. Out: the formula's value there.
#include "shaders/scene.glsl"
#include "volume/field.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 0) writeonly uniform image3D brick;
layout(push_constant) uniform Push {
    FieldSampling sampling;
    uint origin[3];  // the voxel in texel 0
};

void main() {
    const uvec3 texel = gl_GlobalInvocationID;
    if (any(greaterThanEqual(ivec3(texel), imageSize(brick)))) return;
    const uvec3 voxel = texel + uvec3(origin[0], origin[1], origin[2]);
    float value = field_sample(sampling, voxel.x, voxel.y, voxel.z);
    if (VOXEL_BITS != 32) value = float(field_raw(sampling, value)) / sampling.raw_maximum;
    imageStore(brick, ivec3(texel), vec4(value));
}
