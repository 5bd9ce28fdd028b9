#include <math.h>

#include "dynamics.h"

/*
 * Submerged weight acts at the link's centre along +y. In water the drag on a link is normal to it,
 *     f n,   f = -c |v_n| v_n,   v_n = n . (V_{i-1} + l/2 w n) = n . V_{i-1} + l w / 2,
 * with c = 1/2 rho_w Cd D l and V_{i-1} the velocity of the link's upper end (still water).
 */
void link_loads(const Model *model, const double *x, Work *work)
{
    const int n = model->n;
    if (!model->has_drag) {
        for (int i = 0; i < n; i++) {
            work->load_x[i] = 0.0;
            work->load_y[i] = model->weight[i];
        }
        return;
    }
    const double *length = model->link[LINK_LENGTH], *rate = x + n + 2;
    double velocity_x = 0.0, velocity_y = x[n + 1];
    for (int i = 0; i < n; i++) {
        const double normal_x = work->cosine[i], normal_y = -work->sine[i];
        const double swing = length[i] * rate[i];
        const double across = normal_x * velocity_x + normal_y * velocity_y + 0.5 * swing;
        const double drag = -model->drag_factor[i] * fabs(across) * across;
        work->load_x[i] = drag * normal_x;
        work->load_y[i] = drag * normal_y + model->weight[i];
        velocity_x += swing * normal_x;
        velocity_y += swing * normal_y;
    }
}
