#include "linear.h"
#include "dynamics.h"

#include <math.h>
#include <stdlib.h>

/*
 * Nodes, links and forces as in chain.c. With d the unknown of a link, its angle changes by w_q d, its rate by w_v d and
 * its angular acceleration by w_a d. Position, velocity and acceleration of its lower node then change, besides what
 * the upper node does, by
 *     dP += w_q l n d        dV += (w_v n - w_q w e) l d        dA += ((w_a - w_q w^2) n - (2 w_v w + w_q th'') e) l d
 * and half of that at its centre. With D the drag and T the torque of the joint above,
 *     dR_i = dR_{i+1} + m dA_c - dD            dD = -2 c |v_n| (n.dV_c - e.V_c w_q d) n - f e w_q d
 *     w_a I d + (l/2) n.(dR_i + dR_{i+1}) - (l/2) e.(R_i + R_{i+1}) w_q d + dT_i - dT_{i+1} = b
 *     dT_i = kappa (d_i - d_{i-1}),  kappa = w_q k + w_v c
 * Everything below a node answers linearly to z = (dA, dV, dP) of that node: dR = S z + s d + r and dT = U z + u d + t,
 * d being the unknown of the link above. The sweep from the tip eliminates one link after the other:
 *     X = S phi + s     Y = X + beta     phi, beta: what d does to z below the link and to the force on it
 *     p = w_a I + (l/2) n.(2 X + beta) - (l/2) e.(R_i + R_{i+1}) w_q + kappa - U phi - u
 *     G = (l/2) n.(2 S + B) - U     B: what z does to the force on the link
 *     rho = b - l n.r + t
 *     S <- S + B - Y G/p     s <- Y kappa/p     r <- r + Y rho/p
 *     U <- -kappa G/p        u <- kappa^2/p - kappa        t <- kappa rho/p
 * and the sweep down finds d = (rho - G z + kappa d_above)/p.
 *
 * An end that cannot move, or hardly, is not eliminated but bordered: the force through P_n is an unknown of its own,
 *     dA_n + (c/m) dV_n + (k/m) dP_n - dR_{n+1}/m = given
 * for a mass m on a spring-damper, and with c/m = 2 r, k/m = r^2, 1/m = 0 for a pin [terminal.c].
 */

enum { SPARE_LINEAR = 2 }; /* entries of q beyond n */

#define LINEAR_ARRAYS(w)                                                                                               \
    &(w)->sine, &(w)->cosine, &(w)->rate, &(w)->turn, &(w)->force_x, &(w)->force_y, &(w)->pull, &(w)->drag,            \
        &(w)->drag_gain, &(w)->slip, &(w)->a_n, &(w)->a_e, &(w)->v_n, &(w)->v_e, &(w)->p_n, &(w)->lift_x,              \
        &(w)->lift_y, &(w)->per_pivot, &(w)->bend, &(w)->gain[0], &(w)->gain[1], &(w)->gain[2], &(w)->gain[3],         \
        &(w)->gain[4], &(w)->gain[5], &(w)->unit_x, &(w)->unit_y, &(w)->ahead, &(w)->column, &(w)->known_ax,           \
        &(w)->known_ay, &(w)->known_vx, &(w)->known_vy, &(w)->react_x, &(w)->react_y, &(w)->swing[0], &(w)->swing[1],  \
        &(w)->swing_x[0], &(w)->swing_x[1], &(w)->swing_y[0], &(w)->swing_y[1]

size_t linear_doubles(int n)
{
    Linear linear;
    double **const array[] = {LINEAR_ARRAYS(&linear)};
    return sizeof array / sizeof *array * ((size_t)n + SPARE_LINEAR);
}

void linear_layout(Linear *linear, int n, double *block)
{
    double **const array[] = {LINEAR_ARRAYS(linear)};
    for (size_t k = 0; k < sizeof array / sizeof *array; k++) *array[k] = block + k * ((size_t)n + SPARE_LINEAR);
}

/* R down the cable as in tension.c, and e.(R_i + R_{i+1}). */
static void take_forces(const Model *model, const Work *work, const double *turn, Linear *linear)
{
    Pair force = {work->answer_x[0], work->answer_y[0]};
    for (int i = 0; i < model->n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i], upper = force.x * ex + force.y * ey;
        linear->force_x[i] = force.x, linear->force_y[i] = force.y;
        force = force_below(model, work, i, turn[i], force);
        linear->pull[i] = upper + (force.x * ex + force.y * ey);
    }
    linear->force_x[model->n] = force.x, linear->force_y[model->n] = force.y;
}

void linear_pin(Linear *linear)
{
    const double rate = PIN_RATE;
    linear->is_held = true;
    linear->held = (HeldEnd){{2.0 * rate, 2.0 * rate}, {rate * rate, rate * rate}, 0.0};
}

/* Of a mass, where it is a heavy one. */
static void hold(const Model *model, Linear *linear)
{
    linear->is_held = model->end_is_heavy;
    if (!linear->is_held) return;
    if (end_is_given(model)) {
        linear_pin(linear);
        return;
    }
    const double per_mass = 1.0 / model->end_mass;
    linear->held = (HeldEnd){{model->damper[0] * per_mass, model->damper[1] * per_mass},
                             {model->spring[0] * per_mass, model->spring[1] * per_mass},
                             per_mass};
}

/* Columns that the scene's forces fill; where neither velocities nor positions change, those of the acceleration. */
static int columns_of(const Model *model, const Linear *linear)
{
    if (linear->weights.v == 0.0 && linear->weights.q == 0.0) return COLUMN_V;
    if (model->has_spring && !linear->is_held) return MOST_COLUMNS;
    return model->has_drag ? COLUMN_P : COLUMN_V;
}

void linear_rest(const Model *model, const Work *work, const double *force_x, const double *force_y, Linear *linear)
{
    hold(model, linear);
    for (int i = 0; i < model->n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i];
        linear->sine[i] = ex, linear->cosine[i] = ey;
        linear->rate[i] = linear->turn[i] = linear->drag[i] = linear->drag_gain[i] = linear->slip[i] = 0.0;
        linear->pull[i] = (force_x[i] + force_x[i + 1]) * ex + (force_y[i] + force_y[i + 1]) * ey;
    }
    for (int i = 0; i <= model->n; i++) linear->force_x[i] = force_x[i], linear->force_y[i] = force_y[i];
}

void linear_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear)
{
    const int n = model->n;
    const double *factor = model->drag_factor;
    const double *rate = rates_in(model, x), *turn = rates_in(model, derivative);
    hold(model, linear);
    linear->p_0 = work->top;
    for (int i = 0; i < n; i++) {
        linear->sine[i] = work->sine[i], linear->cosine[i] = work->cosine[i];
        linear->rate[i] = rate[i], linear->turn[i] = turn[i];
    }
    for (int i = 0; i < n && model->has_drag; i++) {
        const double ex = work->sine[i], ey = work->cosine[i], vx = work->velocity_x[i], vy = work->velocity_y[i];
        const double across = speed_across(model, work, i, rate[i]);
        linear->drag[i] = -factor[i] * (fabs(across) * across);
        linear->drag_gain[i] = 2.0 * factor[i] * fabs(across);
        linear->slip[i] = ex * vx + ey * vy;
    }
    take_forces(model, work, turn, linear);
}

/* How the unknown of link i moves its lower node, and what its joint answers. */
static void take_moves(const Model *model, Linear *linear)
{
    const double *length = model->link[LINK_LENGTH], *stiffness = model->stiffness, *damping = model->damping;
    const Weights w = linear->weights;
    for (int i = 0; i < model->n; i++) {
        const double l = length[i], rate = linear->rate[i];
        linear->a_n[i] = l * (w.a - w.q * (rate * rate));
        linear->a_e[i] = -l * (2.0 * w.v * rate + w.q * linear->turn[i]);
        linear->v_n[i] = l * w.v;
        linear->v_e[i] = -l * w.q * rate;
        linear->p_n[i] = l * w.q;
        linear->bend[i] = w.q * stiffness[i] + w.v * damping[i];
    }
}

/* What hangs below a node: dR = S z + s d + r, dT = U z + u d + t; r and t are the solution's affair. */
typedef struct {
    double x[MOST_COLUMNS], y[MOST_COLUMNS]; /* S by rows */
    double above_x, above_y;                 /* s */
    double torque[MOST_COLUMNS];             /* U */
    double torque_above;                     /* u */
} Below;

static Below below_terminal(const Model *model, const Linear *linear)
{
    Below below = {{0}, {0}, 0.0, 0.0, {0}, 0.0};
    if (linear->is_held) return below;
    below.x[COLUMN_A] = below.y[COLUMN_A + 1] = model->end_mass;
    below.x[COLUMN_V] = model->damper[0], below.y[COLUMN_V + 1] = model->damper[1];
    below.x[COLUMN_P] = model->spring[0], below.y[COLUMN_P + 1] = model->spring[1];
    return below;
}

/* One link up. Returns its pivot, or 0 where nothing but rounding is left of it. */
static inline double eliminate(const Model *model, Linear *linear, int i, int columns, Below *below)
{
    const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex;
    const double l = model->link[LINK_LENGTH][i], m = model->link[LINK_MASS][i], bend = linear->bend[i];
    const Weights w = linear->weights;
    const bool wet = columns > COLUMN_V && model->has_drag;
    const double gain = wet ? linear->drag_gain[i] : 0.0, drag = wet ? linear->drag[i] : 0.0;
    const double slip = wet ? linear->slip[i] : 0.0;
    const double phi[MOST_COLUMNS] = {linear->a_n[i] * nx + linear->a_e[i] * ex,
                                      linear->a_n[i] * ny + linear->a_e[i] * ey,
                                      linear->v_n[i] * nx + linear->v_e[i] * ex,
                                      linear->v_n[i] * ny + linear->v_e[i] * ey,
                                      linear->p_n[i] * nx,
                                      linear->p_n[i] * ny};
    double xx = below->above_x, xy = below->above_y, turned = below->torque_above;
    for (int c = 0; c < columns; c++) {
        xx += below->x[c] * phi[c];
        xy += below->y[c] * phi[c];
        turned += below->torque[c] * phi[c];
    }
    const double across = 0.5 * gain * linear->v_n[i] - gain * slip * w.q; /* of beta, along n; n.phi_V = v_n */
    const double beta_x = 0.5 * m * phi[0] + across * nx + drag * w.q * ex;
    const double beta_y = 0.5 * m * phi[1] + across * ny + drag * w.q * ey;
    const double lift_x = xx + beta_x, lift_y = xy + beta_y;
    const double mass_part = w.a * link_inertia(model, i) + 0.5 * l * (nx * (xx + lift_x) + ny * (xy + lift_y));
    const double pull_part = -0.5 * l * w.q * linear->pull[i], bend_part = bend - turned;
    const double pivot = mass_part + pull_part + bend_part;
    if (!(fabs(pivot) > 1e-14 * (fabs(mass_part) + fabs(pull_part) + fabs(bend) + fabs(turned)))) return 0.0;
    const double per_pivot = 1.0 / pivot, bend_gain = bend * per_pivot;
    for (int c = 0; c < columns; c++) {
        const double b_x = c == COLUMN_A       ? m
                           : c == COLUMN_V     ? gain * nx * nx
                           : c == COLUMN_V + 1 ? gain * nx * ny
                                               : 0.0;
        const double b_y = c == COLUMN_A + 1   ? m
                           : c == COLUMN_V     ? gain * nx * ny
                           : c == COLUMN_V + 1 ? gain * ny * ny
                                               : 0.0;
        const double sum_x = 2.0 * below->x[c] + b_x, sum_y = 2.0 * below->y[c] + b_y;
        const double g = (0.5 * l * (nx * sum_x + ny * sum_y) - below->torque[c]) * per_pivot;
        below->x[c] += b_x - lift_x * g;
        below->y[c] += b_y - lift_y * g;
        below->torque[c] = -bend * g;
        linear->gain[c][i] = g;
    }
    below->above_x = lift_x * bend_gain, below->above_y = lift_y * bend_gain;
    below->torque_above = bend * bend_gain - bend;
    linear->lift_x[i] = lift_x, linear->lift_y[i] = lift_y;
    linear->per_pivot[i] = per_pivot;
    return pivot;
}

/* Inlined with a constant number of columns, which the compiler unrolls. */
static inline int sweep_up(const Model *model, Linear *linear, int columns, Below *below)
{
    int negative = 0;
    for (int i = model->n - 1; i >= 0; i--) {
        const double pivot = eliminate(model, linear, i, columns, below);
        if (pivot == 0.0) return -1;
        negative += pivot < 0.0;
    }
    return negative;
}

/* The top's pivot, inverted: a number, a matrix, or none. How many of its eigenvalues are negative, or -1 where it is
 * singular. */
static int take_top(const Model *model, Weights w, const Below *below, Linear *linear)
{
    const double *p = model->parameter, moved[] = {w.a, w.v, w.q};
    double *top = linear->top;
    top[0] = top[1] = top[2] = top[3] = 0.0;
    if (top_is_given(model)) return 0;
    double yy = w.a * p[P_M_1] + w.v * p[P_c_m1] + w.q * p[P_k_m1];
    for (int c = 0; c < linear->columns; c += 2)
        yy += below->y[c + 1] * moved[c / 2]; /* the heave moves along y alone */
    if (model->top == TOP_FLOATER) {
        if (!(fabs(yy) > 0.0)) return -1;
        top[3] = 1.0 / yy;
        return yy < 0.0;
    }
    double xx = w.a * p[P_M_1] + w.v * p[P_c_m1H] + w.q * p[P_k_m1H], xy = 0.0, yx = 0.0;
    for (int c = 0; c < linear->columns; c += 2) {
        xx += below->x[c] * moved[c / 2], xy += below->x[c + 1] * moved[c / 2];
        yx += below->y[c] * moved[c / 2];
    }
    const double det = xx * yy - xy * yx;
    if (!(fabs(det) > 0.0)) return -1;
    top[0] = yy / det, top[1] = -xy / det, top[2] = -yx / det, top[3] = xx / det;
    return det < 0.0 ? 1 : yy < 0.0 ? 2 : 0;
}

/* What the top's own unknowns move at P_0. */
static inline void moved_by_top(const Model *model, Weights w, const double *change, double z[MOST_COLUMNS])
{
    const double heave = change[0], surge = model->top == TOP_FREE ? change[model->n + 1] : 0.0;
    z[0] = w.a * surge, z[1] = w.a * heave;
    z[2] = w.v * surge, z[3] = w.v * heave;
    z[4] = w.q * surge, z[5] = w.q * heave;
}

/* Without a held end: L d = force, z_0 and d_0 being the top's. */
static inline void solve_chain(const Model *model, Linear *linear, int columns, const double *force, double rx,
                               double ry, double *change)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH];
    double t = 0.0;
    for (int i = n - 1; i >= 0; i--) {
        const double nx = linear->cosine[i], ny = -linear->sine[i];
        const double rho = (force ? force[i + 1] : 0.0) - length[i] * (nx * rx + ny * ry) + t;
        const double q = rho * linear->per_pivot[i];
        linear->ahead[i] = q;
        rx += linear->lift_x[i] * q;
        ry += linear->lift_y[i] * q;
        t = linear->bend[i] * q;
    }
    const double *top = linear->top, push_y = (force ? force[0] : 0.0) - ry;
    double z[MOST_COLUMNS], above = 0.0;
    change[0] = top[3] * push_y;
    if (model->top == TOP_FREE) {
        const double push_x = (force ? force[n + 1] : 0.0) - rx;
        change[0] += top[2] * push_x;
        change[n + 1] = top[0] * push_x + top[1] * push_y;
    }
    moved_by_top(model, linear->weights, change, z);
    for (int i = 0; i < n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex;
        double d = linear->ahead[i] + linear->bend[i] * linear->per_pivot[i] * above;
        for (int c = 0; c < columns; c++) d -= linear->gain[c][i] * z[c];
        z[0] += (linear->a_n[i] * nx + linear->a_e[i] * ex) * d;
        z[1] += (linear->a_n[i] * ny + linear->a_e[i] * ey) * d;
        if (columns > COLUMN_V) {
            z[2] += (linear->v_n[i] * nx + linear->v_e[i] * ex) * d;
            z[3] += (linear->v_n[i] * ny + linear->v_e[i] * ey) * d;
        }
        if (columns > COLUMN_P) {
            z[4] += linear->p_n[i] * nx * d;
            z[5] += linear->p_n[i] * ny * d;
        }
        change[i + 1] = above = d;
    }
}

static void solve_free(const Model *model, Linear *linear, const double *force, double rx, double ry, double *change)
{
    switch (linear->columns) {
    case COLUMN_V: solve_chain(model, linear, COLUMN_V, force, rx, ry, change); break;
    case COLUMN_P: solve_chain(model, linear, COLUMN_P, force, rx, ry, change); break;
    default: solve_chain(model, linear, MOST_COLUMNS, force, rx, ry, change);
    }
}

/* dA_n + (c/m) dV_n + (k/m) dP_n of what linear_solve() found. */
static void end_of_change(const Model *model, const Linear *linear, const double *change, double end[2])
{
    const HeldEnd held = linear->held;
    double z[MOST_COLUMNS];
    moved_by_top(model, linear->weights, change, z);
    double *const a = z, *const v = z + 2, *const p = z + 4;
    for (int i = 0; i < model->n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, d = change[i + 1];
        a[0] += (linear->a_n[i] * nx + linear->a_e[i] * ex) * d;
        a[1] += (linear->a_n[i] * ny + linear->a_e[i] * ey) * d;
        v[0] += (linear->v_n[i] * nx + linear->v_e[i] * ex) * d;
        v[1] += (linear->v_n[i] * ny + linear->v_e[i] * ey) * d;
        p[0] += linear->p_n[i] * nx * d;
        p[1] += linear->p_n[i] * ny * d;
    }
    for (int k = 0; k < 2; k++) end[k] = a[k] + held.damper[k] * v[k] + held.spring[k] * p[k];
}

/*
 * The border: answers to unit forces through P_n, and the inverse of how the relation at the end follows them. Returns
 * how many negative eigenvalues that relation has, or -1 where it is singular.
 */
static int make_border(const Model *model, Linear *linear)
{
    const double per_mass = linear->held.per_mass;
    double at_x[2], at_y[2];
    solve_free(model, linear, NULL, 1.0, 0.0, linear->unit_x);
    solve_free(model, linear, NULL, 0.0, 1.0, linear->unit_y);
    end_of_change(model, linear, linear->unit_x, at_x);
    end_of_change(model, linear, linear->unit_y, at_y);
    const double xx = at_x[0] - per_mass, yy = at_y[1] - per_mass, xy = at_y[0], yx = at_x[1];
    const double det = xx * yy - xy * yx;
    const double size = fabs(xx) + fabs(yy) + fabs(xy) + fabs(yx);
    if (!(fabs(det) > 1e-28 * size * size)) return -1; /* links in line within 1e-14 rad of where they cannot give */
    linear->border[0] = yy / det, linear->border[1] = -xy / det;
    linear->border[2] = -yx / det, linear->border[3] = xx / det;
    return det < 0.0 ? 1 : xx < 0.0 ? 2 : 0;
}

static int eliminate_all(const Model *model, Linear *linear, Below *below)
{
    switch (linear->columns) {
    case COLUMN_V: return sweep_up(model, linear, COLUMN_V, below);
    case COLUMN_P: return sweep_up(model, linear, COLUMN_P, below);
    default: return sweep_up(model, linear, MOST_COLUMNS, below);
    }
}

int linear_factor(const Model *model, Weights weights, Linear *linear)
{
    linear->weights = weights;
    linear->swinging = -1;
    linear->columns = columns_of(model, linear);
    take_moves(model, linear);
    Below below = below_terminal(model, linear);
    int negative = eliminate_all(model, linear, &below);
    const int of_top = take_top(model, weights, &below, linear);
    if (negative < 0 || of_top < 0) return -1;
    negative += of_top;
    if (!linear->is_held) return negative;
    /* A constraint of two rows has two negative eigenvalues of its own in the bordered matrix; of one that is not
     * symmetric it may have fewer. */
    const int of_border = make_border(model, linear);
    return of_border < 0 ? -1 : abs(negative + of_border - 2);
}

void linear_solve(const Model *model, Linear *linear, const double *force, const double end[2], double *change)
{
    solve_free(model, linear, force, 0.0, 0.0, change);
    if (!linear->is_held) return;
    double found[2];
    end_of_change(model, linear, change, found);
    const double off_x = end[0] - found[0], off_y = end[1] - found[1];
    const double through_x = linear->border[0] * off_x + linear->border[1] * off_y;
    const double through_y = linear->border[2] * off_x + linear->border[3] * off_y;
    const int count = model_coordinates(model);
    for (int k = 0; k < count; k++) change[k] += linear->unit_x[k] * through_x + linear->unit_y[k] * through_y;
    linear->through[0] = through_x, linear->through[1] = through_y;
}

/* What changes of the coordinates, or of a given motion, do to P_0. */
void linear_top(const Model *model, const double *dq, const double *dv, const double *da, const double *du,
                double z[MOST_COLUMNS])
{
    const double *part[] = {da, dv, dq};
    const int surge = model->n + 1;
    for (int k = 0; k < 3; k++) {
        z[2 * k] = part[k] && model->top == TOP_FREE ? part[k][surge] : 0.0;
        z[2 * k + 1] = part[k] && !top_is_given(model) ? part[k][0] : 0.0;
    }
    if (!du || !top_is_given(model)) return;
    z[0] = du[U_ax_1], z[1] = du[U_ay_1], z[2] = du[U_vx_1], z[3] = du[U_vy_1], z[4] = du[U_x_1], z[5] = du[U_y_1];
}

/* A change that is given, from that of P_0 down the cable: of the nodes' acceleration, velocity and position, in z that
 * of P_n in the end, and at the links' centres. */
static void carry_down(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                       double z[MOST_COLUMNS])
{
    const double *length = model->link[LINK_LENGTH];
    double ax = z[0], ay = z[1], vx = z[2], vy = z[3], px = z[4], py = z[5];
    for (int i = 0; i < model->n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, w = linear->rate[i];
        const double q = dq ? dq[i + 1] : 0.0, v = dv ? dv[i + 1] : 0.0, a = da ? da[i + 1] : 0.0, l = length[i];
        const double a_n = l * (a - w * w * q), a_e = -l * (2.0 * w * v + linear->turn[i] * q);
        const double v_n = l * v, v_e = -l * w * q, p_n = l * q;
        const double step_ax = a_n * nx + a_e * ex, step_ay = a_n * ny + a_e * ey;
        const double step_vx = v_n * nx + v_e * ex, step_vy = v_n * ny + v_e * ey;
        linear->known_ax[i] = ax + 0.5 * step_ax, linear->known_ay[i] = ay + 0.5 * step_ay;
        linear->known_vx[i] = vx + 0.5 * step_vx, linear->known_vy[i] = vy + 0.5 * step_vy;
        ax += step_ax, ay += step_ay;
        vx += step_vx, vy += step_vy;
        px += p_n * nx, py += p_n * ny;
    }
    z[0] = ax, z[1] = ay, z[2] = vx, z[3] = vy, z[4] = px, z[5] = py;
}

/* The top's own entries, R_1 changing by (rx, ry). */
static void missing_at_top(const Model *model, const double *dq, const double *dv, const double *da, double rx,
                           double ry, double *force)
{
    const double *p = model->parameter;
    force[0] = 0.0;
    if (top_is_given(model)) return;
    force[0] = ry + p[P_M_1] * (da ? da[0] : 0.0) + p[P_c_m1] * (dv ? dv[0] : 0.0) + p[P_k_m1] * (dq ? dq[0] : 0.0);
    if (model->top != TOP_FREE) return;
    const int surge = model->n + 1;
    force[surge] = rx + p[P_M_1] * (da ? da[surge] : 0.0) + p[P_c_m1H] * (dv ? dv[surge] : 0.0) +
                   p[P_k_m1H] * (dq ? dq[surge] : 0.0);
}

/* Up the cable with what carry_down() left, R_{n+1} changing by (rx, ry): the other R, and the missing forces. */
static void carry_up(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                     double rx, double ry, double *force)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    double torque_below = 0.0;
    linear->react_x[n] = rx, linear->react_y[n] = ry;
    for (int i = n - 1; i >= 0; i--) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, l = length[i];
        const double q = dq ? dq[i + 1] : 0.0, v = dv ? dv[i + 1] : 0.0, a = da ? da[i + 1] : 0.0;
        const double q_above = dq && i ? dq[i] : 0.0, v_above = dv && i ? dv[i] : 0.0; /* joint 1: the angle itself */
        double step_x = mass[i] * linear->known_ax[i], step_y = mass[i] * linear->known_ay[i];
        if (model->has_drag) {
            const double across = nx * linear->known_vx[i] + ny * linear->known_vy[i] - linear->slip[i] * q;
            const double push = linear->drag_gain[i] * across, pull = linear->drag[i] * q;
            step_x += push * nx + pull * ex;
            step_y += push * ny + pull * ey;
        }
        const double torque = model->stiffness[i] * (q - q_above) + model->damping[i] * (v - v_above);
        if (force)
            force[i + 1] = link_inertia(model, i) * a +
                           0.5 * l * (nx * (2.0 * rx + step_x) + ny * (2.0 * ry + step_y)) -
                           0.5 * l * linear->pull[i] * q + (torque - torque_below);
        rx += step_x, ry += step_y;
        linear->react_x[i] = rx, linear->react_y[i] = ry;
        torque_below = torque;
    }
    if (force) missing_at_top(model, dq, dv, da, rx, ry, force);
}

/* Change of the force that the terminal's mass and support take, for a change z of its motion. */
static double end_reaction(const Model *model, const double *z, int axis)
{
    return model->end_mass * z[axis] + model->damper[axis] * z[2 + axis] + model->spring[axis] * z[4 + axis];
}

/* force and end of linear_apply(), P_0 moving by z. */
static void missing_forces(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                           double z[MOST_COLUMNS], double *force, double end[2])
{
    carry_down(model, linear, dq, dv, da, z);
    end[0] = end[1] = 0.0;
    if (!linear->is_held) {
        carry_up(model, linear, dq, dv, da, end_reaction(model, z, 0), end_reaction(model, z, 1), force);
        return;
    }
    const HeldEnd held = linear->held;
    for (int k = 0; k < 2; k++) end[k] = z[k] + held.damper[k] * z[2 + k] + held.spring[k] * z[4 + k];
    carry_up(model, linear, dq, dv, da, 0.0, 0.0, force);
}

void linear_apply(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                  double *force, double end[2])
{
    double z[MOST_COLUMNS];
    linear_top(model, dq, dv, da, NULL, z);
    missing_forces(model, linear, dq, dv, da, z, force, end);
}

void linear_reactions(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                      const double *du)
{
    double z[MOST_COLUMNS];
    linear_top(model, dq, dv, da, du, z);
    carry_down(model, linear, dq, dv, da, z);
    const double rx = linear->is_held ? linear->through[0] : end_reaction(model, z, 0) - du[U_F_cx];
    const double ry = linear->is_held ? linear->through[1] : end_reaction(model, z, 1) - du[U_F_cy] - du[U_u_m2];
    carry_up(model, linear, dq, dv, da, rx, ry, NULL);
}

/* What a change of the ends' given motion takes, by walks of its own; its missing forces go to scratch. */
static void given_motion(const Model *model, Linear *linear, const double *du, double *force, double end[2])
{
    if (model->terminal == TERMINAL_MOTION) {
        end[0] += du[U_ax_2] + linear->held.damper[0] * du[U_vx_2] + linear->held.spring[0] * du[U_x_2];
        end[1] += du[U_ay_2] + linear->held.damper[1] * du[U_vy_2] + linear->held.spring[1] * du[U_y_2];
    }
    if (!top_is_given(model)) return;
    double z[MOST_COLUMNS], off[2], *missing = linear->ahead;
    linear_top(model, NULL, NULL, NULL, du, z);
    missing_forces(model, linear, NULL, NULL, NULL, z, missing, off);
    for (int i = 1; i <= model->n; i++) force[i] -= missing[i];
    for (int k = 0; k < 2; k++) end[k] -= off[k];
}

void linear_inputs(const Model *model, Linear *linear, const double *du, double *force, double end[2])
{
    const double *length = model->link[LINK_LENGTH];
    const double fx = du[U_F_cx], fy = du[U_F_cy] + du[U_u_m2];
    given_motion(model, linear, du, force, end);
    if (!top_is_given(model)) force[0] += du[U_u_m1];
    if (model->top == TOP_FREE) force[model->n + 1] += du[U_u_m1x];
    if (linear->is_held) { /* the force goes to the end, not into the cable */
        const double per_mass = linear->held.per_mass;
        end[0] += fx * per_mass, end[1] += fy * per_mass;
        return;
    }
    if (fx == 0.0 && fy == 0.0) return;
    if (!top_is_given(model)) force[0] += fy;
    if (model->top == TOP_FREE) force[model->n + 1] += fx;
    for (int i = 0; i < model->n; i++) force[i + 1] += length[i] * (linear->cosine[i] * fx - linear->sine[i] * fy);
}
