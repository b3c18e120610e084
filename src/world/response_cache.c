// Gives responses to pushes that are known from the steps before.
//
// They are functions of where the bodies are, as long as no bound is passed. Those of three steps
// t0 > t1 > t2 make a parabola in time through each number, off by
//     (t - t0) (t - t1) (t - t2) / 6   times its third derivative,
// with w the speed of turning about 10 (w h)^3. They are found anew every fourth step; that the
// world responded so is seen from the step under the contacts' forces (world/impulse.c).
#include "world/response_cache.h"

#include "kernel/columns.h"
#include "world/bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SETS = KERNEL_COLUMNS_KNOWN,
    STEPS_BETWEEN = 4, // from one to the next that is found
    STEPS_OVER = 12,   // that the three may lie apart
    SHORTEST_PAUSE = 16,
    LONGEST_PAUSE = 1024,
};

struct ResponseCache {
    size_t row_count;
    size_t body_count;
    size_t place_count;
    size_t count; // sets that are kept, the newest first
    double step;  // s
    double mass;  // kg and kg m^2, of all bodies: others respond otherwise
    size_t found_at[SETS];
    double *sets[SETS];   // the columns, then the bodies
    double *speeds[SETS]; // of all bodies, six each, as those steps began
    dBodyID *bodies;
    bool *is_active; // by place
    void *memory;    // owned, of all of the above
};

static size_t set_size(const ResponseCache *cache)
{
    return cache->row_count * (cache->row_count + BODY_NUMBERS * cache->body_count);
}

void response_cache_free(ResponseCache *cache)
{
    if (cache != NULL) {
        free(cache->memory);
        free(cache);
    }
}

// A sum that changes with the mass or inertia of any body.
static double mass_of(const Bodies *bodies)
{
    double sum = 0.0;
    for (size_t i = 0; i < bodies->moving; i++) {
        dMass mass;
        dBodyGetMass(bodies->records[i].id, &mass);
        sum += mass.mass + mass.I[0] + mass.I[5] + mass.I[10];
    }
    return sum;
}

// Whether a step is of the places, rows and bodies that are kept.
static bool is_alike(const ResponseCache *cache, const WorldResponse *response)
{
    const Bodies *bodies = &response->world->bodies;
    if (cache->row_count != response->row_count || cache->body_count != bodies->moving ||
        cache->place_count != response->place_count || cache->step != response->step ||
        cache->mass != mass_of(bodies)) {
        return false;
    }
    for (size_t i = 0; i < bodies->moving; i++) {
        if (cache->bodies[i] != bodies->records[i].id) {
            return false;
        }
    }
    for (size_t i = 0; i < response->place_count; i++) {
        if (cache->is_active[i] != response->places[i].is_active) {
            return false;
        }
    }
    return true;
}

// Whether to find the responses costs no more than the step that makes sure of them.
static bool is_found_as_soon(const WorldResponse *response)
{
    size_t rows = 0;
    for (size_t i = 0; i < response->place_count; i++) {
        rows += response->places[i].is_active ? response->places[i].place->row_count : 0;
    }
    return response->is_linear && rows < 2;
}

// What the newest sets tell of a step.
static KernelShares shares_of(const ResponseCache *cache, size_t sets, size_t now)
{
    double times_s[SETS];
    for (size_t i = 0; i < sets; i++) {
        times_s[i] = cache->step * ((double)cache->found_at[i] - (double)now);
    }
    return kernel_columns_shares(times_s, sets, 0.0);
}

void response_cache_fill(WorldResponse *response)
{
    const ResponseCache *cache = response->world->cache;
    const size_t now = response->world->stats.steps;
    if (cache == NULL || is_found_as_soon(response) || cache->count < SETS ||
        now < response->world->pause.until || now - cache->found_at[0] >= STEPS_BETWEEN ||
        now - cache->found_at[SETS - 1] > STEPS_OVER || !is_alike(cache, response)) {
        return;
    }
    const KernelShares shares = shares_of(cache, cache->count, now);
    const size_t columns = cache->row_count * cache->row_count;
    for (size_t i = 0; i < set_size(cache); i++) {
        double *number = i < columns ? &response->columns[i] : &response->bodies[i - columns];
        *number = shares.value[0] * cache->sets[0][i] + shares.value[1] * cache->sets[1][i] +
                  shares.value[2] * cache->sets[2][i];
    }
    for (size_t i = 0; i < response->place_count; i++) {
        response->places[i].is_known = response->places[i].is_active;
    }
    response->is_cached = true;
}

// Of the speeds of a step: what they may differ by from those of another one whose responses tell
// how its own change. An impact turns speeds round, and with them the way that responses go.
static const double CALM = 0.1;

// of the fastest turning: what turns no faster changes responses by nothing to speak of
static const double SLOW = 0.01;

// Whether each body turns as it did in the step of a set.
static bool turns_alike(const ResponseCache *cache, const Bodies *bodies, size_t set)
{
    double fastest = 0.0;
    for (size_t i = 0; i < cache->body_count; i++) {
        const dReal *omega = bodies->records[i].kept.omega;
        fastest = fmax(fastest, sqrt(dCalcVectorDot3(omega, omega)));
    }
    for (size_t i = 0; i < cache->body_count; i++) {
        const dReal *omega = bodies->records[i].kept.omega;
        const double *before = &cache->speeds[set][BODY_NUMBERS * i + 3];
        const dVector3 change = {omega[0] - before[0], omega[1] - before[1], omega[2] - before[2],
                                 0.0};
        const double own = sqrt(dCalcVectorDot3(omega, omega));
        if (!(sqrt(dCalcVectorDot3(change, change)) <= CALM * own + SLOW * fastest)) {
            return false;
        }
    }
    return true;
}

// Sets that are recent enough to tell a rate, of steps in which bodies went as in this one.
static size_t recent_sets(const ResponseCache *cache, const Bodies *bodies, size_t now)
{
    size_t recent = 0;
    while (recent < cache->count && now - cache->found_at[recent] <= STEPS_OVER &&
           turns_alike(cache, bodies, recent)) {
        recent++;
    }
    return recent > 0 && now - cache->found_at[0] <= STEPS_BETWEEN ? recent : 0;
}

bool response_cache_rates(WorldResponse *response)
{
    const ResponseCache *cache = response->world->cache;
    const size_t now = response->world->stats.steps;
    if (cache == NULL || !is_alike(cache, response)) {
        return false;
    }
    // in another round the newest set is this step's
    const bool is_kept = cache->count > 0 && cache->found_at[0] == now;
    const size_t known = recent_sets(cache, &response->world->bodies, now);
    if (known < (is_kept || response->is_cached ? 2 : 1)) { // of a rate: two times
        return false;
    }
    const size_t columns = cache->row_count * cache->row_count;
    const size_t numbers = set_size(cache) - columns;
    // a step that has found its own has these first
    const bool is_own = !response->is_cached;
    const size_t first = is_own && is_kept ? 1 : 0;
    double times_s[SETS] = {0.0};
    const double *sets[SETS] = {response->bodies};
    size_t count = is_own ? 1 : 0;
    for (size_t i = first; i < known && count < SETS; i++, count++) {
        times_s[count] = cache->step * ((double)cache->found_at[i] - (double)now);
        sets[count] = cache->sets[i] + columns;
    }
    const KernelShares shares = kernel_columns_shares(times_s, count, 0.0);
    for (size_t i = 0; i < numbers; i++) {
        double rate = 0.0;
        for (size_t k = 0; k < count; k++) {
            rate += shares.rate[k] * sets[k][i];
        }
        response->rates[i] = rate;
    }
    return true;
}

void response_cache_note(JpWorld *world, bool is_promised)
{
    CachePause *pause = &world->pause;
    if (is_promised) {
        pause->steps = 0;
        return;
    }
    pause->steps = pause->steps == 0              ? SHORTEST_PAUSE
                   : pause->steps < LONGEST_PAUSE ? 2 * pause->steps
                                                  : LONGEST_PAUSE;
    pause->until = world->stats.steps + pause->steps;
}

// A cache of no sets, for steps like this one; NULL where there is no memory.
static ResponseCache *start(const WorldResponse *response)
{
    ResponseCache *cache = calloc(1, sizeof *cache);
    if (cache == NULL) {
        return NULL;
    }
    cache->row_count = response->row_count;
    cache->body_count = response->world->bodies.moving;
    cache->place_count = response->place_count;
    cache->step = response->step;
    cache->mass = mass_of(&response->world->bodies);
    const size_t speeds = BODY_NUMBERS * cache->body_count;
    const size_t numbers = SETS * (set_size(cache) + speeds) * sizeof(double);
    cache->memory = calloc(1, numbers + cache->body_count * sizeof *cache->bodies +
                                  cache->place_count * sizeof *cache->is_active + 1);
    if (cache->memory == NULL) {
        free(cache);
        return NULL;
    }
    for (int i = 0; i < SETS; i++) {
        cache->sets[i] = (double *)cache->memory + (size_t)i * (set_size(cache) + speeds);
        cache->speeds[i] = cache->sets[i] + set_size(cache);
    }
    cache->bodies = (dBodyID *)(cache->sets[0] + SETS * (set_size(cache) + speeds));
    cache->is_active = (bool *)(cache->bodies + cache->body_count);
    for (size_t i = 0; i < cache->body_count; i++) {
        cache->bodies[i] = response->world->bodies.records[i].id;
    }
    for (size_t i = 0; i < cache->place_count; i++) {
        cache->is_active[i] = response->places[i].is_active;
    }
    return cache;
}

bool response_cache_keep(const WorldResponse *response)
{
    JpWorld *world = response->world;
    if (world->cache == NULL || !is_alike(world->cache, response)) {
        response_cache_free(world->cache);
        world->cache = start(response);
    }
    ResponseCache *cache = world->cache;
    if (cache == NULL) {
        return false;
    }
    const size_t now = world->stats.steps;
    const bool is_again = cache->count > 0 && cache->found_at[0] == now; // in another round
    if (!is_again) {
        double *oldest = cache->sets[SETS - 1];
        double *oldest_speeds = cache->speeds[SETS - 1];
        memmove(&cache->speeds[1], &cache->speeds[0], (SETS - 1) * sizeof *cache->speeds);
        cache->speeds[0] = oldest_speeds;
        memmove(&cache->sets[1], &cache->sets[0], (SETS - 1) * sizeof *cache->sets);
        memmove(&cache->found_at[1], &cache->found_at[0], (SETS - 1) * sizeof *cache->found_at);
        cache->sets[0] = oldest;
        cache->found_at[0] = now;
        cache->count += cache->count < SETS ? 1 : 0;
    }
    const size_t columns = cache->row_count * cache->row_count;
    memcpy(cache->sets[0], response->columns, columns * sizeof(double));
    memcpy(cache->sets[0] + columns, response->bodies,
           (set_size(cache) - columns) * sizeof(double));
    for (size_t i = 0; i < cache->body_count; i++) {
        const BodyMoment *kept = &world->bodies.records[i].kept;
        memcpy(&cache->speeds[0][BODY_NUMBERS * i], kept->velocity, 3 * sizeof(double));
        memcpy(&cache->speeds[0][BODY_NUMBERS * i + 3], kept->omega, 3 * sizeof(double));
    }
    return true;
}
