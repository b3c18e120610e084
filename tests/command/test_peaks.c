// Does every peak that the tables know stand in the series and in the picture, at 60 samples a
// turn?
#include "program.h"

#include <math.h>

static const char PENDULUM[] =
    "title: Double pendulum with play in both joints\n"
    "bodies:\n"
    "  upper: {mass: 0.5 kg, inertia: 1700 kg mm^2, at: [100 mm, 0 mm]}\n"
    "  lower: {mass: 0.4 kg, inertia: 1300 kg mm^2, at: [300 mm, 0 mm]}\n"
    "joints:\n"
    "  pivot: {between: [ground, upper], at: [0 mm, 0 mm], hole: 10.1 mm, pin: 10 mm, width: 10 "
    "mm}\n"
    "  elbow: {between: [upper, lower], at: [200 mm, 0 mm], hole: 10.1 mm, pin: 10 mm, width: 10 "
    "mm}\n"
    "run: {duration: 300 ms, samples: 60, step: 2 us, backends: [ode]}\n"
    "ode: {stepping: staggered, map: midpoint}\n";

static char *read_file(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    char *text = calloc(1, 1 << 23);
    assert_true(fread(text, 1, (1 << 23) - 1, stream) > 0);
    fclose(stream);
    return text;
}

// The largest of a column times the sign.
static double most_of(const char *csv, const char *column, double sign)
{
    size_t number = 0;
    const char *word = csv;
    while (strncmp(word, column, strlen(column)) != 0 ||
           strchr(",\n", word[strlen(column)]) == NULL) {
        word += strcspn(word, ",\n");
        assert_true(*word == ',');
        word++;
        number++;
    }
    double most = -INFINITY;
    for (const char *row = strchr(csv, '\n') + 1; *row != '\0'; row = strchr(row, '\n') + 1) {
        const char *cell = row;
        for (size_t i = 0; i < number; i++) {
            cell = strchr(cell, ',') + 1;
        }
        most = fmax(most, sign * strtod(cell, NULL));
    }
    return sign * most;
}

// The path element whose title begins so, or NULL.
static const char *find_path(const char *svg, const char *title)
{
    char words[300];
    snprintf(words, sizeof words, "<title>%s", title);
    const char *at = strstr(svg, words);
    while (at != NULL && at > svg && strncmp(at, "<path", 5) != 0) {
        at--;
    }
    return at;
}

// How near the strokes of a path come to a place, in pixels up and down.
static double distance_to(const char *path, double x, double y)
{
    const char *at = strstr(path, " d=\"") + 4;
    double now_x = NAN;
    double last_y = NAN;
    double nearest = INFINITY;
    while (*at != '"') {
        const char letter = *at++;
        char *rest;
        if (letter != 'V') {
            now_x = strtod(at, &rest);
            at = rest;
        }
        const double now_y = strtod(at, &rest);
        at = rest;
        const double from = letter == 'V' ? last_y : now_y;
        last_y = now_y;
        if (fabs(now_x - x) <= 1.5) {
            nearest = fmin(nearest, fmax(0.0, fmax(fmin(from, now_y) - y, y - fmax(from, now_y))));
        }
    }
    return nearest;
}

// Every spike has a mark, and the line of the run goes up to its tip.
static void expect_spikes(const char *svg, const char *backend, const char *quantity,
                          const char *name, const json_t *spikes, const char *key)
{
    char title[256];
    snprintf(title, sizeof title, "%s: %s %s<", backend, quantity, name);
    const char *band = find_path(svg, title);
    assert_non_null(band);
    for (size_t i = 0; i < json_array_size(spikes); i++) {
        const json_t *spike = json_array_get(spikes, i);
        snprintf(title, sizeof title, "%s %s: %.6g ", quantity, name,
                 json_number_value(json_object_get(spike, key)));
        const char *mark = find_path(svg, title);
        assert_non_null(mark);
        double x = 0.0;
        double y = 0.0;
        assert_int_equal(sscanf(strstr(mark, " d=\"") + 4, "M%lf %lf", &x, &y), 2);
        assert_true(distance_to(band, x, y) <= 0.21);
        // the control: nothing goes beyond the strongest
        const double beyond = json_number_value(json_object_get(spike, key)) > 0.0 ? -3.0 : 3.0;
        assert_true(i > 0 || distance_to(band, x, y + beyond) > 2.0);
    }
}

static void expect_all(Program *program, const char *name, const char *backend)
{
    char file[256];
    snprintf(file, sizeof file, "out/%s.json", name);
    char *text = read_file(program, file);
    json_t *root = json_loads(text, 0, NULL);
    free(text);
    const json_t *runs = json_object_get(root, "runs");
    const json_t *run = json_array_get(runs, json_array_size(runs) - 1);
    snprintf(file, sizeof file, "out/%s-%s.csv", name, backend);
    char *csv = read_file(program, file);
    snprintf(file, sizeof file, "out/%s.svg", name);
    char *svg = read_file(program, file);
    assert_true(strlen(svg) < 400000);
    bool is_missed = false;
    const char *owner;
    json_t *own;
    json_object_foreach(json_object_get(run, "bodies"), owner, own)
    {
        static const char *const KEYS[] = {"omega_max_rad_s", "omega_min_rad_s", "alpha_max_rad_s2",
                                           "alpha_min_rad_s2"};
        for (int i = 0; i < 4; i++) {
            char column[128];
            snprintf(column, sizeof column, "%s_%s", owner, KEYS[i]);
            const double extreme = json_number_value(json_object_get(own, KEYS[i]));
            assert_true(most_of(csv, column, i % 2 == 0 ? 1.0 : -1.0) == extreme);
        }
        char column[128];
        snprintf(column, sizeof column, "%s_alpha_rad_s2", owner);
        const double most = json_number_value(json_object_get(own, "alpha_max_rad_s2"));
        // the control: the samples lose peaks
        is_missed = is_missed || most_of(csv, column, 1.0) < 0.9 * most;
        expect_spikes(svg, backend, "alpha", owner, json_object_get(own, "alpha_spikes"),
                      "value_rad_s2");
    }
    json_object_foreach(json_object_get(run, "joints"), owner, own)
    {
        char column[128];
        snprintf(column, sizeof column, "%s_force_max_N", owner);
        const double extreme = json_number_value(json_object_get(own, "force_max_N"));
        assert_true(most_of(csv, column, 1.0) == extreme);
        if (json_is_true(json_object_get(own, "has_play"))) {
            expect_spikes(svg, backend, "force", owner, json_object_get(own, "force_spikes"),
                          "value_N");
        }
    }
    assert_true(is_missed);
    free(csv);
    free(svg);
    json_decref(root);
}

static void every_peak_of_the_restitution_model_is_shown(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/stackup-poisson.yaml --set run.samples=60 --out out");
    assert_int_equal(program->status, 0);
    expect_all(program, "stackup-poisson", "ode");
}

static void every_peak_of_a_double_pendulum_is_shown(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "pendulum.yaml", path);
    FILE *stream = fopen(path, "w");
    fputs(PENDULUM, stream);
    fclose(stream);
    program_run(program, "run pendulum.yaml --out out");
    assert_int_equal(program->status, 0);
    expect_all(program, "pendulum", "ode");
    program_run(program, "run pendulum.yaml --set run.backends=reference "
                         "--set run.duration=60ms --out out");
    assert_int_equal(program->status, 0);
    expect_all(program, "pendulum", "reference");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_peak_of_the_restitution_model_is_shown,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(every_peak_of_a_double_pendulum_is_shown, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
