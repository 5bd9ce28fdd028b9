#include "combine.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { CHUNK = 16 }; /* sums that stay in registers while the slopes go by */

void VARIANT(combine)(int count, const double *x, int terms, const double *weight, double *const *slope, double *out)
{
    int i = 0;
    for (; i + CHUNK <= count; i += CHUNK) {
        double sum[CHUNK];
        if (x)
            memcpy(sum, x + i, sizeof sum);
        else
            memset(sum, 0, sizeof sum);
        for (int j = 0; j < terms; j++) {
            const double *term = slope[j] + i;
            for (int k = 0; k < CHUNK; k++) sum[k] += weight[j] * term[k];
        }
        memcpy(out + i, sum, sizeof sum);
    }
    for (; i < count; i++) {
        double sum = x ? x[i] : 0.0;
        for (int j = 0; j < terms; j++) sum += weight[j] * slope[j][i];
        out[i] = sum;
    }
}

/* Doubles that are not negative sort like their bits, and a NaN (its sign cleared) above all: a maximum without a branch. */
double VARIANT(largest_scaled)(int count, const double *value, const double *x, const double *y)
{
    int64_t largest = 0;
    for (int i = 0; i < count; i++) {
        const double here = fabs(x[i]), there = fabs(y[i]);
        const double scaled = fabs(value[i]) / (1.0 + (here > there ? here : there));
        int64_t bits;
        memcpy(&bits, &scaled, sizeof bits);
        bits &= INT64_MAX;
        largest = bits > largest ? bits : largest;
    }
    double result;
    memcpy(&result, &largest, sizeof result);
    return result;
}
