// How does the cart move?
//
// Coordinates x of the box, a of the arm; M and m their masses, l the arm's length, I its inertia,
// T the torque of the stops on it, f the friction on the box:
//     (M + m) x'' + m l cos a a'' = f + m l sin a a'^2
//     m l cos a x'' + (I + m l^2) a'' = T - m g l sin a
// The floor presses with N = (M + m) g + m l (sin a a'' + cos a a'^2). ODE's dWorldStep solves the
// rows that press before those of friction and bounds these by mu times what it found then (the
// findex of dLCP): so here |f| <= mu N with N of f = 0. Sliding, f is there; resting, f is what
// keeps x'' = 0.
// Runge's classic steps, cut where a stop is met or left and where sliding begins or ends.
#include "cart.h"

#include <math.h>

static const double STEP = 2e-5; // s: leaves 1e-10
enum { HALVINGS = 60 };

// What holds until the next event.
typedef struct Mode {
    int stop;  // -1 the low one presses, 1 the high one, 0 none
    int slide; // the sign of the box's speed; 0: it rests
} Mode;

typedef enum Event { NOTHING, MEETS_LOW, MEETS_HIGH, LEAVES, STOPS, BREAKS_LOOSE } Event;

static double torque(const CartOptions *cart, const CartState *at, int stop)
{
    if (stop == 0) {
        return 0.0;
    }
    const double depth = stop * at->angle - CART_STOP;
    return -stop * (CART_STIFFNESS * depth + cart_damper(cart) * stop * at->arm_speed);
}

// Accelerations of box and arm under a friction force.
typedef struct Accelerations {
    double box;
    double arm;
} Accelerations;

static Accelerations accelerate(const CartOptions *cart, const CartState *at, double turning,
                                double friction)
{
    const double arm = CART_ARM_MASS * CART_ARM_LENGTH;
    const double all = cart->mass + CART_ARM_MASS;
    const double across = arm * cos(at->angle);
    const double about = CART_ARM_INERTIA + arm * CART_ARM_LENGTH;
    const double along = friction + arm * sin(at->angle) * at->arm_speed * at->arm_speed;
    const double turn = turning - arm * CART_GRAVITY * sin(at->angle);
    const double det = all * about - across * across;
    return (Accelerations){(along * about - across * turn) / det,
                           (all * turn - across * along) / det};
}

// The friction at most.
static double bound(const CartOptions *cart, const CartState *at, double turning)
{
    const double arm = CART_ARM_MASS * CART_ARM_LENGTH;
    const Accelerations loose = accelerate(cart, at, turning, 0.0);
    const double pressing =
        (cart->mass + CART_ARM_MASS) * CART_GRAVITY +
        arm * (sin(at->angle) * loose.arm + cos(at->angle) * at->arm_speed * at->arm_speed);
    return cart->friction * fmax(pressing, 0.0);
}

// The acceleration of the arm on a box that rests, and the friction that keeps it there.
static double arm_alone(const CartState *at, double turning)
{
    const double arm = CART_ARM_MASS * CART_ARM_LENGTH;
    return (turning - arm * CART_GRAVITY * sin(at->angle)) /
           (CART_ARM_INERTIA + arm * CART_ARM_LENGTH);
}

static double holding(const CartState *at, double turning)
{
    return CART_ARM_MASS * CART_ARM_LENGTH *
           (cos(at->angle) * arm_alone(at, turning) -
            sin(at->angle) * at->arm_speed * at->arm_speed);
}

static CartState rates(const CartOptions *cart, const CartState *at, Mode mode)
{
    const double turning = torque(cart, at, mode.stop);
    if (mode.slide == 0) {
        return (CartState){0.0, 0.0, at->arm_speed, arm_alone(at, turning)};
    }
    const Accelerations now = accelerate(cart, at, turning, -mode.slide * bound(cart, at, turning));
    return (CartState){at->speed, now.box, at->arm_speed, now.arm};
}

static CartState moved(const CartState *from, const CartState *rate, double time)
{
    return (CartState){from->position + time * rate->position, from->speed + time * rate->speed,
                       from->angle + time * rate->angle, from->arm_speed + time * rate->arm_speed};
}

static CartState advance(const CartOptions *cart, CartState at, Mode mode, double time)
{
    static const double SHARES[] = {0.0, 0.5, 0.5, 1.0};
    static const double WEIGHTS[] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    CartState end = at;
    CartState rate = {0};
    for (int i = 0; i < 4; i++) {
        const CartState stage = moved(&at, &rate, SHARES[i] * time);
        rate = rates(cart, &stage, mode);
        end = moved(&end, &rate, WEIGHTS[i] * time);
    }
    return end;
}

// What ends a mode in a state.
static Event event_at(const CartOptions *cart, const CartState *at, Mode mode)
{
    const double turning = torque(cart, at, mode.stop);
    if (mode.stop == 0 && fabs(at->angle) > CART_STOP && at->angle * at->arm_speed > 0.0) {
        return at->angle > 0.0 ? MEETS_HIGH : MEETS_LOW;
    }
    if (mode.stop * turning > 0.0) {
        return LEAVES; // the stop would pull
    }
    if (mode.slide * at->speed < 0.0) {
        return STOPS;
    }
    return mode.slide == 0 && fabs(holding(at, turning)) > bound(cart, at, turning) ? BREAKS_LOOSE
                                                                                    : NOTHING;
}

// The mode behind an event.
static Mode changed(const CartOptions *cart, CartState *at, Mode mode, Event event)
{
    if (event == MEETS_LOW || event == MEETS_HIGH || event == LEAVES) {
        mode.stop = event == LEAVES ? 0 : event == MEETS_LOW ? -1 : 1;
        return mode;
    }
    const double turning = torque(cart, at, mode.stop);
    const double needed = holding(at, turning);
    at->speed = 0.0;
    mode.slide = fabs(needed) <= bound(cart, at, turning) ? 0 : needed > 0.0 ? -1 : 1;
    return mode;
}

CartState cart_truth(const CartOptions *options, int *changes)
{
    CartState at = {.speed = options->speed, .arm_speed = options->arm_speed};
    Mode mode = {.slide = options->speed > 0.0 ? 1 : 0};
    *changes = 0;
    for (double time = 0.0; options->duration - time > 1e-12;) {
        double step = fmin(STEP, options->duration - time);
        CartState end = advance(options, at, mode, step);
        if (event_at(options, &end, mode) != NOTHING) {
            double before = 0.0;
            for (int i = 0; i < HALVINGS; i++) {
                const double middle = 0.5 * (before + step);
                const CartState then = advance(options, at, mode, middle);
                *(event_at(options, &then, mode) != NOTHING ? &step : &before) = middle;
            }
            end = advance(options, at, mode, step);
            const Event event = event_at(options, &end, mode);
            *changes += event == STOPS || event == BREAKS_LOOSE;
            mode = changed(options, &end, mode, event);
        }
        at = end;
        time += step;
    }
    return at;
}
