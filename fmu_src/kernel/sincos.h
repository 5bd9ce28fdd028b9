/*
 * Sine and cosine of many angles at once, with the same bits on every platform.
 *
 * The platform's libm differs in the last digit from system to system and costs more than the whole
 * elimination along the chain; no compiler vectorises it. This one has no branch and no table, only
 * +, -, * and bit masks, so that a compiler may run several angles side by side.
 */
#ifndef CABLE_SINCOS_H
#define CABLE_SINCOS_H

/* Angles beyond this [rad] (a million turns of a quarter) are outside the reduction's exact range. */
#define SINCOS_RANGE 1.6e6

/* sine[i], cosine[i] of angle[i] for i < count. |angle[i]| <= SINCOS_RANGE is the caller's promise. */
void sincos_array_portable(int count, const double *angle, double *sine, double *cosine);
void sincos_array_avx2(int count, const double *angle, double *sine, double *cosine);

#endif
