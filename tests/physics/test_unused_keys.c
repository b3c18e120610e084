// Does every key of a case either change the run or say that it does not?
//
// Each key of each kind of case below is given other values, one at a time. A value must be
// refused, or be named by casefile_unused, or change what the runs make: else it was passed over in
// silence.
#include "close.h"
#include "kept.h"

#include "casefile/casefile.h"
#include "casefile/schema.h"
#include "measure/chosen_run.h"
#include "run/registry.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FOUR_BAR_LINKS                                                                             \
    "four-bar:\n"                                                                                  \
    "  ground:   {length: 254 mm}\n"                                                               \
    "  crank:    {length: 108 mm, mass: 0.12 kg, inertia: 173.92 kg mm^2}\n"                       \
    "  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}\n"                    \
    "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}\n"                    \
    "drive: {speed: 1000 rpm}\n"
#define FOUR_BAR                                                                                   \
    FOUR_BAR_LINKS                                                                                 \
    "joints: {crank-coupler: {hole: 10.2 mm, pin: 10 mm, width: 13 mm, start: [99 um, 0 mm]}}\n"
#define PIN                                                                                        \
    "bodies: {pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm], spin: 9 rad/s,\n"          \
    "               velocity: [0.5 m/s, 0.1 m/s]}}\n"                                              \
    "joints: {hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.2 mm, pin: 10 mm,\n"       \
    "                width: 10 mm, start: [98 um, 0 mm]}}\n"

static const struct {
    const char *name;
    const char *text;
} KINDS[] = {
    {"four-bar with play", FOUR_BAR "run: {revolutions: 0.02, samples: 3600, step: 5 us}\n"},
    {"slider-crank, ideal", "slider-crank:\n"
                            "  crank:  {length: 50 mm,  mass: 0.30 kg, inertia: 100 kg mm^2}\n"
                            "  rod:    {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
                            "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
                            "drive: {speed: 5000 rpm}\n"
                            "run: {revolutions: 0.1, samples: 360, step: 50 us}\n"
                            "ode: {stepping: extrapolated}\n"},
    {"bodies with a guide",
     "bodies: {block: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [0 mm, 0 mm], velocity: [1 m/s, 0.5 "
     "m/s]}}\n"
     "joints: {rail: {between: [ground, block], at: [0 mm, 0 mm], along: 0 deg, guide: 40.2 mm,\n"
     "                block: 40 mm, length: 60 mm, start: [99 um, 0 deg]}}\n"
     "contact: {stiffness: 1e8 N/m, friction: 0.1}\n"
     "run: {duration: 2 ms, samples: 50, step: 5 us}\n"},
    {"limits",
     "bodies: {lever: {mass: 1 kg, inertia: 0.01 kg m^2, at: [10 mm, 0 mm], velocity: [0 m/s, -0.1 "
     "m/s], spin: -10 rad/s}}\n"
     "joints: {hinge: {between: [ground, lever], at: [0 mm, 0 mm], low: -1 deg, high: 1 deg,\n"
     "                 stiffness: 1e4 N m/rad, viscous-coefficient: 1 N m s/rad,\n"
     "                 gap-damping: 0.1 N m s/rad}}\n"
     "run: {duration: 10 ms, samples: 50, step: 20 us}\n"},
    {"gears", "bodies:\n"
              "  pinion: {mass: 0.2 kg, inertia: 40 kg mm^2, at: [0 mm, 0 mm], spin: 30 rad/s}\n"
              "  wheel:  {mass: 1 kg, inertia: 900 kg mm^2, at: [80 mm, 0 mm]}\n"
              "joints:\n"
              "  a: {between: [ground, pinion], at: [0 mm, 0 mm]}\n"
              "  b: {between: [ground, wheel], at: [80 mm, 0 mm]}\n"
              "  mesh: {gears: [a, b], teeth: [20, 60], backlash: 0.1 mm, stiffness: 1e7 N/m}\n"
              "drive: {joint: a, torque: 0.1 N m}\n"
              "contact: {restitution: 0.4}\n"
              "run: {duration: 10 ms, samples: 50, step: 20 us}\n"},
    {"space",
     "space: spatial\n"
     "bodies: {pin: {mass: 0.1 kg, inertia: 20 kg mm^2, inertia-x: 40 kg mm^2, inertia-y: 40 kg "
     "mm^2,\n"
     "               at: [0 mm, 0 mm], offset: 30 mm, spin-x: 1 rad/s, velocity-z: 20 mm/s}}\n"
     "joints: {hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.1 mm, pin: 10 mm,\n"
     "                width: 10 mm, axial-clearance: 10 um}}\n"
     "contact: {stiffness: 2.0e7 N/m, damping: viscous, viscous-coefficient: 400 N s/m}\n"
     "run: {duration: 20 ms, samples: 50, step: 10 us}\n"},
    {"damping that grows with the depth",
     FOUR_BAR "contact: {stiffness: 1e8 N/m, damping: step, viscous-coefficient: 400 N s/m,\n"
              "          full-damping-depth: 20 um}\n"
              "run: {revolutions: 0.02, samples: 3600, step: 5 us}\n"},
    {"limits whose damping grows",
     "bodies: {lever: {mass: 1 kg, inertia: 0.01 kg m^2, at: [10 mm, 0 mm], velocity: [0 m/s, -0.1 "
     "m/s], spin: -10 rad/s}}\n"
     "joints: {hinge: {between: [ground, lever], at: [0 mm, 0 mm], low: -1 deg, high: 1 deg,\n"
     "                 stiffness: 1e4 N m/rad, viscous-coefficient: 1 N m s/rad,\n"
     "                 full-damping-depth: 0.1 deg}}\n"
     "run: {duration: 10 ms, samples: 50, step: 20 us}\n"},
    {"undriven pin with friction", PIN
     "contact: {friction: 0.2, law: johnson}\nrun: {duration: 2 ms, samples: 50, step: 5 us}\n"},
    {"poisson", FOUR_BAR "contact: {model: poisson, friction: 0.1}\n"
                         "run: {revolutions: 0.02, samples: 3600, step: 5 us}\n"},
    {"springs",
     "bodies: {arm: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [50 mm, 0 mm]}}\n"
     "joints: {hinge: {between: [ground, arm], at: [0 mm, 0 mm]}}\n"
     "springs: {pull: {between: [ground, arm], at-a: [0 mm, 90 mm], at-b: [90 mm, 0 mm],\n"
     "                 stiffness: 100 N/m, damping: 1 N s/m, length: 100 mm}}\n"
     "torsion-springs: {twist: {joint: hinge, stiffness: 1 N m/rad, damping: 0.01 N m s/rad, "
     "angle: "
     "10 deg}}\n"
     "run: {duration: 20 ms, samples: 50, step: 50 us}\n"
     "ode: {stepping: plain, settle-steps: 5}\n"},
    {"bushings",
     "bodies: {arm: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [50 mm, 0 mm]}}\n"
     "bushings: {soft: {between: [ground, arm], at-a: [0 mm, 0 mm], at-b: [1 mm, 0.5 mm],\n"
     "                  stiffness: [1000 N/m, 3000 N/m], damping: [1 N s/m, 2 N s/m],\n"
     "                  direction: 20 deg, torsional-stiffness: 2 N m/rad,\n"
     "                  torsional-damping: 0.01 N m s/rad, angle: 5 deg},\n"
     "           hard: {between: [ground, arm], at: [100 mm, 0 mm], interpolation: smooth,\n"
     "                  force-x: [[-1 mm, -2 N], [0 mm, 0 N], [1 mm, 4 N]],\n"
     "                  force-y: [[-1 mm, -9 N], [0 mm, 0 N], [1 mm, 4 N]],\n"
     "                  torque: [[-1 deg, -2 N m], [0 deg, 0 N m], [9 deg, 9 N m]]}}\n"
     "run: {duration: 20 ms, samples: 50, step: 50 us}\n"},
    {"quick solver with polygons",
     FOUR_BAR "contact: {stiffness: 1e8 N/m, damping: hunt-crossley, friction: 0.1}\n"
              "run: {revolutions: 0.02, samples: 3600, step: 5 us, backends: [ode]}\n"
              "ode: {solver: quick, collider: staves, iterations: 3}\n"},
    {"chosen step", "bodies: {arm: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [50 mm, 0 mm]}}\n"
                    "joints: {hinge: {between: [ground, arm], at: [0 mm, 0 mm]}}\n"
                    "run: {duration: 20 ms, samples: 20, tolerance: 1e-8}\n"},
};

// Of what is printed or drawn from the runs, and of the limits for their cost: no number of a run
// depends on them.
static const char *const OF_OUTPUT[] = {
    "title",           "points.",        "expect",    "run.spike-threshold",
    "run.report-from", "run.most-steps", "run.budget"};

// What a part is, whether or not a run of this kind feels it: a stiffness that is given stands for
// the width of its pin as well, and the laws of cylinders, which --set and --laws may choose, read
// it.
static const char *const OF_PARTS[] = {"width"};

// Of what a motion may do or not: no contact of some of these short runs outlasts its impact, and
// some of these mechanisms never leave the plane. That it counts where one does,
// test_settled_motion.c and test_space_flat.c show.
static const char *const OF_MOTION[] = {"contact.resting-speed", "space"};

// Keys without which the case is none, which are refused or make another mechanism, and which
// nobody can leave out: their values need not matter, as the inertia of what does not turn.
static bool is_structure(const SchemaRow *row)
{
    return row->type == SCHEMA_BETWEEN || row->type == SCHEMA_BODY_NAME ||
           row->type == SCHEMA_JOINT_NAME || row->type == SCHEMA_PIVOTS || row->is_required ||
           row->type == SCHEMA_TEXT || row->type == SCHEMA_EXPECT || row->type == SCHEMA_BACKENDS;
}

static bool is_of_output(const char *key)
{
    for (size_t i = 0; i < sizeof OF_OUTPUT / sizeof *OF_OUTPUT; i++) {
        if (strncmp(key, OF_OUTPUT[i], strlen(OF_OUTPUT[i])) == 0) {
            return true;
        }
    }
    return false;
}

static bool is_of_part(const char *key)
{
    const char *dot = strrchr(key, '.');
    return dot != NULL && strcmp(dot + 1, OF_PARTS[0]) == 0;
}

static bool is_of_motion(const char *key)
{
    return strcmp(key, OF_MOTION[0]) == 0 || strcmp(key, OF_MOTION[1]) == 0;
}

static uint64_t mix(uint64_t print, uint64_t number)
{
    return (print ^ number) * 1099511628211U; // FNV's prime
}

// What the runs of a scenario make: motion, forces, samples, cost and what was claimed of it.
static uint64_t fingerprint(const Scenario *scenario)
{
    uint64_t print = 0;
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        Trajectory *run =
            backend_run(scenario, scenario->run.backends[i], NULL, (ChosenWatch){0}, NULL);
        print = mix(mix(mix(print, run->hash), run->sample_count), run->steps);
        print = mix(mix(print, run->is_complete), run->is_short);
        print = mix(mix(print, run->trials), run->evaluations);
        for (size_t k = 0; run->is_complete && k < run->sample_count * run->body_count; k++) {
            uint64_t bits;
            memcpy(&bits, &run->motions[k].angle, sizeof bits);
            print = mix(print, bits);
        }
        for (const char *c = run->message; *c != '\0'; c++) {
            print = mix(print, (unsigned char)*c);
        }
        trajectory_destroy(run);
    }
    return print;
}

// Appends other values of a setting as a case writes them: the number `choice`; false behind the
// last.
static bool other_value(const SchemaRow *row, const CasefileSetting *setting, size_t choice,
                        Text *text)
{
    static const double FACTORS[] = {1.05, 0.9, 3.0, 1e3, 1e-3};
    const bool is_plain = row->plain_unit != NULL;
    const char *unit = is_plain ? "" : setting->unit;
    if (setting->kind == CASEFILE_WORD && row->words == NULL) {
        // such as auto: the word for 0
        text_append(text, "%.17g %s", ceil(1e6 * (row->low + 1e-3)) * 1e-6, schema_unit(row));
        return choice == 0;
    }
    if (setting->kind == CASEFILE_WORD) {
        size_t count = 0;
        while (row->words[count] != NULL) {
            count++;
        }
        text_append(text, "%s", choice < count ? row->words[choice] : "");
        return choice < count;
    }
    if (choice == sizeof FACTORS / sizeof *FACTORS || setting->number_count == 0) {
        return false;
    }
    const double factor = FACTORS[choice];
    double numbers[3];
    const size_t count = setting->kind == CASEFILE_TOLERATED ? 1 : setting->number_count;
    for (size_t i = 0; i < count && i < 3; i++) {
        const double own = setting->numbers[i];
        const double high = fmin(row->high, row->low + 1.0);
        numbers[i] =
            isfinite(own) && own != 0.0
                ? own * factor
                : row->low + 0.377 / (double)(1 + choice * choice * 100) * (high - row->low);
        numbers[i] = setting->kind == CASEFILE_INTEGER ? ceil(numbers[i]) : numbers[i];
    }
    if (setting->kind == CASEFILE_POINTS) {
        const int over = (int)strcspn(unit, ",");
        const char *of = strchr(unit, ' ') + 1;
        text_append(text, "[[0 %.*s, %.17g %s], [1 %.*s, %.17g %s]]", over, unit,
                    setting->numbers[1] * factor, of, over, unit, setting->numbers[1], of);
        return true;
    }
    if (count == 1) {
        text_append(text, "%.17g %s", numbers[0], unit);
        return true;
    }
    const bool is_mixed = strcmp(unit, "m, rad") == 0;
    text_append(text, "[");
    for (size_t i = 0; i < count; i++) {
        text_append(text, "%s%.17g %s", i > 0 ? ", " : "", numbers[i],
                    is_mixed ? (i == 0 ? "m" : "rad") : unit);
    }
    text_append(text, "]");
    return true;
}

typedef enum Verdict { REFUSED, NAMED, CHANGES, SILENT } Verdict;

static Verdict judge(const char *text, const char *key, const char *value, uint64_t before)
{
    Text override;
    Scenario scenario;
    Err err = {0};
    text_init(&override);
    text_append(&override, "%s=%s", key, value);
    const char *const overrides[] = {override.data};
    const bool is_loaded =
        casefile_load_text("case", text, strlen(text), overrides, 1, &scenario, &err);
    text_finish(&override);
    if (!is_loaded) {
        assert_true(err.text[0] != '\0');
        return REFUSED;
    }
    Text lines;
    text_init(&lines);
    casefile_unused(&scenario, false, &lines);
    char start[CASEFILE_KEY_SIZE + 64];
    snprintf(start, sizeof start, "%s of the command line has no effect", key);
    const Verdict verdict = strstr(lines.data, start) != NULL                       ? NAMED
                            : is_of_output(key) || fingerprint(&scenario) != before ? CHANGES
                                                                                    : SILENT;
    text_finish(&lines);
    scenario_free(&scenario);
    return verdict;
}

// Whether a key is passed over in silence by a case: no value of it is refused, named or seen.
static bool is_silent(const char *text, const SchemaRow *row, const CasefileSetting *setting,
                      uint64_t before)
{
    bool was_silent = false;
    bool has_value = true;
    for (size_t choice = 0; has_value; choice++) {
        Text value;
        text_init(&value);
        has_value = other_value(row, setting, choice, &value);
        const bool is_own =
            setting->kind == CASEFILE_WORD && strcmp(value.data, setting->text) == 0;
        const Verdict verdict =
            has_value && !is_own ? judge(text, setting->key, value.data, before) : REFUSED;
        text_finish(&value);
        if (verdict == CHANGES || verdict == NAMED) {
            return false;
        }
        was_silent = was_silent || verdict == SILENT;
    }
    return was_silent;
}

static const SchemaRow *row_of(const CasefileWalk *walk)
{
    return &SCHEMA_ROWS[walk->row];
}

static void no_key_is_passed_over_in_silence(void **state)
{
    (void)state;
    size_t silent = 0;
    size_t asked = 0;
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        Scenario scenario;
        Err err = {0};
        const char *text = KINDS[i].text;
        if (!casefile_load_text("case", text, strlen(text), NULL, 0, &scenario, &err)) {
            fail_msg("%s: %s", KINDS[i].name, err.text);
        }
        const uint64_t before = fingerprint(&scenario);
        CasefileSetting setting;
        CasefileWalk walk = casefile_walk(&scenario);
        while (casefile_next(&walk, &setting)) {
            if (is_structure(row_of(&walk)) || is_of_part(setting.key) ||
                is_of_motion(setting.key) || strchr(setting.key, '*') != NULL) {
                continue;
            }
            asked++;
            if (is_silent(text, row_of(&walk), &setting, before)) {
                print_message("# %s: %s is passed over in silence\n", KINDS[i].name, setting.key);
                silent++;
            }
        }
        scenario_free(&scenario);
    }
    assert_true(asked > 1000);
    assert_int_equal(silent, 0);
}

// How often the width of the pin is passed over in silence in a four-bar with that contact.
static size_t silent_widths(const char *text)
{
    Scenario scenario;
    Err err = {0};
    assert_true(casefile_load_text("case", text, strlen(text), NULL, 0, &scenario, &err));
    const uint64_t before = fingerprint(&scenario);
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(&scenario);
    size_t seen = 0;
    while (casefile_next(&walk, &setting)) {
        if (strcmp(setting.key, "joints.crank-coupler.width") == 0) {
            seen += is_silent(text, row_of(&walk), &setting, before) ? 1 : 0;
        }
    }
    scenario_free(&scenario);
    return seen;
}

// The control: the width of a pin, which a stiffness that is given stands for, is not named, and a
// test that could not see that would see nothing. Under a law of spheres that the case names it is.
static void a_key_that_is_passed_over_is_seen(void **state)
{
    (void)state;
    static const char RUN[] = "run: {revolutions: 0.02, step: 5 us, start: centred}\n";
    char text[2048];
    snprintf(text, sizeof text, "%scontact: {stiffness: 1e8 N/m}\n%s", FOUR_BAR, RUN);
    assert_int_equal(silent_widths(text), 1);
    snprintf(text, sizeof text, "%scontact: {law: hertz-socket}\n%s", FOUR_BAR, RUN);
    assert_int_equal(silent_widths(text), 0);
    snprintf(text, sizeof text, "%scontact: {law: johnson}\n%s", FOUR_BAR, RUN);
    assert_int_equal(silent_widths(text), 0);
}

// The control of the conditions: what a row asks for has words, or a message could not say it.
static void what_a_key_asks_for_has_words(void **state)
{
    (void)state;
    const char *const asks[] = {"bodies.*.inertia-x", "contact.penalty",        "ode.erp",
                                "ode.gear",           "contact.friction-speed", "run.tolerance",
                                "ode.push-out"};
    for (size_t i = 0; i < sizeof asks / sizeof *asks; i++) {
        Text words;
        text_init(&words);
        schema_list_needs(schema_find(asks[i]), &words);
        assert_true(words.length > 0);
        text_finish(&words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_key_is_passed_over_in_silence),
        cmocka_unit_test(a_key_that_is_passed_over_is_seen),
        cmocka_unit_test(what_a_key_asks_for_has_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
