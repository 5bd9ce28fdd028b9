/* Arithmetic of a Runge-Kutta step over all states, compiled twice like the right-hand side [variant.h]. */
#ifndef CABLE_COMBINE_H
#define CABLE_COMBINE_H

#include "variant.h"

/* out = x + sum_j weight[j] slope[j], each array of `count`; x may be NULL, for 0, and out any of the others. */
/* The largest |value[i]| / (1 + max(|x[i]|, |y[i]|)); NaN if any of them is. */
#define COMBINE_OF(variant)                                                                                            \
    void combine_##variant(int count, const double *x, int terms, const double *weight, double *const *slope,          \
                           double *out);                                                                               \
    double largest_scaled_##variant(int count, const double *value, const double *x, const double *y);
COMBINE_OF(portable)
COMBINE_OF(avx2)
#undef COMBINE_OF

#endif
