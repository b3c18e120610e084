// The runs of tests/bench/python_runs.py in C: N runs of a case at N plays, through
// libjointplay-case. Prints the processor time that they took, s, and the sum of their largest
// forces, N. Usage: case_runs CASE N
#include <jointplay/case.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int count, char **words)
{
    if (count != 3) {
        return 2;
    }
    JpCaseError error;
    JpCase *paper = jp_case_open(words[1], &error);
    const long runs = strtol(words[2], NULL, 10);
    const char *keys[] = {"run.start", "reference.tolerance", "run.samples"};
    const char *values[] = {"centred", "1e-5", "360"};
    JpRunOptions options = jp_run_options_default();
    options.backends = "reference";
    options.is_uncertified = true;
    options.is_quick = true;
    options.is_whole = false;
    options.threads = 1;
    bool is_good = paper != NULL && jp_case_set_all(paper, keys, values, 3, &error) == JP_CASE_OK;
    const clock_t begin = clock();
    double sum = 0;
    for (long i = 0; i < runs && is_good; i++) {
        const double play = 10e-6 + 10e-6 * (double)i / (double)runs;
        JpAnswer *answer = NULL;
        JpNumber force;
        is_good = jp_case_set_number(paper, "joints.crank-coupler.radial-clearance", play,
                                     &error) == JP_CASE_OK &&
                  (answer = jp_case_run(paper, &options, &error)) != NULL &&
                  jp_answer_number(answer, "joints.crank-coupler.force_max_N", &force, &error) ==
                      JP_CASE_OK;
        sum += is_good ? force.value : 0;
        jp_answer_free(answer);
    }
    const double spent = (double)(clock() - begin) / CLOCKS_PER_SEC;
    if (!is_good) {
        fprintf(stderr, "%s\n", error.text);
    }
    printf("%.6f %.17g\n", spent, sum);
    jp_case_free(paper);
    return is_good ? 0 : 1;
}
