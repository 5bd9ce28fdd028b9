#include "dynamics.h"

/*
 * Joint i turns by th_i - th_{i-1}, joint 1 by th_1 itself (it hangs on the floater, which does not turn).
 * T_i acts on link i with - and on link i - 1 with +; there is no joint below link n, so T_{n+1} = 0 [5.2].
 */
void joint_torques(const Model *model, const double *x, Work *work)
{
    const int n = model->n;
    const double *angle = x + 1, *rate = x + n + 2;
    double *torque = work->torque;
    for (int i = 0; i < n; i++) torque[i] = 0.0;
    if (model->has_stiffness) {
        double above = 0.0;
        for (int i = 0; i < n; i++) {
            const double pull = model->stiffness[i] * (angle[i] - above);
            torque[i] -= pull;
            if (i > 0) torque[i - 1] += pull;
            above = angle[i];
        }
    }
    if (model->has_damping) {
        double above = 0.0;
        for (int i = 0; i < n; i++) {
            const double pull = model->damping[i] * (rate[i] - above);
            torque[i] -= pull;
            if (i > 0) torque[i - 1] += pull;
            above = rate[i];
        }
    }
}

/* 1/2 k_1 th_1^2 + 1/2 sum k_i (th_i - th_{i-1})^2; the print leaves it out of [3.2] and its kin. */
double joint_energy(const Model *model, const double *x)
{
    double energy = 0.0, above = 0.0;
    for (int i = 0; i < model->n; i++) {
        const double bend = x[1 + i] - above;
        energy += 0.5 * model->stiffness[i] * bend * bend;
        above = x[1 + i];
    }
    return energy;
}
