// halving.c: a rod swings on a steel pin; coarse steps are made anew in halves
#include <jointplay/jointplay.h>
#include <stdio.h>

// A step of the world, in halves where it is coarse, down to a shortest.
static JpStatus advance(JpWorld *play, double step, double shortest, JpError *error)
{
    JpStatus status = jp_world_step(play, step, error);
    if (status == JP_COARSE && step > shortest) {
        status = jp_world_undo(play, error);
        for (int i = 0; i < 2 && status <= JP_OK; i++) {
            status = advance(play, 0.5 * step, shortest, error);
        }
    }
    return status;
}

// The largest force in a second of steps of 1 ms.
static double largest_force(double shortest, JpWorldStats *stats)
{
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, -9.81, 0);
    dMass mass;
    dMassSetBoxTotal(&mass, 0.5, 0.3, 0.02, 0.02);
    const dBodyID rod = dBodyCreate(world);
    dBodySetMass(rod, &mass);
    dBodySetPosition(rod, 0.15, 0, 0);

    const JpPin sizes = {.hole_radius = 5e-3,
                         .pin_radius = 4.985e-3,
                         .width = 0.02, // m
                         .youngs_modulus = 207e9,
                         .poisson_ratio = 0.3};
    JpPinInHole bearing = jp_pin_default();
    bearing.hole_radius = sizes.hole_radius;
    bearing.pin_radius = sizes.pin_radius;
    bearing.pin[0] = -0.15;
    JpError error;
    JpWorld *play;
    JpJoint *pin;
    JpPinState state = {0};
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    JpStatus status = jp_contact_of_pin(JP_PIN_HERTZ, &sizes, &bearing.contact, &error);
    status = status > JP_OK ? status : jp_world_create(world, &options, &play, &error);
    status = status > JP_OK ? status : jp_pin_create(play, 0, rod, &bearing, &pin, &error);
    for (int i = 0; i < 1000 && status <= JP_OK; i++) {
        status = advance(play, 1e-3, shortest, &error);
    }
    if (status > JP_OK) {
        printf("%s\n", error.text);
        return 0;
    }
    jp_pin_state(pin, &state, &error);
    jp_world_stats(play, stats, &error);
    jp_world_destroy(play);
    dWorldDestroy(world);
    return state.ends[0].force_max;
}

int main(void)
{
    dInitODE2(0);
    JpWorldStats stats;
    double force = largest_force(1e-3, &stats);
    printf("steps of 1 ms: %.0f N, coarse steps: %s\n", force, stats.coarse > 0 ? "yes" : "no");
    force = largest_force(1e-5, &stats);
    printf("halved down to 10 us: %.0f N, coarse steps: %s\n", force,
           stats.coarse > 0 ? "yes" : "no");
    dCloseODE();
    return 0;
}
