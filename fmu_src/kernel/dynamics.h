/*
 * The equations of motion, I x'' + C x' + K x + F + G = T [3.8], in O(n).
 *
 * cable_derivatives() is the theory's table of contents; each line of it is one file. A force is a file
 * that adds to the loads on the links (`load_x`, `load_y`, `torque`), to `end_force`, or to the top.
 */
#ifndef CABLE_DYNAMICS_H
#define CABLE_DYNAMICS_H

#include <math.h>

#include "model.h"
#include "variant.h"

/*
 * The right-hand side: the derivative of x' = f(x, u), as long as x. Pure: depends on its arguments alone,
 * changes nothing but `derivative` and scratch. u[INPUT_COUNT], zeros where the scene has no input.
 */
void cable_derivatives(const Model *model, const double *x, const double *u, Work *work, double *derivative);

/*
 * Every output of Y_..., output[OUTPUT_COUNT]. With has_derivatives, `work` and `derivative` must be
 * what cable_derivatives() left for the same (x, u); without, pulls and forces are left as they are.
 */
void cable_outputs(const Model *model, const double *x, const double *u, const double *derivative, Work *work,
                   double *output, bool has_derivatives);

/* --- one concept a file; those under VARIANT are compiled once more in avx2.c --- */

/* dynamics.c: the first link (1 ...) whose angle is beyond SINCOS_RANGE, or 0. */
int angle_out_of_range(const Model *model, const double *x);

/* terminal.c: force on P_n besides the cable's pull; weight, inputs, springs with preload. */
void terminal_motion(const Model *model, const double *x, const Work *work, double position[2], double velocity[2]);
void terminal_force(const Model *model, const double *x, const double *u, Work *work);
const Motion *terminal_guide(const Model *model, const double *u);
double terminal_energy(const Model *model, const double position[2], const double velocity[2]);

/* What the cable is fastened to at P_0 or P_n: its inertia N / unit with det = det(N) / unit [ends.h], and its bias,
 * at the top the acceleration that it has when nothing pulls [m/s^2], at the terminal the force -F [N]; and the
 * acceleration that a terminal is given, whatever pulls [m/s^2]. */
typedef struct {
    double xx, xy, yy, unit, det;
    double bias_x, bias_y;
    double given_x, given_y;
} Port;

/* top.c, terminal.c: top_motion() comes before everything else that asks where the cable is, or how fast. */
void top_motion(const Model *model, const double *x, const double *u, Work *work);
void top_port(const Model *model, const double *x, const double *u, const Work *work, Port *port);
void terminal_port(const Model *model, const Work *work, Port *port);
void top_acceleration(const Model *model, const double *x, const double *u, double pull_x, double pull_y,
                      double *acceleration);
double top_energy(const Model *model, const Work *work);

/* pin.c: the state x with P_n where the guide is and as fast, from which steps lead away by their error. */
void pin_project(const Model *model, const double *u, Work *work, const Motion *guide, double *x);

/* A force [N] or another pair along x and y. */
typedef struct {
    double x, y;
} Pair;

/* As hypot() of libm, whose last digit is not the same everywhere. */
static inline double size_of_pair(double x, double y)
{
    const double larger = fmax(fabs(x), fabs(y)), ratio = larger > 0.0 ? fmin(fabs(x), fabs(y)) / larger : 0.0;
    return larger * sqrt(1.0 + ratio * ratio);
}

/* tension.c: R_{i+1} from R_i, after cable_derivatives(); turn is th'' of link i. */
static inline Pair force_below(const Model *model, const Work *work, int i, double turn, Pair force)
{
    if (i < model->middle) return (Pair){work->answer_x[i + 1], work->answer_y[i + 1]};
    const double swing = 0.5 * model->link[LINK_LENGTH][i] * turn, mass = model->link[LINK_MASS][i];
    return (Pair){force.x + (work->drive_x[i] - mass * (work->answer_x[i + 1] + swing * work->cosine[i])),
                  force.y + (work->drive_y[i] - mass * (work->answer_y[i + 1] - swing * work->sine[i]))};
}

/* water.c: v_n = n . V at the link's centre [m/s], V_{i-1} being what motion() left. */
static inline double speed_across(const Model *model, const Work *work, int i, double rate)
{
    return (work->cosine[i] * work->velocity_x[i] - work->sine[i] * work->velocity_y[i]) +
           0.5 * model->link[LINK_LENGTH][i] * rate;
}

/* energy.c, tension.c */
double cable_energy(const Model *model, const double *x, const Work *work);
void cable_forces(const Model *model, const double *derivative, const Work *work, double *output);

/* Twice: name_portable and name_avx2 [variant.h]. */
#define STAGES_OF(variant)                                                                                             \
    void orientation_##variant(const Model *model, const double *x, Work *work);                                       \
    void joint_torques_##variant(const Model *model, const double *x, Work *work);                                     \
    void motion_##variant(const Model *model, const double *x, Work *work);     /* sums along the cable */             \
    void link_loads_##variant(const Model *model, const double *x, Work *work); /* weight, drag [5.7, 4.3] */          \
    void chain_accelerations_##variant(const Model *model, const double *x, const double *u, Work *work,               \
                                       double *acceleration);                                                          \
    void cable_derivatives_##variant(const Model *model, const double *x, const double *u, Work *work,                 \
                                     double *derivative);
STAGES_OF(portable)
STAGES_OF(avx2)
#undef STAGES_OF

#endif
