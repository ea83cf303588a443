// Writes a node of the min-max pyramid; see node_range in shaders/scene.glsl.
void store_node(uint node, vec2 range) {
    if (VOXEL_BITS == 8) minmax_8[node] = uint16_t(uint(range.x) | uint(range.y) << 8);
    else if (VOXEL_BITS == 16) minmax_16[node] = uint(range.x) | uint(range.y) << 16;
    else minmax_32[node] = range;
}
