/*
 * Exact directional derivatives of the right-hand side and of the outputs, in O(n) each: what changes when states and
 * inputs change by (dx, du).
 */
#ifndef CABLE_DIRECTIONAL_H
#define CABLE_DIRECTIONAL_H

#include "linear.h"

/* Take the state x; `work` and `derivative` as cable_derivatives() left them for it. False where the inertia matrix is
 * singular: a taut, straight cable between two ends that cannot move. */
bool directional_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear);

/* Changes of the derivative and, unless NULL, of output[OUTPUT_COUNT] with dx and du[INPUT_COUNT]; the former as long as x. */
void directional_derivatives(const Model *model, const double *x, Linear *linear, const double *dx, const double *du,
                             double *d_derivative, double *d_output);

/* Where an output that is a pull is taken: -R . e of a link at one of its nodes. */
typedef struct {
    Output output;
    int node, link;
} Pull;

enum { PULLS = 3 };
void pulls_of_outputs(const Model *model, const Linear *linear, Pull pull[PULLS]);

#endif
