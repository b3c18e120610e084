// Does a linkage follow several drives, and drives that are given by angles?
//
// The truths are written out here: the laws of motion as formulas, their rates by differences, the
// five-bar in closed form, its forces by Newton and Euler one body after the other. Each has a
// control: with one number changed it must be missed.
#include "complete_run.h"
#include "load_case.h"

#include "base/lcg.h"
#include "run/drive_torque.h"

#include <stdio.h>

static const double G = 9.80665;
static const double DEG = 3.14159265358979323846 / 180.0;
static const double TURN = 6.28318530717958647692;

// Laws of motion: the share of the way after a share of the time, and its rates by that.
typedef void (*Law)(double tau, double s[3]);

static void cycloid(double tau, double s[3])
{
    s[0] = tau - sin(TURN * tau) / TURN;
    s[1] = 1.0 - cos(TURN * tau);
    s[2] = TURN * sin(TURN * tau);
}

static void polynomial(double tau, double s[3])
{
    s[0] = tau * tau * tau * (10.0 - 15.0 * tau + 6.0 * tau * tau);
    s[1] = 30.0 * tau * tau * (1.0 - tau) * (1.0 - tau);
    s[2] = 60.0 * tau * (1.0 - tau) * (1.0 - 2.0 * tau);
}

// The speed rises, holds and falls for a third of the time each.
static void trapezoid(double tau, double s[3])
{
    const double from_end = 1.0 - tau;
    const bool rises = tau < 1.0 / 3.0;
    const bool falls = tau >= 2.0 / 3.0;
    s[0] = rises ? 2.25 * tau * tau : falls ? 1.0 - 2.25 * from_end * from_end : 1.5 * tau - 0.25;
    s[1] = rises ? 4.5 * tau : falls ? 4.5 * from_end : 1.5;
    s[2] = rises ? 4.5 : falls ? -4.5 : 0.0;
}

static const Law LAWS[] = {cycloid, polynomial, trapezoid};
enum { LAWS_USED = 3 };

// What turns one crank: a constant speed, or a table of angles.
typedef struct Crank {
    double start; // rad
    double speed; // rad/s, where it has no points
    size_t count;
    double times[4];
    double angles[4]; // rad
    Law law;
} Crank;

static DriveState crank_at(const Crank *crank, double time_s)
{
    if (crank->count == 0) {
        return (DriveState){crank->start + crank->speed * time_s, crank->speed, 0.0};
    }
    size_t i = 0;
    while (i + 2 < crank->count && time_s >= crank->times[i + 1]) {
        i++;
    }
    const double width_s = crank->times[i + 1] - crank->times[i];
    const double lift = crank->angles[i + 1] - crank->angles[i];
    double s[3];
    crank->law((time_s - crank->times[i]) / width_s, s);
    return (DriveState){crank->start + crank->angles[i] + lift * s[0], lift * s[1] / width_s,
                        lift * s[2] / (width_s * width_s)};
}

// A drive as the case has it, of the same points.
static Driver driver_of(const Crank *crank, DriveProfile profile)
{
    Driver driver = {.is_present = true, .has_angles = true, .profile = profile};
    driver.table.count = crank->count;
    for (size_t i = 0; i < crank->count; i++) {
        driver.table.times[i] = crank->times[i];
        driver.table.values[i] = crank->angles[i];
    }
    drive_complete(&driver);
    return driver;
}

static const Crank STRETCH = {
    .count = 4, .times = {0.0, 0.03, 0.05, 0.121}, .angles = {0.0, 1.7, 1.7, -0.4}};

static void laws_of_motion_are_their_formulas(void **state)
{
    (void)state;
    for (size_t k = 0; k < LAWS_USED; k++) {
        Crank crank = STRETCH;
        crank.law = LAWS[k];
        const Driver driver = driver_of(&crank, (DriveProfile)k);
        double largest = 0.0;
        uint64_t seed = 7;
        for (int i = 0; i < 2000; i++) {
            const double time_s = 0.121 * 0.5 * (1.0 + lcg_draw(&seed));
            const DriveState truth = crank_at(&crank, time_s);
            const DriveState found = drive_at(&driver, time_s);
            assert_near(found.angle, truth.angle, 1e-14);
            assert_near(found.omega, truth.omega, 1e-12);
            assert_near(found.alpha, truth.alpha, 1e-9);
            // from a time before, by what has turned since then
            const double from_s = fmax(time_s - 1e-4, 0.0);
            const DrivePiece piece = drive_piece(&driver, from_s);
            if (drive_next_kink(&driver, from_s) > time_s) {
                const DriveState moved = drive_piece_at(&piece, time_s - from_s);
                const double turned = (double)(drive_angle_exact(&driver, time_s) -
                                               drive_angle_exact(&driver, from_s));
                assert_near(moved.angle, turned, 1e-15 * fabs(turned) + 1e-17);
                assert_near(moved.alpha, truth.alpha, 1e-9);
            }
            largest = fmax(largest, fabs(found.omega));
        }
        assert_close(fabs(driver.speed), largest, 1e-3);
        assert_near(drive_extent(&driver, 1.0).forth, 1.7, 1e-14);
        assert_near(drive_extent(&driver, 1.0).back, -0.4, 1e-14);
        assert_near(drive_at(&driver, 1.0).angle, -0.4, 1e-14);
        // the control: another law is another motion
        crank.law = LAWS[(k + 1) % LAWS_USED];
        assert_true(fabs(drive_angle(&driver, 0.01) - crank_at(&crank, 0.01).angle) > 1e-3);
    }
}

// It passes its points, and neither its angle nor its first two rates jump there.
static void check_spline(const Driver *driver, const double *times, const double *angles,
                         size_t count, bool repeats)
{
    const double small_s = 1e-7;
    for (size_t i = 0; i < count; i++) {
        assert_near(drive_angle(driver, times[i]), angles[i], 1e-13);
        if (!repeats && (i == 0 || i + 1 == count)) {
            assert_near(drive_at(driver, times[i]).omega, 0.0, 1e-12);
            continue;
        }
        const double before_s = times[i] + (i == 0 ? driver->table.period_s : 0.0) - small_s;
        const DriveState before = drive_since(driver, before_s, before_s + small_s);
        const DriveState after = drive_at(driver, before_s + small_s * (1.0 + 1e-6));
        assert_near(before.omega, after.omega, 1e-8);
        assert_near(before.alpha, after.alpha, 1e-6 * (1.0 + fabs(before.alpha)));
    }
}

static void a_spline_is_smooth_twice(void **state)
{
    (void)state;
    const Driver once = driver_of(&STRETCH, DRIVE_SPLINE);
    check_spline(&once, STRETCH.times, STRETCH.angles, 4, false);
    // the same again in each turn, and one period later a turn further
    Driver turning = driver_of(&STRETCH, DRIVE_SPLINE);
    turning.table.values[3] = 2.9;
    turning.table.period_s = 0.2;
    turning.gain = TURN;
    drive_complete(&turning);
    check_spline(&turning, turning.table.times, turning.table.values, 4, true);
    assert_near(drive_angle(&turning, 0.63) - drive_angle(&turning, 0.43), TURN, 1e-13);
    // the control: without its slopes it bends
    turning.slopes[1] += 1e-3;
    const DriveState before = drive_since(&turning, 0.029, 0.03);
    assert_true(fabs(before.alpha - drive_at(&turning, 0.03 * (1.0 + 1e-12)).alpha) > 1e-2);
}

// A five-bar: two cranks on the frame, two rods that meet at the tip.
typedef struct FiveBar {
    double frame, crank, rod; // m
    double m1, m2;            // kg, of a crank and a rod, whose centres are at their middles
    double j1, j2;            // kg m^2
} FiveBar;

static const FiveBar ROBOT = {0.08, 0.2, 0.21, 0.25, 0.3, 900e-6, 2200e-6};

typedef struct Point {
    Vec2 at, rate, second;
} Point;

static Point elbow_at(const FiveBar *of, double pivot, const DriveState *crank)
{
    const Vec2 arm = {of->crank * cos(crank->angle), of->crank * sin(crank->angle)};
    return (Point){
        .at = {pivot + arm.x, arm.y},
        .rate = vec2_scale(crank->omega, vec2_perp(arm)),
        .second = vec2_sub(vec2_scale(crank->alpha, vec2_perp(arm)),
                           vec2_scale(crank->omega * crank->omega, arm)),
    };
}

// Solves a . x = p, b . x = q.
static Vec2 solve(Vec2 a, Vec2 b, double p, double q)
{
    const double det = vec2_cross(a, b);
    return (Vec2){(p * b.y - q * a.y) / det, (q * a.x - p * b.x) / det};
}

// The tip above the line from the right elbow to the left one.
static Point tip_of(const FiveBar *of, const Point *left, const Point *right)
{
    const Vec2 apart = vec2_sub(right->at, left->at);
    const double half = 0.5 * vec2_length(apart);
    const double height = sqrt(of->rod * of->rod - half * half);
    Point tip;
    tip.at = vec2_add(vec2_scale(0.5, vec2_add(left->at, right->at)),
                      vec2_scale(0.5 * height / half, vec2_perp(apart)));
    const Vec2 a = vec2_sub(tip.at, left->at);
    const Vec2 b = vec2_sub(tip.at, right->at);
    tip.rate = solve(a, b, vec2_dot(a, left->rate), vec2_dot(b, right->rate));
    const Vec2 da = vec2_sub(tip.rate, left->rate);
    const Vec2 db = vec2_sub(tip.rate, right->rate);
    tip.second = solve(a, b, vec2_dot(a, left->second) - vec2_dot(da, da),
                       vec2_dot(b, right->second) - vec2_dot(db, db));
    return tip;
}

// The angle of a rod from its elbow to the tip, and its rates.
static DriveState rod_at(const FiveBar *of, const Point *elbow, const Point *tip)
{
    const double square = of->rod * of->rod;
    const Vec2 along = vec2_sub(tip->at, elbow->at);
    return (DriveState){
        atan2(along.y, along.x),
        vec2_cross(along, vec2_sub(tip->rate, elbow->rate)) / square,
        vec2_cross(along, vec2_sub(tip->second, elbow->second)) / square,
    };
}

// What a mass needs besides its weight, N.
static Vec2 needed(double mass, Vec2 first, Vec2 second)
{
    const Vec2 middle = vec2_scale(0.5, vec2_add(first, second));
    return (Vec2){mass * middle.x, mass * (middle.y + G)};
}

typedef struct State {
    DriveState rods[2];
    Vec2 pivots[2]; // N, on the cranks
    Vec2 elbows[2]; // N, on the rods
    Vec2 tip;       // N, on the right rod
    double torques[2];
} State;

static State state_at(const FiveBar *of, const DriveState cranks[2])
{
    const double feet[2] = {0.0, of->frame};
    Point elbows[2];
    State state;
    Vec2 arms[2];
    double moments[2];
    Vec2 needs[2];
    for (int i = 0; i < 2; i++) {
        elbows[i] = elbow_at(of, feet[i], &cranks[i]);
    }
    const Point tip = tip_of(of, &elbows[0], &elbows[1]);
    // about its elbow: J alpha + (half arm) x needed = arm x (force at the tip)
    for (int i = 0; i < 2; i++) {
        state.rods[i] = rod_at(of, &elbows[i], &tip);
        arms[i] = vec2_sub(tip.at, elbows[i].at);
        needs[i] = needed(of->m2, elbows[i].second, tip.second);
        moments[i] = of->j2 * state.rods[i].alpha + 0.5 * vec2_cross(arms[i], needs[i]);
    }
    // arm x F = arm.x F.y - arm.y F.x, on the left rod the opposite force
    state.tip =
        solve((Vec2){arms[0].y, -arms[0].x}, (Vec2){-arms[1].y, arms[1].x}, moments[0], moments[1]);
    for (int i = 0; i < 2; i++) {
        const Vec2 at_tip = vec2_scale(i == 0 ? -1.0 : 1.0, state.tip);
        state.elbows[i] = vec2_sub(needs[i], at_tip);
        const Vec2 arm = vec2_sub(elbows[i].at, (Vec2){feet[i], 0.0});
        const Vec2 own = needed(of->m1, elbows[i].second, (Vec2){0.0, 0.0});
        state.pivots[i] = vec2_add(own, state.elbows[i]);
        state.torques[i] = of->j1 * cranks[i].alpha + 0.5 * vec2_cross(arm, own) +
                           vec2_cross(arm, state.elbows[i]);
    }
    return state;
}

// The largest differences of a run from the closed form: of rates, and of forces and torques, over
// the largest of each; the closed form's cranks turned by a factor.
typedef struct Apart {
    double rates;
    double forces;
} Apart;

static Apart apart_of(const Scenario *scenario, const Trajectory *run, const Crank cranks[2],
                      double factor)
{
    double rate = 0.0;
    double force = 0.0;
    Apart apart = {0.0, 0.0};
    for (size_t k = 0; k < run->sample_count; k++) {
        DriveState at[2];
        for (int i = 0; i < 2; i++) {
            at[i] = crank_at(&cranks[i], run->times[k]);
            at[i].omega *= factor;
        }
        const State truth = state_at(&ROBOT, at);
        const JointState *joints = trajectory_state(run, k, 0);
        for (int i = 0; i < 2; i++) {
            const Motion *rod = trajectory_motion(run, k, 2 + (size_t)i);
            const double torque = drive_torque_at(scenario, run, (size_t)i, k);
            rate = fmax(rate, fabs(truth.rods[i].omega));
            apart.rates = fmax(apart.rates, fabs(rod->omega - truth.rods[i].omega));
            apart.rates =
                fmax(apart.rates, fabs(remainder(rod->angle - truth.rods[i].angle, TURN)));
            force = fmax(force, vec2_length(truth.pivots[i]));
            apart.forces =
                fmax(apart.forces, vec2_length(vec2_sub(joints[i].force_on_b, truth.pivots[i])));
            apart.forces = fmax(apart.forces,
                                vec2_length(vec2_sub(joints[2 + i].force_on_b, truth.elbows[i])));
            apart.forces = fmax(apart.forces, fabs(torque - truth.torques[i]) / ROBOT.crank);
        }
        apart.forces = fmax(apart.forces, vec2_length(vec2_sub(joints[4].force_on_b, truth.tip)));
    }
    return (Apart){apart.rates / rate, apart.forces / force};
}

static const Crank LEFT = {
    .start = 120.0, .count = 4, .times = {0.0, 0.2, 0.3, 0.6}, .angles = {0.0, -35.0, -35.0, 0.0}};
static const Crank RIGHT = {
    .start = 60.0, .count = 4, .times = {0.0, 0.2, 0.3, 0.6}, .angles = {0.0, -20.0, -20.0, 0.0}};

static Crank in_rad(const Crank *degrees, Law law)
{
    Crank crank = *degrees;
    crank.start *= DEG;
    crank.law = law;
    for (size_t i = 0; i < crank.count; i++) {
        crank.angles[i] *= DEG;
    }
    return crank;
}

static const char FIVE_BAR[] = "cases/mechanisms/five-bar.yaml";

static void a_five_bar_is_its_closed_form(void **state)
{
    (void)state;
    static const char *const WORDS[LAWS_USED] = {"cycloid", "polynomial", "trapezoid"};
    for (size_t k = 0; k < LAWS_USED; k++) {
        char profiles[2][48];
        snprintf(profiles[0], sizeof profiles[0], "drive.profile=%s", WORDS[k]);
        snprintf(profiles[1], sizeof profiles[1], "drives.right-pivot.profile=%s", WORDS[k]);
        // so many samples that none is at a kink, where the forces jump
        const char *const settings[] = {profiles[0], profiles[1], "run.step=20us",
                                        "run.samples=719"};
        Scenario scenario = load(FIVE_BAR, settings, 4);
        const Crank cranks[2] = {in_rad(&LEFT, LAWS[k]), in_rad(&RIGHT, LAWS[k])};
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Apart apart = apart_of(&scenario, run, cranks, 1.0);
        print_message("# %s: rates %.2g, forces %.2g\n", WORDS[k], apart.rates, apart.forces);
        assert_true(apart.rates < 1e-10 && apart.forces < 1e-10);
        const Apart control = apart_of(&scenario, run, cranks, 1.0 + 1e-9);
        assert_true(control.rates > 1e-10 && control.forces > 1e-10);
        assert_true(fabs(run->energy.residual) < 1e-12);
        trajectory_destroy(run);
        // ODE's forces are those of the middles of its steps
        static const OdeStepping STEPPINGS[] = {ODE_STAGGERED, ODE_PLAIN};
        static const double BOUNDS[] = {1e-6, 2e-3};
        for (int i = 0; i < 2; i++) {
            scenario.ode.stepping = STEPPINGS[i];
            run = complete_run(&scenario, BACKEND_ODE);
            const double rates = apart_of(&scenario, run, cranks, 1.0).rates;
            print_message("# %s, %s: rates %.2g\n", WORDS[k], run->label, rates);
            assert_true(rates < BOUNDS[i]);
            trajectory_destroy(run);
        }
    }
}

// At constant speeds of each crank, in directions that keep the elbows within reach of each other.
static void random_speeds_are_the_closed_form(void **state)
{
    (void)state;
    uint64_t seed = 20261127;
    for (int i = 0; i < 10; i++) {
        const double common = 40.0 * lcg_draw(&seed);
        Crank cranks[2] = {{.start = 120.0 * DEG}, {.start = 60.0 * DEG}};
        char speeds[2][64];
        for (int k = 0; k < 2; k++) {
            cranks[k].speed = common + 1.5 * lcg_draw(&seed);
            snprintf(speeds[k], sizeof speeds[k], "%s.speed=%.17grad/s",
                     k == 0 ? "drive" : "drives.right-pivot", cranks[k].speed);
        }
        const char *const settings[] = {speeds[0], speeds[1], "run.duration=120ms",
                                        "run.step=50us"};
        Scenario scenario = load(FIVE_BAR, settings, 4);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Apart apart = apart_of(&scenario, run, cranks, 1.0);
        print_message("# %.3g and %.3g rad/s: %.2g, %.2g\n", cranks[0].speed, cranks[1].speed,
                      apart.rates, apart.forces);
        assert_true(apart.rates < 1e-10 && apart.forces < 1e-10);
        trajectory_destroy(run);
        scenario.ode.stepping = ODE_EXTRAPOLATED;
        run = complete_run(&scenario, BACKEND_ODE);
        const Apart of_ode = apart_of(&scenario, run, cranks, 1.0);
        print_message("# %s: %.2g, %.2g\n", run->label, of_ode.rates, of_ode.forces);
        // forces come from second differences over 50 us
        assert_true(of_ode.rates < 1e-9 && of_ode.forces < 1e-7);
        trajectory_destroy(run);
    }
}

// Of all that the drives give nothing is lost, in ODE and in the reference, and both agree.
static void play_at_the_tip_keeps_the_balance(void **state)
{
    (void)state;
    const char *const settings[] = {"joints.tip.radial-clearance=20um",
                                    "contact.friction=0.1",
                                    "joints.left-elbow.radial-clearance=20um",
                                    "contact.stiffness=6.6e10N/m^1.5",
                                    "run.duration=60ms",
                                    "run.step=5us"};
    const Scenario scenario = load(FIVE_BAR, settings, 6);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    assert_true(run_impacts(truth) > 3);
    assert_true(fabs(truth->energy.residual) < 1e-11);
    print_message("# residuals %.2g and %.2g J of %.3g\n", truth->energy.residual,
                  run->energy.residual, truth->energy.drive_work);
    assert_true(fabs(run->energy.residual) < 1e-5 * fabs(truth->energy.drive_work));
    double apart = 0.0;
    for (size_t k = 0; k < truth->sample_count; k++) {
        for (size_t i = 2; i < 4; i++) {
            apart = fmax(apart, fabs(trajectory_motion(run, k, i)->omega -
                                     trajectory_motion(truth, k, i)->omega));
        }
    }
    print_message("# apart %.2g rad/s\n", apart);
    assert_true(apart < 1e-3);
    trajectory_destroy(run);
    trajectory_destroy(truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_of_motion_are_their_formulas),
        cmocka_unit_test(a_spline_is_smooth_twice),
        cmocka_unit_test(a_five_bar_is_its_closed_form),
        cmocka_unit_test(random_speeds_are_the_closed_form),
        cmocka_unit_test(play_at_the_tip_keeps_the_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
