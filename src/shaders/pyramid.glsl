// The depth pyramid: the farthest depth of squares of 2, 4, ... 32 pixels, levels 1 to 5 one after
// the other, first for the left eye.
const uint PYRAMID_LEVELS = 5;

uvec2 pyramid_size(uint level) { return (frame.size.xy + (1u << level) - 1) >> level; }

uint pyramid_offset(uint eye, uint level) {
    uint before = 0, all = 0;
    for (uint i = 1; i <= PYRAMID_LEVELS; ++i) {
        if (i == level) before = all;
        all += pyramid_size(i).x * pyramid_size(i).y;
    }
    return eye * all + before;
}
