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
    double end[2] = {0.0, 0.0}, still[INPUT_COUNT];
    statics_inputs(du, still);
    memset(force, 0, (size_t)model_coordinates(model) * sizeof *force);
    linear_inputs(model, linear, still, force, end);
    linear_solve(model, linear, force, end, dq);
}

/* What a given place along x and along y, the inputs first and first + 1, moves. `through` is the last solution's. */
static void place_adjoint(const Model *model, Linear *linear, const double *change, Input first, double *to_input)
{
    const double through[2] = {linear->through[0], linear->through[1]};
    for (int axis = 0; axis < 2; axis++) {
        double du[INPUT_COUNT] = {0.0}, end[2] = {0.0, 0.0}, *force = linear->column;
        du[(int)first + axis] = 1.0;
        memset(force, 0, (size_t)model_coordinates(model) * sizeof *force);
        linear_inputs(model, linear, du, force, end);
        double sum = linear->is_held ? through[0] * end[0] + through[1] * end[1] : 0.0;
        for (int k = 0; k < model_coordinates(model); k++) sum += force[k] * change[k];
        to_input[(int)first + axis] += sum;
    }
}

void equilibrium_adjoint(const Model *model, Linear *linear, const double *seed, double *change, double *to_input)
{
    const double *length = model->link[LINK_LENGTH], none[2] = {0.0, 0.0};
    linear_solve(model, linear, seed, none, change); /* K is symmetric */
    const bool is_floater = !top_is_given(model), surges = model->top == TOP_FREE;
    double x = surges ? change[model->n + 1] : 0.0,
           y = is_floater ? change[0]
                          : 0.0; /* what moves with a force on the end: P_n, or the relation of a held end */
    for (int i = 0; i < model->n; i++) {
        x += length[i] * linear->cosine[i] * change[i + 1];
        y -= length[i] * linear->sine[i] * change[i + 1];
    }
    if (linear->is_held) x = linear->through[0] * linear->held.per_mass, y = linear->through[1] * linear->held.per_mass;
    if (is_floater) to_input[U_u_m1] += change[0];
    if (surges) to_input[U_u_m1x] += change[model->n + 1];
    to_input[U_F_cx] += x;
    to_input[U_F_cy] += y, to_input[U_u_m2] += y;
    if (model->terminal == TERMINAL_MOTION) place_adjoint(model, linear, change, U_x_2, to_input);
    if (top_is_given(model)) place_adjoint(model, linear, change, U_x_1, to_input);
}
