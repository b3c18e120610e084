// Does the case that `new --from` makes of a model move as MuJoCo moves it?
//
// Twenty models, MJCF and URDF, in the plane, in tilted planes and in space, with loops and
// without. Truth: MuJoCo's own run, RK4 at a fine step and at half of it, whose difference is its
// error; loops and gears as hard as that step allows, so that their softness is in it. What is
// compared is where a point of each of its bodies is, XX
#include "commands/new/new_robot.h"
#include "engine_outcome.h"

#include <mujoco/mujoco.h>

typedef struct Model {
    const char *file;
    double step_s; // of MuJoCo
    double duration_s;
    double least_m;    // what is less than this is not told apart, and why
    size_t notes;      // sentences on what is left out
    const char *truth; // another file that MuJoCo runs, where it passes over something; NULL: none
} Model;

// m: numbers of 15 digits, and MuJoCo's sums over thousands of steps
#define ROUNDING 1e-10
// m: teeth that give, and swing against each other, by their load over their stiffness
#define TEETH 5e-6

static const Model MODELS[] = {
    {"double-pendulum.xml", 1e-3, 0.5, ROUNDING, 0, NULL},
    {"four-bar.xml", 2e-5, 0.2, ROUNDING, 0, NULL},
    {"slider-crank.xml", 2e-5, 0.2, ROUNDING, 0, NULL},
    {"delta-leg.xml", 2e-5, 0.15, ROUNDING, 0, NULL},
    {"gripper.xml", 1e-4, 0.2, TEETH, 2, NULL},
    {"geared-servo.xml", 1e-4, 0.1, TEETH, 0, NULL},
    {"jansen-leg.xml", 2e-5, 0.1, ROUNDING, 0, NULL},
    {"scara.xml", 1e-3, 0.5, ROUNDING, 2, NULL},
    {"cart-pole.xml", 1e-3, 0.5, ROUNDING, 0, NULL},
    {"walker.xml", 1e-3, 0.3, ROUNDING, 0, NULL},
    {"arm-in-space.xml", 1e-3, 0.4, ROUNDING, 0, NULL},
    {"floating.xml", 1e-3, 0.4, ROUNDING, 0, NULL},
    {"four-bar-in-space.xml", 2e-5, 0.1, ROUNDING, 0, NULL},
    {"tilted-four-bar.xml", 2e-5, 0.2, ROUNDING, 1, NULL},
    {"six-bar.xml", 2e-5, 0.1, ROUNDING, 0, NULL},
    {"swinging-block.xml", 2e-5, 0.1, ROUNDING, 0, NULL},
    {"spring-pendulum.xml", 1e-3, 0.5, ROUNDING, 0, NULL},
    {"rubbing-pendulum.xml", 1e-4, 0.2, ROUNDING, 0, NULL},
    {"two-link.urdf", 1e-3, 0.5, ROUNDING, 0, NULL},
    {"scara.urdf", 1e-3, 0.5, ROUNDING, 2, NULL},
    {"cart.urdf", 1e-3, 0.5, ROUNDING, 0, NULL},
    {"arm.urdf", 1e-3, 0.3, ROUNDING, 0, NULL},
    {"mimic-gripper.urdf", 1e-4, 0.2, TEETH, 0, "mimic-gripper.xml"},
};

enum { SAMPLES = 20, PLACE_MOST = 64 };

// Where a point of each body is, sample by sample.
typedef struct Places {
    size_t count;
    Vec3 at[SAMPLES + 1][PLACE_MOST];
} Places;

static Vec3 point_of(const mjData *data, size_t body)
{
    static const mjtNum LOCAL[] = {0.1, 0.2, 0.3};
    mjtNum place[3];
    mju_rotVecMat(place, LOCAL, data->xmat + 9 * body);
    mju_addTo3(place, data->xpos + 3 * body);
    return (Vec3){place[0], place[1], place[2]};
}

// As MuJoCo reads it: a URDF without its shapes, whose meshes are nowhere.
static mjModel *load_model(const char *path)
{
    static const char NAME[] = "robot.urdf";
    static char text[1 << 16];
    char words[1000] = "";
    if (strstr(path, ".urdf") == NULL) {
        mjModel *model = mj_loadXML(path, NULL, words, sizeof words);
        if (model == NULL) {
            fail_msg("%s: %s", path, words);
        }
        return model;
    }
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    const size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[size] = '\0';
    for (char *from = text; (from = strstr(from, "<visual><")) != NULL;) {
        char *end = strstr(from, "</collision>") + strlen("</collision>");
        memset(from, ' ', (size_t)(end - from));
    }
    mjVFS *files = calloc(1, sizeof *files);
    assert_non_null(files);
    mj_defaultVFS(files);
    assert_int_equal(mj_makeEmptyFileVFS(files, NAME, (int)size), 0);
    memcpy(files->filedata[mj_findFileVFS(files, NAME)], text, size);
    mjModel *model = mj_loadXML(NAME, files, words, sizeof words);
    mj_deleteVFS(files);
    free(files);
    if (model == NULL) {
        fail_msg("%s: %s", path, words);
    }
    return model;
}

static void run_mujoco(const char *path, const Model *of, double step_s, Places *places)
{
    mjModel *model = load_model(path);
    model->opt.timestep = step_s;
    model->opt.integrator = mjINT_RK4;
    model->opt.disableflags |= mjDSBL_CONTACT;
    model->opt.tolerance = 1e-14;
    model->opt.iterations = 200;
    for (int i = 0; i < model->neq; i++) {
        model->eq_solref[mjNREF * i] = 2.0 * step_s;
        model->eq_solimp[mjNIMP * i] = model->eq_solimp[mjNIMP * i + 1] = 0.9999;
    }
    mjData *data = mj_makeData(model);
    const int steps = (int)lround(of->duration_s / step_s);
    places->count = (size_t)model->nbody - 1;
    assert_true(places->count <= PLACE_MOST);
    for (int step = 0; step <= steps; step++) {
        if (step % (steps / SAMPLES) == 0) {
            mj_kinematics(model, data);
            for (size_t i = 0; i < places->count; i++) {
                places->at[step / (steps / SAMPLES)][i] = point_of(data, i + 1);
            }
        }
        mj_step(model, data);
    }
    mj_deleteData(data);
    mj_deleteModel(model);
}

// The text of the case of a model; the robot stays for its numbers.
static void make_case(const char *path, Robot *robot, RobotCase *of, Text *text)
{
    const EngineDriver driver = engine_named("mujoco");
    Err err = {0};
    if (!robot_read(&driver, path, robot, &err) || !robot_case_make(robot, of, &err)) {
        fail_msg("%s", err.text);
    }
    text_init(text);
    robot_case_write(of, "model.xml", text);
}

static Trajectory *run_case(const Text *text, const Model *of, double scale)
{
    char duration[64];
    char samples[64];
    snprintf(duration, sizeof duration, "run.duration=%.17g s", of->duration_s);
    snprintf(samples, sizeof samples, "run.samples=%d", SAMPLES);
    const char *const overrides[] = {duration, samples, "run.backends=[reference]"};
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case", text->data, text->length, overrides, 3, &scenario, &err)) {
        fail_msg("%s\n%s", err.text, text->data);
    }
    for (size_t i = 0; scale != 1.0 && i < scenario.linkage.body_count; i++) {
        scenario.linkage.bodies[i].inertia *= scale;
    }
    scenario.gravity = vec3_scale(scale, scenario.gravity);
    Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    scenario_free(&scenario);
    return run;
}

// The number in the case of a body of the robot, which those that are fixed do not have.
static size_t number_of(const RobotCase *of, int body)
{
    size_t number = 0;
    for (int i = 0; i < body; i++) {
        number += of->held[i] == i ? 1 : 0;
    }
    return number;
}

// Where a point that was at a place at the start is, in the axes of the case.
static Vec3 moved(const RobotCase *of, const Trajectory *run, size_t sample, int body, Vec3 place)
{
    const Vec3 own = {vec3_dot(of->right, place), vec3_dot(of->up, place),
                      vec3_dot(of->normal, place)};
    if (body == ROBOT_GROUND) {
        return own;
    }
    const size_t number = number_of(of, body);
    if (!of->is_planar) {
        const SpaceMotion *start = trajectory_space_motion(run, 0, number);
        const SpaceMotion *now = trajectory_space_motion(run, sample, number);
        const Vec3 arm = quat_rotate_back(start->turn, vec3_sub(own, start->position));
        return vec3_add(now->position, quat_rotate(now->turn, arm));
    }
    const Motion *start = trajectory_motion(run, 0, number);
    const Motion *now = trajectory_motion(run, sample, number);
    const Vec2 arm =
        vec2_rotate(now->angle - start->angle, vec2_sub((Vec2){own.x, own.y}, start->position));
    return (Vec3){now->position.x + arm.x, now->position.y + arm.y, own.z};
}

// The body of the robot that each of MuJoCo's bodies is fixed to.
static void find_bodies(const char *path, const RobotCase *of, int *bodies)
{
    mjModel *model = load_model(path);
    int count = 0;
    int numbers[PLACE_MOST + 1] = {ROBOT_GROUND};
    for (int i = 1; i < model->nbody; i++) {
        const int held = model->body_weldid[i];
        numbers[i] = held == 0 ? ROBOT_GROUND : held == i ? count++ : numbers[held];
        bodies[i - 1] = robot_case_held(of, numbers[i]);
    }
    mj_deleteModel(model);
}

// A way between two points, of which the plane does not see what leaves it.
static double length_in(const RobotCase *of, Vec3 apart)
{
    return of->is_planar ? hypot(vec3_dot(of->right, apart), vec3_dot(of->up, apart))
                         : vec3_length(apart);
}

// How far the case is from MuJoCo at most.
static double distance(const RobotCase *of, const Trajectory *run, const Places *places,
                       const int *bodies)
{
    double most = 0.0;
    for (size_t sample = 0; sample <= SAMPLES; sample++) {
        for (size_t i = 0; i < places->count; i++) {
            const Vec3 is = moved(of, run, sample, bodies[i], places->at[0][i]);
            const Vec3 in_world =
                vec3_add(vec3_add(vec3_scale(is.x, of->right), vec3_scale(is.y, of->up)),
                         vec3_scale(is.z, of->normal));
            most = fmax(most, length_in(of, vec3_sub(places->at[sample][i], in_world)));
        }
    }
    return most;
}

static double apart(const RobotCase *of, const Places *a, const Places *b)
{
    double most = 0.0;
    for (size_t sample = 0; sample <= SAMPLES; sample++) {
        for (size_t i = 0; i < a->count; i++) {
            most = fmax(most, length_in(of, vec3_sub(a->at[sample][i], b->at[sample][i])));
        }
    }
    return most;
}

static void hold_model(const Model *model, const char *path, const char *truth)
{
    static Places coarse;
    static Places fine;
    Robot robot;
    RobotCase of;
    Text text;
    int bodies[PLACE_MOST];
    make_case(path, &robot, &of, &text);
    assert_int_equal(of.note_count, model->notes);
    Trajectory *run = run_case(&text, model, 1.0);
    Trajectory *other = run_case(&text, model, 1.01);
    find_bodies(truth, &of, bodies);
    run_mujoco(truth, model, model->step_s, &coarse);
    run_mujoco(truth, model, 0.5 * model->step_s, &fine);
    const double own = apart(&of, &coarse, &fine);
    const double off = distance(&of, run, &fine, bodies);
    const double control = distance(&of, other, &fine, bodies);
    if (!(off <= own + model->least_m) || !(control > 10.0 * (own + model->least_m))) {
        fail_msg("%s: MuJoCo is off by %g m, the case by %g, the control by %g", model->file, own,
                 off, control);
    }
    trajectory_destroy(other);
    trajectory_destroy(run);
    text_finish(&text);
    robot_case_finish(&of);
    robot_finish(&robot);
}

static void cases_of_models_move_as_mujoco_moves_them(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof MODELS / sizeof *MODELS; i++) {
        const Model *model = &MODELS[i];
        char path[256];
        char truth[256];
        snprintf(path, sizeof path, "tests/engine/models/%s", model->file);
        snprintf(truth, sizeof truth, "tests/engine/models/%s",
                 model->truth != NULL ? model->truth : model->file);
        hold_model(model, path, truth);
    }
}

// Writes bodies that hang on each other by hinges and slides, with springs and dampers, from a
// seed.
static void write_tree(FILE *file, unsigned seed)
{
    const int count = 2 + (int)(seed % 4);
    bool is_sliding[8] = {false};
    fprintf(file, "<mujoco><compiler angle='radian'/><worldbody>\n<body euler='%g %g %g'>\n",
            drawn(&seed, -3.0, 3.0), drawn(&seed, -3.0, 3.0), drawn(&seed, -3.0, 3.0));
    int depth = 0;
    for (int i = 0; i < count; i++) {
        is_sliding[i] = drawn(&seed, 0.0, 1.0) < 0.3;
        const double turn = drawn(&seed, -3.0, 3.0);
        fprintf(file, "<body pos='%g %g %g' euler='0 0 %g'>\n<inertial pos='%g %g %g' mass='%g' ",
                drawn(&seed, -0.2, 0.2), drawn(&seed, -0.2, 0.2), drawn(&seed, -0.2, 0.2), turn,
                drawn(&seed, -0.1, 0.1), drawn(&seed, -0.1, 0.1), drawn(&seed, -0.1, 0.1),
                drawn(&seed, 0.2, 2.0));
        fprintf(file, "fullinertia='%g %g %g .0003 -.0002 .0001'/>\n", drawn(&seed, 0.003, 0.004),
                drawn(&seed, 0.003, 0.004), drawn(&seed, 0.003, 0.004));
        fprintf(file, "<joint type='%s' pos='%g %g 0' axis='%g %g %d'",
                is_sliding[i] ? "slide" : "hinge", drawn(&seed, -0.1, 0.1), drawn(&seed, -0.1, 0.1),
                is_sliding[i] ? cos(turn) : 0.0, is_sliding[i] ? sin(turn) : 0.0,
                is_sliding[i] ? 0
                : i % 2 == 0  ? 1
                              : -1);
        fprintf(file, " stiffness='%g' springref='%g' damping='%g' ref='%g'/>\n",
                drawn(&seed, 0.0, is_sliding[i] ? 200.0 : 3.0), drawn(&seed, -0.1, 0.1),
                drawn(&seed, 0.0, is_sliding[i] ? 3.0 : 0.05), drawn(&seed, -0.1, 0.1));
        depth++;
        while (depth > 0 && drawn(&seed, 0.0, 1.0) < 0.3) {
            fprintf(file, "</body>\n");
            depth--;
        }
    }
    for (; depth >= 0; depth--) {
        fprintf(file, "</body>\n");
    }
    fprintf(file, "</worldbody></mujoco>\n");
}

static void so_do_those_of_random_trees(void **state)
{
    (void)state;
    for (unsigned seed = 1; seed <= 12; seed++) {
        char path[] = "/tmp/jointplay-model-XXXXXX.xml";
        const int channel = mkstemps(path, 4);
        assert_true(channel >= 0);
        FILE *file = fdopen(channel, "w");
        assert_non_null(file);
        write_tree(file, seed);
        fclose(file);
        char name[32];
        snprintf(name, sizeof name, "tree %u", seed);
        // all that is left out is the pull across the plane, which is tilted
        const Model model = {name, 1e-3, 0.3, ROUNDING, 1, NULL};
        hold_model(&model, path, path);
        remove(path);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cases_of_models_move_as_mujoco_moves_them),
        cmocka_unit_test(so_do_those_of_random_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
