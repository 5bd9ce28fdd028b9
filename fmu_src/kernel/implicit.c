#include "method.h"
#include "rosenbrock.h"

#include <math.h>
#include <string.h>

/*
 * A step of a Rosenbrock method [rosenbrock.h] on x = (q, v), x' = (v, a). With g = gamma h and the right side (r_q, r_v) of a stage,
 *     (1/g - J) u = r      is      u_q = d + g r_q,  u_v = d / g,   L d = ID_a r_v - ID_q (g r_q)
 * where L = ID_q + ID_v / g + ID_a / g^2 [linear.h]: one equation per coordinate, solved in O(n), and no Jacobian is ever
 * written down. Forces that depend on time by themselves add d_i h dQ/dt to the right side of L d.
 */

/* Their slopes by differences of second order, over so small a part of the step that nothing is seen of their curvature
 * and so large a one that nothing is seen of rounding. */
static bool input_slopes(const System *system, double t, double h, const double *u, double *slope, bool *vary)
{
    const double ahead = h * 0x1p-10;
    double near[INPUT_COUNT], far[INPUT_COUNT];
    if (!system->inputs(system->source, t + ahead, near)) return false;
    if (!system->inputs(system->source, t + 2.0 * ahead, far)) return false;
    *vary = false;
    for (int k = 0; k < INPUT_COUNT; k++) {
        slope[k] = (4.0 * near[k] - far[k] - 3.0 * u[k]) / (2.0 * ahead);
        *vary |= slope[k] != 0.0;
    }
    return true;
}

/* From the right side r to the stage's increment: both as long as x. */
static void solve_stage(const System *system, const Vectors *vectors, double g, const double *du, const double *r,
                        double *increment)
{
    const Model *model = system->model;
    const int half = model_coordinates(model);
    double *force = vectors->force, *dq = vectors->force + half, end[2];
    double *d = increment + half;
    for (int k = 0; k < half; k++) dq[k] = -g * r[k];
    linear_apply(model, system->linear, dq, NULL, r + half, force, end);
    if (du) linear_inputs(model, system->linear, du, force, end);
    linear_solve(model, system->linear, force, end, d);
    for (int k = 0; k < half; k++) {
        increment[k] = d[k] - dq[k];
        d[k] /= g;
    }
}

/* x + sum weight_j u_j */
static void point_at(const System *system, const Vectors *vectors, const double *x, int terms, const double *weight,
                     double *out)
{
    combine_states(system, x, terms, weight, vectors->stage, out);
}

static bool stage(const System *system, SolverMemory *memory, const Vectors *vectors, const RosenbrockTable *table,
                  int i, double t, double h, const double *x, const double *input_slope)
{
    const int row = i * (i - 1) / 2;
    double *const r = vectors->right_side, u[INPUT_COUNT], du[INPUT_COUNT], weight[ROSENBROCK_MOST_STAGES];
    if (i > 0) {
        point_at(system, vectors, x, i, table->a + row, vectors->trial);
        const double time = table->alpha[i] == 1.0 ? t + h : t + table->alpha[i] * h;
        if (!slope_at(system, memory, time, vectors->trial, r, u)) return false;
        for (int j = 0; j < i; j++) weight[j] = table->c[row + j] / h;
        point_at(system, vectors, r, i, weight, r);
    }
    for (int k = 0; k < INPUT_COUNT && input_slope; k++) du[k] = h * table->d[i] * input_slope[k];
    solve_stage(system, vectors, table->gamma * h, input_slope ? du : NULL, i > 0 ? r : vectors->slope,
                vectors->stage[i]);
    return true;
}

bool implicit_attempt(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                      const double *x, double *error)
{
    const RosenbrockTable *table = &ROSENBROCK_TABLE;
    const double h = t_new - t, g = table->gamma * h;
    double slope[INPUT_COUNT];
    bool vary;
    if (!input_slopes(system, t, h, memory->slope_u, slope, &vary)) return false;
    memory->counter[SOLVER_jacobians]++;
    *error = NAN; /* where there are no factors, a shorter step has some */
    if (linear_factor(system->model, (Weights){1.0, 1.0 / g, 1.0 / (g * g)}, system->linear) < 0) return true;
    for (int i = 0; i < table->stages; i++)
        if (!stage(system, memory, vectors, table, i, t, h, x, vary ? slope : NULL)) return false;
    point_at(system, vectors, x, table->stages, table->m, vectors->trial);
    combine_states(system, NULL, table->stages, table->e, vectors->stage, vectors->spare);
    *error = largest_of_states(system, vectors->spare, x, vectors->trial) / memory->tolerance;
    return true;
}
