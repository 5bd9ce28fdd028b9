/*
 * The stable equilibrium of a cable under constant inputs: forces balance, and the tangent stiffness is positive
 * definite.
 */
#ifndef CABLE_STATICS_H
#define CABLE_STATICS_H

#include "linear.h"

typedef enum {
    STATICS_OK,
    STATICS_NO_BALANCE, /* the forces could not be balanced: nothing holds the cable, or the search came to its end */
    STATICS_NOT_FINITE  /* forces or angles beyond the range of numbers */
} StaticsStatus;

/* Doubles of the block that statics_solve() works in. */
size_t statics_doubles(int n);

/* still[INPUT_COUNT]: the inputs u without the velocities and accelerations of given motions, of which an equilibrium
 * knows nothing. */
void statics_inputs(const double *u, double *still);

/* Whether statics keeps P_n where it is: on its pin, where the inputs say, or an anchor that is held by its mass
 * alone. */
bool statics_holds_end(const Model *model);

/*
 * From the angles and the top's place in x to a stable equilibrium near them, under u[INPUT_COUNT]; the velocities
 * become zero. figure[STATICS_COUNT] tells how well and how long, on failure as well.
 */
StaticsStatus statics_solve(const Model *model, const double *u, Work *work, Linear *linear, double *block, double *x,
                            double *figure);

#endif
