#include "dynamics.h"

/*
 * Pulls, and what the cable does to whoever holds its ends: -R_1 at P_0, R_{n+1} at P_n. The pull is -R_i . e_i at the top of link i and -R_{i+1} . e_i at its lower end. Down to the middle the elimination
 * has left R [chain.c]; below it, by Newton for each link,
 *     R_{i+1} = R_i + H - m (b_i + (l/2) n th''),
 * which never multiplies the mass of a heavy end by its tiny acceleration.
 */
void cable_forces(const Model *model, const double *derivative, const Work *work, double *output)
{
    const int n = model->n;
    const double *turn = rates_in(model, derivative);
    Pair force = {work->answer_x[0], work->answer_y[0]};
    double largest = -(force.x * work->sine[0] + force.y * work->cosine[0]), end = largest;
    output[Y_tension_top] = largest;
    output[Y_F_1x] = -force.x, output[Y_F_1y] = -force.y;
    for (int i = 0; i < n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i];
        const double upper = -(force.x * ex + force.y * ey);
        force = force_below(model, work, i, turn[i], force);
        const double lower = -(force.x * ex + force.y * ey);
        if (upper > largest) largest = upper;
        if (lower > largest) largest = lower;
        end = lower;
    }
    output[Y_tension_end] = end;
    output[Y_tension_max] = largest;
    output[Y_F_2x] = force.x, output[Y_F_2y] = force.y;
}
