// Is a change point of ideal joints found where a motion passes one, and nowhere else?
#include "measure/error.h"

#include "load_case.h"
#include "scratch.h"

#include <math.h>
#include <unistd.h>

static const double LENGTH = 0.1; // m, of both cranks
static const double BASE = 0.2;   // m, of the bar and between the pivots

static const char PARALLELOGRAM[] =
    "title: Parallelogram\n"
    "bodies:\n"
    "  left:  {mass: 0.1 kg, inertia: 90 kg mm^2, at: [0 mm, 50 mm], angle: 90 deg}\n"
    "  right: {mass: 0.1 kg, inertia: 90 kg mm^2, at: [200 mm, 50 mm], angle: 90 deg}\n"
    "  bar:   {mass: 0.2 kg, inertia: 700 kg mm^2, at: [100 mm, 100 mm]}\n"
    "joints:\n"
    "  heel:  {between: [ground, left], at: [0 mm, 0 mm]}\n"
    "  toe:   {between: [ground, right], at: [200 mm, 0 mm]}\n"
    "  knee:  {between: [left, bar], at: [0 mm, 100 mm]}\n"
    "  wrist: {between: [right, bar], at: [200 mm, 100 mm]}\n"
    "run: {duration: 1 s, samples: 501}\n";

static Scenario load_parallelogram(void)
{
    char path[512];
    scratch_path("parallelogram.yaml", path, sizeof path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(PARALLELOGRAM, stream);
    fclose(stream);
    const Scenario scenario = load(path, NULL, 0);
    unlink(path);
    return scenario;
}

// Its motion on the branch of parallel cranks, which is known in closed form: the cranks turn
// steadily from one angle to another.
static Trajectory *parallel_motion(const Scenario *scenario, double from_deg, double to_deg)
{
    Trajectory *motion = trajectory_create(scenario, "closed form");
    for (size_t k = 0; k < motion->sample_count; k++) {
        const double share = (double)k / (double)(motion->sample_count - 1);
        const double angle = (from_deg + share * (to_deg - from_deg)) * M_PI / 180.0;
        const Vec2 tip = {LENGTH * cos(angle), LENGTH * sin(angle)};
        Motion *bodies = motion->motions + k * motion->body_count;
        motion->times[k] = share;
        bodies[0] = (Motion){.position = {0.5 * tip.x, 0.5 * tip.y}, .angle = angle};
        bodies[1] = (Motion){.position = {BASE + 0.5 * tip.x, 0.5 * tip.y}, .angle = angle};
        bodies[2] = (Motion){.position = {0.5 * BASE + tip.x, tip.y}};
    }
    return motion;
}

static void it_is_found_where_all_joints_lie_on_one_line(void **state)
{
    (void)state;
    Scenario scenario = load_parallelogram();
    Trajectory *motion = parallel_motion(&scenario, 90.0, 230.0);
    const double time_s = 90.0 / 140.0; // at 180 degrees
    assert_true(change_point_is_near(motion, time_s));
    assert_true(change_point_is_near(motion, time_s + 0.009));
    // 3 degrees and more away from it, less the hundredth of the run that counts as near
    assert_false(change_point_is_near(motion, time_s - 0.035));
    assert_false(change_point_is_near(motion, time_s + 0.035));
    assert_false(change_point_is_near(motion, 0.0));
    trajectory_destroy(motion);
}

static void a_motion_that_stays_away_has_none(void **state)
{
    (void)state;
    Scenario scenario = load_parallelogram();
    Trajectory *motion = parallel_motion(&scenario, 20.0, 160.0);
    for (int i = 0; i <= 50; i++) {
        assert_false(change_point_is_near(motion, 0.02 * i));
    }
    trajectory_destroy(motion);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_found_where_all_joints_lie_on_one_line),
        cmocka_unit_test(a_motion_that_stays_away_has_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
