// Reads a model by MuJoCo and says what mechanism it is, in the posture of its file
// (docs/drivers.md).
//
// Bodies are those that move, each with all that is fixed to it; places and axes are in the world.
// Coordinates of joints count from that posture. A limit's spring and damper are what MuJoCo's
// reference acceleration is there, where A is the coordinate's inverse inertia and d the
// largest impedance (documentation, "Computation"):
//     solref (t, r):   k = 1 / (A d t^2 r^2),  c = 2 / (A t);     solref (-k', -c'):   d / A of
//     each
#include "drivers/mujoco/mujoco_driver.h"
#include "drivers/mujoco/mujoco_urdf.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_MOST = 1 << 24, WORDS_SIZE = 1024 };

typedef struct Tell {
    const mjModel *model;
    const mjData *data;
    const Urdf *urdf;
    int *numbers;     // by body: its number in the answer, that of what it is fixed to; -1: ground
    json_t *left_out; // what the answer has no words for, a sentence each
} Tell;

static void leave_out(const Tell *tell, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void leave_out(const Tell *tell, const char *format, ...)
{
    char words[WORDS_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    json_t *text = json_string(words);
    json_array_append_new(tell->left_out,
                          text != NULL ? text : json_string("something whose name is no text"));
}

static const char *name_of(const mjModel *model, int kind, int id)
{
    const char *name = mj_id2name(model, kind, id);
    return name != NULL ? name : "";
}

static json_t *name_string(const mjModel *model, int kind, int id)
{
    json_t *name = json_string(name_of(model, kind, id));
    return name != NULL ? name : json_string("");
}

static json_t *vector(const mjtNum *of)
{
    return json_pack("[f, f, f]", of[0], of[1], of[2]);
}

// Adds something that is told, of numbers that are.
static void append(json_t *array, json_t *object, const char *what, const char *name)
{
    if (object == NULL) {
        driver_refuse("%s '%s' with numbers that are not finite", what, name);
    }
    json_array_append_new(array, object);
}

// What moves together with a body: mass, centre, and inertia about it in the world's axes.
typedef struct Lump {
    mjtNum mass;
    mjtNum centre[3];
    mjtNum inertia[9];
} Lump;

static void add_centre(const Tell *tell, int body, Lump *lump)
{
    const mjtNum mass = tell->model->body_mass[body];
    lump->mass += mass;
    mju_addToScl3(lump->centre, tell->data->xipos + 3 * body, mass);
}

// By Steiner's theorem, with the centre of all known.
static void add_inertia(const Tell *tell, int body, Lump *lump)
{
    const mjtNum *turn = tell->data->ximat + 9 * body;
    const mjtNum *own = tell->model->body_inertia + 3 * body;
    const mjtNum mass = tell->model->body_mass[body];
    mjtNum arm[3];
    mju_sub3(arm, tell->data->xipos + 3 * body, lump->centre);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            mjtNum *sum = &lump->inertia[3 * i + k];
            for (int n = 0; n < 3; n++) {
                *sum += turn[3 * i + n] * own[n] * turn[3 * k + n];
            }
            *sum -= mass * arm[i] * arm[k];
            *sum += i == k ? mass * mju_dot3(arm, arm) : 0.0;
        }
    }
}

static json_t *body_object(const Tell *tell, int body)
{
    const mjModel *model = tell->model;
    Lump lump = {.mass = 0.0};
    for (int i = 1; i < model->nbody; i++) {
        if (model->body_weldid[i] == body) {
            add_centre(tell, i, &lump);
        }
    }
    mju_scl3(lump.centre, lump.centre, 1.0 / lump.mass);
    for (int i = 1; i < model->nbody; i++) {
        if (model->body_weldid[i] == body) {
            add_inertia(tell, i, &lump);
        }
    }
    const mjtNum *all = lump.inertia;
    return json_pack(
        "{s:o, s:i, s:f, s:o, s:[f, f, f, f, f, f]}", "name", name_string(model, mjOBJ_BODY, body),
        "parent", tell->numbers[model->body_parentid[body]], "mass_kg", lump.mass, "position_m",
        vector(lump.centre), "inertia_kg_m2", all[0], all[4], all[8], all[1], all[2], all[5]);
}

static json_t *bodies_array(const Tell *tell)
{
    json_t *bodies = json_array();
    for (int i = 1; i < tell->model->nbody; i++) {
        if (tell->model->body_weldid[i] == i && tell->numbers[i] >= 0) {
            append(bodies, body_object(tell, i), "body", name_of(tell->model, mjOBJ_BODY, i));
        }
    }
    return bodies;
}

// Numbers the bodies that move, in MuJoCo's order.
static void number_bodies(const Tell *tell)
{
    const mjModel *model = tell->model;
    int count = 0;
    tell->numbers[0] = -1;
    for (int i = 1; i < model->nbody; i++) {
        const int held = model->body_weldid[i];
        tell->numbers[i] = held == 0 ? -1 : held == i ? count++ : tell->numbers[held];
        if (model->body_mocapid[i] >= 0) {
            leave_out(tell, "body '%s' is moved by hand (mocap); it stays where it is",
                      name_of(model, mjOBJ_BODY, i));
        }
    }
}

// The limits of a joint, with what resists beyond them.
static void add_limits(const Tell *tell, int joint, mjtNum zero, json_t *object)
{
    const mjModel *model = tell->model;
    if (!model->jnt_limited[joint]) {
        return;
    }
    const mjtNum *range = model->jnt_range + 2 * joint;
    const mjtNum *ref = model->jnt_solref + mjNREF * joint;
    const mjtNum weight = model->dof_invweight0[model->jnt_dofadr[joint]];
    const mjtNum most = model->jnt_solimp[mjNIMP * joint + 1];
    const bool is_direct = ref[0] <= 0.0;
    const mjtNum stiffness = is_direct ? -ref[0] * most / weight
                                       : 1.0 / (weight * most * ref[0] * ref[0] * ref[1] * ref[1]);
    const mjtNum damping = is_direct ? -ref[1] * most / weight : 2.0 / (weight * ref[0]);
    if (!isfinite(stiffness) || !isfinite(damping) || !(stiffness > 0.0)) {
        leave_out(tell, "the limits of joint '%s', whose solref is none",
                  name_of(model, mjOBJ_JOINT, joint));
        return;
    }
    json_object_set_new(object, "range", json_pack("[f, f]", range[0] - zero, range[1] - zero));
    json_object_set_new(object, "limit_stiffness", json_real(stiffness));
    json_object_set_new(object, "limit_damping", json_real(damping));
}

static json_t *joint_object(const Tell *tell, int joint)
{
    static const char *const KINDS[] = {"free", "ball", "slide", "hinge"};
    const mjModel *model = tell->model;
    const int kind = model->jnt_type[joint];
    const int freedom = model->jnt_dofadr[joint];
    if (kind >= mjJNT_SLIDE && !(mju_norm3(tell->data->xaxis + 3 * joint) > 0.5)) {
        driver_refuse("joint '%s' whose axis has no direction", name_of(model, mjOBJ_JOINT, joint));
    }
    json_t *object = json_pack(
        "{s:o, s:s, s:i, s:o, s:o, s:f, s:f, s:f}", "name", name_string(model, mjOBJ_JOINT, joint),
        "kind", KINDS[kind], "body", tell->numbers[model->jnt_bodyid[joint]], "position_m",
        vector(tell->data->xanchor + 3 * joint), "axis", vector(tell->data->xaxis + 3 * joint),
        "damping", model->dof_damping[freedom], "friction", model->dof_frictionloss[freedom],
        "armature", model->dof_armature[freedom]);
    if (kind == mjJNT_SLIDE || kind == mjJNT_HINGE) {
        const int at = model->jnt_qposadr[joint];
        const mjtNum zero = model->qpos0[at];
        json_object_set_new(object, "zero", json_real(zero));
        json_object_set_new(object, "stiffness", json_real(model->jnt_stiffness[joint]));
        json_object_set_new(object, "relaxed", json_real(model->qpos_spring[at] - zero));
        add_limits(tell, joint, zero, object);
    } else if (model->jnt_stiffness[joint] > 0.0 || model->jnt_limited[joint]) {
        leave_out(tell, "spring or limits of joint '%s', which is a %s",
                  name_of(model, mjOBJ_JOINT, joint), KINDS[kind]);
    }
    return object;
}

static json_t *joints_array(const Tell *tell)
{
    json_t *joints = json_array();
    for (int i = 0; i < tell->model->njnt; i++) {
        append(joints, joint_object(tell, i), "joint", name_of(tell->model, mjOBJ_JOINT, i));
    }
    return joints;
}

// An equality by its name; where it has none, as most have, by what it holds.
static const char *equality_words(const mjModel *model, int id, char room[WORDS_SIZE])
{
    const char *name = name_of(model, mjOBJ_EQUALITY, id);
    const mjtEq type = (mjtEq)model->eq_type[id];
    const int kind = type == mjEQ_JOINT    ? mjOBJ_JOINT
                     : type == mjEQ_TENDON ? mjOBJ_TENDON
                                           : mjOBJ_BODY;
    const int second = model->eq_obj2id[id];
    if (name[0] != '\0') {
        snprintf(room, WORDS_SIZE, "'%s'", name);
    } else {
        snprintf(room, WORDS_SIZE, "of '%s'%s%s%s", name_of(model, kind, model->eq_obj1id[id]),
                 second >= 0 ? " and '" : "", second >= 0 ? name_of(model, kind, second) : "",
                 second >= 0 ? "'" : "");
    }
    return room;
}

// Points that are held together, and joints that go together.
static void add_equality(const Tell *tell, int id, json_t *loops, json_t *couplings)
{
    const mjModel *model = tell->model;
    const int first = model->eq_obj1id[id];
    const int second = model->eq_obj2id[id];
    const mjtNum *data = model->eq_data + mjNEQDATA * id;
    const char *name = name_of(model, mjOBJ_EQUALITY, id);
    char words[WORDS_SIZE];
    if (!model->eq_active[id]) {
        leave_out(tell, "equality %s, which is not active", equality_words(model, id, words));
    } else if (model->eq_type[id] == mjEQ_CONNECT) {
        mjtNum place[3];
        mju_rotVecMat(place, data, tell->data->xmat + 9 * first);
        mju_addTo3(place, tell->data->xpos + 3 * first);
        append(loops,
               json_pack("{s:o, s:i, s:i, s:o}", "name", name_string(model, mjOBJ_EQUALITY, id),
                         "body_a", tell->numbers[first], "body_b",
                         second > 0 ? tell->numbers[second] : -1, "position_m", vector(place)),
               "equality", name);
    } else if (model->eq_type[id] == mjEQ_JOINT && second >= 0) {
        const bool is_straight =
            data[0] == 0.0 && data[2] == 0.0 && data[3] == 0.0 && data[4] == 0.0 && data[1] != 0.0;
        json_array_append_new(couplings, json_pack("{s:o, s:i, s:i, s:f, s:b}", "name",
                                                   name_string(model, mjOBJ_EQUALITY, id),
                                                   "joint_a", first, "joint_b", second, "ratio",
                                                   data[1], "is_straight", is_straight));
    } else if (model->eq_type[id] == mjEQ_JOINT) {
        leave_out(tell, "equality %s, which holds joint '%s' at a value",
                  equality_words(model, id, words), name_of(model, mjOBJ_JOINT, first));
    } else {
        leave_out(tell, "equality %s, a %s", equality_words(model, id, words),
                  model->eq_type[id] == mjEQ_WELD ? "weld" : "coupling of tendons");
    }
}

static int joint_named(const mjModel *model, const char *name)
{
    return name[0] != '\0' ? mj_name2id(model, mjOBJ_JOINT, name) : -1;
}

static void add_mimics(const Tell *tell, json_t *couplings)
{
    for (size_t i = 0; i < tell->urdf->mimic_count; i++) {
        const UrdfMimic *mimic = &tell->urdf->mimics[i];
        const int first = joint_named(tell->model, mimic->joint);
        const int second = joint_named(tell->model, mimic->followed);
        if (first < 0 || second < 0) {
            leave_out(tell, "joint '%s' mimics '%s', of which one is not there", mimic->joint,
                      mimic->followed);
            continue;
        }
        json_array_append_new(
            couplings, json_pack("{s:s, s:i, s:i, s:f, s:b}", "name", "", "joint_a", first,
                                 "joint_b", second, "ratio", mimic->multiplier, "is_straight",
                                 mimic->offset == 0.0 && mimic->multiplier != 0.0));
    }
}

// What an actuator does: its force at control 0 is -(stiffness) q - (damping) q', and gain times
// the control besides, on its joint, transmission included.
static void add_actuator(const Tell *tell, int id, json_t *actuators)
{
    const mjModel *model = tell->model;
    const mjtNum gear = model->actuator_gear[6 * id];
    const mjtNum *bias = model->actuator_biasprm + mjNBIAS * id;
    const int joint = model->actuator_trnid[2 * id];
    const bool is_along = model->actuator_trntype[id] == mjTRN_JOINT ||
                          model->actuator_trntype[id] == mjTRN_JOINTINPARENT;
    const char *name = name_of(model, mjOBJ_ACTUATOR, id);
    const bool is_affine = model->actuator_biastype[id] == mjBIAS_AFFINE;
    if (!is_along || model->jnt_type[joint] < mjJNT_SLIDE ||
        model->actuator_gaintype[id] != mjGAIN_FIXED ||
        (!is_affine && model->actuator_biastype[id] != mjBIAS_NONE)) {
        leave_out(tell, "actuator '%s', which is no motor or servo of a hinge or slide", name);
        return;
    }
    const mjtNum scale = is_affine ? gear * gear : 0.0;
    json_t *object = json_pack(
        "{s:o, s:i, s:f, s:f, s:f, s:f}", "name", name_string(model, mjOBJ_ACTUATOR, id), "joint",
        joint, "gain", gear * model->actuator_gainprm[mjNGAIN * id], "stiffness", -bias[1] * scale,
        "damping", -bias[2] * scale, "constant", is_affine ? gear * bias[0] : 0.0);
    if (model->actuator_ctrllimited[id]) {
        const mjtNum *range = model->actuator_ctrlrange + 2 * id;
        json_object_set_new(object, "control", json_pack("[f, f]", range[0], range[1]));
    }
    if (model->actuator_forcelimited[id] && scale > 0.0) {
        leave_out(tell, "the force limit of actuator '%s'", name);
    }
    if (model->actuator_dyntype[id] != mjDYN_NONE) {
        leave_out(tell, "the dynamics of actuator '%s'", name);
    }
    append(actuators, object, "actuator", name);
}

// What else the model has.
static void leave_out_the_rest(const Tell *tell)
{
    const mjModel *model = tell->model;
    int colliding = 0;
    for (int i = 0; i < model->ngeom; i++) {
        colliding += model->geom_contype[i] != 0 || model->geom_conaffinity[i] != 0 ? 1 : 0;
    }
    if (colliding > 0) {
        leave_out(tell, "contacts of bodies: nothing collides, as %d of the shapes could",
                  colliding);
    }
    for (int i = 0; i < model->ntendon; i++) {
        leave_out(tell, "tendon '%s'", name_of(model, mjOBJ_TENDON, i));
    }
    if (model->opt.density > 0.0 || model->opt.viscosity > 0.0) {
        leave_out(tell, "the fluid around the bodies (density, viscosity)");
    }
    for (int i = 0; i < model->nkey; i++) {
        leave_out(tell,
                  "keyframe '%s': the posture is that of the file, in which all joints are as "
                  "drawn",
                  name_of(model, mjOBJ_KEY, i));
    }
}

static json_t *model_object(const Tell *tell)
{
    json_t *loops = json_array();
    json_t *couplings = json_array();
    json_t *actuators = json_array();
    number_bodies(tell);
    for (int i = 0; i < tell->model->neq; i++) {
        add_equality(tell, i, loops, couplings);
    }
    add_mimics(tell, couplings);
    for (int i = 0; i < tell->model->nu; i++) {
        add_actuator(tell, i, actuators);
    }
    json_t *bodies = bodies_array(tell);
    json_t *joints = joints_array(tell);
    leave_out_the_rest(tell);
    return json_pack("{s:{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:O}}", "model", "format",
                     tell->urdf->is_urdf ? "URDF" : "MJCF", "gravity_m_s2",
                     vector(tell->model->opt.gravity), "bodies", bodies, "joints", joints, "loops",
                     loops, "couplings", couplings, "actuators", actuators, "left_out",
                     tell->left_out);
}

static char *read_text(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    char *text = calloc(FILE_MOST + 1, 1);
    if (file == NULL || text == NULL) {
        driver_fail(file == NULL ? "the file cannot be read" : "there is no memory");
    }
    *size = fread(text, 1, FILE_MOST, file);
    if (ferror(file) || fgetc(file) != EOF) {
        driver_refuse("a file of more than %d MB", FILE_MOST >> 20);
    }
    fclose(file);
    return text;
}

// By MuJoCo: a URDF from memory, without its shapes.
static mjModel *load(const char *path, const Urdf *urdf, const char *text, size_t size, char *words)
{
    static const char NAME[] = "robot.urdf";
    if (!urdf->is_urdf) {
        return mj_loadXML(path, NULL, words, WORDS_SIZE);
    }
    mjVFS *files = calloc(1, sizeof *files);
    if (files == NULL) {
        driver_fail("there is no memory");
    }
    mj_defaultVFS(files);
    if (mj_makeEmptyFileVFS(files, NAME, (int)size) != 0) {
        driver_fail("MuJoCo does not take a model of %zu bytes", size);
    }
    memcpy(files->filedata[mj_findFileVFS(files, NAME)], text, size);
    mjModel *model = mj_loadXML(NAME, files, words, WORDS_SIZE);
    mj_deleteVFS(files);
    free(files);
    return model;
}

// What MuJoCo says on several lines, on one.
static void make_one_line(char *words)
{
    size_t length = strlen(words);
    while (length > 0 && strchr(" \n\r", words[length - 1]) != NULL) {
        words[--length] = '\0';
    }
    for (char *at = words; *at != '\0'; at++) {
        *at = *at == '\n' || *at == '\r' || *at == '\t' ? ' ' : *at;
    }
}

// Ends with what MuJoCo says of a model that it does not take, and what that may come of.
static void fail_to_load(const char *words, bool is_urdf)
{
    char more[64] = "";
    if (is_urdf && strstr(words, "mass and inertia") != NULL) {
        snprintf(more, sizeof more, " (every link of a URDF that moves needs <inertial>)");
    } else if (strstr(words, "unrecognized") != NULL) {
        snprintf(more, sizeof more, " (this is MuJoCo %s; later ones know more)",
                 mj_versionString());
    }
    driver_fail("%s%s", words, more);
}

static void pass_over(const char *words)
{
    (void)words;
}

int mujoco_tell_model(const char *path)
{
    Urdf urdf;
    size_t size;
    char words[WORDS_SIZE] = "";
    mju_user_warning = pass_over;
    char *text = read_text(path, &size);
    urdf_prepare(text, size, &urdf);
    mjModel *model = load(path, &urdf, text, size, words);
    if (model == NULL) {
        make_one_line(words);
        fail_to_load(words, urdf.is_urdf);
    }
    mjData *data = mj_makeData(model);
    mj_kinematics(model, data);
    Tell tell = {.model = model,
                 .data = data,
                 .urdf = &urdf,
                 .numbers = calloc((size_t)model->nbody, sizeof *tell.numbers),
                 .left_out = json_array()};
    if (tell.numbers == NULL) {
        driver_fail("there is no memory");
    }
    json_t *answer = model_object(&tell);
    if (answer == NULL) {
        driver_fail("the model has numbers that are not finite");
    }
    driver_answer(answer);
    json_decref(answer);
    json_decref(tell.left_out);
    free(tell.numbers);
    mj_deleteData(data);
    mj_deleteModel(model);
    free(text);
    return 0;
}
