/*
 * How an equilibrium follows the inputs that it was found under: K dq = B du with the tangent stiffness K, in O(n), and
 * the transpose of it. What holds the end in statics.c holds it here.
 */
#ifndef CABLE_EQUILIBRIUM_CHANGE_H
#define CABLE_EQUILIBRIUM_CHANGE_H

#include "linear.h"

/* Take the equilibrium x; `work` and `derivative` as cable_derivatives() left them for it. False where K is not positive
 * definite, and x no stable equilibrium. */
bool equilibrium_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear);

/* dq with du[INPUT_COUNT]; force is scratch, both as long as q. */
void equilibrium_change(const Model *model, Linear *linear, const double *du, double *force, double *dq);

/* Adds to to_input[INPUT_COUNT] what a sum of dq, weighted by a seed, changes by with each input; change is scratch,
 * both as long as q. */
void equilibrium_adjoint(const Model *model, Linear *linear, const double *seed, double *change, double *to_input);

#endif
