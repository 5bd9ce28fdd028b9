#include "dormand_prince.h"
#include "method.h"

enum { STAGES = 7 };

/* k_1 is the slope at the present point, the others are the stages' own. */
static void slopes_of(const Vectors *vectors, double *slope[STAGES])
{
    slope[0] = vectors->slope;
    for (int j = 1; j < STAGES; j++) slope[j] = vectors->stage[j - 1];
}

/* trial = x + h sum_{j < stage} a_{stage, j} k_j */
static void stage_point(const System *system, int stage, double h, const double *x, double *const *slope, double *trial)
{
    const double *a = DORMAND_PRINCE_54.a + stage * (stage - 1) / 2;
    double weight[STAGES];
    for (int j = 0; j < stage; j++) weight[j] = h * a[j];
    combine_states(system, x, stage, weight, slope, trial);
}

/* err = max |h sum (b - b_embedded)_j k_j| / scale; NaN if anything in it is not a number. */
static double scaled_error(const System *system, double h, double tolerance, const double *x, const Vectors *vectors,
                           double *const *slope)
{
    const Tableau *table = &DORMAND_PRINCE_54;
    double weight[STAGES];
    for (int j = 0; j < STAGES; j++) weight[j] = h * (table->b[j] - table->b_embedded[j]);
    combine_states(system, NULL, STAGES, weight, slope, vectors->spare);
    return largest_of_states(system, vectors->spare, x, vectors->trial) / tolerance;
}

bool explicit_attempt(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                      const double *x, double *error)
{
    const double h = t_new - t;
    double *slope[STAGES];
    slopes_of(vectors, slope);
    for (int stage = 1; stage < STAGES; stage++) {
        const double c = DORMAND_PRINCE_54.c[stage];
        stage_point(system, stage, h, x, slope, vectors->trial);
        const double time = c == 1.0 ? t_new : t + c * h;
        if (!slope_at(system, memory, time, vectors->trial, slope[stage], memory->trial_u)) return false;
    }
    *error = scaled_error(system, h, memory->tolerance, x, vectors, slope);
    return true;
}
