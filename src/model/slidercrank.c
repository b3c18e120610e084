// Finds how far the crank of a slider-crank can turn.
//
// a crank, b rod, e offset, p the crank's angle from the line: the loop closes while
//     |e - a sin p| <= b
// so that the crank turns through every angle where a + |e| < b.
#include "model/slidercrank.h"

#include <math.h>

double slidercrank_rise(const SliderCrank *mechanism, double crank_angle)
{
    return fabs(mechanism->offset - mechanism->crank * sin(crank_angle - mechanism->line));
}

bool slidercrank_turns(const SliderCrank *mechanism)
{
    return mechanism->crank + fabs(mechanism->offset) < mechanism->rod;
}

double slidercrank_travel(const SliderCrank *mechanism, double reach, double start,
                          double direction)
{
    double travel = INFINITY;
    for (int sign = -1; sign <= 1; sign += 2) {
        const double sine = (mechanism->offset + sign * reach) / mechanism->crank;
        if (!(fabs(sine) <= 1.0)) {
            continue;
        }
        const double angles[2] = {asin(sine), M_PI - asin(sine)};
        for (int i = 0; i < 2; i++) {
            double turned = fmod(direction * (angles[i] + mechanism->line - start), 2.0 * M_PI);
            turned += turned < 0.0 ? 2.0 * M_PI : 0.0;
            travel = fmin(travel, turned);
        }
    }
    return travel;
}
