/*
 * Exact adjoint derivatives of the right-hand side and of the outputs, in O(n) each: how a sum of their changes, weighted
 * by a seed, follows every state and every input. The transpose of directional.h, pass by pass.
 */
#ifndef CABLE_ADJOINT_H
#define CABLE_ADJOINT_H

#include "linear.h"

/*
 * After directional_point(). From the weights of derivative[2 (n + 1)] and, unless NULL, of output[OUTPUT_COUNT] to
 * to_state[2 (n + 1)] and to_input[INPUT_COUNT], what the sum changes by with each. The seeds must not overlap to_state.
 */
void adjoint_derivatives(const Model *model, const double *x, Linear *linear, const double *seed_derivative,
                         const double *seed_output, double *to_state, double *to_input);

#endif
