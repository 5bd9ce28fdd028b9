/*
 * A linearly implicit (Rosenbrock) method for y' = f(t, y) with Jacobian J, of `stages` stages: with g = gamma h
 *     (1/g - J) u_i = f(t + alpha_i h, y + sum_{j<i} a_ij u_j) + (1/h) sum_{j<i} c_ij u_j + d_i h f_t
 *     y(t + h) = y + sum m_i u_i            local error: sum e_i u_i
 * and inside the step, s in [0, 1],
 *     y(t + s h) = (1 - s) y + s (y(t + h) + (1 - s) sum_k s^k w_k), w_k = sum_j dense_kj u_j,
 * where J and f_t = df/dt are those at (t, y). In the notation of Hairer & Wanner, Solving Ordinary Differential
 * Equations II, section IV.7.
 */
#ifndef CABLE_ROSENBROCK_H
#define CABLE_ROSENBROCK_H

enum { ROSENBROCK_MOST_STAGES = 8, ROSENBROCK_MOST_DENSE = 3 };

typedef struct {
    const char *name;
    int stages;
    int order, error_order; /* of y(t + h), and of y(t + h) without the local error */
    double gamma;
    const double *a, *c; /* strictly lower triangles by rows, stages (stages - 1) / 2 entries */
    const double *m, *e, *alpha, *d;
    int dense_terms;     /* rows of dense */
    const double *dense; /* dense_terms x stages, by rows */
} RosenbrockTable;

/* [rosenbrock_tables.c] */
extern const RosenbrockTable RODAS5P;

/* The one in use; benchmarks compile others in its place. */
#ifdef ROSENBROCK_TABLE
extern const RosenbrockTable ROSENBROCK_TABLE;
#else
#define ROSENBROCK_TABLE RODAS5P
#endif

#endif
