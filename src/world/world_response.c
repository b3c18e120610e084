// Finds how a world responds to pushes in the places of its joints with play.
//
// By steps that are taken back: with a push in a row, beside one without. Rows are frozen where the
// bodies are kept, so that what a step changes of their rates is what it changes of speeds.
#include "world/world_response.h"

#include "world/trial.h"
#include "world/work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// of what turns an impact round: less of a push is lost in rounding
static const double LINEAR_SHARE = 1e-3;

// of forces, in the shortest of contacts, with what it takes to read two nodes of it
static const double EVALUATIONS_LEAST = 100.0;

// of the rate of a row, in pairs of rows
static const double RATE_WORK = 30.0;

enum { INSIDE_ROWS = 4 /* of the kernel, at most, to one here */ };

static void count(const JpWorld *world, WorldResponse *response)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            response->place_count++;
            response->row_count += joint->places[i].row_count;
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

static bool make_room(WorldResponse *response)
{
    const JpWorld *world = response->world;
    count(world, response);
    const size_t n = response->row_count;
    const size_t body = BODY_NUMBERS * world->bodies.moving;
    const size_t numbers = (10 + INSIDE_ROWS) * n + 2 * n * n + (2 * n + 4) * body;
    const size_t size = numbers * sizeof(double) + response->place_count * sizeof(ResponsePlace) +
                        n * (sizeof(Direction *) + INSIDE_ROWS * sizeof(size_t));
    double *at = response->memory = calloc(1, size + 1);
    if (at == NULL) {
        return false;
    }
    double **const by_row[] = {&response->frozen, &response->base, &response->found,
                               &response->pushed, &response->net,  &response->rotors,
                               &response->free};
    for (size_t i = 0; i < sizeof by_row / sizeof *by_row; i++) {
        *by_row[i] = take(&at, n);
    }
    response->moment = take(&at, 2 * n);
    response->signs = take(&at, INSIDE_ROWS * n);
    response->columns = take(&at, n * n);
    response->drift = take(&at, n * n);
    response->bodies = take(&at, n * body);
    response->rates = take(&at, n * body);
    response->later = take(&at, body);
    response->beyond = take(&at, body);
    response->apart = take(&at, body);
    response->before = take(&at, n);
    response->speeds = take(&at, body);
    response->places = (ResponsePlace *)at;
    response->rows = (const Direction **)(response->places + response->place_count);
    response->inside = (size_t *)(response->rows + n);
    return true;
}

void world_response_free(WorldResponse *response)
{
    free(response->memory);
    kernel_sums_free(&response->sums);
    closing_free(&response->closing);
    *response = (WorldResponse){0};
}

// Lists places and rows.
static void fill_places(WorldResponse *response)
{
    size_t place = 0;
    size_t row = 0;
    for (JpJoint *joint = response->world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            Place *of = &joint->places[i];
            response->places[place++] =
                (ResponsePlace){.joint = joint, .place = of, .first_row = row};
            for (size_t k = 0; k < of->row_count; k++, row++) {
                response->rows[row] = &of->rows[k];
                response->rotors[row] = 1.0 / joint->rotor.inertia;
            }
        }
    }
}

void world_response_read_bodies(const JpWorld *world, double *speeds)
{
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID id = world->bodies.records[i].id;
        memcpy(&speeds[BODY_NUMBERS * i], dBodyGetLinearVel(id), 3 * sizeof(double));
        memcpy(&speeds[BODY_NUMBERS * i + 3], dBodyGetAngularVel(id), 3 * sizeof(double));
    }
}

void world_response_read_rates(const WorldResponse *response, double *rates)
{
    for (size_t i = 0; i < response->row_count; i++) {
        rates[i] = direction_rate(response->rows[i]);
    }
}

// A step under the mean forces of impulses, and the rates after it.
JpStatus world_response_step(const WorldResponse *response, double step, double *rates,
                             JpError *error)
{
    for (size_t i = 0; i < response->row_count; i++) {
        if (response->pushed[i] != 0.0) {
            direction_push(response->rows[i], response->pushed[i] / step);
        }
    }
    REFUSAL_TRY(trial_step(response->world, step, error));
    world_response_read_rates(response, rates);
    return JP_OK;
}

// How hard a place may press in the step: as its law does where its pin or its coordinate may get,
// and no harder than what turns an impact round with free bodies.
static double hardest(const WorldResponse *response, const ResponsePlace *of, double speed,
                      double mobility)
{
    const Place *place = of->place;
    const Side *side = &place->sides[0];
    double depth = fabs(speed) * response->step;
    for (size_t i = 0; i < place_side_count(place); i++) {
        depth += place->sides[i].state.is_touching ? place->sides[i].inside : 0.0;
    }
    const double damped = force_law_damping(&side->law, depth, speed) * fabs(speed);
    const double pressed = response->step * (force_law_elastic(&side->law, depth) + damped);
    const double turned = speed / mobility;
    return pressed < turned ? pressed : turned;
}

// The largest component of all bodies' velocities after the base, or of how fast they turn.
static double fastest(const WorldResponse *response, bool is_turn)
{
    double most = 0.0;
    for (size_t b = 0; b < response->world->bodies.moving; b++) {
        for (size_t k = 0; k < 3; k++) {
            most = fmax(most, fabs(response->speeds[BODY_NUMBERS * b + (is_turn ? 3 : 0) + k]));
        }
    }
    return most;
}

// The impulse of a trial in a row, away from where the place presses. Friction is what acts beyond
// the first rows of a hole.
static double push_of(const WorldResponse *response, const ResponsePlace *of, size_t own,
                      double mobility)
{
    const Place *place = of->place;
    const size_t row = of->first_row + own;
    const double floor = place->sides[0].law.impact_speed_floor;
    if (response->is_linear) {
        // no bound to pass: as hard as the bodies are fast, so that rounding takes little of it
        return (fastest(response, response->rows[row]->is_turn) + floor) / mobility;
    }
    if (own >= PLACE_ROWS_PLANE) {
        const double rim = response->rows[row]->is_turn ? place->hole_radius : 1.0;
        const double speed = fmax(floor, hypot(place->start_rate[0], place->start_rate[1]));
        const double plain = direction_mobility(response->rows[of->first_row]);
        return fmax(place->friction * rim * hardest(response, of, speed, plain),
                    LINEAR_SHARE * floor / (rim * mobility));
    }
    const double all = mobility + response->rotors[row];
    const double speed =
        fabs(place->start_rate[own]) + fabs(response->base[row] - response->frozen[row]) + floor;
    const bool is_up = place->shape == PLACE_LINE ? side_gap(&place->sides[0], place->start[0]) <
                                                        side_gap(&place->sides[1], place->start[0])
                                                  : place->start[own] < 0.0;
    const double push = fmax(hardest(response, of, speed, all), LINEAR_SHARE * speed / all);
    return is_up ? push : -push;
}

// The speeds of all bodies after a step with a push in a row of a place, less those of a step
// without it, for a push of 1.
static JpStatus find_push(WorldResponse *response, const ResponsePlace *of, size_t own,
                          const double *without, double step, double *speeds, JpError *error)
{
    JpWorld *world = response->world;
    const Direction *row = response->rows[of->first_row + own];
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    const double push = push_of(response, of, own, direction_mobility(row));
    direction_push(row, push / step);
    REFUSAL_TRY(trial_step(world, step, error));
    world_response_read_bodies(world, speeds);
    for (size_t i = 0; i < numbers; i++) {
        speeds[i] = (speeds[i] - without[i]) / push;
    }
    return JP_OK;
}

// The response to a push in a row of a place, beside the step that the base is of.
static JpStatus find_column(WorldResponse *response, const ResponsePlace *of, size_t own,
                            double step, JpError *error)
{
    JpWorld *world = response->world;
    const size_t n = response->row_count;
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    const size_t row = of->first_row + own;
    const double mobility = direction_mobility(response->rows[row]);
    if (!(mobility > 0.0)) {
        return JP_OK; // it moves nothing
    }
    double *column = &response->columns[row * n];
    double *bodies = &response->bodies[row * numbers];
    const double push = push_of(response, of, own, mobility);
    direction_push(response->rows[row], push / step);
    const JpStatus status = world_response_step(response, step, column, error);
    world_response_read_bodies(world, bodies);
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < n; i++) {
        column[i] = (column[i] - response->base[i]) / push;
    }
    for (size_t i = 0; i < numbers; i++) {
        bodies[i] = (bodies[i] - response->speeds[i]) / push;
    }
    return status;
}

// Of the step: how much later bodies are for the rates of responses. What these change by besides
// in that time is as small a share of what they change by in the step.
static const double LATER = 1.0 / 64.0;

static void go_on(const JpWorld *world, double time)
{
    for (size_t i = 0; i < world->bodies.moving; i++) {
        double speeds[BODY_NUMBERS];
        bodies_read_speeds(&world->bodies.records[i], speeds);
        bodies_move(world->bodies.records[i].id, speeds, time);
    }
}

// The rates of one row, whose arms go on with the bodies.
static JpStatus find_rate(WorldResponse *response, const ResponsePlace *of, size_t own,
                          const double *without, double step, JpError *error)
{
    JpWorld *world = response->world;
    const size_t row = of->first_row + own;
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    const Direction *here = response->rows[row];
    double *rates = &response->rates[row * numbers];
    if (!(direction_mobility(here) > 0.0)) {
        return JP_OK; // it moves nothing
    }
    Direction later = direction_later(here, LATER * step);
    go_on(world, LATER * step);
    response->rows[row] = &later;
    const JpStatus status = find_push(response, of, own, without, step, rates, error);
    response->rows[row] = here;
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < numbers; i++) {
        rates[i] = (rates[i] - response->bodies[row * numbers + i]) / (LATER * step);
    }
    return status;
}

JpStatus world_response_find_rates(WorldResponse *response, double step, JpError *error)
{
    JpWorld *world = response->world;
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    memset(response->rates, 0, response->row_count * numbers * sizeof(double));
    go_on(world, LATER * step);
    REFUSAL_TRY(trial_step(world, step, error));
    world_response_read_bodies(world, response->later);
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        for (size_t k = 0; of->is_active && k < of->place->row_count; k++) {
            REFUSAL_TRY(find_rate(response, of, k, response->later, step, error));
        }
    }
    return JP_OK;
}

bool world_response_is_within_work(const WorldResponse *response)
{
    const JpWorld *world = response->world;
    double active = 0.0;
    double unknown = 0.0;
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        active += of->is_active ? (double)of->place->row_count : 0.0;
        unknown += of->is_active && !of->is_known ? (double)of->place->row_count : 0.0;
    }
    const double trial = RATE_WORK * (double)response->row_count + work_of_step(world);
    return world->work + unknown * trial + EVALUATIONS_LEAST * active * active <= world->work_most;
}

// What impulses do to the rate of a row.
double world_response_to(const WorldResponse *response, const double *impulses, size_t row)
{
    double sum = 0.0;
    for (size_t i = 0; i < response->row_count; i++) {
        // most rows have none, and reading their responses takes long where rows are many
        if (impulses[i] != 0.0) {
            sum += response->columns[i * response->row_count + row] * impulses[i];
        }
    }
    return sum;
}

void world_response_take(const WorldResponse *response)
{
    const size_t numbers = BODY_NUMBERS * response->world->bodies.moving;
    for (size_t b = 0; b < response->world->bodies.moving; b++) {
        const dBodyID id = response->world->bodies.records[b].id;
        double speeds[BODY_NUMBERS];
        memcpy(speeds, &response->speeds[BODY_NUMBERS * b], sizeof speeds);
        for (size_t i = 0; i < response->row_count; i++) {
            const double more = response->net[i] - response->pushed[i]; // than in the base
            for (size_t k = 0; k < BODY_NUMBERS && more != 0.0; k++) {
                speeds[k] += more * response->bodies[i * numbers + BODY_NUMBERS * b + k];
            }
        }
        dBodySetLinearVel(id, speeds[0], speeds[1], speeds[2]);
        dBodySetAngularVel(id, speeds[3], speeds[4], speeds[5]);
        dBodySetForce(id, 0, 0, 0);
        dBodySetTorque(id, 0, 0, 0);
    }
}

// Responses of all active places about the base, but for those that have been found.
JpStatus world_response_find_columns(WorldResponse *response, double step, JpError *error)
{
    for (size_t i = 0; i < response->place_count; i++) {
        ResponsePlace *of = &response->places[i];
        for (size_t k = 0; of->is_active && !of->is_known && k < of->place->row_count; k++) {
            REFUSAL_TRY(find_column(response, of, k, step, error));
        }
        of->is_known = of->is_active;
    }
    return JP_OK;
}

bool world_response_make(JpWorld *world, double step, WorldResponse *response)
{
    *response = (WorldResponse){.world = world, .step = step};
    if (!make_room(response)) {
        return false;
    }
    fill_places(response);
    world_response_read_rates(response, response->frozen);
    return true;
}
