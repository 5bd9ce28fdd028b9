#include "dormand_prince.h"

/*
 * Dormand & Prince, "A family of embedded Runge-Kutta formulae", J. Comput. Appl. Math. 6 (1980) 19-26:
 * order 5 with an embedded 4, seven stages, the last of which is the next step's first.
 */
static const double DP_A[] = {
    1.0 / 5,         3.0 / 40,       9.0 / 40,     44.0 / 45,     -56.0 / 15,  32.0 / 9,       19372.0 / 6561,
    -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176,
    -5103.0 / 18656, 35.0 / 384,     0.0,          500.0 / 1113,  125.0 / 192, -2187.0 / 6784, 11.0 / 84,
};
static const double DP_B[] = {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0.0};
static const double DP_B_EMBEDDED[] = {5179.0 / 57600,    0.0,          7571.0 / 16695, 393.0 / 640,
                                       -92097.0 / 339200, 187.0 / 2100, 1.0 / 40};
static const double DP_C[] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};

const Tableau DORMAND_PRINCE_54 = {"Dormand-Prince 5(4)", 7, 5, DP_A, DP_B, DP_B_EMBEDDED, DP_C};
