// Does a case file become the scenario it describes? Runs in the source root.
#include "casefile/casefile.h"

#include "kept.h"
#include "load_case.h"
#include "mechanism.h"
#include "model/kinematics.h"
#include "scratch.h"

#include <string.h>
#include <sys/stat.h>

static const char IMPACT[] = "cases/paper/stackup-impact.yaml";
static const char NOMINAL[] = "cases/paper/ideal-nominal.yaml";

static void the_paper_cases_are_the_mechanism_of_the_paper(void **state)
{
    (void)state;
    const Scenario built = load(NOMINAL, NULL, 0);
    const Scenario truth = mechanism_paper();
    assert_int_equal(built.linkage.body_count, truth.linkage.body_count);
    assert_int_equal(built.linkage.joint_count, truth.linkage.joint_count);
    for (size_t i = 0; i < truth.linkage.body_count; i++) {
        const Body *body = &built.linkage.bodies[i];
        const Body *other = &truth.linkage.bodies[i];
        assert_string_equal(body->name, other->name);
        assert_near(body->mass, other->mass, 1e-16);
        assert_near(body->inertia, other->inertia, 1e-18);
        assert_near(body->start.position.x, other->start.position.x, 1e-12);
        assert_near(body->start.position.y, other->start.position.y, 1e-12);
        assert_near(body->start.omega, other->start.omega, 1e-9);
        assert_near(body->start.alpha, other->start.alpha, 1e-6);
    }
    for (size_t i = 0; i < truth.linkage.joint_count; i++) {
        const Joint *joint = &built.linkage.joints[i];
        const Joint *other = &truth.linkage.joints[i];
        assert_string_equal(joint->name, other->name);
        assert_int_equal(joint->kind, JOINT_REVOLUTE);
        assert_int_equal(joint->body_a, other->body_a);
        assert_int_equal(joint->body_b, other->body_b);
    }
    assert_true(built.has_fourbar);
    assert_string_equal(built.path, NOMINAL);
}

static void every_paper_case_loads(void **state)
{
    (void)state;
    const Scenario stackup = load("cases/paper/ideal-stackup.yaml", NULL, 0);
    assert_near(stackup.fourbar.follower.nominal, 0.271, 0.0);
    const Scenario impact = load(IMPACT, NULL, 0);
    assert_int_equal(impact.linkage.joints[1].kind, JOINT_CLEARANCE);
    assert_near(linkage_radial_clearance(&impact.linkage.joints[1]), 14.5e-6, 1e-17);
    assert_near(impact.fourbar.crank.upper, 0.3e-3, 1e-18);
    const Scenario poisson = load("cases/paper/stackup-poisson.yaml", NULL, 0);
    assert_int_equal(poisson.contact.model, CONTACT_POISSON);
    assert_near(poisson.contact.penalty, 973330.0, 1e-9);
}

static Motion follower_at(const char *start, const char *assembly)
{
    char angle[64];
    char side[64];
    snprintf(angle, sizeof angle, "drive.start=%s", start);
    snprintf(side, sizeof side, "four-bar.assembly=%s", assembly);
    const char *const overrides[] = {angle, side};
    return load(NOMINAL, overrides, 2).linkage.bodies[2].start;
}

// Central differences over 2e-4 deg: their truncation error is 1e-12 of the value, their
// rounding error 1e-16 / 3.5e-6 rad, times the crank's 105 rad/s.
static void the_start_moves_as_its_neighbours_say(void **state)
{
    (void)state;
    const Motion here = follower_at("50 deg", "open");
    const Motion before = follower_at("49.9999 deg", "open");
    const Motion after = follower_at("50.0001 deg", "open");
    const double crank_speed = 1000.0 * M_PI / 30.0;
    const double time = 2e-4 * M_PI / 180.0 / crank_speed;
    assert_near((after.angle - before.angle) / time, here.omega, 1e-7);
    assert_near((after.omega - before.omega) / time, here.alpha, 1e-3);
    // the wrong neighbour shows
    assert_true(fabs((here.angle - before.angle) / time - here.omega) > 1.0);
}

static void the_crossed_assembly_is_on_the_other_side(void **state)
{
    (void)state;
    assert_near(follower_at("0 deg", "open").angle, -follower_at("0 deg", "crossed").angle, 1e-12);
    assert_true(follower_at("0 deg", "open").angle > 0.0);
}

static void check_eccentricity(const Scenario *scenario, const char *name, double x, double y)
{
    const Joint *joint = &scenario->linkage.joints[linkage_find_joint(&scenario->linkage, name)];
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario->linkage, motions);
    const Vec2 e = vec2_sub(linkage_point(motions, joint->body_b, joint->anchor_b),
                            linkage_point(motions, joint->body_a, joint->anchor_a));
    // positions of some 0.3 m are rounded at 6e-17 m each
    assert_near(e.x, x, 1e-15);
    assert_near(e.y, y, 1e-15);
}

static void a_pin_starts_where_the_case_says(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {
        "joints.crank-coupler.start=[10 um, -8 um]",
        "joints.coupler-follower={radial-clearance: 20 um, pin: 10 mm, start: [-10 um, 10 um]}",
        "joints.follower-ground={radial-clearance: 20 um, pin: 10 mm, start: [3 um, 15 um]}",
    };
    const Scenario scenario = load(IMPACT, OVERRIDES, 3);
    check_eccentricity(&scenario, "ground-crank", 0.0, 0.0);
    check_eccentricity(&scenario, "crank-coupler", 10e-6, -8e-6);
    check_eccentricity(&scenario, "coupler-follower", -10e-6, 10e-6);
    check_eccentricity(&scenario, "follower-ground", 3e-6, 15e-6);
    const Scenario centred = load_with(IMPACT, "joints.crank-coupler.start=centred");
    check_eccentricity(&centred, "crank-coupler", 0.0, 0.0);
}

static void traced_points_are_placed_on_their_links(void **state)
{
    (void)state;
    const Scenario scenario =
        load_with(NOMINAL, "points={tip: {body: coupler, along: 300 mm, offset: 20 mm}, "
                           "pin: {body: crank, along: 108 mm}}");
    assert_int_equal(scenario.point_count, 2);
    assert_string_equal(scenario.points[0].name, "tip");
    assert_int_equal(scenario.points[0].body, 1);
    assert_near(scenario.points[0].local.x, 0.3 - 0.1397, 1e-16);
    assert_near(scenario.points[0].local.y, 0.02, 0.0);
    assert_near(scenario.points[1].local.x, 0.054, 1e-16);
    const char *const parts[] = {"points.tip.body=follower", "points.tip.along=0 mm"};
    const Scenario again = load(NOMINAL, parts, 2);
    assert_int_equal(again.point_count, 1);
    assert_near(again.points[0].local.x, -0.13525, 1e-16);
}

static void assert_same_setting(const CasefileSetting *one, const CasefileSetting *other)
{
    assert_string_equal(one->key, other->key);
    assert_string_equal(one->unit, other->unit);
    assert_string_equal(one->text, other->text);
    assert_int_equal(one->kind, other->kind);
    assert_int_equal(one->applies, other->applies);
    assert_int_equal(one->number_count, other->number_count);
    for (size_t i = 0; i < one->number_count; i++) {
        assert_true(one->numbers[i] == other->numbers[i]);
    }
}

static void settings_tell_what_the_case_said(void **state)
{
    (void)state;
    const char *const overrides[] = {"points.tip={body: coupler, along: 300 mm}",
                                     "joints.crank-coupler.start=[5 um, -3 um]"};
    const Scenario scenario = load(IMPACT, overrides, 2);
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(&scenario);
    size_t count = 0;
    while (casefile_next(&walk, &setting)) {
        // by its key it is the same
        CasefileSetting found;
        assert_true(casefile_find(&scenario, setting.key, &found));
        assert_same_setting(&found, &setting);
        count++;
    }
    assert_int_equal(count, casefile_setting_count(&scenario));
    assert_false(casefile_find(&scenario, "joints.no-such.hole", &setting));
    assert_false(casefile_find(&scenario, "joints.*.no-such", &setting));
    assert_false(casefile_next(&walk, &setting));

    assert_true(casefile_find(&scenario, "four-bar.crank.length", &setting));
    assert_int_equal(setting.number_count, 3);
    assert_near(setting.numbers[1], -0.3e-3, 1e-18);
    assert_string_equal(setting.unit, "m");
    assert_true(casefile_find(&scenario, "joints.crank-coupler.hole", &setting));
    assert_near(setting.numbers[0], 0.010015, 1e-17);
    assert_true(setting.applies);
    assert_true(casefile_find(&scenario, "joints.crank-coupler.start", &setting));
    assert_int_equal(setting.number_count, 2);
    assert_near(setting.numbers[1], -3e-6, 1e-20);
    assert_true(casefile_find(&scenario, "joints.follower-ground.hole", &setting));
    assert_false(setting.applies);
    assert_true(casefile_find(&scenario, "contact.law", &setting));
    assert_int_equal(setting.kind, CASEFILE_WORD);
    assert_string_equal(setting.text, "hertz-socket");
    assert_true(casefile_find(&scenario, "ode.cfm", &setting));
    assert_string_equal(setting.unit, "s/kg");
    assert_true(casefile_find(&scenario, "run.backends", &setting));
    assert_int_equal(setting.kind, CASEFILE_WORDS);
    assert_string_equal(setting.text, "analytic, reference, ode");
    assert_true(casefile_find(&scenario, "run.samples", &setting));
    assert_int_equal(setting.kind, CASEFILE_INTEGER);
    assert_near(setting.numbers[0], 3600.0, 0.0);
    assert_true(casefile_find(&scenario, "points.tip.along", &setting));
    assert_near(setting.numbers[0], 0.3, 1e-16);
}

static void settings_say_whether_they_matter(void **state)
{
    (void)state;
    static const struct {
        const char *override;
        const char *key;
        bool applies;
    } CASES[] = {
        {"contact.stiffness=2e7 N/m", "contact.stiffness", true},
        {"contact.stiffness=2e7 N/m", "contact.law", false},
        {"contact.stiffness=2e7 N/m", "material.youngs-modulus", false},
        {"contact.model=poisson", "contact.penalty", true},
        {"contact.model=poisson", "material.youngs-modulus", true},
        {"contact.model=poisson", "contact.damping", false},
        {"contact.model=poisson", "ode.push-out", true},
        {"run.backends=analytic", "ode.solver", false},
        {"ode.solver=quick", "ode.iterations", true},
        {"ode.solver=direct", "ode.iterations", false},
        {"title=x", "ode.settle-steps", false},
        {"title=x", "ode.collider", true},
        {"title=x", "ode.facets", false},
        {"ode.collider=staves", "ode.facets", true},
        {"ode.collider=trimesh", "ode.polygon", true},
        {"title=x", "contact.viscous-coefficient", false},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        const Scenario scenario = load_with(IMPACT, CASES[i].override);
        CasefileSetting setting;
        assert_true(casefile_find(&scenario, CASES[i].key, &setting));
        if (setting.applies != CASES[i].applies) {
            fail_msg("%s with %s", CASES[i].key, CASES[i].override);
        }
    }
    const Scenario stiff = load_with(IMPACT, "contact.stiffness=2e7 N/m^1.25");
    CasefileSetting setting;
    assert_true(casefile_find(&stiff, "contact.stiffness", &setting));
    assert_string_equal(setting.unit, "N/m^1.25");
}

static void defaults_are_those_of_the_options(void **state)
{
    (void)state;
    static const char TEXT[] = "four-bar:\n"
                               "  ground: {length: 254 mm}\n"
                               "  crank: {length: 108 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
                               "  coupler: {length: 279.4 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
                               "  follower: {length: 270.5 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
                               "drive: {speed: 1000 rpm}\n";
    Scenario scenario;
    Err err = {0};
    assert_true(casefile_load_text("memory", TEXT, strlen(TEXT), NULL, 0, &scenario, &err));
    const Scenario defaults = kept_default();
    // choices one by one, for there is padding between them and the numbers
    assert_int_equal(scenario.ode.solver, defaults.ode.solver);
    assert_int_equal(scenario.ode.stepping, defaults.ode.stepping);
    assert_int_equal(scenario.ode.map, defaults.ode.map);
    assert_int_equal(scenario.ode.collider, defaults.ode.collider);
    assert_int_equal(scenario.ode.polygon, defaults.ode.polygon);
    assert_memory_equal(&scenario.ode.facets, &defaults.ode.facets,
                        sizeof defaults.ode - offsetof(OdeOptions, facets));
    assert_near(scenario.contact.restitution, defaults.contact.restitution, 0.0);
    assert_near(scenario.run.step, defaults.run.step, 0.0);
    assert_near(scenario.gravity.y, -9.80665, 0.0);
    assert_string_equal(scenario.title, "");
    scenario_free(&scenario);
}

// A collider that answers for a contact row needs one: map impulse has none.
static void a_collider_brings_the_map_and_the_step_it_needs(void **state)
{
    (void)state;
    static const char TEXT[] =
        "four-bar:\n"
        "  ground: {length: 254 mm}\n"
        "  crank: {length: 108 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
        "  coupler: {length: 279.4 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
        "  follower: {length: 270.5 mm, mass: 1 kg, inertia: 1 kg m^2}\n"
        "joints: {crank-coupler: {radial-clearance: 20 um, pin: 10 mm, width: 9 mm}}\n"
        "drive: {speed: 1000 rpm}\n";
    static const char *const COLLIDERS[] = {"ode.collider=pin-hole", "ode.collider=staves"};
    for (int i = 0; i < 2; i++) {
        Scenario scenario;
        Err err = {0};
        assert_true(
            casefile_load_text("memory", TEXT, strlen(TEXT), &COLLIDERS[i], 1, &scenario, &err));
        assert_int_equal(scenario.ode.stepping, ODE_STAGGERED);
        assert_int_equal(scenario.ode.map, i == 0 ? ODE_MAP_IMPULSE : ODE_MAP_MIDPOINT);
        assert_near(scenario.run.step, i == 0 ? 0.0 : OPTIONS_GIVEN_STEP, 0.0);
        scenario_free(&scenario);
    }
    static const char *const PLAIN[] = {"ode.collider=staves", "ode.stepping=plain"};
    Scenario scenario;
    Err err = {0};
    assert_true(casefile_load_text("memory", TEXT, strlen(TEXT), PLAIN, 2, &scenario, &err));
    assert_int_equal(scenario.ode.map, ODE_MAP_TEXTBOOK);
    scenario_free(&scenario);
}

static void marks_tabs_and_returns_are_no_mistakes(void **state)
{
    (void)state;
    static const char TEXT[] = "\xef\xbb\xbf"
                               "four-bar:\r\n"
                               "  ground: {length:\t254 mm}\r\n"
                               "  crank: {length: 108 mm, mass: 1 kg, inertia: 1 kg m^2}\t# tab\r\n"
                               "  coupler: {length: 279.4 mm, mass: 1 kg, inertia: 1 kg m^2}\r\n"
                               "  follower: {length: 270.5 mm, mass: 1 kg, inertia: 1 kg m^2}\r\n"
                               "drive: {speed: 1000 rpm}\r\n";
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("memory", TEXT, strlen(TEXT), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    scenario_free(&scenario);
}

static void what_is_no_readable_file_says_so(void **state)
{
    (void)state;
    refuse("no/such/case.yaml", NULL, ERR_FILE,
           "no/such/case.yaml: cannot be read: No such file or directory");
    refuse("tests/bad", NULL, ERR_CASE, "tests/bad: is a directory\nallowed: a case file");
    refuse("/dev/zero", NULL, ERR_FILE, "/dev/zero: cannot be read: it is no regular file");
    refuse("/dev/null", NULL, ERR_FILE, "/dev/null: cannot be read: it is no regular file");
}

// The file has no blocks on the disk: its size alone is enough to refuse it.
static void a_huge_file_is_refused_unread(void **state)
{
    (void)state;
    char path[256];
    scratch_path("huge.yaml", path, sizeof path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(truncate(path, 100 << 20), 0);
    Scenario scenario;
    Err err = {0};
    assert_false(casefile_load(path, NULL, 0, &scenario, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_non_null(strstr(err.text, "104857600 bytes are too large"));
    // nobody may read it, unless the test runs as root
    assert_int_equal(truncate(path, 10), 0);
    assert_int_equal(chmod(path, 0), 0);
    Err unreadable = {0};
    assert_false(casefile_load(path, NULL, 0, &scenario, &unreadable));
    assert_int_equal(unreadable.kind, geteuid() == 0 ? ERR_CASE : ERR_FILE);
    unlink(path);
}

static void gravity_is_one_number_downward_or_a_vector(void **state)
{
    (void)state;
    static const char SPACE[] = "cases/space/overhung-pin.yaml";
    const struct {
        const char *path;
        const char *override;
        Vec3 gravity;
        size_t count; // numbers of the setting: one again where it is along -y
        double numbers[3];
    } rows[] = {
        {NOMINAL, "gravity=9.81 m/s^2", {0.0, -9.81, 0.0}, 1, {9.81}},
        {NOMINAL, "gravity=0", {0.0, 0.0, 0.0}, 1, {0.0}},
        {NOMINAL, "gravity=-5 m/s^2", {0.0, 5.0, 0.0}, 1, {-5.0}},
        {NOMINAL, "gravity=[0, -9.81 m/s^2]", {0.0, -9.81, 0.0}, 1, {9.81}},
        {NOMINAL, "gravity=[1 m/s^2, -9800 mm/s^2]", {1.0, -9.8, 0.0}, 2, {1.0, -9.8}},
        {SPACE, "gravity=1.6 m/s^2", {0.0, -1.6, 0.0}, 1, {1.6}},
        {SPACE, "gravity=[1 m/s^2, 2 m/s^2]", {1.0, 2.0, 0.0}, 3, {1.0, 2.0, 0.0}},
        {SPACE, "gravity=[0, 0, -3 m/s^2]", {0.0, 0.0, -3.0}, 3, {0.0, 0.0, -3.0}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const Scenario scenario = load_with(rows[i].path, rows[i].override);
        assert_near(scenario.gravity.x, rows[i].gravity.x, 0.0);
        assert_near(scenario.gravity.y, rows[i].gravity.y, 1e-15); // of mm
        assert_near(scenario.gravity.z, rows[i].gravity.z, 0.0);
        CasefileSetting setting;
        assert_true(casefile_find(&scenario, "gravity", &setting));
        assert_int_equal(setting.number_count, rows[i].count);
        assert_string_equal(setting.unit, "m/s^2");
        for (size_t k = 0; k < setting.number_count; k++) {
            assert_near(setting.numbers[k], rows[i].numbers[k], 1e-15);
            assert_true(setting.numbers[k] != 0.0 || !signbit(setting.numbers[k]));
        }
    }
    // of two the later holds, whichever way each is written
    const char *const both[] = {"gravity=[1 m/s^2, 2 m/s^2]", "gravity=3 m/s^2"};
    assert_near(load(NOMINAL, both, 2).gravity.x, 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_paper_cases_are_the_mechanism_of_the_paper),
        cmocka_unit_test(every_paper_case_loads),
        cmocka_unit_test(the_start_moves_as_its_neighbours_say),
        cmocka_unit_test(the_crossed_assembly_is_on_the_other_side),
        cmocka_unit_test(a_pin_starts_where_the_case_says),
        cmocka_unit_test(traced_points_are_placed_on_their_links),
        cmocka_unit_test(settings_tell_what_the_case_said),
        cmocka_unit_test(settings_say_whether_they_matter),
        cmocka_unit_test(defaults_are_those_of_the_options),
        cmocka_unit_test(gravity_is_one_number_downward_or_a_vector),
        cmocka_unit_test(a_collider_brings_the_map_and_the_step_it_needs),
        cmocka_unit_test(marks_tabs_and_returns_are_no_mistakes),
        cmocka_unit_test(what_is_no_readable_file_says_so),
        cmocka_unit_test(a_huge_file_is_refused_unread),
    };
    return cmocka_run_group_tests_name("casefile", tests, NULL, NULL);
}
