// What do solref and solimp have to be so that MuJoCo makes the linear contact of them?
//
// One row of MuJoCo, r < 0 the gap, v its rate, a0 its acceleration without the force, W the true
// and A the approximate inverse mass of the row (documentation, "Computation" and "Modeling"):
//     f = (a_ref - a0) / (W + R) >= 0,  R = A (1 - d) / d,  a_ref = -b v - k r
//     direct format, d constant: solref = (-s, -c'), b = c' / d, k = s / d
// For d -> 0, R outweighs W and   f = (d / A) (-b v - k r - a0) = -(s r + c' v) / A  - d a0 / A:
// a spring s / A and a damper c' / A, whatever the mass that is met, but for a share d of a0. So
//     s = A K,  c' = A C,  d as small as is allowed, 1e-4
// A is what the compiler of MuJoCo finds at qpos0: the sum of both bodies' body_invweight0, 1/m of
// a body with a free joint and 0 of one that is welded to the world or moved as mocap. f and the
// forces here: N; K N/m; C N s/m.
//
// r and v are those before the step: the spring is explicit, where the textbook's row in ODE is
// implicit and stable at any step. So omega h and C h / m, m the effective mass, stay below a
// tenth.
#include "commands/tune/tune_export.h"

#include "commands/tune/tune_limit.h"
#include "contact/law.h"
#include "write/joint_units.h"
#include "write/number.h"
#include "write/xml.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

enum { FRICTION_SIZE = 128 };

static const double LEAST_IMPEDANCE = 1e-4; // mjMINIMP

// of the explicit limit 2 for the effective mass at the deepest contact: the lightest that a pin of
// a linkage meets was seen to be a sixth of that, where omega h is then 0.25
static const double STEP_SHARE = 0.1;

static double inverse_mass(const Linkage *linkage, int body)
{
    return body == LINKAGE_GROUND || body == linkage_driven_body(linkage)
               ? 0.0
               : 1.0 / linkage->bodies[body].mass;
}

bool tune_mujoco_find(const TuneReport *report, TuneMujoco *mujoco)
{
    const Tune *tune = report->tune;
    if (tune->linear == TUNE_NONE ||
        (tune->contact.is_limit &&
         tune_limit_lacks_range(report->scenario, tune->contact.joint) != NULL)) {
        return false;
    }
    const Linkage *linkage = &report->scenario->linkage;
    const Joint *joint = &linkage->joints[tune->contact.joint];
    const TuneLinear *linear = &tune->linears[tune->linear];
    const double weight = tune->contact.is_limit ? 1.0 / tune->contact.mass
                                                 : inverse_mass(linkage, joint->body_a) +
                                                       inverse_mass(linkage, joint->body_b);
    *mujoco = (TuneMujoco){
        .weight = weight,
        .impedance = LEAST_IMPEDANCE,
        .solref = {-weight * linear->stiffness, -weight * linear->damping},
        .stiffness = linear->stiffness,
        .damping = linear->damping,
        .step_s = fmin(linear->step_s,
                       STEP_SHARE * fmin(sqrt(tune->contact.mass / linear->stiffness),
                                         tune->contact.mass / fmax(linear->damping, DBL_MIN))),
    };
    return weight > 0.0;
}

bool tune_mujoco_is_finer(const TuneReport *report, const TuneMujoco *mujoco)
{
    return mujoco->step_s < report->tune->held_s;
}

// Appends the words above the document to `text`, and its elements to `parts`.
static void write_pair(const TuneReport *report, const TuneMujoco *mujoco, Text *text, Text *parts)
{
    const Scenario *scenario = report->scenario;
    const Joint *joint = &scenario->linkage.joints[report->tune->contact.joint];
    const double friction = law_options(&scenario->contact, joint).friction;
    char slides[FRICTION_SIZE] = "";
    if (friction > 0.0) {
        // both directions of sliding; MuJoCo's own numbers for torsion and rolling, which a planar
        // pin does not do
        snprintf(slides, sizeof slides, "\n        friction=\"%s %s 0.005 0.0001 0.0001\"",
                 number_shortest(friction).text, number_shortest(friction).text);
    }
    text_append(text,
                "<!-- spring %.4g N/m, damper %.4g N s/m, not run here; for bodies\n"
                "     with free joints, held by connect equalities: A = %.6g 1/kg. In any\n"
                "     other model multiply solref by (invweight0 of both bodies) / A. -->\n",
                mujoco->stiffness, mujoco->damping, mujoco->weight);
    text_append(parts,
                "<option timestep=\"%s\"\n        integrator=\"Euler\" cone=\"elliptic\"/>\n"
                "<contact>\n"
                "  <pair geom1=\"pin\" geom2=\"hole\" condim=\"%d\" margin=\"0\" gap=\"0\"%s\n"
                "        solref=\"%s %s\"\n"
                "        solimp=\"%s %s 1 0.5 1\"/>\n"
                "</contact>\n",
                number_shortest(mujoco->step_s).text, friction > 0.0 ? 3 : 1, slides,
                number_shortest(mujoco->solref[0]).text, number_shortest(mujoco->solref[1]).text,
                number_shortest(mujoco->impedance).text, number_shortest(mujoco->impedance).text);
}

// The limit of a joint, in radians or metres.
static void write_limit(const TuneReport *report, const TuneMujoco *mujoco, Text *text, Text *parts)
{
    const Joint *joint = &report->scenario->linkage.joints[report->tune->contact.joint];
    const JointUnits *units = joint_units(joint);
    text_append(text,
                "<!-- spring %.4g %s, damper %.4g %s, not run here; for bodies\n"
                "     in a tree of joints: A = %.6g 1/(%s). In any other model multiply\n"
                "     solreflimit by the joint's dof_invweight0 / A. -->\n",
                mujoco->stiffness, units->stiffness, mujoco->damping, units->damping,
                mujoco->weight, units->mass);
    text_append(parts,
                "<compiler angle=\"radian\"/>\n"
                "<option timestep=\"%s\" integrator=\"Euler\"/>\n",
                number_shortest(mujoco->step_s).text);
    tune_limit_mjcf(report, mujoco->solref, mujoco->impedance, parts);
}

void tune_mujoco_write(const TuneReport *report, Text *text)
{
    TuneMujoco mujoco;
    if (!tune_mujoco_find(report, &mujoco)) {
        return;
    }
    Text parts;
    text_init(&parts);
    if (report->tune->contact.is_limit) {
        write_limit(report, &mujoco, text, &parts);
    } else {
        write_pair(report, &mujoco, text, &parts);
    }
    xml_append_element("mujoco", parts.data, text);
    text_finish(&parts);
}
