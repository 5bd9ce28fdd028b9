#include "dynamics.h"

/*
 * M y'' + c y' + k y = u_m1 - static_load - R_y, where the cable pulls with R = A a + b on the top point
 * and a = (0, y''): the floater heaves and does not surge. The acceleration is a 2-vector so that other
 * tops may move in x as well.
 */
void top_acceleration(const Model *model, const double *x, const double *u, const double inertia[3],
                      const double bias[2], double acceleration[2])
{
    const double *p = model->parameter;
    const double heave = x[0], velocity = x[model->n + 1];
    const double force = u[U_u_m1] - p[P_static_load] - p[P_k_m1] * heave - p[P_c_m1] * velocity;
    acceleration[0] = 0.0;
    acceleration[1] = (force - bias[1]) / (p[P_M_1] + inertia[2]);
}

/* Kinetic energy, k_m y_m^2 / 2, and the work against the buoyancy that carries the static load. */
double floater_energy(const Model *model, const double *x)
{
    const double *p = model->parameter;
    const double heave = x[0], velocity = x[model->n + 1];
    return 0.5 * p[P_M_1] * velocity * velocity + (0.5 * p[P_k_m1] * heave + p[P_static_load]) * heave;
}
