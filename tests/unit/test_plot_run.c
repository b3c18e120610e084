// Is the picture of a run well-formed, and is nothing lost in it?
#include "commands/run/plot_lines.h"
#include "commands/run/run_report.h"

#include "report_fixture.h"

#include <stdio.h>
#include <string.h>

// Every element that begins also ends, and no text holds a bare angle bracket or ampersand.
static void expect_well_formed(const char *svg)
{
    char open[32][32];
    int depth = 0;
    for (const char *c = svg; *c != '\0'; c++) {
        if (*c == '&') {
            assert_true(strncmp(c, "&amp;", 5) == 0 || strncmp(c, "&lt;", 4) == 0 ||
                        strncmp(c, "&gt;", 4) == 0);
        }
        assert_true(*c != '>');
        if (*c != '<') {
            continue;
        }
        const char *end = strchr(c, '>');
        assert_non_null(end);
        char name[32] = "";
        sscanf(c + 1, "%31[a-zA-Z/]", name);
        if (name[0] == '/') {
            assert_true(depth > 0);
            assert_string_equal(open[--depth], name + 1);
        } else if (end[-1] != '/') {
            assert_true(depth < 32);
            strcpy(open[depth++], name);
        }
        c = end;
    }
    assert_int_equal(depth, 0);
}

static void a_picture_is_well_formed_and_shows_every_contact(void **state)
{
    Fixture *fixture = *state;
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    expect_well_formed(svg.data);
    assert_null(strstr(svg.data, "nan"));
    assert_null(strstr(svg.data, "inf"));
    assert_non_null(strstr(svg.data, "A test &amp; &lt;nothing&gt; else"));
    assert_non_null(strstr(svg.data, "broken (failed)"));
    assert_non_null(strstr(svg.data, "<ellipse"));
    size_t dots = 0;
    for (const char *c = svg.data; (c = strstr(c, "<circle")) != NULL; c++) {
        dots++;
    }
    assert_int_equal(dots, 7);
    text_finish(&svg);
}

static void forces_are_those_of_joints_with_play_that_are_known(void **state)
{
    Fixture *fixture = *state;
    Trajectory *run = fixture->runs[1];
    // the ideal joint behind the one with play has a force, too
    for (size_t i = 0; i < run->sample_count; i++) {
        run->states[i * run->joint_count + 2].force = 100.0;
    }
    ranges_finish(&run->ranges); // so that it is the samples that are drawn
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    assert_non_null(strstr(svg.data, "<title>ode: force crank-coupler</title>"));
    assert_null(strstr(svg.data, "force coupler-follower"));
    assert_null(strstr(svg.data, "broken: force"));
    text_finish(&svg);
}

static void a_picture_without_play_shows_the_difference(void **state)
{
    Fixture *fixture = *state;
    fixture->scenario.linkage.joints[1].kind = JOINT_REVOLUTE;
    fixture->runs[1]->joints[1].spike_count = 0;
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    expect_well_formed(svg.data);
    assert_null(strstr(svg.data, "nan"));
    assert_non_null(strstr(svg.data, "Difference from analytic"));
    text_finish(&svg);
}

static void a_picture_of_nothing_but_failures_is_still_one(void **state)
{
    Fixture *fixture = *state;
    fixture->runs[0]->is_complete = false;
    fixture->runs[1]->is_complete = false;
    fixture->errors[1].is_known = false;
    fixture->scenario.linkage.joints[1].kind = JOINT_REVOLUTE;
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    expect_well_formed(svg.data);
    assert_null(strstr(svg.data, "nan"));
    assert_null(strstr(svg.data, "inf"));
    // there is no difference, and no panel for one
    assert_null(strstr(svg.data, "Difference"));
    text_finish(&svg);
}

static void a_spiky_quantity_gets_decades_on_both_sides(void **state)
{
    Fixture *fixture = *state;
    Motion *motion = fixture->runs[1]->motions + 4;
    motion->alpha = -5e5;
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    expect_well_formed(svg.data);
    assert_non_null(strstr(svg.data, ">-10<tspan"));
    text_finish(&svg);
}

// Rounding by rounding: the speed is shown. A real rotation, however slow: the rotation. That of
// the body that a drive turns is no matter.
static void a_body_that_does_not_turn_shows_its_speed(void **state)
{
    Fixture *fixture = *state;
    static const struct {
        double omega;
        const char *shown;
        const char *not_shown;
    } CASES[] = {
        {5e-15, "Speed of the centre of mass", "Angular velocity"},
        {5e-6, "Angular velocity", "Speed of the centre of mass"},
    };
    for (size_t i = 0; i < 4; i++) {
        const bool is_driven = i >= 2;
        fixture->scenario.linkage.driver.is_present = is_driven;
        for (size_t run = 0; run < 2; run++) {
            Trajectory *trajectory = fixture->runs[run];
            for (size_t j = 0; j < trajectory->sample_count * trajectory->body_count; j++) {
                const bool is_crank = is_driven && j % trajectory->body_count == 0;
                trajectory->motions[j].velocity = (Vec2){1.0 + 0.1 * (double)run, 0.0};
                trajectory->motions[j].omega = is_crank ? 100.0 : CASES[i % 2].omega;
            }
        }
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        expect_well_formed(svg.data);
        assert_non_null(strstr(svg.data, CASES[i % 2].shown));
        assert_null(strstr(svg.data, CASES[i % 2].not_shown));
        assert_true((strstr(svg.data, "difference of velocity") != NULL) == (i % 2 == 0));
        text_finish(&svg);
    }
}

// The frames of the panels, in their order.
typedef struct Frame {
    double left, top, width, height;
} Frame;

enum { FRAMES_MAX = 24 };

static size_t find_frames(const char *svg, Frame frames[FRAMES_MAX])
{
    size_t count = 0;
    for (const char *c = svg; (c = strstr(c, "<rect class=\"frame\"")) != NULL; c++) {
        Frame *frame = &frames[count++];
        assert_int_equal(sscanf(c,
                                "<rect class=\"frame\" x=\"%lf\" y=\"%lf\" width=\"%lf\" "
                                "height=\"%lf\"",
                                &frame->left, &frame->top, &frame->width, &frame->height),
                         4);
    }
    return count;
}

// How far apart the dots of the strongest contacts are, whose forces fall by 100 N each, in pixels.
static void measure_dots(const Fixture *fixture, double steps[6])
{
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    double last = 0.0;
    size_t count = 0;
    for (const char *c = svg.data; (c = strstr(c, "<circle")) != NULL; c++) {
        double x;
        double y;
        assert_int_equal(sscanf(c, "<circle cx=\"%lf\" cy=\"%lf\"", &x, &y), 2);
        if (count++ > 0) {
            steps[count - 2] = y - last;
        }
        last = y;
    }
    assert_int_equal(count, 7);
    text_finish(&svg);
}

static void forces_are_linear_unless_decades_are_asked_for(void **state)
{
    Fixture *fixture = *state;
    double steps[6];
    // also where the largest is far above all else
    fixture->runs[1]->joints[1].spikes[0].force_max = 1234.5;
    measure_dots(fixture, steps);
    for (int i = 1; i < 6; i++) {
        assert_near(steps[i], steps[0], 0.03);
    }
    assert_true(steps[0] > 5.0);
    // the control: of decades each is longer than the one before
    fixture->report.has_log_forces = true;
    measure_dots(fixture, steps);
    for (int i = 1; i < 6; i++) {
        assert_true(steps[i] > steps[i - 1] + 0.03);
    }
}

static void marks_of_spikes_stand_in_the_frame(void **state)
{
    Fixture *fixture = *state;
    Frame frames[FRAMES_MAX];
    // far below the samples, which are all that the axis would have else
    add_spikes(fixture);
    fixture->runs[1]->alpha_spikes[1].spikes[0].value = -1.3e4;
    for (size_t i = 0; i < fixture->runs[1]->sample_count * 3; i++) {
        fixture->runs[1]->motions[i].alpha = -1e4;
        fixture->runs[0]->motions[i].alpha = -1e4;
    }
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    assert_true(find_frames(svg.data, frames) > 2);
    const char *title = strstr(svg.data, "<title>alpha coupler: -13000 rad/s^2");
    assert_non_null(title);
    const char *mark = title;
    while (strncmp(mark, "<path", 5) != 0) {
        mark--;
    }
    double x;
    double y;
    assert_int_equal(sscanf(mark, "<path class=\"mark\" d=\"M%lf %lf", &x, &y), 2);
    // the mark hangs below its tip by its height
    assert_true(y > frames[1].top && y + 7.0 < frames[1].top + frames[1].height);
    assert_true(x > frames[1].left && x < frames[1].left + frames[1].width);
    text_finish(&svg);
}

static void ideal_joints_are_a_thin_dark_line_on_top(void **state)
{
    Fixture *fixture = *state;
    for (size_t i = 0; i < fixture->runs[0]->sample_count; i++) {
        fixture->runs[0]->states[i * 4 + 1].force = 50.0;
    }
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    const char *ideal = strstr(svg.data, "<title>analytic: force crank-coupler</title>");
    const char *other = strstr(svg.data, "<title>ode: force crank-coupler</title>");
    assert_true(ideal != NULL && other != NULL && ideal > other);
    // of the joint's colour, but dark
    assert_non_null(strstr(other, "title"));
    assert_memory_equal(ideal -
                            strlen("stroke=\"#004734\" stroke-width=\"0.9\" stroke-opacity=\"1\">"),
                        "stroke=\"#004734\" stroke-width=\"0.9\"", 34);
    text_finish(&svg);
    // the control: without play it is what the others are held against, wide and below them
    fixture->scenario.linkage.joints[1].kind = JOINT_REVOLUTE;
    fixture->runs[1]->joints[1].spike_count = 0;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    ideal = strstr(svg.data, "<title>analytic: force crank-coupler</title>");
    other = strstr(svg.data, "<title>ode: force crank-coupler</title>");
    assert_true(ideal != NULL && other != NULL && ideal < other);
    text_finish(&svg);
}

// Where the middle of the circles is in the panel of loads, as a share of its width.
static double find_middle(const Fixture *fixture)
{
    Text svg;
    text_init(&svg);
    plot_run_write(&fixture->report, &svg);
    const char *panel = strstr(svg.data, "Force on the pin, seen from its hole");
    assert_non_null(panel);
    assert_non_null(strstr(panel, ">90\302\260<"));
    assert_non_null(strstr(panel, " N</text>"));
    const char *spoke = strstr(panel, "<path class=\"line\" d=\"M");
    double x;
    double y;
    assert_int_equal(sscanf(spoke, "<path class=\"line\" d=\"M%lf %lf", &x, &y), 2);
    Frame frame;
    Frame frames[FRAMES_MAX];
    find_frames(panel, frames);
    frame = frames[0];
    text_finish(&svg);
    return (x - frame.left) / frame.width;
}

static void no_quarter_of_the_loads_is_empty(void **state)
{
    Fixture *fixture = *state;
    for (size_t i = 0; i < 2 * fixture->runs[1]->sample_count; i++) {
        Trajectory *run = fixture->runs[i % 2];
        run->motions[i / 2 * 3].angle = 0.0;
        run->states[i / 2 * 4 + 1].force_on_b = (Vec2){100.0 * (double)(i / 2), 10.0};
    }
    // to one side alone
    assert_true(find_middle(fixture) < 0.15);
    // the control: to both
    for (size_t i = 0; i < fixture->runs[1]->sample_count; i++) {
        fixture->runs[1]->states[i * 4 + 1].force_on_b.x = 400.0 * (i % 2 == 0 ? 1.0 : -1.0);
    }
    assert_near(find_middle(fixture), 0.5, 0.01);
}

static void no_quarter_of_the_picture_is_empty(void **state)
{
    Fixture *fixture = *state;
    for (int is_odd = 0; is_odd < 2; is_odd++) {
        // with or without the panel of the difference
        fixture->errors[1].is_known = is_odd == 0;
        fixture->errors[0].is_known = false;
        Text svg;
        Frame frames[FRAMES_MAX];
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        const size_t count = find_frames(svg.data, frames);
        for (size_t i = 0; i < count; i++) {
            const bool is_alone = count % 2 == 1 && i + 1 == count;
            assert_near(frames[i].width, is_alone ? 890.0 : 390.0, 0.0);
        }
        // nothing but the picture's margin below the last
        double height;
        assert_int_equal(sscanf(strstr(svg.data, " height=\""), " height=\"%lf\"", &height), 1);
        assert_true(height - frames[count - 1].top - frames[count - 1].height < 70.0);
        text_finish(&svg);
    }
}

enum { CORNERS = 8 };

static double turned_at(size_t sample)
{
    return 2.0 * acos(-1.0) * (double)sample / CORNERS;
}

static Vec2 circle_at(const RunReport *report, const Trajectory *run, size_t sample,
                      const PlotPath *path)
{
    (void)report;
    (void)run;
    (void)path;
    return (Vec2){cos(turned_at(sample)), sin(turned_at(sample))};
}

static Vec2 circle_rate(const RunReport *report, const Trajectory *run, size_t sample,
                        const PlotPath *path)
{
    (void)report;
    (void)path;
    const double rate = turned_at(1) / (run->times[1] - run->times[0]);
    return (Vec2){-rate * sin(turned_at(sample)), rate * cos(turned_at(sample))};
}

// How far a path through a few points of a circle leaves it, of its radius.
static double leave_circle(const Fixture *fixture, bool has_rate)
{
    PlotView view = plot_view_begin(&fixture->report);
    Text svg;
    text_init(&svg);
    const PlotPanel panel = {.svg = &svg,
                             .title = "",
                             .width = 200.0,
                             .height = 200.0,
                             .x = {.low = -1.0, .high = 1.0},
                             .y = {.low = -1.0, .high = 1.0}};
    plot_look_path(&view, &panel, 1,
                   &(PlotPath){.joint = 1, .at = circle_at, .rate = has_rate ? circle_rate : NULL});
    double most = 0.0;
    for (const char *c = svg.data; (c = strpbrk(c, "ML")) != NULL; c++) {
        double x;
        double y;
        if (sscanf(c + 1, "%lf %lf", &x, &y) == 2) {
            most = fmax(most, fabs(hypot(x - 100.0, y - 100.0) / 100.0 - 1.0));
        }
    }
    text_finish(&svg);
    plot_view_finish(&view);
    return most;
}

static void an_orbit_is_as_smooth_as_its_velocities(void **state)
{
    const Fixture *fixture = *state;
    // the cubic through points an eighth of a turn apart leaves the circle by (pi / 4)^4 / 384
    assert_true(leave_circle(fixture, true) < 0.002);
    // the control: one that only stays between its points leaves it by much more
    assert_true(leave_circle(fixture, false) > 0.02);
}

// Pendulums with play side by side; what happens to one goes up and down with its number.
static RunReport make_many(size_t count, Scenario *scenario, Trajectory **runs,
                           TrajectoryError *errors)
{
    *scenario = scenario_default();
    scenario->linkage = linkage_create((LinkageRoom){.bodies = count, .joints = count});
    scenario->run.duration = 0.1;
    scenario->run.samples = 50;
    Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < count; i++) {
        Body *body = &linkage->bodies[linkage->body_count++];
        Joint *joint = &linkage->joints[linkage->joint_count++];
        *body = (Body){.mass = 1.0, .inertia = 1.0};
        snprintf(body->name, sizeof body->name, "bar-%zu", i);
        *joint = (Joint){.kind = JOINT_CLEARANCE, .body_a = LINKAGE_GROUND, .body_b = (int)i};
        joint->clearance = (Clearance){5.1e-3, 5e-3, 1e-2, {0.0, 0.0}, false};
        snprintf(joint->name, sizeof joint->name, "pin-%zu", i);
    }
    for (size_t run = 0; run < 2; run++) {
        runs[run] = trajectory_create(scenario, run == 0 ? "reference" : "ode");
        runs[run]->is_complete = true;
        runs[run]->duration_s = scenario_duration(scenario);
        for (size_t i = 0; i < count; i++) {
            const double size = 1.5 + sin(0.7 * (double)i);
            runs[run]->bodies[i].alpha_max.value = size;
            runs[run]->joints[i].force_max.value = 1e3 * size;
            for (size_t k = 0; k < runs[run]->sample_count; k++) {
                runs[run]->motions[k * count + i].omega = sin(0.1 * (double)(i + k));
                runs[run]->motions[k * count + i].alpha = size;
                runs[run]->states[k * count + i].force = 1e3 * size;
            }
        }
    }
    return (RunReport){.scenario = scenario, .run_count = 2, .runs = runs, .errors = errors};
}

static size_t count_words(const char *text, const char *words)
{
    size_t count = 0;
    for (const char *c = text; (c = strstr(c, words)) != NULL; c++) {
        count++;
    }
    return count;
}

static void draw_many(size_t count, Text *svg)
{
    Scenario scenario;
    Trajectory *runs[2];
    const TrajectoryError errors[2] = {{.is_known = false}, {.is_known = false}};
    const RunReport report = make_many(count, &scenario, runs, (TrajectoryError *)errors);
    text_init(svg);
    plot_run_write(&report, svg);
    trajectory_destroy(runs[0]);
    trajectory_destroy(runs[1]);
    linkage_free(&scenario.linkage);
}

static void of_a_thousand_bodies_those_are_drawn_that_most_happens_to(void **state)
{
    (void)state;
    Text svg;
    draw_many(1000, &svg);
    expect_well_formed(svg.data);
    assert_null(strstr(svg.data, "nan"));
    assert_true(svg.length < 2000000);
    assert_non_null(strstr(svg.data, "12 of 1000 bodies are drawn, those of the largest "
                                     "accelerations; grey: the range of the others"));
    assert_non_null(strstr(svg.data, "12 of 1000 joints are drawn"));
    assert_non_null(strstr(svg.data, "All bodies: the largest of the whole run"));
    assert_int_equal(count_words(svg.data, "<title>ode: alpha bar-"), 12);
    assert_int_equal(count_words(svg.data, "<title>ode: alpha of all others"), 1);
    // sin(0.7 i) is largest at i = 92, where 0.7 i is 2.6e-3 from ten turns and a quarter
    assert_non_null(strstr(svg.data, "<title>ode: alpha bar-92</title>"));
    assert_null(strstr(svg.data, "<title>ode: alpha bar-0</title>"));
    text_finish(&svg);
}

// The control: as many as can be told apart are drawn, all of them and nothing more.
static void of_twenty_bodies_all_are_drawn(void **state)
{
    (void)state;
    Text svg;
    draw_many(20, &svg);
    assert_int_equal(count_words(svg.data, "<title>ode: alpha bar-"), 20);
    assert_null(strstr(svg.data, "are drawn"));
    assert_null(strstr(svg.data, "of all others"));
    assert_null(strstr(svg.data, "All bodies"));
    text_finish(&svg);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_picture_is_well_formed_and_shows_every_contact,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(forces_are_those_of_joints_with_play_that_are_known,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_picture_without_play_shows_the_difference, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_picture_of_nothing_but_failures_is_still_one,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_body_that_does_not_turn_shows_its_speed, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_spiky_quantity_gets_decades_on_both_sides, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(forces_are_linear_unless_decades_are_asked_for,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(marks_of_spikes_stand_in_the_frame, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(ideal_joints_are_a_thin_dark_line_on_top, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(no_quarter_of_the_loads_is_empty, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(no_quarter_of_the_picture_is_empty, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(an_orbit_is_as_smooth_as_its_velocities, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test(of_a_thousand_bodies_those_are_drawn_that_most_happens_to),
        cmocka_unit_test(of_twenty_bodies_all_are_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
