// The depth pyramid: the farthest depth of squares of 2, 4, ... 64 pixels, levels 1 to 6 one after
// the other.
const uint PYRAMID_LEVELS = 6;

uvec2 pyramid_size(uint level) { return (frame.size.xy + (1u << level) - 1) >> level; }

uint pyramid_offset(uint level) {
    uint offset = 0;
    for (uint i = 1; i < level; ++i) offset += pyramid_size(i).x * pyramid_size(i).y;
    return offset;
}
