// From the task shader to its mesh shaders, and what a draw is told.
struct Payload {
    uint meshlets[32];
    uint unused;  // some drivers crash on payloads of one member
};

layout(push_constant) uniform Push { uint meshlet_count, surface, culling; };
