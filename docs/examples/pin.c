// pin.c: a rod swings on a steel pin of 10 mm with 50 um of play in its bearing
#include <jointplay/jointplay.h>
#include <stdio.h>

int main(void)
{
    dInitODE2(0);
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, -9.81, 0);
    dMass mass;
    dMassSetBoxTotal(&mass, 0.5, 0.3, 0.02, 0.02);
    const dBodyID rod = dBodyCreate(world);
    dBodySetMass(rod, &mass);
    dBodySetPosition(rod, 0.12, 0, 0); // level, its pin in the middle of the hole

    const JpPin sizes = {.hole_radius = 5e-3,
                         .pin_radius = 4.95e-3,
                         .width = 0.02, // m
                         .youngs_modulus = 207e9,
                         .poisson_ratio = 0.3};
    JpPinInHole bearing = jp_pin_default(); // about z, of the world at its origin
    bearing.hole_radius = sizes.hole_radius;
    bearing.pin_radius = sizes.pin_radius;
    bearing.width = sizes.width;
    bearing.axial_play = 0.1e-3;
    bearing.pin[0] = -0.12; // in the rod
    bearing.contact.restitution = 0.6;
    bearing.friction = 0.1;

    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE; // knocks are shorter than the step
    JpError error;
    JpWorld *play;
    JpJoint *pin;
    if (jp_contact_of_pin(JP_PIN_ELASTIC, &sizes, &bearing.contact, &error) != JP_OK ||
        jp_world_create(world, &options, &play, &error) != JP_OK ||
        jp_pin_create(play, 0, rod, &bearing, &pin, &error) != JP_OK) {
        printf("%s\n", error.text);
        return 1;
    }
    int coarse = 0;
    for (int i = 0; i < 200; i++) {
        const JpStatus status = jp_world_step(play, 0.5e-3, &error);
        if (status > JP_OK) {
            printf("%s\n", error.text);
            return 1;
        }
        coarse += status == JP_COARSE; // too long for the contacts in it
    }
    JpPinState state;
    jp_pin_state(pin, &state, &error);
    printf("%zu and %zu knocks, the hardest of %.0f N; %d coarse steps\n", state.ends[0].impacts,
           state.ends[1].impacts, state.ends[0].force_max, coarse);
    printf("now %.1f N upwards, %.2f um off the middle, %.2f mJ rubbed away\n", state.force[1],
           1e6 * state.eccentricity[1], 1e3 * state.slid);
    jp_world_destroy(play);
    dWorldDestroy(world);
    dCloseODE();
    return 0;
}
