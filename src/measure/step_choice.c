// Which step is to be tried next?
//
// One that is a little finer. A trial ends at the first sample that is above the tolerance, which
// is mostly soon: on random mechanisms a walk in small steps comes to the coarsest step that will
// do at the cost of little more than that one run. To jump ahead as the order says takes fewer
// trials and more world steps, for errors do not fall as the order says: grazing impacts come and
// go. Where all joints are ideal they do: a trial is run to its end, and the next step follows from
// its largest error and the order.
#include "measure/step_choice.h"

#include "base/zeroed.h"
#include "contact/touch.h"
#include "model/scale.h"

#include <math.h>

// the next step over the last one, where that missed at once and where it missed at the end
static const double FINER_EARLY = 0.8;
static const double FINER_LATE = 0.7;

// a failed trial gives no hint of the step that succeeds
static const double AFTER_FAILURE = 0.5;

// The first step is coarser than most that will do: a trial of it costs next to nothing.
static const double FIRST_STEPS = 20.0;    // of the drive's turn, or of a run without a drive
static const double FIRST_CONTACTS = 64.0; // half-periods of a contact, if that is less
static const double LEAST_STEPS = 10.0;    // of any run

// Where the order says it, a step this much shorter than what would just do; and within these
// shares of the last one, for the coarsest steps are beyond what the order says.
static const double ORDER_SHARE = 0.9;
static const double ORDER_LEAST = 0.4;
static const double ORDER_MOST = 0.9;

// How fast the sides of a place may meet: as the fastest point of the linkage, or at a turn as the
// faster of its two bodies turns at the most.
static double meeting_speed(const Scenario *scenario, const Touch *place)
{
    SpeedScale scale = scale_speeds(scenario);
    double speed = place->shape == TOUCH_TURN ? 0.0 : scale.moving;
    for (int side = 0; place->shape == TOUCH_TURN && side < 2; side++) {
        const int body = linkage_end(&scenario->linkage.joints[place->joint], side).body;
        speed = body == LINKAGE_GROUND ? speed : fmax(speed, scale.turning[body]);
    }
    scale_free(&scale);
    return speed;
}

// A depth of a contact: a tenth of the clearance, or of stops and of the ends of a coordinate what
// their bodies would press in. Laws of these are powers.
static double contact_depth(const Scenario *scenario, const Touch *place, double mass)
{
    static const double DEPTH = 0.1;
    const Joint *joint = &scenario->linkage.joints[place->joint];
    if (joint->kind == JOINT_CLEARANCE || joint->kind == JOINT_GUIDE) {
        return fmin(DEPTH * linkage_radial_clearance(joint),
                    0.5 * force_law_depth_limit(&place->law));
    }
    const double speed = meeting_speed(scenario, place);
    const double power = place->law.exponent + 1.0;
    return pow(0.5 * power * mass * speed * speed / place->law.stiffness, 1.0 / power);
}

// The shortest half-period of contacts at places that the response has been taken with, s.
static double shortest_time(const Scenario *scenario, const Response *response, const Touch *places,
                            size_t count)
{
    double shortest_s = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const size_t row = response_first_row(response, i);
        // the first row of a line is along its normal
        const double along = response_mass(response, row, (Vec2){1.0, 0.0});
        const double mass = touch_is_scalar(&places[i])
                                ? along
                                : fmin(along, response_mass(response, row, (Vec2){0.0, 1.0}));
        const double depth = contact_depth(scenario, &places[i], mass);
        shortest_s = fmin(shortest_s, M_PI * sqrt(mass / force_law_tangent(&places[i].law, depth)));
    }
    return shortest_s;
}

// The half-period of the stiffest contact, s.
static double contact_time(const Scenario *scenario)
{
    Touch *places;
    size_t count;
    Response response;
    Err unused = {ERR_NONE, ""};
    if (!touch_list(scenario, &places, &count, &unused)) {
        return INFINITY; // opening the world says what is wrong
    }
    Motion *motions = zeroed(scenario->linkage.body_count, sizeof *motions);
    linkage_start(&scenario->linkage, motions);
    touch_response(&scenario->linkage, places, count, false, &response);
    const double shortest_s = response_place(&response, motions)
                                  ? shortest_time(scenario, &response, places, count)
                                  : INFINITY;
    response_finish(&response);
    free(motions);
    free(places);
    return shortest_s;
}

StepChoice step_choice_begin(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const double duration_s = scenario_duration(scenario);
    const double turn_s = drive_is_steady(&linkage->driver) ? linkage_period(linkage) : duration_s;
    const double first_s = fmin(turn_s / FIRST_STEPS, duration_s / LEAST_STEPS);
    const OdeOptions *ode = &scenario->ode;
    bool is_smooth = true;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_smooth = is_smooth && !linkage_has_play(&linkage->joints[i]);
    }
    return (StepChoice){
        .scenario = scenario,
        .first_step_s = fmin(first_s, FIRST_CONTACTS * contact_time(scenario)),
        .is_smooth = is_smooth,
        .order = ode->stepping == ODE_PLAIN          ? 1.0
                 : ode->stepping == ODE_EXTRAPOLATED ? (double)ode->levels + 1.0
                                                     : 2.0,
    };
}

Scenario step_choice_scenario(const StepChoice *choice, double step_s)
{
    return scenario_with_step(choice->scenario, step_s);
}

double step_choice_finer(double step_s, double share)
{
    return step_s * (FINER_EARLY + (FINER_LATE - FINER_EARLY) * fmin(1.0, share));
}

double step_choice_by_order(const StepChoice *choice, double step_s, double excess)
{
    const double share = ORDER_SHARE * pow(excess, -1.0 / choice->order);
    return step_s * fmin(fmax(share, ORDER_LEAST), ORDER_MOST);
}

double step_choice_after_failure(double step_s)
{
    return AFTER_FAILURE * step_s;
}
