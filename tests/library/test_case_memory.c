// Is a call of the library of cases without memory an error, and the process as good as before?
//
// All memory of the process is asked for here. One request in a call is refused, or all from one
// on; whatever the call was doing it says so, or had no need of it, and the next one gives the same
// numbers as the first.
#include "close.h"

#include <jointplay/case.h>

#include <errno.h>
#include <malloc.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);

static atomic_bool is_counting;
static atomic_long asked;
static atomic_long refused_from; // the request that is refused, from 1; 0: none
static atomic_bool refuses_all;  // and all behind it

static bool is_refused(void)
{
    if (!atomic_load(&is_counting)) {
        return false;
    }
    const long number = atomic_fetch_add(&asked, 1) + 1;
    const long from = atomic_load(&refused_from);
    return from > 0 && (number == from || (number > from && atomic_load(&refuses_all)));
}

static void *refuse(void)
{
    errno = ENOMEM;
    return NULL;
}

void *malloc(size_t size)
{
    return is_refused() ? refuse() : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return is_refused() ? refuse() : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return is_refused() ? refuse() : __libc_realloc(old, size);
}

static const char TEXT[] = "title: A pin with play\n"
                           "bodies:\n"
                           "  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm],\n"
                           "        velocity: [0.5 m/s, 0 m/s]}\n"
                           "joints:\n"
                           "  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.2 mm,\n"
                           "         pin: 10 mm, width: 10 mm}\n"
                           "run: {duration: 3 ms, samples: 31, step: 10 us,\n"
                           "      backends: [reference, ode]}\n";

// One way through the library: a status, and the number at its end.
static JpCaseStatus go_through(double *number)
{
    JpCaseError error = {.status = JP_CASE_OK};
    JpNumber force = {.value = 0.0};
    JpColumn column;
    JpAnswer *answer = NULL;
    JpCase *of = jp_case_parse(TEXT, strlen(TEXT), "mine.yaml", &error);
    if (of != NULL && jp_case_set(of, "joints.hole.pin", "10.1 mm", &error) == JP_CASE_OK) {
        JpRunOptions options = jp_run_options_default();
        options.has_contacts = true;
        answer = jp_case_run(of, &options, &error);
    }
    if (answer != NULL && jp_answer_json(answer, NULL, &error) != NULL &&
        jp_answer_number_count(answer, &error) > 0 &&
        jp_answer_column(answer, "contacts", "force_max_N", &column, &error) == JP_CASE_OK &&
        jp_answer_text(answer, "screen", NULL, &error) != NULL) {
        jp_answer_number(answer, "ode.joints.hole.force_max_N", &force, &error);
    }
    jp_answer_free(answer);
    jp_case_free(of);
    *number = force.value;
    return error.status;
}

static JpCaseStatus go_without(long from, bool all, double *number)
{
    atomic_store(&asked, 0);
    atomic_store(&refused_from, from);
    atomic_store(&refuses_all, all);
    atomic_store(&is_counting, true);
    const JpCaseStatus status = go_through(number);
    atomic_store(&is_counting, false);
    return status;
}

static size_t bytes_taken(void)
{
    malloc_trim(0);
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

// Requests that are refused, one of every so many, at least one in the first of them.
enum { TRIALS = 100 };

static void refuse_each(bool all, size_t *broken, double *leaked)
{
    double truth;
    double number;
    assert_int_equal(go_without(0, false, &truth), JP_CASE_OK);
    const long count = atomic_load(&asked);
    assert_true(count > 1000 && truth > 0.0);
    const size_t before = bytes_taken();
    size_t calls;
    size_t lost;
    const size_t calls_before = jp_case_lost(&lost);
    for (int i = 0; i < TRIALS; i++) {
        // the early ones all, then ever fewer
        const long from = 1 + (long)((double)(count - 1) * (double)i * i / (TRIALS * TRIALS));
        const JpCaseStatus status = go_without(from, all, &number);
        if (status == JP_CASE_OK) {
            // somebody could do without, such as a sort
            assert_true(!all && number == truth);
        } else if (status != JP_CASE_ERROR_MEMORY && status != JP_CASE_ERROR_FILE) {
            print_message("request %ld of %ld: status %d\n", from, count, status);
            fail();
        }
        *broken += status == JP_CASE_ERROR_MEMORY;
        if (i % 10 == 0) {
            assert_int_equal(go_without(0, false, &number), JP_CASE_OK);
            assert_true(number == truth);
        }
    }
    calls = jp_case_lost(&lost) - calls_before;
    assert_true(calls >= *broken);
    *leaked = ((double)bytes_taken() - (double)before) / TRIALS;
}

static void one_request_that_is_refused_is_an_error(void **state)
{
    (void)state;
    size_t broken = 0;
    double leaked;
    refuse_each(false, &broken, &leaked);
    assert_true(broken > TRIALS / 2);
    print_message("# %zu of %d calls broke off; %.0f bytes a call are lost\n", broken, TRIALS,
                  leaked);
    assert_true(leaked < 60e3);
}

static void all_requests_from_one_on_are_an_error(void **state)
{
    (void)state;
    size_t broken = 0;
    double leaked;
    refuse_each(true, &broken, &leaked);
    assert_true(broken > TRIALS / 2);
    print_message("# %zu of %d calls broke off; %.0f bytes a call are lost\n", broken, TRIALS,
                  leaked);
    assert_true(leaked < 60e3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_request_that_is_refused_is_an_error),
        cmocka_unit_test(all_requests_from_one_on_are_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
