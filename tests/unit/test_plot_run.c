// Is the picture of a run well-formed, and is nothing lost in it?
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
    assert_non_null(strstr(svg.data, "No run to compare with"));
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

// Rounding by rounding: the speed is shown. A real rotation, however slow: the rotation.
static void a_body_that_does_not_turn_shows_its_speed(void **state)
{
    Fixture *fixture = *state;
    fixture->scenario.linkage.driver.is_present = false;
    static const struct {
        double omega;
        const char *shown;
        const char *not_shown;
    } CASES[] = {
        {5e-15, "Speed of the centre of mass", "Angular velocity"},
        {5e-6, "Angular velocity", "Speed of the centre of mass"},
    };
    for (size_t i = 0; i < 2; i++) {
        for (size_t run = 0; run < 2; run++) {
            Trajectory *trajectory = fixture->runs[run];
            for (size_t j = 0; j < trajectory->sample_count * trajectory->body_count; j++) {
                trajectory->motions[j].velocity = (Vec2){1.0, 0.0};
                trajectory->motions[j].omega = CASES[i].omega;
            }
        }
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        expect_well_formed(svg.data);
        assert_non_null(strstr(svg.data, CASES[i].shown));
        assert_null(strstr(svg.data, CASES[i].not_shown));
        text_finish(&svg);
    }
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
        joint->clearance = (Clearance){5.1e-3, 5e-3, 1e-2, {0.0, 0.0}};
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
        cmocka_unit_test(of_a_thousand_bodies_those_are_drawn_that_most_happens_to),
        cmocka_unit_test(of_twenty_bodies_all_are_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
