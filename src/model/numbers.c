// Makes the table of the numbers of a run from their list.
#include "model/numbers.h"

#include <stddef.h>

#define OWNER(id, members, path, before, part)                                                     \
    [NUMBER_OWNER_##id] = {NUMBER_OF_##members, path, before, part},
const NumberOwnerRow NUMBER_OWNERS[NUMBER_OWNER_COUNT] = {NUMBER_OWNER_LIST(OWNER)};

// The second and third of some words, or what stands for them.
#define SECOND(first, second, ...)       second
#define THIRD(first, second, third, ...) third

// clang-format off
#define ROW_UNITS(word, column, units)  ROW_UNITS_OF(word, column, units)
#define ROW_UNITS_OF(word, column, ...) ROW_UNITS_SPLIT(word, column, __VA_ARGS__)
#define ROW_UNITS_SPLIT(word, column, key, unit, turned_key, turned_unit, sped_key, sped_unit, \
                        end) \
    .keys = {word key, word turned_key, word sped_key}, \
    .columns = {column key, column turned_key, column sped_key}, \
    .unit_keys = {key, turned_key, sped_key}, \
    .units = {unit, turned_unit, sped_unit}, .check_end = end

#define ROW(of, id, word, what, title, turned, shown_as, in, with, value, ...) \
    [NUMBER_##of##_##id] = { \
        .owner = NUMBER_OWNER_##of, \
        .name = word, \
        .kind = NUMBER_OF_##what, \
        .titles = {title, (turned) != NULL ? (turned) : (title), title}, \
        .format = shown_as, \
        .places = in, \
        .traits = with, \
        ROW_UNITS(word, THIRD(__VA_ARGS__, NUMBER_COLUMN_##of word, NUMBER_COLUMN_##of word, ), \
                  NUMBER_UNITS_##what), \
        .crank_key = ((with) & NUMBER_INSTANT) != 0 ? "crank_deg" : word "_crank_deg", \
        .meaning = THIRD(, , __VA_ARGS__, ), \
        .axis = SECOND(__VA_ARGS__, THIRD(, , __VA_ARGS__, ), ), \
    },
// clang-format on

const Number NUMBERS[NUMBER_COUNT] = {NUMBER_LIST(ROW)};
