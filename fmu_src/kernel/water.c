#include <math.h>

#include "dynamics.h"

/*
 * Submerged weight acts at the link's centre along +y. In water the drag on a link is normal to it,
 *     f n,   f = -c |v_n| v_n,   v_n = n . (V_{i-1} + l/2 w n) = n . V_{i-1} + l w / 2,
 * with c = 1/2 rho_w Cd D l and V_{i-1} the velocity of the link's upper end (still water).
 */
void VARIANT(link_loads)(const Model *model, const double *x, Work *work)
{
    const int n = model->n;
    const double *weight = model->weight, *factor = model->drag_factor;
    const double *length = model->link[LINK_LENGTH], *rate = rates_in(model, x);
    const double *sine = work->sine, *cosine = work->cosine;
    const double *velocity_x = work->velocity_x, *velocity_y = work->velocity_y;
    double *load_x = work->load_x, *load_y = work->load_y;
    if (!model->has_drag) {
        LINKS_ARE_INDEPENDENT
        for (int i = 0; i < n; i++) {
            load_x[i] = 0.0;
            load_y[i] = weight[i];
        }
        return;
    }
    LINKS_ARE_INDEPENDENT
    for (int i = 0; i < n; i++) {
        const double across = (cosine[i] * velocity_x[i] - sine[i] * velocity_y[i]) + 0.5 * length[i] * rate[i];
        const double drag = -factor[i] * (fabs(across) * across);
        load_x[i] = drag * cosine[i];
        load_y[i] = weight[i] - drag * sine[i];
    }
}
