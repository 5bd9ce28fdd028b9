#include "effective_mass.h"

#include <string.h>

/*
 * Let P_0 accelerate by 1 along axis k, and nothing else act: links then turn by w_k, and the reactions R_k go with it. The
 * cable's inertia there is the force that this takes,
 *     m_kl = R_k . l   at the top        m_kl = -R_k . l   at the lower end, through which R goes the other way.
 * As the turns are those of least constraint (Gauss), m_kl changes with the angles as if they and R stayed what they are:
 *     dm_kl / dth_i = -(l_i / 2) e_i . (w_k,i (R_l,i + R_l,i+1) + w_l,i (R_k,i + R_k,i+1))
 */
typedef struct {
    Input first;   /* acceleration along x; that along y is next */
    Output output; /* m_xx, followed by m_xy and m_yy */
    int node;
    double sign;
} End;

/* The given ends; how many. */
static int given_ends(const Model *model, End end[2])
{
    int count = 0;
    if (top_is_given(model)) end[count++] = (End){U_ax_1, Y_m_1xx, 0, 1.0};
    if (model->terminal == TERMINAL_MOTION) end[count++] = (End){U_ax_2, Y_m_2xx, model->n, -1.0};
    return count;
}

/* w and R of both axes; they stay until there are other factors, as a host's dense Jacobian asks n times for them. */
static void accelerate(const Model *model, Linear *linear, const End *end)
{
    if (linear->swinging == (int)end->first) return;
    linear->swinging = (int)end->first;
    const size_t nodes = (size_t)model->n + 1;
    for (int axis = 0; axis < 2; axis++) {
        double du[INPUT_COUNT] = {0.0}, off[2] = {0.0, 0.0}, *force = linear->column, *turn = linear->swing[axis];
        du[(int)end->first + axis] = 1.0;
        memset(force, 0, (size_t)model_coordinates(model) * sizeof *force);
        linear_inputs(model, linear, du, force, off);
        linear_solve(model, linear, force, off, turn);
        linear_reactions(model, linear, NULL, NULL, turn, du);
        memcpy(linear->swing_x[axis], linear->react_x, nodes * sizeof(double));
        memcpy(linear->swing_y[axis], linear->react_y, nodes * sizeof(double));
    }
}

void effective_masses(const Model *model, Linear *linear, double output[OUTPUT_COUNT])
{
    End end[2];
    const int count = given_ends(model, end);
    for (int k = 0; k < count; k++) {
        accelerate(model, linear, &end[k]);
        const int node = end[k].node;
        double *mass = output + end[k].output;
        mass[0] = end[k].sign * linear->swing_x[0][node];
        mass[1] = end[k].sign * linear->swing_y[0][node];
        mass[2] = end[k].sign * linear->swing_y[1][node];
    }
}

/* dm / dth_i for m_xx, m_xy, m_yy. */
static void slopes(const Model *model, const Linear *linear, int i, double slope[3])
{
    double along[2], turn[2];
    for (int axis = 0; axis < 2; axis++) {
        const double *x = linear->swing_x[axis], *y = linear->swing_y[axis];
        along[axis] = 0.5 * model->link[LINK_LENGTH][i] *
                      (linear->sine[i] * (x[i] + x[i + 1]) + linear->cosine[i] * (y[i] + y[i + 1]));
        turn[axis] = linear->swing[axis][i + 1];
    }
    slope[0] = -2.0 * turn[0] * along[0];
    slope[1] = -(turn[0] * along[1] + turn[1] * along[0]);
    slope[2] = -2.0 * turn[1] * along[1];
}

void effective_mass_changes(const Model *model, Linear *linear, const double *dq, double d_output[OUTPUT_COUNT])
{
    End end[2];
    const int count = given_ends(model, end);
    for (int k = 0; k < count; k++) {
        accelerate(model, linear, &end[k]);
        double *change = d_output + end[k].output, slope[3];
        change[0] = change[1] = change[2] = 0.0;
        for (int i = 0; i < model->n; i++) {
            slopes(model, linear, i, slope);
            for (int m = 0; m < 3; m++) change[m] += slope[m] * dq[i + 1];
        }
    }
}

void effective_mass_adjoint(const Model *model, Linear *linear, const double *seed, double *q)
{
    End end[2];
    const int count = given_ends(model, end);
    for (int k = 0; k < count; k++) {
        const double *weight = seed + end[k].output;
        if (weight[0] == 0.0 && weight[1] == 0.0 && weight[2] == 0.0) continue;
        accelerate(model, linear, &end[k]);
        double slope[3];
        for (int i = 0; i < model->n; i++) {
            slopes(model, linear, i, slope);
            for (int m = 0; m < 3; m++) q[i + 1] += slope[m] * weight[m];
        }
    }
}
