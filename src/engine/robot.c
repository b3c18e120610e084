// Asks a driver what mechanism a model of its engine is, and reads the answer.
//
// Nothing in the answer is believed: numbers are finite, bodies and joints are there, and a parent
// comes before its body.
#include "engine/robot.h"

#include "base/memory.h"
#include "base/text.h"
#include "engine/converse.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// MuJoCo compiles models of thousands of bodies in seconds
static const double READ_LIMIT_S = 60.0;
enum { READ_OUTPUT_MOST = 1 << 26, BODY_MOST = 100000 };

typedef struct RobotReply {
    json_t *model; // NULL: not yet
    char *fault;   // why there is none
    size_t lines;
} RobotReply;

static char *copy_text(const char *text)
{
    const size_t size = strlen(text) + 1;
    return memcpy(memory_plain(size, 1), text, size);
}

// Takes a line: what the driver is, then the model or why there is none.
static bool take_line(char *line, size_t size, void *context, Err *err)
{
    RobotReply *reply = context;
    json_t *object = json_loadb(line, size, 0, NULL);
    bool is_known = false;
    if (reply->lines++ == 0) {
        is_known = json_is_integer(json_object_get(object, "jointplay-driver"));
    } else {
        json_t *model = json_object_get(object, "model");
        const char *failed = json_string_value(json_object_get(object, "failed"));
        const char *refused = json_string_value(json_object_get(object, "refused"));
        if (json_is_object(model) && reply->model == NULL) {
            reply->model = json_incref(model);
        }
        if ((failed != NULL || refused != NULL) && reply->fault == NULL) {
            reply->fault = copy_text(failed != NULL ? failed : refused);
        }
        is_known = reply->model != NULL || reply->fault != NULL;
    }
    json_decref(object);
    return is_known || err_set(err, ERR_SOLVER, "wrote a line that is none of the protocol");
}

// The answer of the driver, a model, which the caller gives back; or NULL.
static json_t *ask(const EngineDriver *driver, const char *path, Err *err)
{
    RobotReply reply = {.model = NULL};
    char *whole = realpath(path, NULL);
    json_t *request = json_pack("{s:i, s:s, s:s}", "jointplay-driver", 1, "ask", "model", "file",
                                whole != NULL ? whole : path);
    free(whole);
    if (request == NULL) {
        err_set(err, ERR_FILE, "the path '%s' is no text", path);
        return NULL;
    }
    char *text = json_dumps(request, JSON_COMPACT);
    Err own = {0};
    const Converse with = {
        .program = driver->program,
        .input = text,
        .input_size = strlen(text),
        .time_limit_s = READ_LIMIT_S,
        .output_most = READ_OUTPUT_MOST,
        .take = take_line,
        .context = &reply,
    };
    const bool is_answered = converse(&with, &own);
    json_decref(request);
    free(text);
    if (!is_answered) {
        err_set(err, ERR_SOLVER, "%s: the driver '%s', as it read the model, %s", path,
                driver->name, own.text);
    } else if (reply.fault != NULL) {
        err_set(err, ERR_CASE, "%s: %s", path, reply.fault);
    } else if (reply.model == NULL) {
        err_set(err, ERR_SOLVER, "the driver '%s' does not read models", driver->name);
    }
    free(reply.fault);
    if (!is_answered && reply.model != NULL) {
        json_decref(reply.model);
        reply.model = NULL;
    }
    return reply.model;
}

// A number, which is finite: JSON has no other.
static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static Vec3 vector(const json_t *object, const char *key)
{
    const json_t *of = json_object_get(object, key);
    return (Vec3){json_number_value(json_array_get(of, 0)),
                  json_number_value(json_array_get(of, 1)),
                  json_number_value(json_array_get(of, 2))};
}

static void read_pair(const json_t *object, const char *key, double pair[2])
{
    for (size_t i = 0; i < 2; i++) {
        pair[i] = json_number_value(json_array_get(json_object_get(object, key), i));
    }
}

static void read_name(const json_t *object, char name[ROBOT_NAME_SIZE])
{
    const char *text = json_string_value(json_object_get(object, "name"));
    text_copy(name, ROBOT_NAME_SIZE, text != NULL ? text : "");
}

// A number of a body or joint, below a count; or -1.
static int index_of(const json_t *object, const char *key, size_t count)
{
    const json_int_t index = json_integer_value(json_object_get(object, key));
    return index >= 0 && index < (json_int_t)count ? (int)index : -1;
}

static bool read_body(const json_t *object, size_t number_of_it, RobotBody *body)
{
    const json_t *inertia = json_object_get(object, "inertia_kg_m2");
    double of[6];
    for (size_t i = 0; i < 6; i++) {
        of[i] = json_number_value(json_array_get(inertia, i));
    }
    *body = (RobotBody){.parent = index_of(object, "parent", number_of_it),
                        .mass = number(object, "mass_kg"),
                        .centre = vector(object, "position_m"),
                        .inertia = {{{of[0], of[3], of[4]}, //
                                     {of[3], of[1], of[5]},
                                     {of[4], of[5], of[2]}}}};
    read_name(object, body->name);
    return body->mass > 0.0;
}

static bool read_joint(const json_t *object, size_t body_count, RobotJoint *joint)
{
    static const char *const KINDS[] = {"hinge", "slide", "ball", "free"};
    const char *kind = json_string_value(json_object_get(object, "kind"));
    int found = -1;
    for (int i = 0; kind != NULL && i < 4; i++) {
        found = strcmp(kind, KINDS[i]) == 0 ? i : found;
    }
    *joint = (RobotJoint){.kind = found < 0 ? ROBOT_FREE : (RobotJointKind)found,
                          .body = index_of(object, "body", body_count),
                          .place = vector(object, "position_m"),
                          .axis = vector(object, "axis"),
                          .zero = number(object, "zero"),
                          .is_limited = json_is_array(json_object_get(object, "range")),
                          .limit_stiffness = number(object, "limit_stiffness"),
                          .limit_damping = number(object, "limit_damping"),
                          .stiffness = number(object, "stiffness"),
                          .relaxed = number(object, "relaxed"),
                          .damping = number(object, "damping"),
                          .friction = number(object, "friction"),
                          .armature = number(object, "armature")};
    read_pair(object, "range", joint->range);
    read_name(object, joint->name);
    return found >= 0 && joint->body >= 0 &&
           (joint->kind > ROBOT_SLIDE || fabs(vec3_dot(joint->axis, joint->axis) - 1.0) < 1e-6);
}

static void read_loop(const json_t *object, size_t body_count, RobotLoop *loop)
{
    *loop = (RobotLoop){
        .bodies = {index_of(object, "body_a", body_count), index_of(object, "body_b", body_count)},
        .place = vector(object, "position_m")};
    read_name(object, loop->name);
}

static bool read_coupling(const json_t *object, size_t joint_count, RobotCoupling *coupling)
{
    *coupling =
        (RobotCoupling){.joints = {index_of(object, "joint_a", joint_count),
                                   index_of(object, "joint_b", joint_count)},
                        .ratio = number(object, "ratio"),
                        .is_straight = json_is_true(json_object_get(object, "is_straight"))};
    read_name(object, coupling->name);
    return coupling->joints[0] >= 0 && coupling->joints[1] >= 0;
}

static bool read_actuator(const json_t *object, size_t joint_count, RobotActuator *actuator)
{
    *actuator = (RobotActuator){.joint = index_of(object, "joint", joint_count),
                                .gain = number(object, "gain"),
                                .constant = number(object, "constant"),
                                .stiffness = number(object, "stiffness"),
                                .damping = number(object, "damping"),
                                .is_limited = json_is_array(json_object_get(object, "control"))};
    read_pair(object, "control", actuator->control);
    read_name(object, actuator->name);
    return actuator->joint >= 0;
}

// The parts of a model, by kind; false where one of them is none.
static bool read_parts(const json_t *model, Robot *robot)
{
    const json_t *bodies = json_object_get(model, "bodies");
    const json_t *joints = json_object_get(model, "joints");
    const json_t *loops = json_object_get(model, "loops");
    const json_t *couplings = json_object_get(model, "couplings");
    const json_t *actuators = json_object_get(model, "actuators");
    robot->bodies = memory_zeroed(json_array_size(bodies), sizeof *robot->bodies);
    robot->joints = memory_zeroed(json_array_size(joints), sizeof *robot->joints);
    robot->loops = memory_zeroed(json_array_size(loops), sizeof *robot->loops);
    robot->couplings = memory_zeroed(json_array_size(couplings), sizeof *robot->couplings);
    robot->actuators = memory_zeroed(json_array_size(actuators), sizeof *robot->actuators);
    bool is_whole = json_array_size(bodies) <= BODY_MOST;
    for (size_t i = 0; is_whole && i < json_array_size(bodies); i++) {
        is_whole = read_body(json_array_get(bodies, i), i, &robot->bodies[robot->body_count++]);
    }
    for (size_t i = 0; is_whole && i < json_array_size(joints); i++) {
        is_whole = read_joint(json_array_get(joints, i), robot->body_count,
                              &robot->joints[robot->joint_count++]);
    }
    for (size_t i = 0; is_whole && i < json_array_size(loops); i++) {
        read_loop(json_array_get(loops, i), robot->body_count, &robot->loops[robot->loop_count++]);
    }
    for (size_t i = 0; is_whole && i < json_array_size(couplings); i++) {
        is_whole = read_coupling(json_array_get(couplings, i), robot->joint_count,
                                 &robot->couplings[robot->coupling_count++]);
    }
    for (size_t i = 0; is_whole && i < json_array_size(actuators); i++) {
        is_whole = read_actuator(json_array_get(actuators, i), robot->joint_count,
                                 &robot->actuators[robot->actuator_count++]);
    }
    return is_whole;
}

static void read_left_out(const json_t *model, Robot *robot)
{
    const json_t *sentences = json_object_get(model, "left_out");
    robot->left_out = memory_zeroed(json_array_size(sentences), sizeof *robot->left_out);
    for (size_t i = 0; i < json_array_size(sentences); i++) {
        const char *sentence = json_string_value(json_array_get(sentences, i));
        if (sentence != NULL) {
            robot->left_out[robot->left_out_count++] = copy_text(sentence);
        }
    }
}

static bool read_model(const json_t *model, Robot *robot)
{
    const char *format = json_string_value(json_object_get(model, "format"));
    text_copy(robot->format, sizeof robot->format, format != NULL ? format : "");
    robot->gravity = vector(model, "gravity_m_s2");
    read_left_out(model, robot);
    return read_parts(model, robot);
}

bool robot_read(const EngineDriver *driver, const char *path, Robot *robot, Err *err)
{
    struct stat status;
    *robot = (Robot){.body_count = 0};
    if (stat(path, &status) != 0) {
        return err_set(err, ERR_FILE, "%s: %s", path, strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
        return err_set(err, ERR_FILE, "%s is no file", path);
    }
    json_t *model = ask(driver, path, err);
    if (model == NULL) {
        return false;
    }
    const bool is_whole = read_model(model, robot);
    json_decref(model);
    if (!is_whole) {
        robot_finish(robot);
        return err_set(err, ERR_SOLVER, "%s: the driver '%s' tells of a model that is none", path,
                       driver->name);
    }
    return true;
}

void robot_finish(Robot *robot)
{
    for (size_t i = 0; i < robot->left_out_count; i++) {
        free(robot->left_out[i]);
    }
    free(robot->left_out);
    free(robot->actuators);
    free(robot->couplings);
    free(robot->loops);
    free(robot->joints);
    free(robot->bodies);
    *robot = (Robot){.body_count = 0};
}
