// Does the woodpecker go down its pole as the model of Glocker and Studer says?
//
// Their three coordinates q = (y, p, s): height of the sleeve, its angle, the bird's; gaps and the
// speeds at which friction acts are linear in them, beak first:
//     g1 = l_M + l_G - l_S - r_O - h_S s,    g2,3 = r_M - r_O +- h_M p
//     v1 = y' + l_M p' + (l_G - l_S) s',     v2,3 = y' + r p'
// M q'' = gravity and spring + sum over places of N grad g - mu N tanh(v / v_s) grad v. Their lever
// r is r_M: both corners that touch count as one, on one side. With corners on both sides of the
// pole the moments of friction cancel, and r is 0. Here N is that of the case's stiff corners.
// Source: C. Glocker, C. Studer, Multibody System Dynamics 13 (2005) 447-463.
#include "complete_run.h"
#include "load_case.h"

#include <math.h>

enum { COORDINATES = 3, PLACES = 3 };

static const double STEP = 2e-7; // s: the corners' period is some 1e-3

// What the model says after the run.
typedef struct Outcome {
    double height; // m
    double omega_max;
    double omega_min; // rad/s, of the sleeve
    int pecks;
} Outcome;

typedef struct Place {
    double clearance;            // m, the gap where all coordinates are 0
    double gap[COORDINATES];     // the gap over each coordinate
    double sliding[COORDINATES]; // the sliding speed likewise
    double factor;               // 1, of the damping
    double approach;             // m/s, as the contact began
    bool is_touching;
} Place;

typedef struct Model {
    double inverse_mass[COORDINATES][COORDINATES];
    Place places[PLACES];
    double q[COORDINATES];
    double u[COORDINATES];
} Model;

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const double R_O = 0.0025;
static const double R_M = 0.0031;
static const double H_M = 0.0058;
static const double L_M = 0.010;
static const double L_G = 0.015;
static const double H_S = 0.02;
static const double L_S = 0.0201;
static const double SLEEVE = 0.0003; // kg
static const double BIRD = 0.0045;

static void invert_mass(double inverse[COORDINATES][COORDINATES])
{
    const double lever[COORDINATES] = {1.0, L_M, L_G};
    double m[COORDINATES][COORDINATES];
    for (int i = 0; i < COORDINATES; i++) {
        for (int k = 0; k < COORDINATES; k++) {
            m[i][k] = BIRD * lever[i] * lever[k];
        }
    }
    m[0][0] += SLEEVE;
    m[1][1] += 5e-9;
    m[2][2] += 7e-7;
    double determinant = 0.0;
    for (int i = 0; i < COORDINATES; i++) {
        for (int k = 0; k < COORDINATES; k++) {
            const int a = (k + 1) % COORDINATES;
            const int b = (k + 2) % COORDINATES;
            const int c = (i + 1) % COORDINATES;
            const int d = (i + 2) % COORDINATES;
            inverse[i][k] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    }
    for (int k = 0; k < COORDINATES; k++) {
        determinant += m[0][k] * inverse[k][0];
    }
    for (int i = 0; i < COORDINATES * COORDINATES; i++) {
        inverse[i / COORDINATES][i % COORDINATES] /= determinant;
    }
}

// The factors of restitution 0.5 and 0.05, where factor (1 + e) = ln((1 + factor) / (1 - factor
// e)).
static Model make_model(double lever)
{
    Model model = {
        .places =
            {{L_M + L_G - L_S - R_O, {0.0, 0.0, -H_S}, {1.0, L_M, L_G - L_S}, 1.432751, 0.0, false},
             {R_M - R_O, {0.0, H_M, 0.0}, {1.0, lever, 0.0}, 19.9999999836, 0.0, false},
             {R_M - R_O, {0.0, -H_M, 0.0}, {1.0, lever, 0.0}, 19.9999999836, 0.0, false}},
        .q = {0.0, -0.1036, -0.2788},
        .u = {-0.3411, 0.0, -7.4583},
    };
    invert_mass(model.inverse_mass);
    return model;
}

// Adds what a place does; returns whether a contact began.
static bool add_place(const Scenario *scenario, Place *place, const Model *model, double *force)
{
    const double gap = place->clearance + dot(place->gap, model->q);
    const double closing = -dot(place->gap, model->u);
    const bool began = gap < 0.0 && !place->is_touching;
    place->is_touching = gap < 0.0;
    if (!place->is_touching) {
        return false;
    }
    place->approach = began ? fmax(closing, scenario->contact.impact_speed_floor) : place->approach;
    const ContactOptions *contact = &scenario->contact;
    const double normal =
        fmax(0.0, contact->stiffness * -gap * (1.0 + place->factor * closing / place->approach));
    const double sliding = tanh(dot(place->sliding, model->u) / contact->friction_speed);
    for (int i = 0; i < COORDINATES; i++) {
        force[i] += normal * (place->gap[i] - contact->friction * sliding * place->sliding[i]);
    }
    return began;
}

static Outcome integrate(const Scenario *scenario, double lever)
{
    const double c = 0.0056;
    const double g = 9.81;
    Model model = make_model(lever);
    Outcome outcome = {.pecks = 0};
    const long steps = lround(scenario->run.duration / STEP);
    for (long step = 0; step < steps; step++) {
        for (int i = 0; i < COORDINATES; i++) {
            model.q[i] += 0.5 * STEP * model.u[i];
        }
        const double spring = c * (model.q[1] - model.q[2]);
        double force[COORDINATES] = {-(SLEEVE + BIRD) * g, -spring - BIRD * g * L_M,
                                     spring - BIRD * g * L_G};
        for (int k = 0; k < PLACES; k++) {
            const bool began = add_place(scenario, &model.places[k], &model, force);
            outcome.pecks += began && k == 0 ? 1 : 0;
        }
        for (int i = 0; i < COORDINATES; i++) {
            model.u[i] += STEP * dot(model.inverse_mass[i], force);
            model.q[i] += 0.5 * STEP * model.u[i];
        }
        outcome.omega_max = fmax(outcome.omega_max, model.u[1]);
        outcome.omega_min = fmin(outcome.omega_min, model.u[1]);
    }
    outcome.height = model.q[0];
    return outcome;
}

static Scenario load_woodpecker(void)
{
    return load("cases/mechanisms/woodpecker.yaml", NULL, 0);
}

// The model itself gives the numbers in print, which a time-stepping code has: y -41.35 mm, and the
// sleeve's angular velocity up to 31.9 rad/s.
static void the_models_lever_gives_the_published_descent(void **state)
{
    (void)state;
    // stiffer, for that code's corners are rigid
    const Scenario scenario =
        load_with("cases/mechanisms/woodpecker.yaml", "contact.stiffness=1e6 N/m");
    const Outcome outcome = integrate(&scenario, R_M);
    assert_close(outcome.height, -0.04135, 0.01);
    assert_close(outcome.omega_max, 31.9, 0.05);
    assert_int_equal(outcome.pecks, 2);
}

static void without_that_lever_the_descent_is_that_of_the_reference(void **state)
{
    (void)state;
    const Scenario scenario = load_woodpecker();
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const size_t last = run->sample_count - 1;
    const double height = trajectory_motion(run, last, 0)->position.y;
    const Outcome outcome = integrate(&scenario, 0.0);
    // tilts of 0.1 and angles of 0.5 rad are not small: their cosines are up to a tenth off 1
    assert_close(height, outcome.height, 0.15);
    assert_close(run->bodies[0].omega_max.value, outcome.omega_max, 0.15);
    assert_int_equal(run->joints[2].impacts, outcome.pecks);
    // the control: with the lever it is another descent
    assert_true(fabs(integrate(&scenario, R_M).height / height - 1.0) > 0.4);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_models_lever_gives_the_published_descent),
        cmocka_unit_test(without_that_lever_the_descent_is_that_of_the_reference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
