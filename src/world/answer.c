// How does a world answer to pushes in the places of its joints with play?
//
// By steps that are taken back: with a push in a row, beside one without. Rows are frozen where the
// bodies are kept, so that what a step changes of their rates is what it changes of speeds.
#include "world/answer.h"

#include "world/trial.h"
#include "world/work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// of what turns an impact round: less of a push is lost in rounding
static const double NEAR = 1e-3;

// of forces, in the shortest of contacts, with what it takes to read two nodes of it
static const double EVALUATIONS_LEAST = 100.0;

// of the rate of a row, in pairs of rows
static const double RATE_WORK = 30.0;

enum { BODY_NUMBERS = 6, INSIDE_ROWS = 4 /* of the kernel, at most, to one here */ };

static void count(const JpWorld *world, Answer *answer)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            answer->place_count++;
            answer->row_count += joint->places[i].row_count;
        }
    }
}

// Arrays of numbers, taken from one piece of memory.
static double *take(double **at, size_t size)
{
    double *taken = *at;
    *at += size;
    return taken;
}

static bool make_room(Answer *answer)
{
    const JpWorld *world = answer->world;
    count(world, answer);
    const size_t n = answer->row_count;
    const size_t body = BODY_NUMBERS * world->bodies.moving;
    const size_t numbers = (8 + INSIDE_ROWS) * n + n * n + (n + 1) * body;
    const size_t size = numbers * sizeof(double) + answer->place_count * sizeof(AnswerPlace) +
                        n * (sizeof(Direction *) + INSIDE_ROWS * sizeof(size_t));
    double *at = answer->memory = calloc(1, size + 1);
    if (at == NULL) {
        return false;
    }
    double **const by_row[] = {&answer->frozen, &answer->base,   &answer->found,  &answer->pushed,
                               &answer->net,    &answer->moment, &answer->rotors, &answer->free};
    for (size_t i = 0; i < sizeof by_row / sizeof *by_row; i++) {
        *by_row[i] = take(&at, n);
    }
    answer->signs = take(&at, INSIDE_ROWS * n);
    answer->columns = take(&at, n * n);
    answer->bodies = take(&at, n * body);
    answer->speeds = take(&at, body);
    answer->places = (AnswerPlace *)at;
    answer->rows = (const Direction **)(answer->places + answer->place_count);
    answer->inside = (size_t *)(answer->rows + n);
    return true;
}

void answer_free(Answer *answer)
{
    free(answer->memory);
    kernel_sums_free(&answer->sums);
    closing_free(&answer->closing);
    *answer = (Answer){0};
}

// Lists places and rows.
static void fill_places(Answer *answer)
{
    size_t place = 0;
    size_t row = 0;
    for (JpJoint *joint = answer->world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            Place *of = &joint->places[i];
            answer->places[place++] = (AnswerPlace){.joint = joint, .place = of, .first_row = row};
            for (size_t k = 0; k < of->row_count; k++, row++) {
                answer->rows[row] = &of->rows[k];
                answer->rotors[row] = 1.0 / joint->rotor.inertia;
            }
        }
    }
}

void answer_read_bodies(const JpWorld *world, double *speeds)
{
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID id = world->bodies.records[i].id;
        memcpy(&speeds[BODY_NUMBERS * i], dBodyGetLinearVel(id), 3 * sizeof(double));
        memcpy(&speeds[BODY_NUMBERS * i + 3], dBodyGetAngularVel(id), 3 * sizeof(double));
    }
}

void answer_read_rates(const Answer *answer, double *rates)
{
    for (size_t i = 0; i < answer->row_count; i++) {
        rates[i] = direction_rate(answer->rows[i]);
    }
}

// A step under the mean forces of impulses, and the rates after it.
JpStatus answer_step(const Answer *answer, double step, double *rates, JpError *error)
{
    for (size_t i = 0; i < answer->row_count; i++) {
        if (answer->pushed[i] != 0.0) {
            direction_push(answer->rows[i], answer->pushed[i] / step);
        }
    }
    REFUSAL_TRY(trial_step(answer->world, step, error));
    answer_read_rates(answer, rates);
    return JP_OK;
}

// How hard a place may press in the step: as its law does where its pin or its coordinate may get,
// and no harder than what turns an impact round with free bodies.
static double hardest(const Answer *answer, const AnswerPlace *of, double speed, double mobility)
{
    const Place *place = of->place;
    const Side *side = &place->sides[0];
    double depth = fabs(speed) * answer->step;
    for (size_t i = 0; i < place_side_count(place); i++) {
        depth += place->sides[i].state.is_touching ? place->sides[i].inside : 0.0;
    }
    const double damped = force_law_damping(&side->law, depth, speed) * fabs(speed);
    const double pressed = answer->step * (force_law_elastic(&side->law, depth) + damped);
    const double turned = speed / mobility;
    return pressed < turned ? pressed : turned;
}

// The largest component of all bodies' velocities after the base, or of how fast they turn.
static double fastest(const Answer *answer, bool is_turn)
{
    double most = 0.0;
    for (size_t b = 0; b < answer->world->bodies.moving; b++) {
        for (size_t k = 0; k < 3; k++) {
            most = fmax(most, fabs(answer->speeds[BODY_NUMBERS * b + (is_turn ? 3 : 0) + k]));
        }
    }
    return most;
}

// The impulse of a trial in a row, away from where the place presses. Friction is what acts beyond
// the first rows of a hole.
static double push_of(const Answer *answer, const AnswerPlace *of, size_t own, double mobility)
{
    const Place *place = of->place;
    const size_t row = of->first_row + own;
    const double floor = place->sides[0].law.impact_speed_floor;
    if (answer->is_linear) {
        // no bound to pass: as hard as the bodies are fast, so that rounding takes little of it
        return (fastest(answer, answer->rows[row]->is_turn) + floor) / mobility;
    }
    if (own >= PLACE_ROWS_PLANE) {
        const double rim = answer->rows[row]->is_turn ? place->hole_radius : 1.0;
        const double speed = fmax(floor, hypot(place->start_rate[0], place->start_rate[1]));
        const double plain = direction_mobility(answer->rows[of->first_row]);
        return fmax(place->friction * rim * hardest(answer, of, speed, plain),
                    NEAR * floor / (rim * mobility));
    }
    const double all = mobility + answer->rotors[row];
    const double speed =
        fabs(place->start_rate[own]) + fabs(answer->base[row] - answer->frozen[row]) + floor;
    const bool is_up = place->shape == PLACE_LINE ? side_gap(&place->sides[0], place->start[0]) <
                                                        side_gap(&place->sides[1], place->start[0])
                                                  : place->start[own] < 0.0;
    const double push = fmax(hardest(answer, of, speed, all), NEAR * speed / all);
    return is_up ? push : -push;
}

// The answer to a push in a row of a place, beside the step that the base is of.
static JpStatus find_column(Answer *answer, const AnswerPlace *of, size_t own, double step,
                            JpError *error)
{
    JpWorld *world = answer->world;
    const size_t n = answer->row_count;
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    const size_t row = of->first_row + own;
    const double mobility = direction_mobility(answer->rows[row]);
    if (!(mobility > 0.0)) {
        return JP_OK; // it moves nothing
    }
    double *column = &answer->columns[row * n];
    double *bodies = &answer->bodies[row * numbers];
    const double push = push_of(answer, of, own, mobility);
    direction_push(answer->rows[row], push / step);
    const JpStatus status = answer_step(answer, step, column, error);
    answer_read_bodies(world, bodies);
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < n; i++) {
        column[i] = (column[i] - answer->base[i]) / push;
    }
    for (size_t i = 0; i < numbers; i++) {
        bodies[i] = (bodies[i] - answer->speeds[i]) / push;
    }
    return status;
}

bool answer_is_within_work(const Answer *answer)
{
    const JpWorld *world = answer->world;
    double active = 0.0;
    double unknown = 0.0;
    for (size_t i = 0; i < answer->place_count; i++) {
        const AnswerPlace *of = &answer->places[i];
        active += of->is_active ? (double)of->place->row_count : 0.0;
        unknown += of->is_active && !of->is_known ? (double)of->place->row_count : 0.0;
    }
    const double trial = RATE_WORK * (double)answer->row_count + work_of_step(world);
    return world->work + unknown * trial + EVALUATIONS_LEAST * active * active <= world->work_most;
}

// What impulses do to the rate of a row.
double answer_to(const Answer *answer, const double *impulses, size_t row)
{
    double sum = 0.0;
    for (size_t i = 0; i < answer->row_count; i++) {
        // most rows have none, and reading their answers takes long where rows are many
        if (impulses[i] != 0.0) {
            sum += answer->columns[i * answer->row_count + row] * impulses[i];
        }
    }
    return sum;
}

void answer_take(const Answer *answer)
{
    const size_t numbers = BODY_NUMBERS * answer->world->bodies.moving;
    for (size_t b = 0; b < answer->world->bodies.moving; b++) {
        const dBodyID id = answer->world->bodies.records[b].id;
        double speeds[BODY_NUMBERS];
        memcpy(speeds, &answer->speeds[BODY_NUMBERS * b], sizeof speeds);
        for (size_t i = 0; i < answer->row_count; i++) {
            const double more = answer->net[i] - answer->pushed[i]; // than in the base
            for (size_t k = 0; k < BODY_NUMBERS && more != 0.0; k++) {
                speeds[k] += more * answer->bodies[i * numbers + BODY_NUMBERS * b + k];
            }
        }
        dBodySetLinearVel(id, speeds[0], speeds[1], speeds[2]);
        dBodySetAngularVel(id, speeds[3], speeds[4], speeds[5]);
        dBodySetForce(id, 0, 0, 0);
        dBodySetTorque(id, 0, 0, 0);
    }
}

// Answers of all active places about the base, but for those that have been found.
JpStatus answer_find_columns(Answer *answer, double step, JpError *error)
{
    for (size_t i = 0; i < answer->place_count; i++) {
        AnswerPlace *of = &answer->places[i];
        for (size_t k = 0; of->is_active && !of->is_known && k < of->place->row_count; k++) {
            REFUSAL_TRY(find_column(answer, of, k, step, error));
        }
        of->is_known = of->is_active;
    }
    return JP_OK;
}

bool answer_make(JpWorld *world, double step, Answer *answer)
{
    *answer = (Answer){.world = world, .step = step};
    if (!make_room(answer)) {
        return false;
    }
    fill_places(answer);
    answer_read_rates(answer, answer->frozen);
    return true;
}
