// How do the places of an encounter move each other, where most do not?
#include "contact/encounter_coupling.h"

#include <math.h>

static void fill_between(Encounter *encounter, const double *block, size_t a, size_t b)
{
    const EncounterJoint *of = &encounter->joints[a];
    const EncounterJoint *other = &encounter->joints[b];
    for (size_t i = 0; i < of->row_count; i++) {
        double *row = encounter_mobility(encounter, of->first_row + i, other->first_row);
        for (size_t k = 0; k < other->row_count; k++) {
            row[k] = block[i * other->row_count + k];
            *encounter_mobility(encounter, other->first_row + k, of->first_row + i) = row[k];
        }
    }
}

// The number of a place among sorted ones, or `count`.
static size_t find_place(const size_t *places, size_t count, size_t place)
{
    size_t low = 0;
    size_t high = count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (places[middle] <= place) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return count > 0 && places[low] == place ? low : count;
}

void encounter_fill(Encounter *encounter, const EncounterCoupling *coupling, const size_t *places)
{
    for (size_t a = 0; a < encounter->joint_count; a++) {
        const size_t place = places == NULL ? a : places[a];
        for (size_t n = coupling->first_partner[place]; n < coupling->first_partner[place + 1];
             n++) {
            const size_t other = coupling->partners[n];
            const size_t b = places == NULL ? other : find_place(places, a + 1, other);
            if (b > a) {
                continue;
            }
            fill_between(encounter, coupling->block(coupling->context, place, other), a, b);
        }
    }
}

size_t encounter_coupling_reach(const EncounterCoupling *coupling, const Encounter *encounter,
                                const size_t *places)
{
    size_t reach = 0;
    for (size_t a = 0; a < encounter->joint_count; a++) {
        const EncounterJoint *joint = &encounter->joints[a];
        for (size_t n = coupling->first_partner[places[a]];
             n < coupling->first_partner[places[a] + 1] && coupling->partners[n] <= places[a];
             n++) {
            const size_t b = find_place(places, a + 1, coupling->partners[n]);
            if (b <= a) {
                const size_t apart =
                    joint->first_row + joint->row_count - 1 - encounter->joints[b].first_row;
                reach = apart > reach ? apart : reach;
                break;
            }
        }
    }
    return reach;
}

double encounter_coupling_push(const EncounterCoupling *coupling, const Encounter *all, size_t from,
                               const double *variations, size_t to)
{
    const size_t rows = all->joints[from].row_count;
    const size_t own = all->joints[to].row_count;
    const double *block = coupling->block(coupling->context, to, from);
    double sums[2] = {0.0, 0.0};
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < rows; k++) {
            sums[i] += fabs(to > from ? block[i * rows + k] : block[k * own + i]) * variations[k];
        }
    }
    return hypot(sums[0], sums[1]);
}
