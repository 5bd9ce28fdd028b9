#include "catenary.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "sincos.h"

/*
 * With the pull (H, V - W_i) in link i, of size T_i, the ports' distance is the gradient of the convex function
 * sum l_i T_i. So (H, V) minimises
 *     phi = sum l_i T_i - H x - V y,
 * which grows in every direction if the ports are closer than the cable is long: Newton with a step control finds it
 * from any start. phi has a kink where a link carries nothing, and if that is the minimum, these links do not fit.
 * Newton crawls along kinks, so they are rounded off, T = sqrt(H^2 + (V - W)^2 + r^2), and sharpened step by step.
 */
static const double ROUNDINGS[] = {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0};
static const double ARMIJO = 1e-4; /* share of the decrease that the slope promises that a step must bring */
static const double SHORTEST_STEP = 1e-10, LARGEST_STEP = 1e20;
static const double HALF_TURN = 3.14159265358979323846;
enum { MOST_STEPS = 100, MOST_CORRECTIONS = 3, BATCH = 64 };

/* In units of the cable's length and of its links' weights, all taken positive. */
typedef struct {
    int n;
    const double *length, *weight;
    double total, scale; /* [m], [N] */
    double span[2];
} Hanging;

/* A symmetric 2 x 2 matrix. */
typedef struct {
    double xx, xy, yy;
} Square;

/* phi at a pull, its gradient (how far the end misses the port) and its Hessian. */
typedef struct {
    double value, miss[2];
    Square hessian;
} Look;

static Look look_at(const Hanging *cable, const double pull[2], double rounding)
{
    Look seen = {.miss = {-cable->span[0], -cable->span[1]}};
    double above = 0.0;
    for (int i = 0; i < cable->n; i++) {
        const double length = cable->length[i] / cable->total, weight = cable->weight[i] / cable->scale;
        const double x = pull[0], y = pull[1] - (above + weight / 2.0);
        above += weight;
        const double size = fmax(sqrt(x * x + y * y + rounding * rounding), DBL_MIN);
        const double ux = x / size, uy = y / size, round = rounding / size, share = length / size;
        seen.value += length * size;
        seen.miss[0] += length * ux;
        seen.miss[1] += length * uy;
        /* T'' = (1 - u u^T)/T with u the pull over T, written so that nothing cancels. */
        seen.hessian.xx += share * (uy * uy + round * round);
        seen.hessian.xy -= share * ux * uy;
        seen.hessian.yy += share * (ux * ux + round * round);
    }
    seen.value -= pull[0] * cable->span[0] + pull[1] * cable->span[1];
    return seen;
}

/* matrix answer = right, by elimination from the larger pivot; false where the other one is not above `least` of it. */
static bool solve(Square matrix, const double right[2], double least, double answer[2])
{
    const int first = matrix.xx >= matrix.yy ? 0 : 1, last = 1 - first;
    const double pivot = first == 0 ? matrix.xx : matrix.yy, other = first == 0 ? matrix.yy : matrix.xx;
    const double ratio = matrix.xy / pivot, rest = other - ratio * matrix.xy;
    if (!(rest > least * pivot)) return false;
    answer[last] = (right[last] - ratio * right[first]) / rest;
    answer[first] = (right[first] - matrix.xy * answer[last]) / pivot;
    return true;
}

static double norm(const double vector[2])
{
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1]);
}

/* One step from `pull`, as long as it may be; false where none leads further down. */
static bool step_down(const Hanging *cable, double pull[2], double rounding, Look *seen)
{
    double step[2];
    const double against[2] = {-seen->miss[0], -seen->miss[1]};
    if (!solve(seen->hessian, against, 0.0, step) || !(norm(step) < LARGEST_STEP)) return false;
    const double slope = seen->miss[0] * step[0] + seen->miss[1] * step[1];
    for (double reach = 1.0; reach > SHORTEST_STEP; reach *= 0.5) {
        const double there[2] = {pull[0] + reach * step[0], pull[1] + reach * step[1]};
        const Look trial = look_at(cable, there, rounding);
        /* Near the minimum phi is flat to rounding, and the miss alone tells a good step. */
        const bool is_lower = trial.value < seen->value + ARMIJO * reach * slope;
        if (!is_lower && !(norm(trial.miss) < 0.5 * norm(seen->miss))) continue;
        pull[0] = there[0], pull[1] = there[1];
        *seen = trial;
        return true;
    }
    return false;
}

static void minimise(const Hanging *cable, double pull[2])
{
    for (unsigned k = 0; k < sizeof ROUNDINGS / sizeof *ROUNDINGS; k++) {
        Look seen = look_at(cable, pull, ROUNDINGS[k]);
        for (int step = 0; step < MOST_STEPS && step_down(cable, pull, ROUNDINGS[k], &seen); step++) {
        }
    }
}

/* The angle of (x, y) from the axis of y within 4e-3 rad. */
static double rough_angle(double x, double y)
{
    const double ax = fabs(x), ay = fabs(y), larger = fmax(ax, ay), ratio = larger > 0.0 ? fmin(ax, ay) / larger : 0.0;
    double angle = ratio * (HALF_TURN / 4.0 + 0.273 * (1.0 - ratio));
    if (ax > ay) angle = HALF_TURN / 2.0 - angle;
    if (y < 0.0) angle = HALF_TURN - angle;
    return x < 0.0 ? -angle : angle;
}

/* Along (x, y): without an arc tangent, whose last digits differ between platforms. sin(wanted - angle) is a product of
 * what is known, and its inverse to the third power takes 4e-3 rad to 1e-13, and that to rounding. */
static void direct(int count, const double *x, const double *y, double *angle)
{
    double sine[BATCH], cosine[BATCH];
    for (int i = 0; i < count; i++) angle[i] = rough_angle(x[i], y[i]);
    for (int correction = 0; correction < 2; correction++) {
        sincos_array_portable(count, angle, sine, cosine);
        for (int i = 0; i < count; i++) {
            const double off = x[i] * cosine[i] - y[i] * sine[i];
            angle[i] += off + off * off * off / 6.0;
        }
    }
}

static void hang(const Hanging *cable, const double pull[2], double *angle)
{
    double x[BATCH], y[BATCH], above = 0.0;
    for (int first = 0; first < cable->n; first += BATCH) {
        const int count = cable->n - first < BATCH ? cable->n - first : BATCH;
        for (int k = 0; k < count; k++) {
            const double weight = cable->weight[first + k] / cable->scale;
            const double along[2] = {pull[0], pull[1] - (above + weight / 2.0)};
            const double size = fmax(norm(along), DBL_MIN);
            x[k] = along[0] / size, y[k] = along[1] / size;
            above += weight;
        }
        direct(count, x, y, angle + first);
    }
}

/* How far the last link ends from the port [m], and J J^T, J being what the angles move of it [m^2]. */
static Square reach_for(const Hanging *cable, const double end[2], const double *angle, double miss[2])
{
    double sine[BATCH], cosine[BATCH];
    Square square = {0.0, 0.0, 0.0};
    miss[0] = end[0], miss[1] = end[1];
    for (int first = 0; first < cable->n; first += BATCH) {
        const int count = cable->n - first < BATCH ? cable->n - first : BATCH;
        sincos_array_portable(count, angle + first, sine, cosine);
        for (int k = 0; k < count; k++) {
            const double x = cable->length[first + k] * sine[k], y = cable->length[first + k] * cosine[k];
            miss[0] -= x, miss[1] -= y;
            square.xx += y * y, square.xy -= x * y, square.yy += x * x;
        }
    }
    return square;
}

/* To the last digits: Newton's method on the two equations, by the smallest change of angles. The last miss [m]. */
static double meet_end(const Hanging *cable, const double end[2], double *angle)
{
    double miss[2], share[2], sine[BATCH], cosine[BATCH];
    Square square = reach_for(cable, end, angle, miss);
    for (int k = 0; k < MOST_CORRECTIONS && norm(miss) <= CATENARY_MISS; k++) {
        if (norm(miss) <= 1e-15 * cable->total || !solve(square, miss, 1e-12, share)) break;
        for (int first = 0; first < cable->n; first += BATCH) {
            const int count = cable->n - first < BATCH ? cable->n - first : BATCH;
            sincos_array_portable(count, angle + first, sine, cosine);
            for (int i = 0; i < count; i++)
                angle[first + i] += cable->length[first + i] * (cosine[i] * share[0] - sine[i] * share[1]);
        }
        square = reach_for(cable, end, angle, miss);
    }
    return norm(miss);
}

CatenaryStatus catenary(int n, const double *length, const double *weight, const double end[2], double *angle,
                        double pull[2])
{
    Hanging cable = {.n = n, .length = length, .weight = weight};
    double sum = 0.0;
    for (int i = 0; i < n; i++) cable.total += length[i], cable.scale += fabs(weight[i]), sum += weight[i];
    if (!(norm(end) < cable.total)) return CATENARY_TOO_SHORT;
    if (cable.scale == 0.0) return CATENARY_WEIGHTLESS;
    if (!isfinite(cable.total + cable.scale)) return CATENARY_NO_FIT;
    cable.span[0] = end[0] / cable.total, cable.span[1] = end[1] / cable.total;
    /* The pull of a slack cable: half the weight at each port, and as much sideways. */
    pull[0] = cable.span[0] < 0.0 ? -0.5 : 0.5;
    pull[1] = 0.5 * ((sum - (weight[n - 1] - weight[0]) / 2.0) / cable.scale);
    minimise(&cable, pull);
    hang(&cable, pull, angle);
    pull[0] *= cable.scale, pull[1] *= cable.scale;
    return meet_end(&cable, end, angle) <= CATENARY_MISS ? CATENARY_OK : CATENARY_NO_FIT;
}
