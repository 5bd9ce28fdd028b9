#include "equilibrium_change.h"

#include <string.h>

#include "statics.h"

bool equilibrium_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear)
{
    linear_point(model, x, work, derivative, linear);
    if (statics_holds_end(model)) linear_pin(linear);
    return linear_factor(model, (Weights){1.0, 0.0, 0.0}, linear) == 0;
}

void equilibrium_change(const Model *model, Linear *linear, const double *du, double *force, double *dq)
{
    double end[2] = {0.0, 0.0};
    memset(force, 0, ((size_t)model->n + 1) * sizeof *force);
    linear_inputs(model, linear, du, force, end);
    linear_solve(model, linear, force, end, dq);
}

void equilibrium_adjoint(const Model *model, Linear *linear, const double *seed, double *change, double *to_input)
{
    const double *length = model->link[LINK_LENGTH], none[2] = {0.0, 0.0};
    linear_solve(model, linear, seed, none, change); /* K is symmetric */
    double x = 0.0, y = change[0]; /* what moves with a force on the end: P_n, or the relation of a held end */
    for (int i = 0; i < model->n; i++) {
        x += length[i] * linear->cosine[i] * change[i + 1];
        y -= length[i] * linear->sine[i] * change[i + 1];
    }
    if (linear->is_held) x = linear->through[0] * linear->held.per_mass, y = linear->through[1] * linear->held.per_mass;
    to_input[U_u_m1] += change[0];
    to_input[U_F_cx] += x;
    to_input[U_F_cy] += y, to_input[U_u_m2] += y;
}
