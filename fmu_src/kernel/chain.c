#include "dynamics.h"

/*
 * Forward dynamics of the chain by elimination, O(n) [docs/model.md, section "In O(n)"].
 *
 * The cable below node P_{i-1} answers an acceleration a of that node with the force R = A a + b, A a
 * symmetric 2x2 matrix (articulated inertia) and b a bias force. At the tip A = m_c 1 and b = -(force on
 * the terminal). Going up over link i, with J0 = I_R + m l^2/4 and all of A, b still those below it:
 *
 *     J = J0 + l^2 n.A n                    g = l A n + (m l/2) n          r = b - l w^2 A e
 *     s = tau + (l/2) n.W - l n.r           th'' = (s - g.a) / J
 *     A <- A + m 1 - g g^T / J              b <- r - (m l/2) w^2 e - W + g s / J
 *
 * At the top the floater's equation gives a_0, and the same expressions give every th'' going down:
 *     a <- a + l (n th'' - w^2 e).
 */
void chain_accelerations(const Model *model, const double *x, const double *u, Work *work, double *acceleration)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const double *rate = x + n + 2;

    double axx = model->end_mass, axy = 0.0, ayy = model->end_mass;
    double bx = -work->end_force[0], by = -work->end_force[1];
    for (int i = n - 1; i >= 0; i--) {
        const double l = length[i], m = mass[i], half = 0.5 * l;
        const double ex = work->sine[i], ey = work->cosine[i], nx = ey, ny = -ex;
        const double wx = work->load_x[i], wy = work->load_y[i];
        const double squared = rate[i] * rate[i];
        const double an_x = axx * nx + axy * ny, an_y = axy * nx + ayy * ny;
        const double ae_x = axx * ex + axy * ey, ae_y = axy * ex + ayy * ey;
        const double inverse = 1.0 / (model->rotary[i] + l * l * (nx * an_x + ny * an_y));
        const double gx = l * an_x + m * half * nx, gy = l * an_y + m * half * ny;
        const double rx = bx - l * squared * ae_x, ry = by - l * squared * ae_y;
        const double s = work->torque[i] + half * (nx * wx + ny * wy) - l * (nx * rx + ny * ry);
        axx += m - gx * gx * inverse;
        axy -= gx * gy * inverse;
        ayy += m - gy * gy * inverse;
        bx = rx - m * half * squared * ex - wx + gx * s * inverse;
        by = ry - m * half * squared * ey - wy + gy * s * inverse;
        work->gain_x[i] = gx;
        work->gain_y[i] = gy;
        work->moment[i] = s;
        work->inverse[i] = inverse;
    }

    double a[2];
    top_acceleration(model, x, u, (const double[3]){axx, axy, ayy}, (const double[2]){bx, by}, a);
    acceleration[0] = a[1];
    for (int i = 0; i < n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i];
        const double turn = (work->moment[i] - work->gain_x[i] * a[0] - work->gain_y[i] * a[1]) * work->inverse[i];
        const double inward = rate[i] * rate[i];
        acceleration[1 + i] = turn;
        a[0] += length[i] * (ey * turn - inward * ex);
        a[1] += length[i] * (-ex * turn - inward * ey);
    }
}
