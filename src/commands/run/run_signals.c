// What the motion of a run is like over its revolutions, as JSON: its state once a revolution, and
// its signals by order.
#include "base/zeroed.h"
#include "commands/run/run_report.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "run/drive_torque.h"
#include "write/json_value.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>

// A run, and which of its bodies or joints a signal is of.
typedef struct Signal {
    const Scenario *scenario;
    const Trajectory *run;
    size_t number;
} Signal;

static double angle_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->angle;
}

static double omega_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->omega;
}

static double x_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->position.x;
}

static double y_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->position.y;
}

static double velocity_x_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->velocity.x;
}

static double velocity_y_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_motion(signal->run, sample, signal->number)->velocity.y;
}

static double ex_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_state(signal->run, sample, signal->number)->eccentricity.x;
}

static double ey_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_state(signal->run, sample, signal->number)->eccentricity.y;
}

static double force_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return trajectory_state(signal->run, sample, signal->number)->force;
}

static double torque_at(const void *context, size_t sample)
{
    const Signal *signal = context;
    return drive_torque_at(signal->scenario, signal->run, signal->number, sample);
}

// Sections.

static json_t *values_at(const Sections *sections, SpectrumSignal *of, const Signal *signal)
{
    json_t *values = json_array();
    for (size_t n = 0; n < sections->count; n++) {
        json_array_append_new(values, json_value_real(of(signal, section_sample(sections, n))));
    }
    return values;
}

typedef struct SignalName {
    const char *key;
    SpectrumSignal *at;
} SignalName;

static const SignalName SECTION_OF_BODY[] = {
    {"angle_rad", angle_at}, {"omega_rad_s", omega_at},         {"x_m", x_at},
    {"y_m", y_at},           {"velocity_x_m_s", velocity_x_at}, {"velocity_y_m_s", velocity_y_at},
};

static const SignalName SECTION_OF_JOINT[] = {{"ex_m", ex_at}, {"ey_m", ey_at}};

static json_t *section_members(const Sections *sections, const SignalName *names, size_t count,
                               const Signal *signal)
{
    json_t *object = json_object();
    for (size_t k = 0; k < count; k++) {
        json_object_set_new(object, names[k].key, values_at(sections, names[k].at, signal));
    }
    return object;
}

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static json_t *section_json(const Scenario *scenario, const Trajectory *run,
                            const Sections *sections)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *object = json_object();
    const double crank = run->crank_angles[sections->first];
    json_value_set(object, "crank_deg",
                   drive_is_steady(&linkage->driver) ? units_wrapped_deg(crank) : NAN);
    json_object_set_new(object, "revolutions", json_integer((json_int_t)sections->count - 1));
    json_object_set_new(object, "period",
                        sections->is_period_known ? json_integer((json_int_t)sections->period)
                                                  : json_null());
    json_value_set(object, "change", sections->change);
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i)) {
            json_object_set_new(bodies, linkage->bodies[i].name,
                                section_members(sections, SECTION_OF_BODY,
                                                COUNT_OF(SECTION_OF_BODY),
                                                &(Signal){scenario, run, i}));
        }
    }
    json_object_set_new(object, "bodies", bodies);
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (trajectory_feels_play(run, &linkage->joints[i]) &&
            joint_has_hole(linkage->joints[i].kind)) {
            json_object_set_new(joints, linkage->joints[i].name,
                                section_members(sections, SECTION_OF_JOINT,
                                                COUNT_OF(SECTION_OF_JOINT),
                                                &(Signal){scenario, run, i}));
        }
    }
    json_object_set_new(object, "joints", joints);
    return object;
}

// Spectra.

// The lines of a signal, and by how much they may be off, under the same key in `uncertainty`.
static void set_lines(json_t *object, const char *key, const double *amplitudes, size_t count,
                      double folded)
{
    json_t *values = json_array();
    for (size_t k = 0; k < count; k++) {
        json_array_append_new(values, json_value_real(amplitudes[k]));
    }
    json_object_set_new(object, key, values);
    json_t *uncertainty = json_object_get(object, "uncertainty");
    if (uncertainty == NULL) {
        uncertainty = json_object();
        json_object_set_new(object, "uncertainty", uncertainty);
    }
    json_value_set(uncertainty, key, folded);
}

static void set_amplitudes(json_t *object, const char *key, Spectrum *spectrum, SpectrumSignal *of,
                           const Signal *signal)
{
    double *amplitudes = zeroed(spectrum->orders.count, sizeof *amplitudes);
    const double folded = spectrum_find(spectrum, of, signal, amplitudes);
    set_lines(object, key, amplitudes, spectrum->orders.count, folded);
    free(amplitudes);
}

// Of a body's angle.
static void set_accelerations(json_t *object, Spectrum *spectrum, const Signal *signal)
{
    const Orders *orders = &spectrum->orders;
    const double *times = signal->run->times;
    const double span_s = times[orders->first + orders->samples] - times[orders->first];
    double *amplitudes = zeroed(orders->count, sizeof *amplitudes);
    const double folded =
        spectrum_find_acceleration(spectrum, angle_at, omega_at, signal, span_s, amplitudes);
    set_lines(object, "alpha_rad_s2", amplitudes, orders->count, folded);
    free(amplitudes);
}

static json_t *spectrum_json(const Scenario *scenario, const Trajectory *run, const Orders *orders)
{
    const Linkage *linkage = &scenario->linkage;
    Spectrum spectrum = spectrum_begin(orders);
    json_t *object = json_object();
    json_t *numbers = json_array();
    for (size_t k = 0; k < orders->count; k++) {
        json_array_append_new(numbers, json_value_real(spectrum_order(orders, k)));
    }
    json_object_set_new(object, "revolutions", json_integer((json_int_t)orders->revolutions));
    json_object_set_new(object, "orders", numbers);
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (linkage_is_driven(linkage, (int)i)) {
            continue;
        }
        const Signal signal = {scenario, run, i};
        json_t *body = json_object();
        set_amplitudes(body, "omega_rad_s", &spectrum, omega_at, &signal);
        set_accelerations(body, &spectrum, &signal);
        set_amplitudes(body, "velocity_x_m_s", &spectrum, velocity_x_at, &signal);
        set_amplitudes(body, "velocity_y_m_s", &spectrum, velocity_y_at, &signal);
        json_object_set_new(bodies, linkage->bodies[i].name, body);
    }
    json_object_set_new(object, "bodies", bodies);
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *of = &linkage->joints[i];
        if (trajectory_feels_play(run, of)) {
            json_t *joint = json_object();
            set_amplitudes(joint, linkage_is_torsional(of) ? "torque_N_m" : "force_N", &spectrum,
                           force_at, &(Signal){scenario, run, i});
            json_object_set_new(joints, of->name, joint);
        }
    }
    json_object_set_new(object, "joints", joints);
    if (drive_torque_exists(linkage)) {
        set_amplitudes(object, "drive_torque_N_m", &spectrum, torque_at,
                       &(Signal){scenario, run, 0});
    }
    spectrum_finish(&spectrum);
    return object;
}

void run_signals_json(json_t *object, const Scenario *scenario, const Trajectory *run)
{
    const Sections sections = section_find(run);
    const Orders orders = spectrum_orders(&sections);
    json_object_set_new(object, "section",
                        sections.count > 0 ? section_json(scenario, run, &sections) : json_null());
    json_object_set_new(object, "spectrum",
                        orders.count > 0 ? spectrum_json(scenario, run, &orders) : json_null());
}
