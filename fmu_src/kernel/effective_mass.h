/*
 * What a vessel feels of the cable's inertia at an end whose motion it gives: m = -dF/da, F being the force that the cable
 * exerts on it and a its acceleration, a symmetric 2x2 of masses [kg]. It follows the angles alone.
 */
#ifndef CABLE_EFFECTIVE_MASS_H
#define CABLE_EFFECTIVE_MASS_H

#include "directional.h"

/* The six outputs of both ends, zeros at one that is not given; after directional_point(), whose scratch it takes. */
void effective_masses(const Model *model, Linear *linear, double output[OUTPUT_COUNT]);

/* Their changes with dq, and what their weighted sum changes by with q, which is added. */
void effective_mass_changes(const Model *model, Linear *linear, const double *dq, double d_output[OUTPUT_COUNT]);
void effective_mass_adjoint(const Model *model, Linear *linear, const double *seed, double *q);

#endif
