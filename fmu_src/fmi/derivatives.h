/* Partial derivatives of the unknowns by the knowns [kernel/directional.h, kernel/adjoint.h], whatever the version of FMI. */
#ifndef CABLE_DERIVATIVES_H
#define CABLE_DERIVATIVES_H

#include "instance.h"

/* Unknowns, and what they are taken by: `count` references, each with a value, or with as many as an array has. */
typedef struct {
    const uint32_t *reference;
    size_t count;
} References;

/* sensitivity of every unknown = dy/dx seed of every known */
Status instance_directional(Instance *instance, References unknowns, References knowns, const double *seed,
                            double *sensitivity);

/* sensitivity of every known = (dy/dx)^T seed of every unknown */
Status instance_adjoint(Instance *instance, References unknowns, References knowns, const double *seed,
                        double *sensitivity);

/* One of the outputs that are partial derivatives themselves [kernel/effective_mass.h]. False after a message. */
bool instance_effective_mass(Instance *instance, uint32_t output, double *value);

/* Time derivatives of outputs, of order 1, while the inputs go on by the derivatives given for the step to come. */
Status instance_output_derivatives(Instance *instance, References outputs, const int32_t *orders, double *values);

#endif
