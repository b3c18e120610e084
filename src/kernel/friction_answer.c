// Bounds the largest eigenvalue of a matrix without negative numbers, which says whether frictions
// have one answer.
#include "kernel/friction_answer.h"

#include <math.h>

enum { POWERS = 24 }; // by which the eigenvalue is bounded

int friction_answer_fails(size_t n, const double *matrix, double *room)
{
    double *weight = room;
    double *weighed = room + n;
    int worst = -1;
    for (size_t i = 0; i < n; i++) {
        weight[i] = 1.0;
    }
    for (int power = 0; power < POWERS; power++) {
        double largest = 0.0;
        double most = 0.0;
        for (size_t i = 0; i < n; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < n; j++) {
                sum += matrix[i * n + j] * weight[j];
            }
            weighed[i] = sum;
            const double over = sum / weight[i];
            if (!(over <= largest)) {
                largest = over;
                worst = (int)i;
            }
            most = fmax(most, sum + weight[i]);
        }
        if (largest < 1.0) {
            return -1;
        }
        for (size_t i = 0; i < n; i++) {
            weight[i] = (weighed[i] + weight[i]) / most;
        }
    }
    return worst;
}

// By how much what presses in a joint changes with a pair of numbers, at most.
static double size_of(const KernelRub *rub, const double *pair)
{
    return rub->steady > 0.0 ? 0.0
           : rub->is_guide   ? fmax(fabs(pair[0]), fabs(pair[1]))
                             : hypot(pair[0], pair[1]);
}

int friction_answer_of_rubs_fails(const Kernel *kernel, double *room)
{
    const size_t n = kernel->rub_count;
    for (size_t i = 0; i < n; i++) {
        const KernelRub *of = &kernel->rubs[i];
        const ForceLaw *law = &kernel->contacts[of->contact].law;
        const double ratio = law->bristle.law == BRISTLE_STICK ? law->bristle.ratio : 1.0;
        for (size_t j = 0; j < n; j++) {
            const size_t row = kernel->contacts[kernel->rubs[j].contact].first_row;
            room[i * n + j] = law->friction * ratio * size_of(of, of->answers + 2 * row);
        }
    }
    return friction_answer_fails(n, room, room + n * n);
}

bool friction_answer_refuse(const char *joint, Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the friction of joint %s has no single answer: it changes what presses there "
                   "by as much as that changes it, as where its coefficient times the radius of "
                   "its pin comes up to the arm that it works on; lower friction or "
                   "friction-radius",
                   joint);
}
