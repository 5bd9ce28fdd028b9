#include "dynamics.h"

/*
 * R_i is the force through joint i on link i from above. By Newton, from the tip up:
 *     R_{n+1} = m_c a_n - F_end,   R_i = R_{i+1} + m_i a_{c,i} - W_i,
 * and the pull is -R_i . e_i at the top of link i, -R_{i+1} . e_i at its lower end.
 */
void cable_tensions(const Model *model, const double *x, const double *derivative, const Work *work, double *top,
                    double *end, double *largest)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const double *rate = x + n + 2, *turn = derivative + n + 2;

    double ax = 0.0, ay = derivative[n + 1];
    for (int i = 0; i < n; i++) {
        const double inward = rate[i] * rate[i];
        ax += length[i] * (work->cosine[i] * turn[i] - inward * work->sine[i]);
        ay += length[i] * (-work->sine[i] * turn[i] - inward * work->cosine[i]);
    }
    double rx = model->end_mass * ax - work->end_force[0], ry = model->end_mass * ay - work->end_force[1];
    double pull = -(rx * work->sine[n - 1] + ry * work->cosine[n - 1]);
    *end = *largest = pull;
    for (int i = n - 1; i >= 0; i--) {
        const double ex = work->sine[i], ey = work->cosine[i], inward = rate[i] * rate[i];
        const double half_x = 0.5 * length[i] * (ey * turn[i] - inward * ex);
        const double half_y = 0.5 * length[i] * (-ex * turn[i] - inward * ey);
        const double lower = -(rx * ex + ry * ey);
        rx += mass[i] * (ax - half_x) - work->load_x[i];
        ry += mass[i] * (ay - half_y) - work->load_y[i];
        ax -= 2.0 * half_x;
        ay -= 2.0 * half_y;
        pull = -(rx * ex + ry * ey);
        if (lower > *largest) *largest = lower;
        if (pull > *largest) *largest = pull;
    }
    *top = pull;
}
