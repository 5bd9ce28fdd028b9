#include "directional.h"
#include "effective_mass.h"

#include <string.h>

bool directional_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear)
{
    linear_point(model, x, work, derivative, linear);
    return linear_factor(model, (Weights){0.0, 0.0, 1.0}, linear) >= 0;
}

/* P_n and its velocity. */
static void terminal_changes(const Model *model, const Linear *linear, const double *dq, const double *dv,
                             const double *du, double *dy)
{
    const double *length = model->link[LINK_LENGTH];
    double z[MOST_COLUMNS];
    linear_top(model, dq, dv, NULL, du, z);
    double vx = z[2], vy = z[3], px = z[4], py = z[5];
    dy[Y_x_m1] = px, dy[Y_y_m1] = py, dy[Y_vx_m1] = vx, dy[Y_v_m1] = vy;
    for (int i = 0; i < model->n; i++) {
        const double nx = linear->cosine[i], ny = -linear->sine[i], ex = -ny, ey = nx, l = length[i];
        const double spin = linear->rate[i] * dq[i + 1];
        px += l * nx * dq[i + 1];
        py += l * ny * dq[i + 1];
        vx += l * (nx * dv[i + 1] - ex * spin);
        vy += l * (ny * dv[i + 1] - ey * spin);
    }
    dy[Y_x_c] = px, dy[Y_y_c] = py, dy[Y_vx_c] = vx, dy[Y_vy_c] = vy;
}

/* Of the pull -R . e at a node along link i: -dR . e - R . n dth. */
static double pull_change(const Linear *linear, int node, int i, double turn)
{
    const double ex = linear->sine[i], ey = linear->cosine[i];
    return -(linear->react_x[node] * ex + linear->react_y[node] * ey) -
           (linear->force_x[node] * ey - linear->force_y[node] * ex) * turn;
}

/* The largest pull changes as the one does that is the largest. */
void pulls_of_outputs(const Model *model, const Linear *linear, Pull pull[PULLS])
{
    const int n = model->n;
    double largest = -1.0 / 0.0;
    pull[0] = (Pull){Y_tension_top, 0, 0};
    pull[1] = (Pull){Y_tension_end, n, n - 1};
    pull[2] = (Pull){Y_tension_max, 0, 0};
    for (int i = 0; i < n; i++) {
        for (int node = i; node <= i + 1; node++) {
            const double here = -(linear->force_x[node] * linear->sine[i] + linear->force_y[node] * linear->cosine[i]);
            if (!(here > largest)) continue;
            largest = here;
            pull[2].node = node, pull[2].link = i;
        }
    }
}

/* Of top_energy(), P_0 moving by z. */
static double top_energy_change(const Model *model, const Motion *top, const double z[MOST_COLUMNS])
{
    if (top_is_given(model)) return 0.0;
    const double *p = model->parameter;
    const double heaved = p[P_k_m1] * top->position[1] + p[P_static_load];
    const double change = p[P_M_1] * top->velocity[1] * z[3] + heaved * z[5];
    if (model->top != TOP_FREE) return change;
    return change + p[P_M_1] * top->velocity[0] * z[2] + (p[P_k_m1H] * top->position[0] + p[P_static_pull]) * z[4];
}

/* The derivative of energy.c, line by line. */
static double energy_change(const Model *model, const double *x, const Motion *top, const Linear *linear,
                            const double *dx, const double *du)
{
    const int n = model->n, half = model_coordinates(model);
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const double *dq = dx, *dv = dx + half, *v = x + half;
    double z[MOST_COLUMNS];
    linear_top(model, dq, dv, NULL, du, z);
    double px = top->position[0], py = top->position[1], vx = top->velocity[0], vy = top->velocity[1];
    double dvx = z[2], dvy = z[3], dpx = z[4], dpy = z[5];
    double change = top_energy_change(model, top, z);
    for (int i = 0; i < n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, l = length[i];
        const double rate = v[i + 1], dt = dq[i + 1], spin = rate * dt;
        const double inertia = link_inertia(model, i);
        const double step_x = l * rate * nx, step_y = l * rate * ny;
        const double d_step_x = l * (nx * dv[i + 1] - ex * spin), d_step_y = l * (ny * dv[i + 1] - ey * spin);
        const double above = i ? x[i] : 0.0, d_above = i ? dq[i] : 0.0;
        change +=
            mass[i] * ((vx + 0.5 * step_x) * (dvx + 0.5 * d_step_x) + (vy + 0.5 * step_y) * (dvy + 0.5 * d_step_y));
        change += inertia * rate * dv[i + 1] - model->weight[i] * (dpy + 0.5 * l * ny * dt);
        change += model->stiffness[i] * (x[i + 1] - above) * (dt - d_above);
        px += l * ex, py += l * ey, dpx += l * nx * dt, dpy += l * ny * dt;
        vx += step_x, vy += step_y, dvx += d_step_x, dvy += d_step_y;
    }
    change += model->end_mass * (vx * dvx + vy * dvy) - model->end_weight * dpy;
    if (!model->has_spring) return change;
    change += (model->spring[0] * (px - model->rest[0]) - model->preload[0]) * dpx;
    return change + (model->spring[1] * (py - model->rest[1]) - model->preload[1]) * dpy;
}

void directional_derivatives(const Model *model, const double *x, Linear *linear, const double *dx, const double *du,
                             double *d_derivative, double *d_output)
{
    const int half = model_coordinates(model);
    const double *dq = dx, *dv = dx + half;
    double *da = d_derivative + half, *force = d_derivative, end[2];
    /* M da = du - ID_q dq - ID_v dv */
    if (d_output) effective_mass_changes(model, linear, dq, d_output);
    linear_apply(model, linear, dq, dv, NULL, force, end);
    for (int k = 0; k < half; k++) force[k] = -force[k];
    for (int k = 0; k < 2; k++) end[k] = -end[k];
    linear_inputs(model, linear, du, force, end);
    linear_solve(model, linear, force, end, da);
    memcpy(d_derivative, dv, (size_t)half * sizeof *dv);
    if (!d_output) return;
    linear_reactions(model, linear, dq, dv, da, du);
    terminal_changes(model, linear, dq, dv, du, d_output);
    d_output[Y_F_1x] = -linear->react_x[0], d_output[Y_F_1y] = -linear->react_y[0];
    d_output[Y_F_2x] = linear->react_x[model->n], d_output[Y_F_2y] = linear->react_y[model->n];
    Pull pull[PULLS];
    pulls_of_outputs(model, linear, pull);
    for (int k = 0; k < PULLS; k++)
        d_output[pull[k].output] = pull_change(linear, pull[k].node, pull[k].link, dq[pull[k].link + 1]);
    d_output[Y_energy] = energy_change(model, x, &linear->p_0, linear, dx, du);
}
