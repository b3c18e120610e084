// Backlash on a hinge by the ways that there are in ODE: what an impact of the teeth gives back,
// with how many bodies and rows, and at which cost. Prints the table of docs/library.md.
//
// A rotor of .005 kg m^2 at 2 rad/s crosses a gap of .01 rad and hits a load of .01 kg m^2 that
// rests; teeth of 1e4 N m/rad are to give back .7. Shown is the least and the largest restitution
// over 16 phases of the step in the gap. Where ODE is given ERP and CFM they are the textbook's for
// the linear damper of that restitution.
#include <jointplay/jointplay.h>

#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <time.h>

enum { PHASES = 16, WAYS = 5, STEPS = 4, ROUNDS = 9 };

static const double ROTOR = 0.005;
static const double LOAD = 0.01;
static const double GAP = 0.01;
static const double SPEED = 2.0;
static const double STIFFNESS = 1e4;
static const double RESTITUTION = 0.7;

typedef struct Scene {
    dWorldID world;
    dBodyID rotor; // NULL where it is a number
    dBodyID load;
    JpWorld *play; // NULL where ODE does it all
    JpJoint *joint;
} Scene;

typedef struct Way {
    const char *name;
    int bodies;
    int rows; // with a tooth that touches
    void (*make)(Scene *scene, double step, double ahead);
} Way;

static dBodyID make_body(dWorldID world, double inertia)
{
    dMass mass;
    dMassSetParameters(&mass, 1.0, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    return body;
}

static dJointID make_hinge(dWorldID world, dBodyID first, dBodyID second)
{
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, first, second);
    dJointSetHingeAnchor(hinge, 0, 0, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    return hinge;
}

static double reduced(void)
{
    return 1.0 / (1.0 / ROTOR + 1.0 / LOAD);
}

static JpRow textbook_row(double step)
{
    double damper = 0.0;
    JpRow row = {0.0, 0.0, 0.0};
    jp_damper_of(STIFFNESS, RESTITUTION, reduced(), &damper, NULL);
    jp_row_of_gazebo(STIFFNESS, damper, step, &row, NULL);
    return row;
}

static void make_ours(Scene *scene, JpStepping stepping, double ahead)
{
    scene->load = make_body(scene->world, LOAD);
    const dJointID hinge = make_hinge(scene->world, scene->load, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = GAP;
    backlash.offset = -ahead;
    backlash.rotor_inertia = ROTOR;
    backlash.tooth.stiffness = STIFFNESS;
    backlash.tooth.restitution = RESTITUTION;
    jp_world_create(scene->world, &options, &scene->play, NULL);
    jp_backlash_create(scene->play, hinge, &backlash, &scene->joint, NULL);
    // led up to its speed, then let go
    jp_backlash_lead(scene->joint, 0.0, SPEED, NULL);
    jp_backlash_drive(scene->joint, 0.0, NULL);
}

static void make_rows(Scene *scene, double step, double ahead)
{
    (void)step;
    make_ours(scene, JP_STEPPING_STAGGERED, ahead);
}

static void make_plain(Scene *scene, double step, double ahead)
{
    (void)step;
    make_ours(scene, JP_STEPPING_PLAIN, ahead);
}

static void make_impulse(Scene *scene, double step, double ahead)
{
    (void)step;
    make_ours(scene, JP_STEPPING_IMPULSE, ahead);
}

// A ghost body for the rotor on a hinge of its own, and a second hinge with stops to the load.
static void make_two_hinges(Scene *scene, double step, double ahead)
{
    const JpRow row = textbook_row(step);
    scene->rotor = make_body(scene->world, ROTOR);
    scene->load = make_body(scene->world, LOAD);
    dBodySetAngularVel(scene->rotor, 0, 0, SPEED);
    make_hinge(scene->world, scene->rotor, 0);
    const dJointID hinge = make_hinge(scene->world, scene->load, scene->rotor);
    dJointSetHingeParam(hinge, dParamLoStop, -0.5 * GAP - ahead);
    dJointSetHingeParam(hinge, dParamHiStop, 0.5 * GAP - ahead);
    dJointSetHingeParam(hinge, dParamStopERP, row.erp);
    dJointSetHingeParam(hinge, dParamStopCFM, row.cfm);
}

// ODE's gear between two bodies on hinges of their own, 1 m apart. Its row is of the way of the
// teeth, at a radius of half of that, and its backlash is to either side.
static const double RADIUS = 0.5;

static void make_gear(Scene *scene, double step, double ahead)
{
    const JpRow row = textbook_row(step);
    scene->rotor = make_body(scene->world, ROTOR);
    scene->load = make_body(scene->world, LOAD);
    dBodySetAngularVel(scene->rotor, 0, 0, SPEED);
    make_hinge(scene->world, scene->rotor, 0);
    const dJointID hinge = make_hinge(scene->world, scene->load, 0);
    dBodySetPosition(scene->load, 1, 0, 0);
    dJointSetHingeAnchor(hinge, 1, 0, 0);
    const dJointID gear = dJointCreateTransmission(scene->world, 0);
    dJointAttach(gear, scene->rotor, scene->load);
    dJointSetTransmissionMode(gear, dTransmissionParallelAxes);
    dJointSetTransmissionAxis(gear, 0, 0, 1);
    dJointSetTransmissionAnchor1(gear, 0, 0, 0);
    dJointSetTransmissionAnchor2(gear, 1, 0, 0);
    dJointSetTransmissionParam(gear, dParamERP, row.erp);
    dJointSetTransmissionParam(gear, dParamCFM, RADIUS * RADIUS * row.cfm);
    dJointSetTransmissionBacklash(gear, RADIUS * (0.5 * GAP - ahead));
}

static const Way THE_WAYS[WAYS] = {
    {"jp_backlash, rows", 1, 6, make_rows},       {"jp_backlash, plain rows", 1, 6, make_plain},
    {"jp_backlash, impulse", 1, 5, make_impulse}, {"two hinges and a stop", 2, 11, make_two_hinges},
    {"ODE's transmission", 2, 11, make_gear},
};

static double relative_speed(const Scene *scene)
{
    const double load = dBodyGetAngularVel(scene->load)[2];
    if (scene->rotor != NULL) {
        // wheels beside each other turn against each other
        return dBodyGetAngularVel(scene->rotor)[2] -
               (dBodyGetPosition(scene->load)[0] > 0.5 ? -load : load);
    }
    JpJointState state;
    jp_joint_state(scene->joint, &state, NULL);
    return state.rotor_speed - load;
}

// What the impact gives back; NaN where there was none.
static double rebound(const Way *way, double step, double phase)
{
    Scene scene = {.world = dWorldCreate()};
    const double ahead = phase * step * SPEED;
    way->make(&scene, step, ahead);
    // half the gap takes 2.5 ms, the contact 1.8 ms, the way back to the other tooth 7 ms
    const int most = (int)ceil(0.0075 / step);
    for (int i = 0; i < most; i++) {
        if (scene.play != NULL) {
            jp_world_step(scene.play, step, NULL);
        } else {
            dWorldStep(scene.world, step);
        }
    }
    const double back = -relative_speed(&scene) / SPEED;
    jp_world_destroy(scene.play);
    dWorldDestroy(scene.world);
    return back;
}

// Processor time of a step without contact, us; of one of several rounds.
static double cost(const Way *way)
{
    enum { MANY = 3000 };
    Scene scene = {.world = dWorldCreate()};
    way->make(&scene, 1e-5, 0.0);
    if (scene.play != NULL) {
        jp_backlash_lead(scene.joint, 0.0, 0.0, NULL);
    } else {
        dBodySetAngularVel(scene.rotor, 0, 0, 0);
    }
    const clock_t start = clock();
    for (int i = 0; i < MANY; i++) {
        if (scene.play != NULL) {
            jp_world_step(scene.play, 1e-5, NULL);
        } else {
            dWorldStep(scene.world, 1e-5);
        }
    }
    const double taken = (double)(clock() - start) / CLOCKS_PER_SEC;
    jp_world_destroy(scene.play);
    dWorldDestroy(scene.world);
    return 1e6 * taken / MANY;
}

static void print_spread(const Way *way, double step)
{
    double least = INFINITY;
    double most = -INFINITY;
    for (int phase = 0; phase < PHASES; phase++) {
        const double back = rebound(way, step, (phase + 0.5) / PHASES);
        least = fmin(least, back);
        most = fmax(most, back);
    }
    printf(" %.3f to %.3f |", least, most);
}

int main(void)
{
    static const double SHARES[STEPS] = {0.32, 0.1, 0.032, 0.0032};
    const double contact = M_PI * sqrt(reduced() / STIFFNESS);
    dInitODE2(0);
    // in turn, and the least of each: other work on the machine only adds
    double costs[WAYS];
    for (int i = 0; i < ROUNDS * WAYS; i++) {
        const double taken = cost(&THE_WAYS[i % WAYS]);
        costs[i % WAYS] = i < WAYS ? taken : fmin(taken, costs[i % WAYS]);
    }
    printf("| way | bodies | rows | h/Tc .32 | .1 | .032 | .0032 | time a step |\n");
    printf("|---|---|---|---|---|---|---|---|\n");
    for (int number = 0; number < WAYS; number++) {
        const Way *way = &THE_WAYS[number];
        printf("| %s | %d | %d |", way->name, way->bodies, way->rows);
        for (int i = 0; i < STEPS; i++) {
            print_spread(way, SHARES[i] * contact);
        }
        printf(" %.2f |\n", costs[number] / costs[0]);
    }
    dCloseODE();
    return 0;
}
