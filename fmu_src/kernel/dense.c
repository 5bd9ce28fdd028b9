#include "dynamics.h"
#include "method.h"

#include <string.h>

/*
 * While the inputs rest, an implicit step need not end where the host looks: it goes as far as its error allows, and the
 * states in between come of the method's own interpolation [rosenbrock.h], of order 4. Should the inputs change at
 * one of them, the rest of the step is dropped and integration goes on from there.
 */
void dense_remember(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                    const double *x)
{
    const RosenbrockTable *table = &ROSENBROCK_TABLE;
    const size_t bytes = (size_t)model_states(system->model) * sizeof *x;
    memcpy(vectors->begin, x, bytes);
    memcpy(vectors->end, vectors->trial, bytes);
    for (int k = 0; k < table->dense_terms; k++)
        combine_states(system, NULL, table->stages, table->dense + k * table->stages, vectors->stage, vectors->bend[k]);
    memory->dense_from = t, memory->dense_to = t_new;
}

bool dense_state(const System *system, const SolverMemory *memory, const Vectors *vectors, double t, double *x)
{
    const RosenbrockTable *table = &ROSENBROCK_TABLE;
    const double s = (t - memory->dense_from) / (memory->dense_to - memory->dense_from), left = 1.0 - s;
    double *vector[2 + ROSENBROCK_MOST_DENSE] = {vectors->begin, vectors->end};
    double weight[2 + ROSENBROCK_MOST_DENSE] = {left, s}, power = s * left;
    for (int k = 0; k < table->dense_terms; k++, power *= s) weight[2 + k] = power, vector[2 + k] = vectors->bend[k];
    combine_states(system, NULL, 2 + table->dense_terms, weight, vector, x);
    return back_to_guide(system, t, x);
}
