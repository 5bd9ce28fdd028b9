#include "dynamics.h"

/*
 * Joint i turns by th_i - th_{i-1}, joint 1 by th_1 itself (it hangs on the floater, which does not turn).
 * T_i acts on link i with - and on link i - 1 with +; there is no joint below link n, so T_{n+1} = 0 [5.2].
 */
void VARIANT(joint_torques)(const Model *model, const double *x, Work *work)
{
    const int n = model->n;
    const double *angle = x + 1, *rate = rates_in(model, x);
    const double *stiffness = model->stiffness, *damping = model->damping;
    double *joint = work->joint, *torque = work->torque;
    joint[0] = stiffness[0] * angle[0] + damping[0] * rate[0];
    joint[n] = 0.0;
    if (model->has_stiffness && model->has_damping) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++)
            joint[i] = stiffness[i] * (angle[i] - angle[i - 1]) + damping[i] * (rate[i] - rate[i - 1]);
    } else if (model->has_stiffness) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++) joint[i] = stiffness[i] * (angle[i] - angle[i - 1]);
    } else if (model->has_damping) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++) joint[i] = damping[i] * (rate[i] - rate[i - 1]);
    } else {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++) joint[i] = 0.0;
    }
    LINKS_ARE_INDEPENDENT
    for (int i = 0; i < n; i++) torque[i] = joint[i + 1] - joint[i];
}
