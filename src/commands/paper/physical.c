// How large are the pin forces really, and what does contact mechanics say under them?
//
// Pin forces     Newton and Euler for each link with every joint ideal; the largest size over a
//                turn. Twice the speed is four times the inertia forces; gravity stays:
//                R(phi, w) = (w / w0)^2 R_inertia(phi) + R_gravity(phi)
// Approach       the laws of contact/law under that force, static
// Half width     b = sqrt(4 F R / (pi L E*)), half-angle = asin(b / Rj)   (Hertz, line contact)
//
// phi crank angle; w crank speed, w0 = 1000 rpm; F force, N; R = Ri Rj / (Ri - Rj), m; L width, m.
// Hertz takes the contact as narrow. At the paper's speed the half-angle is 17 degrees, so every
// law here is an approximation there, good to some ten per cent.
//
// Source: Johnson, Contact Mechanics (1985), ch. 4.
#include "commands/paper/paper.h"

#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"
#include "contact/law.h"
#include "contact/penalty.h"

#include <math.h>

static const double RAD_PER_S_PER_RPM = 3.14159265358979323846 / 30.0;

// forces are smooth over the turn: a tenth of a degree finds a maximum to some 1e-6 of it
enum { ANGLE_COUNT = 3600 };

static const double BASE_RPM = 1000.0;

// The reactions at one crank angle in two parts, N.
typedef struct ForceParts {
    Vec2 inertia; // at BASE_RPM
    Vec2 gravity;
} ForceParts;

static bool split_forces(const Scenario *fourbar, double angle, ForceParts parts[PRINTED_PIN_COUNT],
                         Err *err)
{
    const Linkage *linkage = &fourbar->linkage;
    const FourBarLengths lengths = fourbar_motion_nominal(&fourbar->fourbar);
    Motion motions[3];
    Reactions weightless;
    Reactions whole;
    if (!fourbar_motion_bodies(&lengths, BASE_RPM * RAD_PER_S_PER_RPM, angle, motions)) {
        return err_set(err, ERR_SOLVER, "the crank of the paper's four-bar does not turn fully");
    }
    if (!inverse_dynamics_solve(linkage, motions, 0.0, &weightless, err) ||
        !inverse_dynamics_solve(linkage, motions, fourbar->gravity, &whole, err)) {
        return false;
    }
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        const int joint = linkage_find_joint(linkage, PRINTED_PIN_NAMES[pin]);
        if (joint < 0) {
            return err_set(err, ERR_SOLVER, "the four-bar has no joint %s", PRINTED_PIN_NAMES[pin]);
        }
        parts[pin].inertia = weightless.force_on_b[joint];
        parts[pin].gravity = vec2_sub(whole.force_on_b[joint], weightless.force_on_b[joint]);
    }
    return true;
}

// The largest forces at many speeds, from one walk round the turn.
static bool largest_forces(const Scenario *fourbar, int speed_count, const double *rpm,
                           double (*forces)[PRINTED_PIN_COUNT], Err *err)
{
    for (int i = 0; i < ANGLE_COUNT; i++) {
        ForceParts parts[PRINTED_PIN_COUNT];
        const double angle = 2.0 * M_PI * i / ANGLE_COUNT;
        if (!split_forces(fourbar, angle, parts, err)) {
            return false;
        }
        for (int row = 0; row < speed_count; row++) {
            const double share = rpm[row] / BASE_RPM * (rpm[row] / BASE_RPM);
            for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
                const Vec2 inertia = vec2_scale(share, parts[pin].inertia);
                const double size = vec2_length(vec2_add(inertia, parts[pin].gravity));
                forces[row][pin] = i == 0 ? size : fmax(forces[row][pin], size);
            }
        }
    }
    return true;
}

bool physical_force(const Scenario *fourbar, double rpm, double forces[PRINTED_PIN_COUNT], Err *err)
{
    double row[1][PRINTED_PIN_COUNT];
    if (!largest_forces(fourbar, 1, &rpm, row, err)) {
        return false;
    }
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        forces[pin] = row[0][pin];
    }
    return true;
}

static ContactPair paper_pair(const MaterialOptions *material)
{
    const Clearance clearance = {
        .hole_radius = 0.5 * PRINTED_HOLE_DIAMETER,
        .pin_radius = 0.5 * PRINTED_PIN_DIAMETER,
        .width = PRINTED_PIN_WIDTH,
    };
    return law_pair(&clearance, material, BASE_RPM * RAD_PER_S_PER_RPM);
}

static double half_angle(const ContactPair *pair, double force)
{
    const double difference = pair->hole_radius - pair->pin_radius;
    const double radius = pair->hole_radius * pair->pin_radius / difference;
    const double stiffness = M_PI * pair->width * law_effective_modulus(pair);
    return asin(fmin(1.0, sqrt(4.0 * force * radius / stiffness) / pair->pin_radius));
}

static bool fill_pin(const ContactPair *pair, double force, PhysicalPin *made, Err *err)
{
    ForceLaw hertz;
    ForceLaw johnson;
    if (!law_make(LAW_HERTZ_SOCKET, pair, &hertz, err) ||
        !law_make(LAW_JOHNSON, pair, &johnson, err)) {
        return false;
    }
    made->force = force;
    made->hertz_approach = force_law_penetration(&hertz, force);
    made->johnson_approach = force_law_penetration(&johnson, force);
    made->johnson_tangent = force_law_tangent(&johnson, made->johnson_approach);
    made->half_angle = half_angle(pair, force);
    return true;
}

static bool fill_laws(const ContactPair *pair, double force, PhysicalLaw laws[PHYSICAL_LAW_COUNT],
                      Err *err)
{
    for (int kind = 0; kind < PHYSICAL_LAW_COUNT; kind++) {
        ForceLaw law;
        if (!law_make((LawKind)kind, pair, &law, err)) {
            return false;
        }
        const double approach = force_law_penetration(&law, force);
        laws[kind] = (PhysicalLaw){
            .name = OPTIONS_LAWS[kind],
            .approach = approach,
            .tangent = force_law_tangent(&law, approach),
        };
    }
    return true;
}

bool physical_compute(const Scenario *fourbar, Physical *physical, Err *err)
{
    double rpm[PRINTED_SPEED_COUNT];
    double forces[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        rpm[row] = printed_speed_rpm(row);
    }
    if (!largest_forces(fourbar, PRINTED_SPEED_COUNT, rpm, forces, err)) {
        return false;
    }
    Physical made = {0};
    const ContactPair pair = paper_pair(&fourbar->material);
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
            made.pins[row][pin] = (PhysicalPin){.name = PRINTED_PIN_NAMES[pin], .rpm = rpm[row]};
            if (!fill_pin(&pair, forces[row][pin], &made.pins[row][pin], err)) {
                return false;
            }
        }
    }
    made.estimated_force = pair.reference_force;
    made.real_force = forces[PHYSICAL_BASE_ROW][PRINTED_CRANK_COUPLER];
    if (!fill_laws(&pair, made.estimated_force, made.estimated, err) ||
        !fill_laws(&pair, made.real_force, made.real, err)) {
        return false;
    }
    *physical = made;
    return true;
}
