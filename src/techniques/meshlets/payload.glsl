// From the task shader to its mesh shaders, and what a draw is told.
struct Payload {
    uint meshlets[TASK_MESHLETS];
    uint unused;  // some drivers crash on payloads of one member
};

layout(push_constant) uniform Push {
    uint meshlet_count, surface;
    uint pass;      // ONLY_PASS draws all
    uint has_seen;  // 0: no frame has seen these meshlets yet
};
