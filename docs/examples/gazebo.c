// gazebo.c: which kp, kd and step for a contact that bounces with .8?
#include <jointplay/jointplay.h>
#include <stdio.h>

int main(void)
{
    const double mass = 0.2, kp = 1e6, speed = 1.0;
    JpError error;
    double kd, step;
    if (jp_damper_of(kp, 0.8, mass, &kd, &error) != JP_OK) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    printf("kd %.4g N s/m\n", kd);

    JpRow row;
    JpSpring made;
    double delivered;
    const JpInstant at_1_ms = {.step = 1e-3};
    jp_row_of_gazebo(kp, kd, at_1_ms.step, &row, &error);
    jp_spring_of(JP_MAP_CORRECTED, row, &at_1_ms, &made, &error);
    jp_restitution_of(made.stiffness, made.damper, mass, &delivered, &error);
    printf("at 1 ms the damper is %.4g N s/m\n", made.damper);

    JpContact contact = jp_contact_default();
    contact.stiffness = kp;
    contact.damping = JP_DAMPING_VISCOUS;
    contact.damper = kd;
    if (jp_step_longest(JP_MAP_TEXTBOOK, &contact, mass, speed, 0.05, &step, &error) != JP_OK) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    printf("right within 5 %% up to %.3g us with kp and kd\n", 1e6 * step);
    jp_step_longest(JP_MAP_CORRECTED, &contact, mass, speed, 0.05, &step, &error);
    printf("and up to %.3g us with ERP and CFM of map corrected\n", 1e6 * step);
    return 0;
}
