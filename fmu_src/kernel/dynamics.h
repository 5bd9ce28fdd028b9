/*
 * The equations of motion, I x'' + C x' + K x + F + G = T [3.8], in O(n).
 *
 * cable_derivatives() is the theory's table of contents; each line of it is one file. A force is a file
 * that adds to the loads on the links (`load_x`, `load_y`, `torque`), to `end_force`, or to the top.
 */
#ifndef CABLE_DYNAMICS_H
#define CABLE_DYNAMICS_H

#include "model.h"

/*
 * The right-hand side: derivative[2 (n + 1)] of x' = f(x, u). Pure: depends on its arguments alone,
 * changes nothing but `derivative` and scratch. u[INPUT_COUNT] in N, zeros where the scene has no input.
 */
void cable_derivatives(const Model *model, const double *x, const double *u, Work *work, double *derivative);

/*
 * Every output of Y_..., output[OUTPUT_COUNT]. With has_derivatives, `work` and `derivative` must be
 * what cable_derivatives() left for the same (x, u); without, the tensions are left as they are.
 */
void cable_outputs(const Model *model, const double *x, const double *derivative, Work *work, double *output,
                   bool has_derivatives);

/* --- one concept a file --- */

/* orientation.c: sine and cosine of every link; the first link (1 ...) whose angle is beyond SINCOS_RANGE, or 0. */
void orientation(const Model *model, const double *x, Work *work);
int angle_out_of_range(const Model *model, const double *x);

/* joints.c: torque[i] = T_{i+1} - T_i with T_i = k_i (th_i - th_{i-1}) + c_i (w_i - w_{i-1}) [5.2]. */
void joint_torques(const Model *model, const double *x, Work *work);
double joint_energy(const Model *model, const double *x);

/* water.c: load on every link's centre: submerged weight and normal drag [5.7, 4.3]. */
void link_loads(const Model *model, const double *x, Work *work);

/* terminal.c: force on P_n besides the cable's pull; weight, inputs, springs with preload. */
void terminal_motion(const Model *model, const double *x, const Work *work, double position[2], double velocity[2]);
void terminal_force(const Model *model, const double *x, const double *u, Work *work);
double terminal_energy(const Model *model, const double position[2], const double velocity[2]);

/* floater.c: acceleration of the top point P_0 from the cable's inertia {A_xx, A_xy, A_yy} and bias there. */
void top_acceleration(const Model *model, const double *x, const double *u, const double inertia[3],
                      const double bias[2], double acceleration[2]);
double floater_energy(const Model *model, const double *x);

/* chain.c: elimination from the tip to the top and back substitution. */
void chain_accelerations(const Model *model, const double *x, const double *u, Work *work, double *acceleration);

/* energy.c, tension.c */
double cable_energy(const Model *model, const double *x, const Work *work);
void cable_tensions(const Model *model, const double *x, const double *derivative, const Work *work, double *top,
                    double *end, double *largest);

#endif
