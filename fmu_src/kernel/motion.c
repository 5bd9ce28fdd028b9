#include "dynamics.h"

/*
 * What moves along the cable, summed from the top: at the node above link i
 *     V_{i-1} = P_0' + sum_{k<i} l_k w_k n_k              velocity, for drag alone [m/s]
 *     C_{i-1} = sum_{k<i} l_k w_k^2 e_k                   centripetal part of the acceleration, reversed [m/s^2]
 * Inlined with a constant: the compiler makes two loops of it, and without drag no velocities.
 */
static inline void sum_along(const Model *model, const double *x, Work *work, bool with_velocity)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *rate = rates_in(model, x);
    const double *sine = work->sine, *cosine = work->cosine;
    double vx = work->top.velocity[0], vy = work->top.velocity[1], cx = 0.0, cy = 0.0;
    for (int i = 0; i < n; i++) {
        const double swing = length[i] * rate[i], inward = swing * rate[i];
        work->inward_x[i] = cx, work->inward_y[i] = cy;
        cx += inward * sine[i];
        cy += inward * cosine[i];
        if (!with_velocity) continue;
        work->velocity_x[i] = vx, work->velocity_y[i] = vy;
        vx += swing * cosine[i];
        vy -= swing * sine[i];
    }
    work->inward_x[n] = cx, work->inward_y[n] = cy;
}

void VARIANT(motion)(const Model *model, const double *x, Work *work)
{
    if (model->has_drag)
        sum_along(model, x, work, true);
    else
        sum_along(model, x, work, false);
}
