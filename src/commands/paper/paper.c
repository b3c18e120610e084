// What did the paper compute, does it come out again, and what should it have been?
#include "commands/paper/paper.h"

#include "base/side_by_side.h"
#include "commands/paper/embedded.h"

static bool compute_physical(Physical *physical, Err *err)
{
    Scenario nominal;
    if (!embedded_load(EMBEDDED_IDEAL_NOMINAL, &nominal, err)) {
        return false;
    }
    const bool is_computed = physical_compute(&nominal, physical, err);
    scenario_free(&nominal);
    return is_computed;
}

// What is made at the same time.
enum { PIECE_LONGEST, PIECE_OTHERS, PIECE_COUNT };

typedef struct Making {
    PaperResult made;
    RunWatch watch;
    Err errors[PIECE_COUNT];
    bool is_made[PIECE_COUNT];
} Making;

static void make_piece(size_t index, bool is_callers, void *context)
{
    (void)is_callers;
    Making *making = context;
    PaperResult *made = &making->made;
    Err *err = &making->errors[index];
    making->is_made[index] =
        index == PIECE_LONGEST
            ? extremes_longest(making->watch, &made->extremes[PRINTED_POISSON], err)
            : compute_physical(&made->physical, err) && extremes_others(made->extremes, err);
}

bool paper_compute(PaperResult *result, RunWatch watch, Err *err)
{
    Making making = {.made = {.inputs = estimate_inputs_printed()}, .watch = watch};
    PaperResult *made = &making.made;
    // what takes longest goes first, and is the caller's
    side_by_side_run(PIECE_COUNT, side_by_side_processors(), make_piece, &making);
    for (int i = 0; i < PIECE_COUNT; i++) {
        if (!making.is_made[i]) {
            *err = making.errors[i];
            return false;
        }
    }
    estimate_compute(&made->inputs, made->tables);
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        made->cell_count += made->tables[i].cell_count;
        made->as_printed += made->tables[i].as_printed;
    }
    made->ideal_difference_max = extremes_difference_max(made->extremes);
    made->ideal_as_printed = extremes_as_printed(made->extremes, &made->ideal_cell_count);
    *result = *made;
    return true;
}

bool paper_check(const PaperResult *result, Err *err)
{
    // the printed digits of the ideal rows are good to 1e-4; the combination of lengths behind the
    // stack-up row, which the paper does not name, fits them to 2.1e-4, the next best to 1e-3
    const double ideal_limit = 3e-4;
    if (result->as_printed != result->cell_count) {
        return err_set(err, ERR_DIFFERS, "only %d of %d cells of Tables I to III are as printed",
                       result->as_printed, result->cell_count);
    }
    if (!(result->ideal_difference_max <= ideal_limit)) {
        return err_set(err, ERR_DIFFERS,
                       "the ideal rows of Tables VII and VIII differ by %.2g, more than %.2g",
                       result->ideal_difference_max, ideal_limit);
    }
    return true;
}
