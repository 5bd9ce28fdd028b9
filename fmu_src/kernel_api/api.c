/*
 * The kernel for Python: its right-hand side and outputs, statics, and the cable linearised about a state of rest,
 * behind flat functions, so that no layout of a C structure is repeated there [models/cablefmu/kernel.py]. Sizes of
 * arrays are the caller's affair.
 */
#include "api.h"

#include <stdlib.h>
#include <string.h>

static size_t states_of(int n)
{
    return 2u * (size_t)most_coordinates(n);
}

/* NULL where there is no memory. link[LINK_COLUMNS][n] stays the caller's, to be kept as long as the kernel. */
Kernel *kernel_new(int n, int top, int terminal, int drag, uint64_t present, const double *parameter,
                   const double *rest, const double *link)
{
    Kernel *kernel = calloc(1, sizeof *kernel);
    if (!kernel) return NULL;
    const size_t size[] = {model_doubles(n), work_doubles(n), linear_doubles(n), states_of(n), states_of(n)};
    double *part[sizeof size / sizeof *size];
    size_t before = 0;
    for (size_t k = 0; k < sizeof size / sizeof *size; k++) before += size[k];
    kernel->block = calloc(before + statics_doubles(n), sizeof(double));
    if (!kernel->block) {
        free(kernel);
        return NULL;
    }
    part[0] = kernel->block;
    for (size_t k = 1; k < sizeof size / sizeof *size; k++) part[k] = part[k - 1] + size[k - 1];
    kernel->x = part[3], kernel->derivative = part[4];
    kernel->statics_block = kernel->block + before;
    Model *model = &kernel->model;
    model->n = n;
    model->top = (Top)top;
    model->terminal = (Terminal)terminal;
    model->drag = (Drag)drag;
    model->present = present;
    memcpy(model->parameter, parameter, sizeof model->parameter);
    memcpy(model->rest, rest, sizeof model->rest);
    for (size_t column = 0; column < LINK_COLUMNS; column++) model->link[column] = link + column * (size_t)n;
    model_layout(model, part[0]);
    work_layout(&kernel->work, n, part[1]);
    linear_layout(&kernel->linear, n, part[2]);
    model_prepare(model);
    return kernel;
}

void kernel_free(Kernel *kernel)
{
    free(kernel->block);
    free(kernel);
}

/* The derivative of x' = f(x, u). 0 where an angle is beyond the range of the kernel's sines. */
int kernel_derivatives(Kernel *kernel, const double *x, const double *u, double *derivative)
{
    if (angle_out_of_range(&kernel->model, x)) return 0;
    cable_derivatives(&kernel->model, x, u, &kernel->work, derivative);
    return 1;
}

/* Every output[OUTPUT_COUNT] at (x, u). 0 where an angle is beyond the range of the kernel's sines. */
int kernel_outputs(Kernel *kernel, const double *x, const double *u, double *output)
{
    if (!kernel_derivatives(kernel, x, u, kernel->derivative)) return 0;
    cable_outputs(&kernel->model, x, u, kernel->derivative, &kernel->work, output, true);
    if (motion_is_given(&kernel->model) &&
        directional_point(&kernel->model, x, &kernel->work, kernel->derivative, &kernel->linear))
        effective_masses(&kernel->model, &kernel->linear, output);
    return 1;
}

/* pull[2][n] of every link at its upper and at its lower end [N], as cable_forces() has them for the ends of the cable
 * [tension.c]. 0 where an angle is beyond the range of the kernel's sines. */
int kernel_pulls(Kernel *kernel, const double *x, const double *u, double *pull)
{
    if (!kernel_derivatives(kernel, x, u, kernel->derivative)) return 0;
    const Work *work = &kernel->work;
    const int n = kernel->model.n;
    const double *turn = rates_in(&kernel->model, kernel->derivative);
    Pair force = {work->answer_x[0], work->answer_y[0]};
    for (int i = 0; i < n; i++) {
        const double ex = work->sine[i], ey = work->cosine[i];
        pull[i] = -(force.x * ex + force.y * ey);
        force = force_below(&kernel->model, work, i, turn[i], force);
        pull[n + i] = -(force.x * ex + force.y * ey);
    }
    return 1;
}

/* From q to an equilibrium near it; figure[STATICS_COUNT]. Returns a StaticsStatus, or -1 where an angle is
 * beyond the range of the kernel's sines. */
int kernel_equilibrium(Kernel *kernel, const double *u, double *q, double *figure)
{
    const size_t bytes = (size_t)model_coordinates(&kernel->model) * sizeof *q;
    memcpy(kernel->x, q, bytes);
    if (angle_out_of_range(&kernel->model, kernel->x)) return -1;
    const StaticsStatus status =
        statics_solve(&kernel->model, u, &kernel->work, &kernel->linear, kernel->statics_block, kernel->x, figure);
    memcpy(q, kernel->x, bytes);
    return (int)status;
}

/*
 * Linearised about q at rest. force[2][n + 1]: R through every node, x then y [N]; acceleration, as long as q: what is
 * left of it there. 0 where an angle is beyond the range of the kernel's sines.
 */
int kernel_rest(Kernel *kernel, const double *u, const double *q, double *force, double *acceleration)
{
    const size_t half = (size_t)model_coordinates(&kernel->model), nodes = (size_t)kernel->model.n + 1u;
    memcpy(kernel->x, q, half * sizeof *q);
    memset(kernel->x + half, 0, half * sizeof *q);
    if (angle_out_of_range(&kernel->model, kernel->x)) return 0;
    cable_derivatives(&kernel->model, kernel->x, u, &kernel->work, kernel->derivative);
    linear_point(&kernel->model, kernel->x, &kernel->work, kernel->derivative, &kernel->linear);
    memcpy(force, kernel->linear.force_x, nodes * sizeof *force);
    memcpy(force + nodes, kernel->linear.force_y, nodes * sizeof *force);
    memcpy(acceleration, kernel->derivative + half, half * sizeof *acceleration);
    return 1;
}

/* The factors of stiffness K + mass M about the state of kernel_rest(); how many pivots are negative, -1: singular. */
int kernel_factor(Kernel *kernel, double stiffness, double mass)
{
    return linear_factor(&kernel->model, (Weights){stiffness, 0.0, mass}, &kernel->linear);
}

/* (stiffness K + mass M) change = force, a pinned end staying; through[2]: the force that it takes [N]. */
void kernel_solve(Kernel *kernel, const double *force, double *change, double *through)
{
    const double stays[2] = {0.0, 0.0};
    linear_solve(&kernel->model, &kernel->linear, force, stays, change);
    const bool is_pinned = kernel->linear.is_held && kernel->linear.held.per_mass == 0.0;
    for (int k = 0; k < 2; k++) through[k] = is_pinned ? kernel->linear.through[k] : 0.0;
}

/* A heavy end's share, which linear.c keeps apart: the force through P_n by its relation, on every coordinate. */
static void add_heavy_end(const Kernel *kernel, const double relation[2], double *force)
{
    const Linear *linear = &kernel->linear;
    const double *length = kernel->model.link[LINK_LENGTH];
    const double fx = relation[0] / linear->held.per_mass, fy = relation[1] / linear->held.per_mass;
    if (!top_is_given(&kernel->model)) force[0] += fy;
    if (kernel->model.top == TOP_FREE) force[kernel->model.n + 1] += fx;
    for (int i = 0; i < kernel->model.n; i++)
        force[i + 1] += length[i] * (linear->cosine[i] * fx - linear->sine[i] * fy);
}

/* force = (stiffness K + mass M) change, without factors; what a pin takes is not in it. */
void kernel_product(Kernel *kernel, double stiffness, double mass, const double *change, double *force)
{
    const size_t half = (size_t)model_coordinates(&kernel->model);
    double *q = kernel->statics_block, *a = q + half, relation[2]; /* of eight times that size */
    for (size_t k = 0; k < half; k++) q[k] = stiffness * change[k], a[k] = mass * change[k];
    linear_apply(&kernel->model, &kernel->linear, q, NULL, a, force, relation);
    if (kernel->linear.is_held && kernel->linear.held.per_mass > 0.0) add_heavy_end(kernel, relation, force);
}

/* catenary(), a CatenaryStatus. */
int kernel_catenary(int n, const double *length, const double *weight, const double *end, double *angle, double *pull)
{
    return (int)catenary(n, length, weight, end, angle, pull);
}
