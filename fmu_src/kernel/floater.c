#include "dynamics.h"

/* The force on floater 1 besides the cable's: u_m1 - static_load - k y - c y'. */
static double floater_force(const Model *model, const double *x, const double *u)
{
    const double *p = model->parameter;
    return u[U_u_m1] - p[P_static_load] - p[P_k_m1] * x[0] - p[P_c_m1] * x[model->n + 1];
}

/* The floater heaves and does not surge: fixed in x, mass M in y, and b = (0, force / M) when nothing hangs on it. */
void top_port(const Model *model, const double *x, const double *u, Port *port)
{
    const double mass = model->parameter[P_M_1];
    *port = (Port){.xx = 1.0, .det = mass, .bias_y = floater_force(model, x, u) / mass};
}

/* M y'' = force - R_y, R = (pull_x, pull_y) being the cable's pull. */
double top_acceleration(const Model *model, const double *x, const double *u, double pull_x, double pull_y)
{
    (void)pull_x; /* borne by what keeps the floater from surging */
    return (floater_force(model, x, u) - pull_y) / model->parameter[P_M_1];
}

/* Kinetic energy, k_m y_m^2 / 2, and the work against the buoyancy that carries the static load. */
double floater_energy(const Model *model, const double *x)
{
    const double *p = model->parameter;
    const double heave = x[0], velocity = x[model->n + 1];
    return 0.5 * p[P_M_1] * velocity * velocity + (0.5 * p[P_k_m1] * heave + p[P_static_load]) * heave;
}
