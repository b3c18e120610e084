// Reads the answer of a driver, line by line, into a trajectory (docs/drivers.md).
//
// A run is believed only where its answer is whole and of this case: every sample is there, at its
// time, finite, follows from the one before, has the drive's angle and joints that hold. An engine
// that starts over or flies apart is so a run that failed, whatever it says itself.
#include "engine/protocol.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/printable.h"
#include "base/text.h"
#include "engine/features.h"
#include "engine/row.h"
#include "model/joint_rows.h"
#include "ode/stepping.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// rad: a driven body that is further off is not driven as the case has it
static const double DRIVE_OFF_MOST = 1e-2;

// of a body's reach: an ideal joint that opens by more no longer is one
static const double OPENING_MOST = 0.05;

// how many times further than its speeds at both samples say a body may have gone between them,
// and of the mechanism's size, which is let go in any case: impacts change speeds in between
static const double JUMP_MOST = 20.0;
static const double JUMP_FLOOR = 1e-3;

// contacts that may begin in a step of the case's, and steps of the engine in it: engines divide it
static const double SHARES_MOST = 1e3;

// s: no step of an engine is calculated in less
static const double STEP_WALL_LEAST_S = 1e-9;

// of the time that a conversation has taken, and s: by how much two clocks may differ over it
static const double CLOCK_RATIO = 1.01;
static const double CLOCK_OFF_S = 1e-3;

enum {
    BODY_NUMBERS = 6,  // x, y, angle and their rates
    JOINT_NUMBERS = 2, // force on body b
    TOTAL_NUMBERS = 3, // of a joint: largest force and depth, contacts begun
    SHOWN_MOST = 60,   // bytes of a line that is shown
};

EngineReply engine_reply_start(const Scenario *scenario, EngineDriver *driver,
                               Trajectory *trajectory, EngineSaid *said)
{
    EngineReply reply = {
        .scenario = scenario,
        .driver = driver,
        .trajectory = trajectory,
        .said = said,
        .began_s = clock_now_s(),
    };
    if (scenario != NULL) {
        const Linkage *linkage = &scenario->linkage;
        reply.sample = sample_create(linkage);
        reply.bodies = memory_zeroed(BODY_NUMBERS * linkage->body_count, sizeof *reply.bodies);
        reply.joints = memory_zeroed(TOTAL_NUMBERS * linkage->joint_count, sizeof *reply.joints);
    }
    return reply;
}

void engine_reply_finish(EngineReply *reply)
{
    if (reply->scenario != NULL) {
        sample_free(&reply->sample);
    }
    free(reply->bodies);
    free(reply->joints);
}

static bool refuse_key(Err *err, const char *object, const char *key, const char *what)
{
    return err_set(err, ERR_SOLVER, "its line '%s' has no '%s', which has to be %s", object, key,
                   what);
}

static bool read_text(const json_t *object, const char *in, const char *key, char *target,
                      size_t size, Err *err)
{
    const json_t *value = json_object_get(object, key);
    if (!json_is_string(value)) {
        return refuse_key(err, in, key, "a text");
    }
    // it is shown in tables, pages and messages
    char *shown = printable_copy(json_string_value(value), false);
    text_copy(target, size, shown);
    free(shown);
    return true;
}

static bool read_number(const json_t *object, const char *in, const char *key, double *number,
                        Err *err)
{
    const json_t *value = json_object_get(object, key);
    if (!json_is_number(value)) {
        return refuse_key(err, in, key, "a number");
    }
    *number = json_number_value(value);
    return true;
}

// Reads rows of so many numbers each.
static bool read_rows(const json_t *object, const char *line, const char *key, size_t rows,
                      size_t columns, double *numbers, Err *err)
{
    const json_t *array = json_object_get(object, key);
    EngineRow as = {.line = line, .field = key, .known = columns, .count = columns};
    bool is_right = engine_row_count(array, &as, rows, err);
    for (; is_right && as.index < rows; as.index++) {
        is_right = engine_row_read(json_array_get(array, as.index), &as,
                                   numbers + columns * as.index, err);
    }
    return is_right;
}

// What a driver takes in each of its ways; words that are not known are passed over.
static bool take_words(EngineDriver *driver, const json_t *takes, Err *err)
{
    for (size_t i = 0; i < driver->way_count; i++) {
        const json_t *words = json_object_get(takes, driver->ways[i]);
        driver->takes[i] = 0;
        for (size_t k = 0; k < json_array_size(words); k++) {
            const char *word = json_string_value(json_array_get(words, k));
            if (word == NULL) {
                return refuse_key(err, "jointplay-driver", "takes", "lists of words by way");
            }
            const EngineFeature feature = engine_feature_of(word);
            driver->takes[i] |= feature < ENGINE_FEATURE_COUNT ? 1U << feature : 0U;
        }
    }
    return takes == NULL || json_is_object(takes) ||
           refuse_key(err, "jointplay-driver", "takes", "lists of words by way");
}

static bool take_hello(EngineReply *reply, const json_t *line, Err *err)
{
    EngineDriver *driver = reply->driver;
    const json_t *protocol = json_object_get(line, "jointplay-driver");
    if (!json_is_integer(protocol) || json_integer_value(protocol) < 1 ||
        json_integer_value(protocol) > ENGINE_PROTOCOL) {
        return err_set(err, ERR_SOLVER, "its first line is not of protocol 1 to %d",
                       ENGINE_PROTOCOL);
    }
    driver->protocol = (int)json_integer_value(protocol);
    static const char HELLO[] = "jointplay-driver";
    if (!read_text(line, HELLO, "engine", driver->engine, sizeof driver->engine, err) ||
        !read_text(line, HELLO, "version", driver->version, sizeof driver->version, err) ||
        !read_text(line, HELLO, "precision", driver->precision, sizeof driver->precision, err)) {
        return false;
    }
    const json_t *ways = json_object_get(line, "ways");
    const size_t count = json_array_size(ways);
    if (count == 0 || count > ENGINE_WAY_MAX) {
        return refuse_key(err, HELLO, "ways", "a list of one to eight names");
    }
    for (size_t i = 0; i < count; i++) {
        const char *way = json_string_value(json_array_get(ways, i));
        if (way == NULL || strlen(way) >= ENGINE_NAME_SIZE || !engine_is_name(way)) {
            return refuse_key(err, HELLO, "ways", "a list of names such as 'native'");
        }
        text_copy(driver->ways[i], sizeof driver->ways[i], way);
    }
    driver->way_count = count;
    reply->is_introduced = true;
    return take_words(driver, json_object_get(line, "takes"), err);
}

// The size of a mechanism: the largest reach of a body, m.
static double size_of(const Trajectory *run)
{
    double size = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        size = fmax(size, run->reach[i]);
    }
    return size;
}

// The same as a bound, which there is none of where bodies have no reach.
static double size_most(const Trajectory *run)
{
    const double size = size_of(run);
    return size > 0.0 ? size : INFINITY;
}

// Whether a body goes no further in a step of the case's than a thousand times the mechanism's
// size, and turns no more than by a thousand radians: nothing that is stepped so is a motion.
static bool check_rate(const EngineReply *reply, const char *line, double time_s, size_t body,
                       EngineRates rates, Err *err)
{
    const double step_s = reply->scenario->run.step;
    const double speed = vec2_length(rates.velocity);
    const double speed_most = SHARES_MOST * size_most(reply->trajectory) / step_s;
    const double omega_most = SHARES_MOST / step_s;
    return (speed <= speed_most && fabs(rates.omega) <= omega_most) ||
           err_set(err, ERR_SOLVER,
                   "its line '%s' of %.6g s has as 'bodies[%zu]' one that goes at %.3g m/s and "
                   "%.3g rad/s: at most %.3g and %.3g are believed",
                   line, time_s, body, speed, rates.omega, speed_most, omega_most);
}

static bool check_rates(const EngineReply *reply, double time_s, Err *err)
{
    for (size_t i = 0; i < reply->trajectory->body_count; i++) {
        const Motion *of = &reply->sample.bodies[i];
        if (!check_rate(reply, "sample", time_s, i, (EngineRates){of->velocity, of->omega}, err)) {
            return false;
        }
    }
    return true;
}

// Whether the last record can be.
static bool check_record(const EngineReply *reply, Err *err)
{
    const EngineRecords *records = reply->records;
    const size_t last = records->count - 1;
    const double end_s = engine_records_end(records, last);
    const double most = size_most(reply->trajectory);
    for (size_t i = 0; i < records->body_count; i++) {
        if (!check_rate(reply, "step", end_s, i, engine_records_body(records, last, i), err)) {
            return false;
        }
    }
    for (size_t i = 0; i < records->joint_count; i++) {
        const EngineTouch touch = engine_records_joint(records, last, i);
        // the gap of a stop may be larger than any body, and that of a hinge is an angle
        const bool is_bounded = joint_has_hole(reply->scenario->linkage.joints[i].kind);
        if (is_bounded && (vec2_length(touch.eccentricity) > most || touch.depth_max > most)) {
            return err_set(err, ERR_SOLVER,
                           "its line 'step' of %.6g s has as 'joints[%zu]' an eccentricity or a "
                           "depth above the longest reach of a body, %.3g m",
                           end_s, i, most);
        }
    }
    return true;
}

// Whether the bodies went on from the sample before.
static bool check_jump(const EngineReply *reply, Err *err)
{
    const Trajectory *run = reply->trajectory;
    const Sample *now = &reply->sample;
    if (reply->samples == 0) {
        return true;
    }
    const size_t last = reply->samples - 1;
    const double since_s = now->time_s - run->times[last];
    double fastest = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *before = trajectory_motion(run, last, i);
        fastest = fmax(fastest, fmax(vec2_length(before->velocity), //
                                     vec2_length(now->bodies[i].velocity)));
        fastest =
            fmax(fastest, run->reach[i] * fmax(fabs(before->omega), fabs(now->bodies[i].omega)));
    }
    const double most = JUMP_MOST * since_s * fastest + JUMP_FLOOR * size_of(run);
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *before = trajectory_motion(run, last, i);
        const double gone = vec2_length(vec2_sub(now->bodies[i].position, before->position));
        if (!(gone <= most)) {
            return err_set(err, ERR_SOLVER,
                           "after %.6g s '%s' is suddenly %.3g m away: the engine started over, or "
                           "its motion diverged",
                           now->time_s, run->linkage.bodies[i].name, gone);
        }
        const double turned = now->bodies[i].angle - before->angle;
        if (!(run->reach[i] * fabs(turned) <= most)) {
            return err_set(err, ERR_SOLVER,
                           "after %.6g s '%s' has suddenly turned by %.3g rad: the engine started "
                           "over, or its motion diverged",
                           now->time_s, run->linkage.bodies[i].name, turned);
        }
    }
    return true;
}

static bool check_drive(const EngineReply *reply, Err *err)
{
    const Linkage *linkage = &reply->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double turned = reply->sample.bodies[linkage_drive_body(linkage, i)].angle;
        const double off = turned - drive_angle(linkage_drive(linkage, i), reply->sample.time_s);
        if (!(fabs(off) <= DRIVE_OFF_MOST)) {
            return err_set(err, ERR_SOLVER, "after %.6g s its drive is %.3g rad off",
                           reply->sample.time_s, off);
        }
    }
    return true;
}

// Where a joint is in a sample. Returns how far its bodies are from where it holds them, m; 0 of
// one that holds nothing.
static double fill_place(EngineReply *reply, size_t joint)
{
    const Linkage *linkage = &reply->scenario->linkage;
    const Joint *of = &linkage->joints[joint];
    stepping_observe_joint(linkage, joint, &reply->sample);
    if (!joint_holds(of->kind)) {
        return 0.0;
    }
    JointRows rows;
    joint_rows_find(linkage, reply->sample.bodies, (int)joint, &rows);
    const double across =
        joint_slides(of->kind) ? fabs(rows.position[0]) : hypot(rows.position[0], rows.position[1]);
    return across - linkage_radial_clearance(of);
}

// Whether the ideal joints hold; keeps how far they open.
static bool check_joints(EngineReply *reply, Err *err)
{
    const Trajectory *run = reply->trajectory;
    const Linkage *linkage = &reply->scenario->linkage;
    const double most = OPENING_MOST * size_of(run);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double opening = fill_place(reply, i) - linkage_radial_clearance(joint);
        if (!(opening <= most)) {
            return err_set(err, ERR_SOLVER, "after %.6g s the joint '%s' is %.3g m apart",
                           reply->sample.time_s, joint->name, opening);
        }
        if (!linkage_has_play(joint)) {
            reply->said->opening_m = fmax(reply->said->opening_m, opening);
        }
    }
    return true;
}

static void fill_sample(EngineReply *reply, const double *bodies, const double *joints)
{
    const Linkage *linkage = &reply->scenario->linkage;
    Sample *sample = &reply->sample;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double *of = bodies + BODY_NUMBERS * i;
        sample->bodies[i] = (Motion){
            .position = {of[0], of[1]}, .angle = of[2], .velocity = {of[3], of[4]}, .omega = of[5]};
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Vec2 force = {joints[JOINT_NUMBERS * i], joints[JOINT_NUMBERS * i + 1]};
        sample->joints[i] = (JointState){.force_on_b = force, .force = vec2_length(force)};
        if (linkage_is_torsional(&linkage->joints[i])) {
            sample->joints[i] = (JointState){.moment_on_b = force.x, .force = fabs(force.x)};
        }
    }
    sample->crank_rad =
        linkage->driver.is_present ? drive_angle(&linkage->driver, sample->time_s) : 0.0;
}

static bool take_sample(EngineReply *reply, const json_t *line, Err *err)
{
    const Linkage *linkage = &reply->scenario->linkage;
    const Trajectory *run = reply->trajectory;
    double time_s = 0.0;
    if (!read_number(line, "sample", "sample", &time_s, err)) {
        return false;
    }
    if (reply->samples == run->sample_count) {
        return err_set(err, ERR_SOLVER, "has more than the %zu samples asked for",
                       run->sample_count);
    }
    const double asked_s = scenario_sample_time(reply->scenario, reply->samples);
    if (!(fabs(time_s - asked_s) <= 1e-9 * scenario_duration(reply->scenario))) {
        return err_set(err, ERR_SOLVER, "its sample %zu is of %.9g s, and was asked for at %.9g s",
                       reply->samples, time_s, asked_s);
    }
    double *bodies = reply->bodies;
    double *joints = reply->joints;
    if (!read_rows(line, "sample", "bodies", linkage->body_count, BODY_NUMBERS, bodies, err) ||
        !read_rows(line, "sample", "joints", linkage->joint_count, JOINT_NUMBERS, joints, err)) {
        return false;
    }
    reply->sample.time_s = asked_s;
    fill_sample(reply, bodies, joints);
    if (!check_rates(reply, time_s, err) || !check_drive(reply, err) || !check_jump(reply, err) ||
        !check_joints(reply, err)) {
        return false;
    }
    trajectory_store(reply->trajectory, reply->samples++, &reply->sample);
    return true;
}

// How many steps of the case's length a run has.
static double steps_of(const Scenario *scenario)
{
    return ceil(scenario_duration(scenario) / scenario->run.step);
}

// The totals of a joint: its largest force, N, deepest penetration, m, and contacts begun.
static bool take_totals(EngineReply *reply, const json_t *done, Err *err)
{
    Trajectory *run = reply->trajectory;
    double *totals = reply->joints;
    if (!read_rows(done, "done", "joints", run->joint_count, TOTAL_NUMBERS, totals, err)) {
        return false;
    }
    static const char *const NAMES[TOTAL_NUMBERS] = {"largest force", "deepest penetration",
                                                     "contacts begun"};
    const double contacts_most = SHARES_MOST * steps_of(reply->scenario);
    const double depth_most = size_most(run);
    for (size_t i = 0; i < TOTAL_NUMBERS * run->joint_count; i++) {
        const bool is_count = i % TOTAL_NUMBERS == TOTAL_NUMBERS - 1;
        const bool is_depth = i % TOTAL_NUMBERS == 1;
        if (!(totals[i] >= 0.0) || (is_depth && totals[i] > depth_most) ||
            (is_count && (totals[i] != floor(totals[i]) || totals[i] > contacts_most))) {
            return err_set(err, ERR_SOLVER, "says of '%s' that its %s is %.6g, which has to be %s",
                           reply->scenario->linkage.joints[i / TOTAL_NUMBERS].name,
                           NAMES[i % TOTAL_NUMBERS], totals[i],
                           is_count   ? "a whole number of at most 1000 a step"
                           : is_depth ? "0 or more, and not above the longest reach of a body"
                                      : "0 or more");
        }
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        run->joints[i].force_max.value = totals[TOTAL_NUMBERS * i];
        run->joints[i].penetration_max.value = totals[TOTAL_NUMBERS * i + 1];
        run->joints[i].impacts = (size_t)totals[TOTAL_NUMBERS * i + 2];
    }
    return true;
}

// Whether a run can have taken so many steps, and its time.
static bool check_effort(const EngineReply *reply, double steps, Err *err)
{
    const Trajectory *run = reply->trajectory;
    // a step may end at each sample besides
    const double steps_most = SHARES_MOST * (steps_of(reply->scenario) + (double)run->sample_count);
    if (!(steps >= 1.0 && steps == floor(steps) && steps <= steps_most)) {
        return err_set(err, ERR_SOLVER,
                       "says that its 'steps' are %g, which have to be a whole number from 1 to "
                       "%.3g: 1000 to each step of the case's and to each sample",
                       steps, steps_most);
    }
    const size_t records = reply->records != NULL ? reply->records->count : 0;
    // where contacts begin and end a step may be recorded in parts of the length asked for
    const double parts_most =
        records > 0 ? scenario_duration(reply->scenario) / reply->records->record_s : 0.0;
    if ((double)records > steps + (double)run->sample_count + parts_most) {
        return err_set(err, ERR_SOLVER, "says that its 'steps' are %g, and told of %zu", steps,
                       records);
    }
    const double most_s = CLOCK_RATIO * (clock_now_s() - reply->began_s) + CLOCK_OFF_S;
    const double least_s = STEP_WALL_LEAST_S * steps;
    return (run->wall_s >= least_s && run->wall_s <= most_s) ||
           err_set(
               err, ERR_SOLVER,
               "says that its 'wall_s' is %g, which has to be from %.3g, 1 ns to a step, to the "
               "%.3g that it took as a whole",
               run->wall_s, least_s, most_s);
}

static bool take_done(EngineReply *reply, const json_t *done, Err *err)
{
    Trajectory *run = reply->trajectory;
    double steps = 0.0;
    if (reply->samples != run->sample_count) {
        return err_set(err, ERR_SOLVER, "says that it is done after %zu of %zu samples",
                       reply->samples, run->sample_count);
    }
    if (!read_number(done, "done", "steps", &steps, err) ||
        !read_number(done, "done", "wall_s", &run->wall_s, err) || !take_totals(reply, done, err)) {
        return false;
    }
    if (!check_effort(reply, steps, err)) {
        return false;
    }
    if (json_object_get(done, "settings") != NULL &&
        !read_text(done, "done", "settings", reply->said->settings, sizeof reply->said->settings,
                   err)) {
        return false;
    }
    const json_t *model = json_object_get(done, "model");
    if (model != NULL && !json_is_string(model)) {
        return refuse_key(err, "done", "model", "a text");
    }
    if (model != NULL && reply->said->model != NULL && *reply->said->model == NULL) {
        *reply->said->model = strdup(json_string_value(model));
    }
    run->steps = (size_t)steps;
    reply->is_done = true;
    return true;
}

// A line that is JSON, by what it begins with.
static bool take_line(EngineReply *reply, const json_t *line, Err *err)
{
    const json_t *value;
    if (reply->is_done) {
        return err_set(err, ERR_SOLVER, "goes on after it said that it is done");
    }
    if (!reply->is_introduced) {
        return take_hello(reply, line, err);
    }
    if ((value = json_object_get(line, "failed")) != NULL) {
        const char *why = json_string_value(value);
        return err_set(err, ERR_SOLVER, "%s",
                       why != NULL && why[0] != '\0' ? why : "it does not say why");
    }
    if ((value = json_object_get(line, "refused")) != NULL) {
        const char *what = json_string_value(value);
        what = what != NULL ? what : "this case";
        if (reply->said != NULL) {
            reply->said->is_refused = true;
            text_copy(reply->said->refused, sizeof reply->said->refused, what);
        }
        return err_set(err, ERR_SOLVER, "does not take %s", what);
    }
    if (reply->scenario != NULL && json_object_get(line, "sample") != NULL) {
        return take_sample(reply, line, err);
    }
    if (reply->records != NULL && json_object_get(line, "step") != NULL) {
        return engine_records_take(reply->records, line, err) && check_record(reply, err);
    }
    if (reply->scenario != NULL && (value = json_object_get(line, "done")) != NULL) {
        return take_done(reply, value, err);
    }
    return err_set(err, ERR_SOLVER,
                   "wrote a line that has none of the keys 'sample', 'step', 'done', 'failed' and "
                   "'refused'%s",
                   json_object_get(line, "step") != NULL ? ", or a 'step' that was not asked for"
                                                         : "");
}

// The last key before a place in a line; empty where there is none.
static void key_before(const char *text, size_t place, char key[ENGINE_NAME_SIZE])
{
    size_t end = place;
    while (end > 1 && !(text[end - 1] == ':' && text[end - 2] == '"')) {
        end--;
    }
    size_t length = 0;
    while (end > 2 + length && text[end - 3 - length] != '"' && length + 1 < ENGINE_NAME_SIZE) {
        length++;
    }
    memcpy(key, text + (length > 0 ? end - 2 - length : 0), length);
    key[length] = '\0';
}

bool engine_reply_take(char *text, size_t size, void *context, Err *err)
{
    EngineReply *reply = context;
    json_error_t wrong = {.position = 0};
    json_t *line = json_loadb(text, size, 0, &wrong);
    if (!json_is_object(line)) {
        char key[ENGINE_NAME_SIZE];
        key_before(text, line == NULL && wrong.position > 0 ? (size_t)wrong.position : 0, key);
        json_decref(line);
        text[size < SHOWN_MOST ? size : SHOWN_MOST] = '\0';
        return err_set(err, ERR_SOLVER, "wrote a line that is no JSON object: '%s%s'%s%s%s", text,
                       size > SHOWN_MOST ? " ..." : "", key[0] != '\0' ? ", wrong at its '" : "",
                       key, key[0] != '\0' ? "'" : "");
    }
    const bool is_taken = take_line(reply, line, err);
    json_decref(line);
    return is_taken;
}

bool engine_reply_check(const EngineReply *reply, Err *err)
{
    if (!reply->is_introduced) {
        return err_set(err, ERR_SOLVER, "said nothing");
    }
    return reply->scenario == NULL || reply->is_done ||
           err_set(err, ERR_SOLVER, "ended after %zu of %zu samples", reply->samples,
                   reply->trajectory->sample_count);
}
