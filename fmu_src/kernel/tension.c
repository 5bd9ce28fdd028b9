#include "dynamics.h"

/*
 * The pull is -R_i . e_i at the top of link i and -R_{i+1} . e_i at its lower end. Down to the middle the elimination
 * has left R [chain.c]; below it, by Newton for each link,
 *     R_{i+1} = R_i + H - m (b_i + (l/2) n th''),
 * which never multiplies the mass of a heavy end by its tiny acceleration.
 */
void cable_tensions(const Model *model, const double *derivative, const Work *work, double *top, double *end,
                    double *largest)
{
    const int n = model->n, middle = model->middle;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS], *turn = derivative + n + 2;
    double rx = work->answer_x[0], ry = work->answer_y[0];
    *top = *largest = -(rx * work->sine[0] + ry * work->cosine[0]);
    for (int i = 0; i < n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i], swing = 0.5 * length[i] * turn[i];
        const double upper = -(rx * ex + ry * ey);
        if (i < middle) {
            rx = work->answer_x[i + 1], ry = work->answer_y[i + 1];
        } else {
            rx += work->drive_x[i] - mass[i] * (work->answer_x[i + 1] + swing * ey);
            ry += work->drive_y[i] - mass[i] * (work->answer_y[i + 1] - swing * ex);
        }
        const double lower = -(rx * ex + ry * ey);
        if (upper > *largest) *largest = upper;
        if (lower > *largest) *largest = lower;
        *end = lower;
    }
}
