// From the task shader of the raster proxies to its mesh shaders: as the paper's listing 2.
const uint PAYLOAD_WORDS = 64;

struct Payload {
    uint first_group;  // in the list of active groups
    uint count;
    uint entries[PAYLOAD_WORDS];  // four a word: 32 * group + place
};
