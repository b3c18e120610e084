// Reads tolerance classes of ISO 286-1: a letter for where the zone lies against the nominal size,
// a grade for how wide it is.
//
//     es = ei + IT        of a shaft, ei = es - IT
//     EI of a hole A to H is -es of the shaft of that letter; ES = EI + IT
//
// Standard tolerances and fundamental deviations are those of the tables of ISO 286-1:2010 for
// sizes up to 500 mm. Its formulas, i = 0.45 D^(1/3) + 0.001 D um with D mm the geometric mean of
// the size's step, IT6 to IT12 = 10, 16, 25, 40, 64, 100, 160 i and IT5 = 7 i, give the tables but
// for their rounding: tests/unit/test_fit.c. Holes K to ZC have a correction by the grade and some
// letters finer steps of sizes: they are refused.
#include "casefile/fit.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEP_COUNT = 13, GRADE_LEAST = 5, GRADE_COUNT = 8, CLASS_SIZE = 8 };

// mm, the largest size of each step
static const double SIZES[STEP_COUNT] = {3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500};

// um, by grade from IT5 on
// clang-format off
static const double GRADES[GRADE_COUNT][STEP_COUNT] = {
    {  4,   5,   6,   8,   9,  11,  13,  15,  18,  20,  23,  25,  27},
    {  6,   8,   9,  11,  13,  16,  19,  22,  25,  29,  32,  36,  40},
    { 10,  12,  15,  18,  21,  25,  30,  35,  40,  46,  52,  57,  63},
    { 14,  18,  22,  27,  33,  39,  46,  54,  63,  72,  81,  89,  97},
    { 25,  30,  36,  43,  52,  62,  74,  87, 100, 115, 130, 140, 155},
    { 40,  48,  58,  70,  84, 100, 120, 140, 160, 185, 210, 230, 250},
    { 60,  75,  90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400},
    {100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630},
};

// A letter of shafts: its fundamental deviation, um, that of the limit next to the nominal size.
typedef struct FitLetter {
    const char *name;
    bool is_above; // it is the lower limit, ei; else the upper one, es
    int grade_most; // up to which it holds
    double deviations[STEP_COUNT];
} FitLetter;

static const FitLetter LETTERS[] = {
    {"d",  false, 12, {-20, -30, -40, -50, -65, -80, -100, -120, -145, -170, -190, -210, -230}},
    {"e",  false, 12, {-14, -20, -25, -32, -40, -50, -60, -72, -85, -100, -110, -125, -135}},
    {"f",  false, 12, {-6, -10, -13, -16, -20, -25, -30, -36, -43, -50, -56, -62, -68}},
    {"g",  false, 12, {-2, -4, -5, -6, -7, -9, -10, -12, -14, -15, -17, -18, -20}},
    {"h",  false, 12, {0}},
    {"k",  true,   7, {0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5}},
    {"m",  true,  12, {2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23}},
    {"n",  true,  12, {4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40}},
    {"p",  true,  12, {6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68}},
};
// clang-format on

static const char SYMMETRIC[] = "js";
static const char HOLES[] = "D, E, F, G, H, JS";
static const char SHAFTS[] = "d, e, f, g, h, js, k (5 to 7), m, n, p";

// A text in parts.
typedef struct FitText {
    double size; // mm
    size_t class_count;
    struct {
        char letter[CLASS_SIZE];
        int grade;
    } classes[2];
} FitText;

static const char *skip_spaces(const char *text)
{
    return text + strspn(text, " \t");
}

// Takes a class from a text: letters and two digits at most.
static bool take_class(const char **text, FitText *fit)
{
    const char *at = skip_spaces(*text);
    size_t letters = 0;
    while (isalpha((unsigned char)at[letters])) {
        letters++;
    }
    const size_t digits = strspn(at + letters, "0123456789");
    if (letters == 0 || letters > 2 || digits == 0 || digits > 2) {
        return false;
    }
    char *letter = fit->classes[fit->class_count].letter;
    memcpy(letter, at, letters);
    letter[letters] = '\0';
    fit->classes[fit->class_count++].grade = atoi(at + letters);
    *text = skip_spaces(at + letters + digits);
    return true;
}

// size [mm] class [/ class]
static bool cut_fit(const char *text, FitText *fit)
{
    char *end;
    const char *start = skip_spaces(text);
    *fit = (FitText){.class_count = 0};
    if (strspn(start, "0123456789.") == 0) {
        return false;
    }
    fit->size = strtod(start, &end);
    const char *at = skip_spaces(end);
    if (strncmp(at, "mm", 2) == 0 && (at[2] == ' ' || at[2] == '\t')) {
        at += 2;
    }
    if (!take_class(&at, fit)) {
        return false;
    }
    if (*at == '/') {
        at++;
        return take_class(&at, fit) && *at == '\0';
    }
    return *at == '\0';
}

bool fit_is(const char *text)
{
    FitText fit;
    return cut_fit(text, &fit);
}

bool fit_is_of_both(const char *text)
{
    FitText fit;
    return cut_fit(text, &fit) && fit.class_count == 2;
}

static bool complain(Complaint *complaint, const char *what, const char *letter, int grade)
{
    snprintf(complaint->text, sizeof complaint->text, "%s: %s%d", what, letter, grade);
    snprintf(
        complaint->allowed, sizeof complaint->allowed,
        "holes %s, shafts %s, of grades %d to %d and sizes up to %g mm; or a tolerance such as "
        "30 +0.021/-0 mm",
        HOLES, SHAFTS, GRADE_LEAST, GRADE_LEAST + GRADE_COUNT - 1, SIZES[STEP_COUNT - 1]);
    return false;
}

static const FitLetter *find_letter(const char *name)
{
    for (size_t i = 0; i < sizeof LETTERS / sizeof *LETTERS; i++) {
        if (strcmp(LETTERS[i].name, name) == 0) {
            return &LETTERS[i];
        }
    }
    return NULL;
}

// The limits of a class against the nominal size, um.
static bool find_zone(double size, const char *class_letter, int grade, bool is_hole,
                      FitLimits *zone, Complaint *complaint)
{
    size_t step = 0;
    while (step < STEP_COUNT && size > SIZES[step]) {
        step++;
    }
    if (step == STEP_COUNT || !(size > 0.0)) {
        return complain(complaint, "the size is not in the table of fits", class_letter, grade);
    }
    if (grade < GRADE_LEAST || grade >= GRADE_LEAST + GRADE_COUNT) {
        return complain(complaint, "the grade is not in the table of fits", class_letter, grade);
    }
    const double width = GRADES[grade - GRADE_LEAST][step];
    char letter[CLASS_SIZE] = "";
    for (size_t i = 0; class_letter[i] != '\0'; i++) {
        letter[i] = (char)tolower((unsigned char)class_letter[i]);
    }
    if (strcmp(letter, SYMMETRIC) == 0) {
        *zone = (FitLimits){-0.5 * width, 0.5 * width};
        return true;
    }
    const FitLetter *found = find_letter(letter);
    if (found == NULL || grade > found->grade_most || (is_hole && found->is_above)) {
        return complain(complaint, "this class of fits is not known here", class_letter, grade);
    }
    const double deviation = found->deviations[step];
    *zone = is_hole           ? (FitLimits){-deviation, -deviation + width}
            : found->is_above ? (FitLimits){deviation, deviation + width}
                              : (FitLimits){deviation - width, deviation};
    return true;
}

static bool is_of_hole(const char *letter)
{
    return isupper((unsigned char)letter[0]) &&
           (letter[1] == '\0' || isupper((unsigned char)letter[1]));
}

static bool is_of_shaft(const char *letter)
{
    return islower((unsigned char)letter[0]) &&
           (letter[1] == '\0' || islower((unsigned char)letter[1]));
}

bool fit_read(const char *text, bool is_hole, FitLimits *limits, Complaint *complaint)
{
    FitText fit = {.class_count = 0};
    complaint->allowed[0] = '\0';
    if (!cut_fit(text, &fit)) {
        snprintf(complaint->text, sizeof complaint->text, "'%.40s' is no fit", text);
        return false;
    }
    // of both the hole's stands first
    const size_t number = is_hole || fit.class_count == 1 ? 0 : 1;
    const char *letter = fit.classes[number].letter;
    const int grade = fit.classes[number].grade;
    if (is_hole ? !is_of_hole(letter) : !is_of_shaft(letter)) {
        return complain(complaint,
                        is_hole ? "a hole has a class of capital letters"
                                : "a pin has a class of small letters",
                        letter, grade);
    }
    FitLimits zone;
    if (!find_zone(fit.size, letter, grade, is_hole, &zone, complaint)) {
        return false;
    }
    *limits = (FitLimits){fit.size + 1e-3 * zone.low, fit.size + 1e-3 * zone.high};
    return true;
}
