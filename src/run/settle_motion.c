// Sums up what starts do in the motion that they have come to.
//
// Of a motion that repeats a number is its largest over the period. Of one that does not it is a
// random number, a revolution at a time, and is told by quantiles of the revolutions of all starts
// (base/quantile.h).
#include "base/quantile.h"
#include "base/zeroed.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdlib.h>

// 1: the share of revolutions below the headline of a motion that does not repeat
static const double HEADLINE = 0.95;

// 1: two distributions whose headlines differ by less are one for who designs a joint
static const double DIFFERENT = 0.1;

// of both half intervals together, which 2 of them leave to chance in one pair of ten thousand
static const double APART = 2.0;

// 1: what a number of a revolution may be off by that is turned at the reference's loosest
// tolerance (run/settling.c)
static const double TURNED_TO = 1e-3;

// The revolutions that count, of some starts.
typedef struct Counted {
    const Settling *const *settlings;
    size_t count;
    double *values;  // room for one number of all of them; owned, like the next
    size_t *lengths; // by start
} Counted;

static SettledNumber number_of_period(const Counted *counted, size_t number)
{
    const size_t many = settling_numbers(counted->settlings[0], number, counted->values);
    double largest = 0.0;
    double sum = 0.0;
    for (size_t k = 0; k < many; k++) {
        largest = fmax(largest, counted->values[k]);
        sum += counted->values[k];
    }
    return (SettledNumber){
        .headline = largest,
        .low = largest,
        .high = largest,
        .median = largest,
        .median_low = largest,
        .median_high = largest,
        .largest = largest,
        .mean = sum / (double)many,
    };
}

static SettledNumber number_of_all(const Counted *counted, size_t number)
{
    size_t many = 0;
    for (size_t i = 0; i < counted->count; i++) {
        counted->lengths[i] =
            settling_numbers(counted->settlings[i], number, counted->values + many);
        many += counted->lengths[i];
    }
    const QuantileSeries series = {counted->values, many, counted->lengths, counted->count};
    const Quantile headline = quantile_of(&series, HEADLINE);
    const Quantile median = quantile_of(&series, 0.5);
    SettledNumber found = {
        .headline = headline.value,
        .low = (1.0 - TURNED_TO) * headline.low,
        .high = (1.0 + TURNED_TO) * headline.high,
        .median = median.value,
        .median_low = (1.0 - TURNED_TO) * median.low,
        .median_high = (1.0 + TURNED_TO) * median.high,
    };
    for (size_t k = 0; k < many; k++) {
        found.largest = fmax(found.largest, counted->values[k]);
        found.mean += counted->values[k] / (double)many;
    }
    return found;
}

static SettledNumber number_of(const Counted *counted, size_t number)
{
    return (counted->settlings[0]->period > 0 ? number_of_period : number_of_all)(counted, number);
}

// Of a revolution of the drive, of which a common period with loads may have several.
static SettledNumber impacts_of(const Counted *counted, size_t joint)
{
    const double turns = scenario_settling_turns(&counted->settlings[0]->scenario);
    SettledNumber found = number_of(counted, settle_joint_number(joint, SETTLE_IMPACTS));
    double *const values[] = {&found.headline,   &found.low,         &found.high,    &found.median,
                              &found.median_low, &found.median_high, &found.largest, &found.mean};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        *values[i] /= turns;
    }
    return found;
}

// The angular velocities at the ends of the revolutions that count, of the first start.
static void add_sections(const Settling *settling, SettledMotion *motion)
{
    const Linkage *linkage = &settling->scenario.linkage;
    const size_t counted = settling_counted(settling);
    motion->section_count = counted < SETTLE_PERIOD_MAX ? counted : SETTLE_PERIOD_MAX;
    motion->sections =
        zeroed(motion->section_count * linkage->body_count, sizeof *motion->sections);
    for (size_t k = 0; k < motion->section_count; k++) {
        const size_t number = settling->count - motion->section_count + k;
        for (size_t i = 0; i < linkage->body_count; i++) {
            // the last of the rates is that about z, times the reach
            const double *rates = settling->revolutions[number].section + SETTLE_RATES * i;
            const double reach = linkage_reach(linkage, (int)i);
            motion->sections[k * linkage->body_count + i] =
                reach > 0.0 ? rates[SETTLE_RATES - 1] / reach : 0.0;
        }
    }
}

static void add_numbers(const Counted *counted, SettledMotion *motion)
{
    const Linkage *linkage = &counted->settlings[0]->scenario.linkage;
    motion->joints = zeroed(linkage->joint_count, sizeof *motion->joints);
    motion->alpha = zeroed(linkage->body_count, sizeof *motion->alpha);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            motion->joints[i] = (SettledJoint){
                .force = number_of(counted, settle_joint_number(i, SETTLE_FORCE)),
                .depth = number_of(counted, settle_joint_number(i, SETTLE_DEPTH)),
                .impacts = impacts_of(counted, i),
                .contact = number_of(counted, settle_joint_number(i, SETTLE_CONTACT)),
            };
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        motion->alpha[i] = number_of(counted, settle_body_number(linkage, i));
    }
    for (size_t i = 0; i < LINKAGE_DRIVE_MAX; i++) {
        motion->drives[i] = number_of(counted, settle_drive_number(linkage, i));
    }
}

SettledMotion settle_motion_of(const Settling *const *settlings, size_t count, size_t of)
{
    const Quantile share = quantile_share(count, of);
    SettledMotion motion = {
        .starts = count,
        .share_low = share.low,
        .share_high = share.high,
        .period = settlings[0]->period,
        .change = settlings[0]->change,
        .watched = settlings[0]->count,
    };
    size_t room = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t watched = settlings[i]->count;
        room += watched;
        motion.watched = watched < motion.watched ? watched : motion.watched;
        motion.counted += motion.period == 0 ? settling_counted(settlings[i]) : 0;
    }
    motion.counted = motion.period > 0 ? motion.period : motion.counted;
    const Counted counted = {
        .settlings = settlings,
        .count = count,
        .values = zeroed(room, sizeof *counted.values),
        .lengths = zeroed(count, sizeof *counted.lengths),
    };
    add_numbers(&counted, &motion);
    add_sections(settlings[0], &motion);
    free(counted.values);
    free(counted.lengths);
    return motion;
}

// Half of the interval of a headline.
static double half_width(const SettledNumber *number)
{
    return 0.5 * (number->high - number->low);
}

double settle_motion_width(const SettledMotion *motion, const Linkage *linkage)
{
    double widest = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SettledNumber *force = &motion->joints[i].force;
        if (linkage_has_play(&linkage->joints[i]) && force->headline > 0.0) {
            widest = fmax(widest, half_width(force) / force->headline);
        }
    }
    return widest;
}

bool settle_motions_differ(const SettledMotion *a, const SettledMotion *b, const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SettledNumber *of_a = &a->joints[i].force;
        const SettledNumber *of_b = &b->joints[i].force;
        const double apart = fabs(of_a->headline - of_b->headline);
        if (apart > DIFFERENT * fmax(of_a->headline, of_b->headline) &&
            apart > APART * (half_width(of_a) + half_width(of_b))) {
            return true;
        }
    }
    return false;
}
