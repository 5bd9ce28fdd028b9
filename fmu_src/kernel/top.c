#include "dynamics.h"

#include <string.h>

/*
 * What the cable hangs from: a floater that heaves, one that surges as well, or somebody else's vessel, whose motion is
 * an input. A floater has mass M on spring-dampers, its buoyancy carries static_load, its mooring static_pull:
 *     M y'' = u_m1 - static_load - k y - c y' - R_y        M x'' = u_m1x - static_pull - k_H x - c_H x' - R_x
 * R being the force through P_0 on the cable. A vessel takes -R and may have any acceleration.
 */

/* Along x and y, besides the cable's [N]; x[n + 1] is the surge. */
static void floater_force(const Model *model, const double *x, const double *u, double force[2])
{
    const double *p = model->parameter, *v = x + model->first_rate - 1;
    force[1] = u[U_u_m1] - p[P_static_load] - p[P_k_m1] * x[0] - p[P_c_m1] * v[0];
    if (model->top != TOP_FREE) return;
    const int surge = model->n + 1;
    force[0] = u[U_u_m1x] - p[P_static_pull] - p[P_k_m1H] * x[surge] - p[P_c_m1H] * v[surge];
}

void top_motion(const Model *model, const double *x, const double *u, Work *work)
{
    if (top_is_given(model)) {
        memcpy(&work->top, u + U_x_1, sizeof work->top);
        return;
    }
    Motion *top = &work->top;
    const double *v = x + model->first_rate - 1;
    const bool surges = model->top == TOP_FREE;
    const int surge = model->n + 1;
    top->position[0] = surges ? x[surge] : 0.0, top->position[1] = x[0];
    top->velocity[0] = surges ? v[surge] : 0.0, top->velocity[1] = v[0];
}

/* A floater that only heaves: fixed in x, mass M in y, and b = (0, force / M) when nothing hangs on it. */
void top_port(const Model *model, const double *x, const double *u, const Work *work, Port *port)
{
    if (top_is_given(model)) {
        const double *given = work->top.acceleration;
        *port = (Port){.det = 1.0, .bias_x = given[0], .bias_y = given[1]};
        return;
    }
    const double mass = model->parameter[P_M_1];
    double force[2];
    floater_force(model, x, u, force);
    *port = (Port){.xx = 1.0, .det = mass, .bias_y = force[1] / mass};
    if (model->top == TOP_FREE)
        *port = (Port){.xx = mass,
                       .yy = mass,
                       .unit = 1.0,
                       .det = mass * mass,
                       .bias_x = force[0] / mass,
                       .bias_y = force[1] / mass};
}

/* The top's own entries of q'', R = (pull_x, pull_y) being the force through P_0. */
void top_acceleration(const Model *model, const double *x, const double *u, double pull_x, double pull_y,
                      double *acceleration)
{
    acceleration[0] = 0.0;
    if (top_is_given(model)) return;
    const double mass = model->parameter[P_M_1];
    double force[2];
    floater_force(model, x, u, force);
    acceleration[0] = (force[1] - pull_y) / mass;
    if (model->top == TOP_FREE) acceleration[model->n + 1] = (force[0] - pull_x) / mass;
}

/* Kinetic energy, k y^2 / 2, and the work against what carries the static load; along x likewise. */
double top_energy(const Model *model, const Work *work)
{
    if (top_is_given(model)) return 0.0;
    const double *p = model->parameter;
    const double heave = work->top.position[1], velocity = work->top.velocity[1];
    const double energy = 0.5 * p[P_M_1] * velocity * velocity + (0.5 * p[P_k_m1] * heave + p[P_static_load]) * heave;
    if (model->top != TOP_FREE) return energy;
    const double surge = work->top.position[0], along = work->top.velocity[0];
    return energy + 0.5 * p[P_M_1] * along * along + (0.5 * p[P_k_m1H] * surge + p[P_static_pull]) * surge;
}
