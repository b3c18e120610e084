// The box is .6 by .4 by .1 m; its hinge is in the middle of its upper face. Contacts have a
// surface layer, so that none comes and goes by rounding (docs/library.md).
#include "cart.h"

#include <math.h>
#include <ode/ode.h>

const double CART_ARM_MASS = 0.2;
const double CART_ARM_LENGTH = 0.15;
const double CART_ARM_INERTIA = 0.2 * 0.15 * 0.15 / 3.0;
const double CART_GRAVITY = 9.81;
const double CART_STOP = 0.1;
const double CART_STIFFNESS = 2e4; // contacts of 1.7 ms

static const double HEIGHT = 0.1; // m, of the box
static const double LAYER = 1e-4; // m

double cart_damper(const CartOptions *options)
{
    const double inertia = CART_ARM_INERTIA + CART_ARM_MASS * CART_ARM_LENGTH * CART_ARM_LENGTH;
    double damper = NAN;
    jp_damper_of(CART_STIFFNESS, options->restitution, inertia, &damper, NULL);
    return damper;
}

typedef struct Cart {
    dWorldID world;
    dSpaceID space;
    dBodyID box;
    dJointID hinge;
    JpWorld *play;
    JpJoint *stops;
} Cart;

static void make_box(Cart *cart, const CartOptions *options)
{
    dMass mass;
    dMassSetBoxTotal(&mass, options->mass, 0.6, 0.4, HEIGHT);
    cart->box = dBodyCreate(cart->world);
    dBodySetMass(cart->box, &mass);
    dBodySetPosition(cart->box, 0, 0, 0.5 * (HEIGHT - LAYER));
    dBodySetLinearVel(cart->box, options->speed, 0, 0);
    dGeomSetBody(dCreateBox(cart->space, 0.6, 0.4, HEIGHT), cart->box);
    dCreatePlane(cart->space, 0, 0, 1, 0);
}

static void make_arm(Cart *cart, const CartOptions *options)
{
    const double top = HEIGHT - 0.5 * LAYER;
    const double inertia = CART_ARM_INERTIA;
    dMass mass;
    dMassSetParameters(&mass, CART_ARM_MASS, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
    const dBodyID arm = dBodyCreate(cart->world);
    dBodySetMass(arm, &mass);
    dBodySetPosition(arm, 0, 0, top - CART_ARM_LENGTH);
    dBodySetLinearVel(arm, options->speed + CART_ARM_LENGTH * options->arm_speed, 0, 0);
    dBodySetAngularVel(arm, 0, -options->arm_speed, 0);
    cart->hinge = dJointCreateHinge(cart->world, 0);
    dJointAttach(cart->hinge, arm, cart->box);
    dJointSetHingeAnchor(cart->hinge, 0, 0, top);
    dJointSetHingeAxis(cart->hinge, 0, -1, 0);
}

static bool make(const CartOptions *options, JpStepping stepping, Cart *cart, JpError *error)
{
    *cart = (Cart){.world = dWorldCreate(), .space = dSimpleSpaceCreate(0)};
    dWorldSetGravity(cart->world, 0, 0, -CART_GRAVITY);
    dWorldSetERP(cart->world, 1.0);
    dWorldSetContactSurfaceLayer(cart->world, LAYER);
    make_box(cart, options);
    make_arm(cart, options);
    JpWorldOptions chosen = jp_world_options_default();
    chosen.stepping = stepping;
    chosen.space = cart->space;
    chosen.surface.mode = dContactApprox1;
    chosen.surface.mu = options->friction;
    JpStops stops = jp_stops_default();
    stops.low = -CART_STOP;
    stops.high = CART_STOP;
    stops.contact.stiffness = CART_STIFFNESS;
    stops.contact.damping = JP_DAMPING_VISCOUS;
    stops.contact.damper = cart_damper(options);
    return jp_world_create(cart->world, &chosen, &cart->play, error) == JP_OK &&
           jp_stops_create(cart->play, cart->hinge, &stops, &cart->stops, error) == JP_OK;
}

bool cart_run(const CartOptions *options, JpStepping stepping, double step, CartState *end,
              JpWorldStats *stats, JpError *error)
{
    Cart cart;
    bool is_done = make(options, stepping, &cart, error);
    const long count = lround(options->duration / step);
    for (long i = 0; i < count && is_done; i++) {
        is_done = jp_world_step(cart.play, step, error) <= JP_OK; // coarse ones are counted
    }
    JpJointState arm;
    if (is_done && jp_joint_state(cart.stops, &arm, error) == JP_OK) {
        jp_world_stats(cart.play, stats, NULL);
        *end = (CartState){dBodyGetPosition(cart.box)[0], dBodyGetLinearVel(cart.box)[0],
                           arm.position, arm.speed};
    }
    jp_world_destroy(cart.play);
    dSpaceDestroy(cart.space);
    dWorldDestroy(cart.world);
    return is_done;
}

bool cart_errors(CartOptions options, JpStepping stepping, double step, CartErrors *errors,
                 JpError *error)
{
    *errors = (CartErrors){0};
    for (int i = 0; i < CART_STARTS; i++) {
        options.arm_speed = 2.5 + 0.07 * i;
        int changes;
        const CartState truth = cart_truth(&options, &changes);
        CartState end;
        JpWorldStats stats;
        if (!cart_run(&options, stepping, step, &end, &stats, error)) {
            return false;
        }
        errors->position += pow(end.position - truth.position, 2);
        errors->angle += pow(end.angle - truth.angle, 2);
        errors->changes += changes;
        errors->stats.steps += stats.steps;
        errors->stats.world_steps += stats.world_steps;
        errors->stats.fallbacks += stats.fallbacks;
    }
    errors->position = sqrt(errors->position / CART_STARTS);
    errors->angle = sqrt(errors->angle / CART_STARTS);
    return true;
}
