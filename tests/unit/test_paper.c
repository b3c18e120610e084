// Do the paper's numbers come out again, and for the right reasons?
#include "close.h"

#include "commands/paper/paper.h"
#include "contact/law.h"
#include "kept.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <stdio.h>
#include <string.h>

static PaperResult result; // filled once: the two ODE runs take a moment

static int set_up(void **state)
{
    (void)state;
    Err err = {0};
    if (!paper_compute(&result, (RunWatch){0}, &err)) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

// Cells as printed, of each table, for given inputs.
static void count_cells(const EstimateInputs *inputs, int counts[PRINTED_TABLE_COUNT])
{
    EstimateTable tables[PRINTED_TABLE_COUNT];
    estimate_compute(inputs, tables);
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        assert_int_equal(tables[i].cell_count, 30);
        counts[i] = tables[i].as_printed;
    }
}

static void all_90_cells_of_tables_1_to_3_come_out_as_printed(void **state)
{
    (void)state;
    assert_int_equal(result.cell_count, 90);
    assert_int_equal(result.as_printed, 90);
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        assert_near(result.tables[i].difference_max, 0.0, 0.0);
    }
    // and by hand for one cell of each, from the numbers alone
    const double modulus = 2.07e5 / (2.0 * (1.0 - 0.29 * 0.29)); // N/mm^2
    char cell[32];
    snprintf(cell, sizeof cell, "%.2f", 2.0 * modulus * 0.1 * sqrt(1.051416) * 0.042);
    assert_string_equal(cell, "973.33");
    assert_near(result.tables[1].cells[9][0].printed, 973.33, 0.0);
    snprintf(cell, sizeof cell, "%.2f", 2.0 * modulus * 0.1 * sqrt(0.04) * 0.042);
    assert_string_equal(cell, "189.85"); // the noise at 200 rpm: 0.04 N, not 0.04386 N
    assert_near(result.tables[1].cells[1][1].printed, 189.85, 0.0);
}

static void an_altered_alpha_breaks_the_count(void **state)
{
    (void)state;
    int counts[PRINTED_TABLE_COUNT];
    EstimateInputs inputs = estimate_inputs_printed();
    assert_near(inputs.alpha_max[0], 11970.0, 0.0);
    assert_near(inputs.alpha_max[1], 12484.0, 0.0);
    count_cells(&inputs, counts);
    assert_int_equal(counts[0] + counts[1] + counts[2], 90);

    inputs.alpha_max[1] = 12485.5; // the exact extreme, where the paper has 12484
    count_cells(&inputs, counts);
    assert_true(counts[1] < 30);

    inputs = estimate_inputs_printed();
    inputs.alpha_max[0] = 12090.0; // one per cent
    count_cells(&inputs, counts);
    assert_true(counts[0] < 30);
    assert_true(counts[1] <= 15);
    assert_true(counts[2] < 20);
}

static void the_exponent_of_the_text_does_not_give_table_2(void **state)
{
    (void)state;
    int counts[PRINTED_TABLE_COUNT];
    EstimateInputs inputs = estimate_inputs_printed();
    inputs.reading.exponent = 1.5;
    count_cells(&inputs, counts);
    assert_int_equal(counts[0], 30);
    assert_int_equal(counts[1], 0);
    assert_int_equal(counts[2], 30);
}

static void the_clearance_of_table_4_does_not_give_table_2(void **state)
{
    (void)state;
    int counts[PRINTED_TABLE_COUNT];
    EstimateInputs inputs = estimate_inputs_printed();
    inputs.reading.clearance = PRINTED_HOLE_DIAMETER - PRINTED_PIN_DIAMETER;
    count_cells(&inputs, counts);
    assert_int_equal(counts[1], 0);
}

static void correct_hertz_does_not_give_table_3(void **state)
{
    (void)state;
    // with the 3/4 under the power the formula is the paper's for 3/4 of the radius
    int counts[PRINTED_TABLE_COUNT];
    EstimateInputs inputs = estimate_inputs_printed();
    inputs.reading.sphere_radius = 5e-3 * 0.75;
    count_cells(&inputs, counts);
    assert_int_equal(counts[2], 0);
    EstimateTable tables[PRINTED_TABLE_COUNT];
    estimate_compute(&inputs, tables);
    assert_near(tables[2].cells[9][0].value, 0.2136, 1e-4);
}

static void a_cell_agrees_only_to_its_last_digit(void **state)
{
    (void)state;
    assert_true(printed_agrees(0.12345, 0.1234, 4) || printed_agrees(0.12345, 0.1235, 4));
    assert_true(printed_agrees(99.404, 99.40, 2));
    assert_false(printed_agrees(99.406, 99.40, 2));
    assert_true(printed_agrees(-42.2006, -42.201, 3));
    assert_false(printed_agrees(42.2006, -42.201, 3));
}

static void the_ideal_rows_come_out(void **state)
{
    (void)state;
    // the nominal row differs by the paper's own rounding and sampling, 0.012 %, the stack-up row
    // by 0.021 %
    assert_true(result.ideal_difference_max < 2.2e-4);
    const ExtremesRow *nominal = &result.extremes[PRINTED_IDEAL_NOMINAL];
    static const double EXACT[] = {78.6973, -42.2008, 80.5551, -43.8186,
                                   7574.6,  -11970.4, 12485.5, -7512.3};
    for (int i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        assert_near(nominal->ours[i], EXACT[i], i < 4 ? 5.1e-5 : 0.051);
    }
    assert_true(result.extremes[PRINTED_IDEAL_STACKUP].difference_max > 1e-5);
    // the sampled row: every printed digit but one, -42.199
    const ExtremesRow *sampled = &result.extremes[PRINTED_IDEAL_ANALYTICAL];
    assert_int_equal(sampled->as_printed, 7);
    assert_near(sampled->ours[1], -42.1999, 5.1e-5);
    assert_int_equal(result.ideal_cell_count, 24);
    // control: the exact extremes are not the sampled ones
    assert_true(nominal->as_printed < 8);
    assert_true(fabs(sampled->ours[2] - nominal->ours[2]) > 1e-3);
}

static void the_crank_turns_clockwise_as_in_the_paper(void **state)
{
    (void)state;
    Scenario scenario;
    Err err = {0};
    for (int i = 0; i < EMBEDDED_COUNT; i++) {
        assert_true(embedded_load((EmbeddedCase)i, &scenario, &err));
        assert_close(scenario.linkage.driver.speed, -1000.0 / 30.0 * acos(-1.0), 1e-12);
        assert_int_equal(scenario_has_clearance(&scenario), i >= EMBEDDED_STACKUP_POISSON);
        scenario_free(&scenario);
    }
}

static void the_rows_with_play_ran_and_count_as_no_target(void **state)
{
    (void)state;
    for (int i = PRINTED_POISSON; i <= PRINTED_IMPACT; i++) {
        const ExtremesRow *row = &result.extremes[i];
        assert_false(row->is_target);
        assert_true(row->is_known);
        assert_true(row->impacts > 0);
        assert_true(row->step_s > 0.0);
        // play can only add to the ideal extremes of the coupler's speed
        assert_true(row->ours[0] > 78.0 && row->ours[1] < -41.0);
    }
    // impacts leave accelerations far above the ideal 7575
    assert_true(result.extremes[PRINTED_IMPACT].ours[4] > 2e4);
    assert_true(result.extremes[PRINTED_POISSON].ours[4] > 2e4);
}

static void the_peaks_of_the_impact_row_are_those_of_the_reference(void **state)
{
    (void)state;
    Scenario scenario;
    Err err = {0};
    assert_true(embedded_load(EMBEDDED_STACKUP_IMPACT, &scenario, &err));
    Trajectory *exact =
        tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    const ExtremesRow *row = &result.extremes[PRINTED_IMPACT];
    for (int i = 0; i < 2; i++) {
        const BodyExtremes *body = &exact->bodies[1 + i];
        assert_close(row->ours[2 * i], body->omega_max.value, 1e-5);
        assert_close(row->ours[2 * i + 1], body->omega_min.value, 1e-5);
        // textbook use of ODE at 1 us has errors of 0.1 here
        assert_close(row->ours[2 * i + 4], body->alpha_max.value, 2e-4);
        assert_close(row->ours[2 * i + 5], body->alpha_min.value, 2e-4);
    }
    assert_int_equal(row->impacts, exact->joints[1].impacts);
    assert_close(row->force_max, exact->joints[1].force_max.value, 2e-4);
    trajectory_destroy(exact);
    scenario_free(&scenario);
}

static void the_real_pin_forces_are_those_of_inverse_dynamics(void **state)
{
    (void)state;
    static const double RPM[] = {100, 300, 500, 700, 900, 1000, 1100, 1300, 1500};
    static const double A[] = {14.1, 134.5, 375.4, 736.8, 1218.6, 1504.7, 1821.0, 2543.8, 3387.0};
    static const double B[] = {12.0, 96.8, 266.6, 521.1, 860.5, 1062.1, 1284.8, 1794.0, 2387.9};
    Scenario nominal;
    Err err = {0};
    assert_true(embedded_load(EMBEDDED_IDEAL_NOMINAL, &nominal, &err));
    for (int i = 0; i < 9; i++) {
        const int row = (int)(RPM[i] / 100.0) - 1;
        assert_near(result.physical.pins[row][0].force, A[i], 0.06);
        assert_near(result.physical.pins[row][1].force, B[i], 0.06);
        double forces[PRINTED_PIN_COUNT];
        assert_true(physical_force(&nominal, RPM[i], forces, &err));
        assert_close(forces[0], result.physical.pins[row][0].force, 1e-14);
    }
    // without gravity they go with the square of the speed: 1.5058e-3 and 1.0607e-3 rpm^2
    nominal.gravity = scenario_downward(0.0);
    double forces[PRINTED_PIN_COUNT];
    assert_true(physical_force(&nominal, 100.0, forces, &err));
    assert_close(forces[0], 1.5058e-3 * 1e4, 5e-5);
    assert_close(forces[1], 1.0607e-3 * 1e4, 5e-5);
    // control: gravity matters at 100 rpm
    assert_true(fabs(forces[1] - 12.0) > 1.0);
    scenario_free(&nominal);
}

static void the_contact_under_the_real_force_is_johnsons(void **state)
{
    (void)state;
    const PhysicalPin *pin = &result.physical.pins[9][PRINTED_CRANK_COUPLER];
    assert_near(pin->johnson_approach * 1e6, 1.36, 5e-3);
    assert_close(pin->johnson_tangent, 1.45e9, 5e-3);
    assert_near(pin->half_angle * 180.0 / acos(-1.0), 17.0, 0.6);
    assert_near(result.physical.estimated_force, 1.0514, 1e-4);
    assert_near(result.physical.estimated[LAW_JOHNSON - LAW_AUTO - 1].approach * 1e6, 0.0026, 1e-4);
    assert_near(result.physical.real[LAW_JOHNSON - LAW_AUTO - 1].approach, pin->johnson_approach,
                1e-15);
}

static void a_four_bar_that_is_not_one_is_refused(void **state)
{
    (void)state;
    Scenario scenario;
    Err err = {0};
    assert_true(embedded_load(EMBEDDED_IDEAL_NOMINAL, &scenario, &err));
    Scenario renamed = kept_copy(&scenario);
    renamed.linkage.joints[1].name[0] = 'x';
    renamed.linkage.joints[2].name[0] = 'x';
    double forces[PRINTED_PIN_COUNT];
    Physical physical;
    assert_false(physical_force(&renamed, 1000.0, forces, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    scenario.fourbar.ground.nominal = 0.6; // the crank no longer turns
    err = (Err){0};
    assert_false(physical_compute(&scenario, &physical, &err));
    assert_non_null(strstr(err.text, "does not turn fully"));
    scenario_free(&scenario);
}

static void every_typo_says_what_it_is(void **state)
{
    (void)state;
    assert_true(TYPOS_COUNT >= 11);
    for (size_t i = 0; i < TYPOS_COUNT; i++) {
        assert_true(strlen(TYPOS[i].where) > 0 && strlen(TYPOS[i].printed) > 0);
        assert_true(strlen(TYPOS[i].reading) > 0 && strlen(TYPOS[i].evidence) > 0);
    }
}

static void the_text_shows_the_counts_and_the_typos(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    paper_text_write(&result, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "Tables I to III: 90 of 90 cells as printed."));
    assert_non_null(strstr(text.data, "30 of 30 cells as printed."));
    assert_non_null(strstr(text.data, "half-angle is 17 degrees"));
    for (size_t i = 0; i < TYPOS_COUNT; i++) {
        assert_non_null(strstr(text.data, TYPOS[i].printed));
    }
    text_finish(&text);

    // the counts are counted: one altered cell and a failed run show
    PaperResult altered = result;
    altered.inputs.alpha_max[0] = 12090.0;
    estimate_compute(&altered.inputs, altered.tables);
    altered.extremes[PRINTED_IMPACT].is_known = false;
    snprintf(altered.extremes[PRINTED_IMPACT].message, ERR_TEXT_SIZE, "it blew up");
    text_init(&text);
    paper_text_write(&altered, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "30 of 30 cells as printed. A"));
    assert_non_null(strstr(text.data, "FAILED: it blew up"));
    text_finish(&text);
}

static void the_json_holds_every_cell_and_row(void **state)
{
    (void)state;
    json_t *object = paper_json_make(&result);
    assert_int_equal(json_integer_value(json_object_get(object, "cells_as_printed")), 90);
    json_t *tables = json_object_get(object, "tables");
    assert_int_equal(json_array_size(tables), 3);
    json_t *cells = json_object_get(json_array_get(tables, 2), "cells");
    assert_int_equal(json_array_size(cells), 30);
    json_t *cell = json_array_get(cells, 18); // 1000 rpm, crank-coupler
    assert_near(json_real_value(json_object_get(cell, "printed")), 0.1940, 0.0);
    assert_true(json_is_true(json_object_get(cell, "as_printed")));
    json_t *rows = json_object_get(object, "extremes");
    assert_int_equal(json_array_size(rows), PRINTED_ROW_COUNT);
    json_t *ours = json_object_get(json_array_get(rows, 0), "recomputed");
    assert_near(json_real_value(json_object_get(ours, "coupler_omega_max_rad_s")), 78.6973, 1e-4);
    assert_int_equal(json_array_size(json_object_get(object, "typos")), TYPOS_COUNT);
    json_decref(object);

    PaperResult failed = result;
    failed.extremes[PRINTED_IDEAL_NOMINAL].is_known = false;
    failed.ideal_difference_max = extremes_difference_max(failed.extremes);
    object = paper_json_make(&failed);
    rows = json_object_get(object, "extremes");
    assert_null(json_object_get(json_array_get(rows, 0), "recomputed"));
    json_t *ideal = json_object_get(object, "ideal");
    assert_true(json_is_null(json_object_get(ideal, "difference_max")));
    json_decref(object);
}

static void a_result_that_is_not_the_papers_is_an_error(void **state)
{
    (void)state;
    Err err = {ERR_NONE, ""};
    assert_true(paper_check(&result, &err));
    PaperResult altered = result;
    altered.as_printed--;
    assert_false(paper_check(&altered, &err));
    assert_int_equal(err.kind, ERR_DIFFERS);
    altered = result;
    altered.ideal_difference_max = NAN;
    err = (Err){ERR_NONE, ""};
    assert_false(paper_check(&altered, &err));
    assert_int_equal(err.kind, ERR_DIFFERS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_result_that_is_not_the_papers_is_an_error),
        cmocka_unit_test(all_90_cells_of_tables_1_to_3_come_out_as_printed),
        cmocka_unit_test(an_altered_alpha_breaks_the_count),
        cmocka_unit_test(the_exponent_of_the_text_does_not_give_table_2),
        cmocka_unit_test(the_clearance_of_table_4_does_not_give_table_2),
        cmocka_unit_test(correct_hertz_does_not_give_table_3),
        cmocka_unit_test(a_cell_agrees_only_to_its_last_digit),
        cmocka_unit_test(the_ideal_rows_come_out),
        cmocka_unit_test(the_crank_turns_clockwise_as_in_the_paper),
        cmocka_unit_test(the_rows_with_play_ran_and_count_as_no_target),
        cmocka_unit_test(the_peaks_of_the_impact_row_are_those_of_the_reference),
        cmocka_unit_test(the_real_pin_forces_are_those_of_inverse_dynamics),
        cmocka_unit_test(the_contact_under_the_real_force_is_johnsons),
        cmocka_unit_test(a_four_bar_that_is_not_one_is_refused),
        cmocka_unit_test(every_typo_says_what_it_is),
        cmocka_unit_test(the_text_shows_the_counts_and_the_typos),
        cmocka_unit_test(the_json_holds_every_cell_and_row),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
