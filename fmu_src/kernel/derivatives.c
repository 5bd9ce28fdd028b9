#include <string.h>

#include "dynamics.h"

/* The theory's table of contents: x' = f(x, u) of [3.8], each line one file. */
void VARIANT(cable_derivatives)(const Model *model, const double *x, const double *u, Work *work, double *derivative)
{
    const int half = model_coordinates(model);
    memcpy(derivative, x + half, (size_t)half * sizeof *x); /* q' = v */

    VARIANT(orientation)(model, x, work);
    top_motion(model, x, u, work);
    VARIANT(joint_torques)(model, x, work);
    VARIANT(motion)(model, x, work);
    VARIANT(link_loads)(model, x, work);
    terminal_force(model, x, u, work);
    VARIANT(chain_accelerations)(model, x, u, work, derivative + half);
}
