// Has the stiffness of a pin in the hole of an eye, by elasticity; and what law a pin has of which
// none is asked for.
//
// elastic  contact/eye.h, of a pin over whose width pin and hole touch
// auto     elastic where there is a width, else the law of a sphere in a socket, which needs none
#include "contact/eye.h"
#include "contact/law.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

// of an eye whose outer radius is not given, in radii of the hole: a usual one
static const double USUAL_EYE = 2.0;

// What was found last. Whoever changes a case in anything but its radii and materials, or these in
// turn, finds it here.
enum { KEPT = 8 };

typedef struct Found {
    Eye eye;
    bool is_sound;
    double series[CONFORMING_TERMS];
} Found;

static _Thread_local struct {
    Found found[KEPT];
    size_t count; // of all that were found
} kept;

static const Found *find(const Eye *eye)
{
    for (size_t i = 0; i < kept.count && i < KEPT; i++) {
        if (memcmp(&kept.found[i].eye, eye, sizeof *eye) == 0) {
            return &kept.found[i];
        }
    }
    Found *found = &kept.found[kept.count++ % KEPT];
    found->eye = *eye;
    found->is_sound = eye_series(eye, found->series);
    return found;
}

double law_eye_ratio(double eye_radius, double hole_radius)
{
    return eye_radius > 0.0 ? eye_radius / hole_radius : USUAL_EYE;
}

static Eye eye_of(const ContactPair *pair)
{
    const double outer = law_eye_ratio(pair->eye_radius, pair->hole_radius);
    if (pair->pin_modulus == 0.0) {
        return (Eye){outer, 0.5, pair->poisson_ratio, pair->poisson_ratio};
    }
    const double hole = (1.0 - pair->poisson_ratio * pair->poisson_ratio) / pair->youngs_modulus;
    const double pin = (1.0 - pair->pin_ratio * pair->pin_ratio) / pair->pin_modulus;
    return (Eye){outer, hole / (hole + pin), pair->poisson_ratio, pair->pin_ratio};
}

static void make_elastic(const ContactPair *pair, ForceLaw *law)
{
    const Eye eye = eye_of(pair);
    const Found *found = find(&eye);
    const double stiffness = found->is_sound ? PI * law_effective_modulus(pair) * pair->width : NAN;
    *law = force_law_conforming(stiffness, pair->hole_radius - pair->pin_radius, found->series);
}

static void make_auto(const ContactPair *pair, ForceLaw *law)
{
    law_get(law_chosen(LAW_AUTO, pair->width))->make(pair, law);
}

LawKind law_chosen(LawKind kind, double width)
{
    return kind != LAW_AUTO ? kind : width > 0.0 ? LAW_ELASTIC : LAW_HERTZ_SOCKET;
}

const Law law_elastic = {.needs_width = true, .make = make_elastic};
const Law law_auto = {.make = make_auto};
