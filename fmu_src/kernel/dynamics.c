#include "dynamics.h"

#include <string.h>

void cable_derivatives(const Model *model, const double *x, const double *u, Work *work, double *derivative)
{
    const int half = model->n + 1;
    memcpy(derivative, x + half, (size_t)half * sizeof *x); /* q' = v */

    orientation(model, x, work);
    joint_torques(model, x, work);
    link_loads(model, x, work);
    terminal_force(model, x, u, work);
    chain_accelerations(model, x, u, work, derivative + half);
}

void cable_outputs(const Model *model, const double *x, const double *derivative, Work *work, double *output,
                   bool has_derivatives)
{
    if (!has_derivatives) orientation(model, x, work);
    terminal_motion(model, x, work, work->end_position, work->end_velocity);
    output[Y_y_m1] = x[0];
    output[Y_v_m1] = x[model->n + 1];
    output[Y_x_c] = work->end_position[0];
    output[Y_y_c] = work->end_position[1];
    output[Y_vx_c] = work->end_velocity[0];
    output[Y_vy_c] = work->end_velocity[1];
    output[Y_energy] = cable_energy(model, x, work);
    if (has_derivatives)
        cable_tensions(model, x, derivative, work, &output[Y_tension_top], &output[Y_tension_end],
                       &output[Y_tension_max]);
}
