#include <math.h>

#include "dynamics.h"
#include "sincos.h"

void orientation(const Model *model, const double *x, Work *work)
{
    sincos_array(model->n, x + 1, work->sine, work->cosine);
}

int angle_out_of_range(const Model *model, const double *x)
{
    for (int i = 1; i <= model->n; i++)
        if (!(fabs(x[i]) <= SINCOS_RANGE)) return i;
    return 0;
}
