#include "adjoint.h"
#include "directional.h"
#include "dynamics.h"
#include "effective_mass.h"

#include <string.h>

/*
 * directional.c does, for changes (dq, dv, du),
 *     r = ID_q dq + ID_v dv - B du    M da = -r    dR = R_q dq + R_v dv + R_a da - R_u du    dy = y_q dq + y_v dv + y_R dR
 * where r and dR come of one walk down the cable and one up [carry_down and carry_up, linear.c]. The weighted sum of da
 * and dy therefore follows (dq, dv, du) by the transposed walks, the first of which runs down and the second up:
 *     a-bar = seed + R_a^T y_R^T seed_y      M mu = a-bar      -mu^T r + (y_R^T seed_y)^T dR
 * M being symmetric, a held end's border included. What r weighs a force by is a virtual displacement, and so the
 * walk down is that of the nodes under link turns mu.
 */

/* Whether a pull is weighted; then y_R^T seed_y, node by node, is in react, else zeros. */
static bool weigh_reactions(const Model *model, Linear *linear, const Pull *pull, const double *seed)
{
    const int n = model->n;
    memset(linear->react_x, 0, ((size_t)model->n + 1) * sizeof(double));
    memset(linear->react_y, 0, ((size_t)model->n + 1) * sizeof(double));
    bool any = false;
    for (int k = 0; seed && k < PULLS; k++) {
        const double weight = seed[pull[k].output];
        linear->react_x[pull[k].node] -= weight * linear->sine[pull[k].link];
        linear->react_y[pull[k].node] -= weight * linear->cosine[pull[k].link];
        any |= weight != 0.0;
    }
    if (!seed) return any;
    linear->react_x[0] -= seed[Y_F_1x], linear->react_y[0] -= seed[Y_F_1y];
    linear->react_x[n] += seed[Y_F_2x], linear->react_y[n] += seed[Y_F_2y];
    for (Output force = Y_F_1x; force <= Y_F_2y; force++) any |= seed[force] != 0.0;
    return any;
}

/* Adds R_a^T of what react holds; what it makes of the force through a held end goes to end. */
static void reactions_to_accelerations(const Model *model, Linear *linear, double *acceleration, double end[2])
{
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    double sum_x = 0.0, sum_y = 0.0;
    for (int i = 0; i <= model->n; i++) {
        sum_x += linear->react_x[i], sum_y += linear->react_y[i];
        linear->known_ax[i] = sum_x, linear->known_ay[i] = sum_y; /* of R_{n+1} in the end */
    }
    const double end_mass = linear->is_held ? 0.0 : model->end_mass;
    if (linear->is_held) end[0] = sum_x, end[1] = sum_y;
    double ax = end_mass * sum_x, ay = end_mass * sum_y;
    for (int i = model->n - 1; i >= 0; i--) {
        const double nx = linear->cosine[i], ny = -linear->sine[i];
        const double own_x = mass[i] * linear->known_ax[i], own_y = mass[i] * linear->known_ay[i];
        acceleration[i + 1] += length[i] * (nx * (ax + 0.5 * own_x) + ny * (ay + 0.5 * own_y));
        ax += own_x, ay += own_y;
    }
    if (!top_is_given(model)) acceleration[0] += ay;
    if (model->top == TOP_FREE) acceleration[model->n + 1] += ax;
}

/* The top's part of walk_down(): its virtual displacement. */
static Pair top_walked(const Model *model, double *q, double *v)
{
    const double *p = model->parameter;
    const int surge = model->n + 1;
    Pair moved = {0.0, 0.0};
    if (top_is_given(model)) return moved;
    moved.y = -v[0];
    q[0] += p[P_k_m1] * moved.y, v[0] = p[P_c_m1] * moved.y;
    if (model->top != TOP_FREE) return moved;
    moved.x = -v[surge];
    q[surge] += p[P_k_m1H] * moved.x, v[surge] = p[P_c_m1H] * moved.x;
    return moved;
}

/*
 * Transposed carry_up(): v holds mu. Leaves in known_a and known_v what the links' centres weigh, in v and added to q what
 * rates and angles do by themselves, and returns the weight of R_{n+1}.
 */
static Pair walk_down(const Model *model, Linear *linear, double *q, double *v)
{
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const Pair top = top_walked(model, q, v);
    Pair moved = {linear->react_x[0] + top.x, linear->react_y[0] + top.y};
    double above = 0.0;
    for (int i = 0; i < model->n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex;
        const double turned = -v[i + 1], half = 0.5 * length[i] * turned, bent = turned - above;
        const double x = moved.x + half * nx, y = moved.y + half * ny;
        linear->known_ax[i] = mass[i] * x, linear->known_ay[i] = mass[i] * y;
        q[i + 1] += model->stiffness[i] * bent - half * linear->pull[i];
        v[i + 1] = model->damping[i] * bent;
        if (i) q[i] -= model->stiffness[i] * bent, v[i] -= model->damping[i] * bent;
        if (model->has_drag) {
            const double push = linear->drag_gain[i] * (nx * x + ny * y);
            linear->known_vx[i] = push * nx, linear->known_vy[i] = push * ny;
            q[i + 1] += linear->drag[i] * (ex * x + ey * y) - linear->slip[i] * push;
        }
        moved.x += 2.0 * half * nx + linear->react_x[i + 1], moved.y += 2.0 * half * ny + linear->react_y[i + 1];
        above = turned;
    }
    return moved;
}

/* Transposed linear_top(), from what P_0's acceleration, velocity and position weigh; adds to q and v. */
static void top_reached(const Model *model, const double z[MOST_COLUMNS], double *q, double *v, double *to_input)
{
    if (top_is_given(model)) {
        to_input[U_ax_1] += z[0], to_input[U_ay_1] += z[1], to_input[U_vx_1] += z[2], to_input[U_vy_1] += z[3];
        to_input[U_x_1] += z[4], to_input[U_y_1] += z[5];
        return;
    }
    q[0] += z[5], v[0] += z[3];
    if (model->top == TOP_FREE) q[model->n + 1] += z[4], v[model->n + 1] += z[2];
}

/* Transposed carry_down(), from what P_n's acceleration, velocity and position weigh. */
static void walk_up(const Model *model, const Linear *linear, const double z[MOST_COLUMNS], double *q, double *v,
                    double *to_input)
{
    const double *length = model->link[LINK_LENGTH];
    double ax = z[0], ay = z[1], vx = z[2], vy = z[3];
    for (int i = model->n - 1; i >= 0; i--) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, l = length[i];
        const double rate = linear->rate[i], own_ax = linear->known_ax[i], own_ay = linear->known_ay[i];
        const double own_vx = model->has_drag ? linear->known_vx[i] : 0.0;
        const double own_vy = model->has_drag ? linear->known_vy[i] : 0.0;
        const double at_x = ax + 0.5 * own_ax, at_y = ay + 0.5 * own_ay;
        const double vt_x = vx + 0.5 * own_vx, vt_y = vy + 0.5 * own_vy;
        const double a_n = nx * at_x + ny * at_y, a_e = ex * at_x + ey * at_y;
        const double v_n = nx * vt_x + ny * vt_y, v_e = ex * vt_x + ey * vt_y;
        q[i + 1] += l * (nx * z[4] + ny * z[5] - rate * (rate * a_n + v_e) - linear->turn[i] * a_e);
        v[i + 1] += l * (v_n - 2.0 * rate * a_e);
        ax += own_ax, ay += own_ay;
        vx += own_vx, vy += own_vy;
    }
    const double top[MOST_COLUMNS] = {ax, ay, vx, vy, z[4], z[5]};
    top_reached(model, top, q, v, to_input);
}

/* What R_{n+1} weighs, or at a held end the relation there, carried on to P_n's motion and to the inputs. */
static void end_to_motion(const Model *model, const Linear *linear, Pair weight, double z[MOST_COLUMNS],
                          double *to_input)
{
    const HeldEnd held = linear->held;
    const double relation[] = {-linear->through[0], -linear->through[1]}, through[] = {weight.x, weight.y};
    double force[2];
    for (int k = 0; k < 2; k++) {
        const bool is_held = linear->is_held;
        z[k] = is_held ? relation[k] : model->end_mass * through[k];
        z[2 + k] = is_held ? held.damper[k] * relation[k] : model->damper[k] * through[k];
        z[4 + k] = is_held ? held.spring[k] * relation[k] : model->spring[k] * through[k];
        force[k] = is_held ? -held.per_mass * relation[k] : -through[k];
    }
    to_input[U_F_cx] = force[0];
    to_input[U_F_cy] = to_input[U_u_m2] = force[1];
    if (model->terminal != TERMINAL_MOTION) return;
    to_input[U_ax_2] = -relation[0], to_input[U_ay_2] = -relation[1];
    to_input[U_vx_2] = -z[2], to_input[U_vy_2] = -z[3];
    to_input[U_x_2] = -z[4], to_input[U_y_2] = -z[5];
}

/* Adds what top_energy() makes of it to what P_0's velocity and position weigh. */
static void add_top_energy(const Model *model, const Motion *top, double weight, double z[MOST_COLUMNS])
{
    if (top_is_given(model)) return;
    const double *p = model->parameter;
    z[3] += weight * p[P_M_1] * top->velocity[1];
    z[5] += weight * (p[P_k_m1] * top->position[1] + p[P_static_load]);
    if (model->top != TOP_FREE) return;
    z[2] += weight * p[P_M_1] * top->velocity[0];
    z[4] += weight * (p[P_k_m1H] * top->position[0] + p[P_static_pull]);
}

/* Adds what the energy's weight makes of it: energy.c, transposed. */
static void energy_to_states(const Model *model, const double *x, Linear *linear, double weight, double *q, double *v,
                             double *to_input)
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS], *rate = rates_in(model, x);
    const Motion *top = &linear->p_0;
    double px = top->position[0], py = top->position[1], vx = top->velocity[0], vy = top->velocity[1];
    for (int i = 0; i < n; i++) {
        const double ex = linear->sine[i], ey = linear->cosine[i], l = length[i];
        const double step_x = l * rate[i] * ey, step_y = -l * rate[i] * ex;
        linear->known_vx[i] = vx + 0.5 * step_x, linear->known_vy[i] = vy + 0.5 * step_y;
        px += l * ex, py += l * ey, vx += step_x, vy += step_y;
    }
    vx *= weight * model->end_mass, vy *= weight * model->end_mass;
    double fx = 0.0, fy = -weight * model->end_weight; /* along x and y, by which P moves energy */
    if (model->has_spring) {
        fx += weight * (model->spring[0] * (px - model->rest[0]) - model->preload[0]);
        fy += weight * (model->spring[1] * (py - model->rest[1]) - model->preload[1]);
    }
    for (int i = n - 1; i >= 0; i--) {
        const double ex = linear->sine[i], ey = linear->cosine[i], nx = ey, ny = -ex, l = length[i];
        const double own_x = weight * mass[i] * linear->known_vx[i], own_y = weight * mass[i] * linear->known_vy[i];
        const double at_x = vx + 0.5 * own_x, at_y = vy + 0.5 * own_y, own_f = -weight * model->weight[i];
        const double inertia = link_inertia(model, i);
        const double bent = weight * model->stiffness[i] * (x[i + 1] - (i ? x[i] : 0.0));
        q[i + 1] += l * (nx * fx + ny * (fy + 0.5 * own_f) - rate[i] * (ex * at_x + ey * at_y)) + bent;
        v[i + 1] += l * (nx * at_x + ny * at_y) + weight * inertia * rate[i];
        if (i) q[i] -= bent;
        vx += own_x, vy += own_y, fy += own_f;
    }
    double reached[MOST_COLUMNS] = {0.0, 0.0, vx, vy, fx, fy};
    add_top_energy(model, top, weight, reached);
    top_reached(model, reached, q, v, to_input);
}

/* Adds what outputs follow of states without any force in between: to the motion of P_n, to q and to v. */
static void outputs_to_states(const Model *model, const double *x, Linear *linear, const Pull *pull, const double *seed,
                              double *q, double *v, double *to_input)
{
    for (int k = 0; k < PULLS; k++) {
        const int node = pull[k].node, i = pull[k].link;
        const double across = linear->force_x[node] * linear->cosine[i] - linear->force_y[node] * linear->sine[i];
        q[i + 1] -= seed[pull[k].output] * across;
    }
    const double top[MOST_COLUMNS] = {0.0, 0.0, seed[Y_vx_m1], seed[Y_v_m1], seed[Y_x_m1], seed[Y_y_m1]};
    top_reached(model, top, q, v, to_input);
    if (seed[Y_energy] != 0.0) energy_to_states(model, x, linear, seed[Y_energy], q, v, to_input);
}

void adjoint_derivatives(const Model *model, const double *x, Linear *linear, const double *seed_derivative,
                         const double *seed_output, double *to_state, double *to_input)
{
    const int half = model_coordinates(model);
    double *q = to_state, *v = to_state + half, z[MOST_COLUMNS], end[2] = {0.0, 0.0};
    Pull pull[PULLS];
    pulls_of_outputs(model, linear, pull);
    memcpy(q, seed_derivative + half, (size_t)half * sizeof *q);
    if (weigh_reactions(model, linear, pull, seed_output)) reactions_to_accelerations(model, linear, q, end);
    linear_solve(model, linear, q, end, v); /* mu */
    memset(q, 0, (size_t)half * sizeof *q);
    memset(to_input, 0, INPUT_COUNT * sizeof *to_input);
    if (!top_is_given(model)) to_input[U_u_m1] = v[0];
    if (model->top == TOP_FREE) to_input[U_u_m1x] = v[model->n + 1];
    end_to_motion(model, linear, walk_down(model, linear, q, v), z, to_input);
    if (seed_output) {
        z[2] += seed_output[Y_vx_c], z[3] += seed_output[Y_vy_c];
        z[4] += seed_output[Y_x_c], z[5] += seed_output[Y_y_c];
    }
    walk_up(model, linear, z, q, v, to_input);
    for (int k = 0; k < half; k++) v[k] += seed_derivative[k];
    if (seed_output) effective_mass_adjoint(model, linear, seed_output, q);
    if (seed_output) outputs_to_states(model, x, linear, pull, seed_output, q, v, to_input);
}
