// Needs LOCKSTEP: the workgroup is one subgroup, and a CPU driver runs its threads in lockstep.
// Then nobody has to be waited for; and there a barrier saves and restores all that threads know.
void wait_for_all() {
    if (LOCKSTEP)
        memoryBarrierShared();
    else
        barrier();
}
