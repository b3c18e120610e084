// stop.cpp: what spring and damper is the stop of a hinge?
#include <jointplay/jointplay.h>

#include <cstdio>

int main()
{
    const double inertia = 0.01;
    JpError error{};
    JpInstant at{};
    at.step = 0.5e-3;
    JpSpring spring{};
    // dParamStopERP .8, dParamStopCFM 1
    if (jp_spring_of(JP_MAP_CORRECTED, jp_row_of(0.8, 1.0), &at, &spring, &error) != JP_OK) {
        std::fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    std::printf("%.4g N m/rad, %.4g N m s/rad\n", spring.stiffness, spring.damper);

    JpContact stop = jp_contact_default();
    stop.stiffness = spring.stiffness;
    stop.damping = JP_DAMPING_VISCOUS;
    stop.damper = spring.damper;
    JpDelivered delivered{};
    jp_impact_of_rows(JP_MAP_CORRECTED, &stop, inertia, 2.0, at.step, &delivered, &error);
    std::printf("restitution %.3f to %.3f\n", delivered.least.restitution,
                delivered.most.restitution);
    return 0;
}
