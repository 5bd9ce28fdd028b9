#include <math.h>

#include "dynamics.h"
#include "sincos.h"

/* Sine and cosine of every link, and of the turn from the link above to it (from the vertical to link 1). */
void VARIANT(orientation)(const Model *model, const double *x, Work *work)
{
    const int n = model->n;
    const double *sine = work->sine, *cosine = work->cosine;
    double *turn_sine = work->turn_sine, *turn_cosine = work->turn_cosine;
    VARIANT(sincos_array)(n, x + 1, work->sine, work->cosine);
    turn_sine[0] = sine[0];
    turn_cosine[0] = cosine[0];
    LINKS_ARE_INDEPENDENT
    for (int i = 1; i < n; i++) {
        turn_sine[i] = sine[i] * cosine[i - 1] - cosine[i] * sine[i - 1];
        turn_cosine[i] = cosine[i] * cosine[i - 1] + sine[i] * sine[i - 1];
    }
}
