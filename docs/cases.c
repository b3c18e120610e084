// cases.c: runs a case with settings, KEY=VALUE each, and prints what `jointplay run --json` prints
#include <jointplay/case.h>
#include <stdio.h>
#include <string.h>

static int fail(const JpCaseError *error)
{
    fprintf(stderr, "%s\n", error->text); // the sentence of the command line, with the place
    return (int)error->status;
}

int main(int argc, char **argv)
{
    JpCaseError error;
    JpCase *of = jp_case_open(argc > 1 ? argv[1] : "impact-k66", &error);
    for (int i = 2; of != NULL && i < argc; i++) {
        char *value = strchr(argv[i], '=');
        if (value != NULL) {
            *value++ = '\0';
        }
        if (jp_case_set(of, argv[i], value, &error) != JP_CASE_OK) {
            jp_case_free(of);
            return fail(&error);
        }
    }
    JpRunOptions options = jp_run_options_default(); // .backends = "reference": not the case's
    JpAnswer *answer = of != NULL ? jp_case_run(of, &options, &error) : NULL;
    jp_case_free(of); // an answer needs its case no more
    if (answer == NULL) {
        return fail(&error);
    }
    JpNumber peak;
    if (jp_answer_number(answer, "alpha_peak_rad_s2", &peak, &error) == JP_CASE_OK) {
        fprintf(stderr, "%s: %.4g %s\n", peak.doc, peak.value, peak.unit);
    }
    printf("%s\n", jp_answer_json(answer, NULL, &error));
    jp_answer_free(answer);
    return 0;
}
