#include "dynamics.h"

/* 1/2 k_1 th_1^2 + 1/2 sum k_i (th_i - th_{i-1})^2; the print leaves it out of [3.2] and its kin. */
static double joint_energy(const Model *model, const double *x)
{
    double energy = 0.0, above = 0.0;
    for (int i = 0; i < model->n; i++) {
        const double bend = x[1 + i] - above;
        energy += 0.5 * model->stiffness[i] * bend * bend;
        above = x[1 + i];
    }
    return energy;
}

/*
 * E = floater + joint springs + terminal + sum over links of
 *     m V_c^2 / 2 + I_R w^2 / 2 - m^w g Y_c,   c the link's centre.
 * I_R being with I_Rc on the last link. External forces are left out.
 */
double cable_energy(const Model *model, const double *x, const Work *work)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS], *rate = rates_in(model, x);
    double y = work->top.position[1], vx = work->top.velocity[0], vy = work->top.velocity[1], energy = 0.0;
    for (int i = 0; i < n; i++) {
        const double l = length[i], swing = 0.5 * l * rate[i];
        const double step_x = swing * work->cosine[i], step_y = -swing * work->sine[i];
        const double cx = vx + step_x, cy = vy + step_y;
        const double inertia = link_inertia(model, i);
        energy += 0.5 * mass[i] * (cx * cx + cy * cy) + 0.5 * inertia * rate[i] * rate[i] -
                  model->weight[i] * (y + 0.5 * l * work->cosine[i]);
        y += l * work->cosine[i];
        vx += 2.0 * step_x;
        vy += 2.0 * step_y;
    }
    return energy + joint_energy(model, x) + top_energy(model, work) +
           terminal_energy(model, work->end_position, work->end_velocity);
}
