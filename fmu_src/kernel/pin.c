#include <math.h>

#include "dynamics.h"

/*
 * Back onto the pin, or whatever guides P_n: the smallest change of (q, v), weighed by the inertia of every coordinate by
 * itself, that brings P_n and its velocity where they belong,
 *     dq = W J^T (J W J^T)^-1 (P_guide - P_n),   J = dP_n/dq = [(0, 1), l_1 n_1, ...],   W = diag(1/M_1, 1/J_1, ...)
 * and the same for v; a floater that surges adds (1, 0) and 1/M_1, a top that is given has neither. A taut cable cannot give along itself, where J W J^T vanishes; nor can it drift there.
 */

typedef struct {
    double xx, xy, yy;
} Symmetric;

static Symmetric compliance(const Model *model, const Work *work)
{
    const double *length = model->link[LINK_LENGTH];
    const double top = top_is_given(model) ? 0.0 : 1.0 / model->parameter[P_M_1];
    Symmetric a = {model->top == TOP_FREE ? top : 0.0, 0.0, top};
    for (int i = 0; i < model->n; i++) {
        const double lx = length[i] * work->cosine[i], ly = -length[i] * work->sine[i], w = model->per_rotary[i];
        a.xx += w * lx * lx, a.xy += w * lx * ly, a.yy += w * ly * ly;
    }
    return a;
}

/* out += W J^T (a)^-1 off, with a floor under a's smaller eigenvalue. */
static void shift(const Model *model, const Work *work, Symmetric a, const double off[2], double *out)
{
    const double *length = model->link[LINK_LENGTH], floor = 1e-12 * (a.xx + a.yy);
    const double xx = a.xx + floor, yy = a.yy + floor, det = xx * yy - a.xy * a.xy;
    const double fx = (yy * off[0] - a.xy * off[1]) / det, fy = (xx * off[1] - a.xy * off[0]) / det;
    if (!top_is_given(model)) out[0] += fy / model->parameter[P_M_1];
    if (model->top == TOP_FREE) out[model->n + 1] += fx / model->parameter[P_M_1];
    for (int i = 0; i < model->n; i++)
        out[i + 1] += model->per_rotary[i] * length[i] * (work->cosine[i] * fx - work->sine[i] * fy);
}

static void place(const Model *model, const double *x, const double *u, Work *work, double position[2],
                  double velocity[2])
{
    model->variant->orientation(model, x, work);
    top_motion(model, x, u, work);
    terminal_motion(model, x, work, position, velocity);
}

void pin_project(const Model *model, const double *u, Work *work, const Motion *guide, double *x)
{
    enum { MOST = 5 };
    const int half = model_coordinates(model);
    double position[2], velocity[2], size = 0.0;
    for (int i = 0; i < model->n; i++) size += model->link[LINK_LENGTH][i];
    for (int k = 0; k < MOST; k++) {
        place(model, x, u, work, position, velocity);
        const double off[2] = {guide->position[0] - position[0], guide->position[1] - position[1]};
        if (!(size_of_pair(off[0], off[1]) > 1e-14 * size)) break;
        shift(model, work, compliance(model, work), off, x);
    }
    place(model, x, u, work, position, velocity);
    const double off[2] = {guide->velocity[0] - velocity[0], guide->velocity[1] - velocity[1]};
    shift(model, work, compliance(model, work), off, x + half);
}
