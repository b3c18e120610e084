// What are the answers to pushes, known from the steps before?
//
// They are functions of where the bodies are, as long as no bound is passed. Those of three steps
// t0 > t1 > t2 make a parabola in time through each number, off by
//     (t - t0) (t - t1) (t - t2) / 6   times its third derivative,
// with w the speed of turning about 10 (w h)^3. They are found anew every fourth step; that the
// world answered so is seen from the step under the contacts' forces (world/impulse.c).
#include "world/recall.h"

#include <stdlib.h>
#include <string.h>

enum {
    SETS = 3,
    STEPS_BETWEEN = 4, // from one to the next that is found
    STEPS_OVER = 12,   // that the three may lie apart
    SHORTEST_PAUSE = 16,
    LONGEST_PAUSE = 1024,
    BODY_NUMBERS = 6,
};

struct Recall {
    size_t row_count;
    size_t body_count;
    size_t place_count;
    size_t count; // sets that are kept, the newest first
    double step;  // s
    size_t found_at[SETS];
    double *sets[SETS]; // the columns, then the bodies
    dBodyID *bodies;
    bool *is_active; // by place
    void *memory;    // owned, of all of the above
};

static size_t set_size(const Recall *recall)
{
    return recall->row_count * (recall->row_count + BODY_NUMBERS * recall->body_count);
}

void recall_free(Recall *recall)
{
    if (recall != NULL) {
        free(recall->memory);
        free(recall);
    }
}

// Whether a step is of the places, rows and bodies that are kept.
static bool is_alike(const Recall *recall, const Answer *answer)
{
    const Bodies *bodies = &answer->world->bodies;
    if (recall->row_count != answer->row_count || recall->body_count != bodies->moving ||
        recall->place_count != answer->place_count || recall->step != answer->step) {
        return false;
    }
    for (size_t i = 0; i < bodies->moving; i++) {
        if (recall->bodies[i] != bodies->records[i].id) {
            return false;
        }
    }
    for (size_t i = 0; i < answer->place_count; i++) {
        if (recall->is_active[i] != answer->places[i].is_active) {
            return false;
        }
    }
    return true;
}

// Whether to find the answers costs no more than the step that makes sure of them.
static bool is_found_as_soon(const Answer *answer)
{
    size_t rows = 0;
    for (size_t i = 0; i < answer->place_count; i++) {
        rows += answer->places[i].is_active ? answer->places[i].place->row_count : 0;
    }
    return answer->is_linear && rows < 2;
}

void recall_columns(Answer *answer)
{
    const Recall *recall = answer->world->recall;
    const size_t now = answer->world->stats.steps;
    if (recall == NULL || is_found_as_soon(answer) || recall->count < SETS ||
        now < answer->world->pause.until || now - recall->found_at[0] >= STEPS_BETWEEN ||
        now - recall->found_at[SETS - 1] > STEPS_OVER || !is_alike(recall, answer)) {
        return;
    }
    double shares[SETS];
    for (int i = 0; i < SETS; i++) {
        shares[i] = 1.0;
        for (int k = 0; k < SETS; k++) {
            if (k != i) {
                shares[i] *= ((double)now - (double)recall->found_at[k]) /
                             ((double)recall->found_at[i] - (double)recall->found_at[k]);
            }
        }
    }
    const size_t columns = recall->row_count * recall->row_count;
    for (size_t i = 0; i < set_size(recall); i++) {
        double *number = i < columns ? &answer->columns[i] : &answer->bodies[i - columns];
        *number = shares[0] * recall->sets[0][i] + shares[1] * recall->sets[1][i] +
                  shares[2] * recall->sets[2][i];
    }
    for (size_t i = 0; i < answer->place_count; i++) {
        answer->places[i].is_known = answer->places[i].is_active;
    }
    answer->is_recalled = true;
}

void recall_note(JpWorld *world, bool is_promised)
{
    RecallPause *pause = &world->pause;
    if (is_promised) {
        pause->steps = 0;
        return;
    }
    pause->steps = pause->steps == 0              ? SHORTEST_PAUSE
                   : pause->steps < LONGEST_PAUSE ? 2 * pause->steps
                                                  : LONGEST_PAUSE;
    pause->until = world->stats.steps + pause->steps;
}

// A recall of no sets, for steps like this one; NULL where there is no memory.
static Recall *start(const Answer *answer)
{
    Recall *recall = calloc(1, sizeof *recall);
    if (recall == NULL) {
        return NULL;
    }
    recall->row_count = answer->row_count;
    recall->body_count = answer->world->bodies.moving;
    recall->place_count = answer->place_count;
    recall->step = answer->step;
    const size_t numbers = SETS * set_size(recall) * sizeof(double);
    recall->memory = calloc(1, numbers + recall->body_count * sizeof *recall->bodies +
                                   recall->place_count * sizeof *recall->is_active + 1);
    if (recall->memory == NULL) {
        free(recall);
        return NULL;
    }
    for (int i = 0; i < SETS; i++) {
        recall->sets[i] = (double *)recall->memory + (size_t)i * set_size(recall);
    }
    recall->bodies = (dBodyID *)(recall->sets[0] + SETS * set_size(recall));
    recall->is_active = (bool *)(recall->bodies + recall->body_count);
    for (size_t i = 0; i < recall->body_count; i++) {
        recall->bodies[i] = answer->world->bodies.records[i].id;
    }
    for (size_t i = 0; i < recall->place_count; i++) {
        recall->is_active[i] = answer->places[i].is_active;
    }
    return recall;
}

bool recall_keep(const Answer *answer)
{
    JpWorld *world = answer->world;
    if (world->recall == NULL || !is_alike(world->recall, answer)) {
        recall_free(world->recall);
        world->recall = start(answer);
    }
    Recall *recall = world->recall;
    if (recall == NULL) {
        return false;
    }
    const size_t now = world->stats.steps;
    const bool is_again = recall->count > 0 && recall->found_at[0] == now; // in another round
    if (!is_again) {
        double *oldest = recall->sets[SETS - 1];
        memmove(&recall->sets[1], &recall->sets[0], (SETS - 1) * sizeof *recall->sets);
        memmove(&recall->found_at[1], &recall->found_at[0], (SETS - 1) * sizeof *recall->found_at);
        recall->sets[0] = oldest;
        recall->found_at[0] = now;
        recall->count += recall->count < SETS ? 1 : 0;
    }
    const size_t columns = recall->row_count * recall->row_count;
    memcpy(recall->sets[0], answer->columns, columns * sizeof(double));
    memcpy(recall->sets[0] + columns, answer->bodies,
           (set_size(recall) - columns) * sizeof(double));
    return true;
}
