#include "dynamics.h"

#include "combine.h"
#include "sincos.h"

const Variant PORTABLE = {orientation_portable, cable_derivatives_portable, combine_portable, largest_scaled_portable};

void cable_derivatives(const Model *model, const double *x, const double *u, Work *work, double *derivative)
{
    model->variant->derivatives(model, x, u, work, derivative);
}

void cable_outputs(const Model *model, const double *x, const double *u, const double *derivative, Work *work,
                   double *output, bool has_derivatives)
{
    if (!has_derivatives) orientation_portable(model, x, work), top_motion(model, x, u, work);
    terminal_motion(model, x, work, work->end_position, work->end_velocity);
    output[Y_x_m1] = work->top.position[0];
    output[Y_y_m1] = work->top.position[1];
    output[Y_vx_m1] = work->top.velocity[0];
    output[Y_v_m1] = work->top.velocity[1];
    output[Y_x_c] = work->end_position[0];
    output[Y_y_c] = work->end_position[1];
    output[Y_vx_c] = work->end_velocity[0];
    output[Y_vy_c] = work->end_velocity[1];
    output[Y_energy] = cable_energy(model, x, work);
    if (has_derivatives) cable_forces(model, derivative, work, output);
}

int angle_out_of_range(const Model *model, const double *x)
{
    for (int i = 1; i <= model->n; i++)
        if (!(x[i] <= SINCOS_RANGE && x[i] >= -SINCOS_RANGE)) return i;
    return 0;
}
