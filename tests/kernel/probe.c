/*
 * The kernel behind flat functions, for the tests: what Python sees is pointers and numbers, so no layout
 * of a C structure is written down twice.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fmu_src/kernel/adjoint.h"
#include "../../fmu_src/kernel/directional.h"
#include "../../fmu_src/kernel/dormand_prince.h"
#include "../../fmu_src/kernel/method.h"
#include "../../fmu_src/kernel/processor.h"
#include "../../fmu_src/kernel/rosenbrock.h"
#include "../../fmu_src/kernel/sincos.h"
#include "../../fmu_src/kernel/solver.h"
#include "../../fmu_src/kernel_api/api.h"

/* A kernel as Python has it, and what the solver needs besides. */
typedef struct {
    Kernel *kernel;
    Model *model;
    Work *work;
    Linear *linear;
    SolverMemory memory;
    double *stages;
} Probe;

void probe_free(Probe *probe)
{
    if (probe->kernel) kernel_free(probe->kernel);
    free(probe->stages);
    free(probe);
}

/* The link arrays stay the caller's: link[LINK_COLUMNS][n], to be kept as long as the probe. */
Probe *probe_new(int n, int top, int terminal, int drag, uint64_t present, const double *parameter, const double *rest,
                 const double *link)
{
    Probe *probe = calloc(1, sizeof *probe);
    if (!probe) return NULL;
    probe->kernel = kernel_new(n, top, terminal, drag, present, parameter, rest, link);
    probe->stages = calloc(solver_doubles(n), sizeof(double));
    if (!probe->kernel || !probe->stages) {
        probe_free(probe);
        return NULL;
    }
    probe->model = &probe->kernel->model;
    probe->work = &probe->kernel->work;
    probe->linear = &probe->kernel->linear;
    return probe;
}

/* For the functions of the API itself. */
Kernel *probe_kernel(Probe *probe)
{
    return probe->kernel;
}

/* Everything in the model that an evaluation must leave alone: parameters, then the derived arrays. */
size_t probe_constants(const Probe *probe, double *copy)
{
    const size_t arrays = model_doubles(probe->model->n);
    if (copy) {
        memcpy(copy, probe->model->parameter, sizeof probe->model->parameter);
        memcpy(copy + PARAMETER_COUNT, probe->kernel->block, arrays * sizeof *copy);
    }
    return PARAMETER_COUNT + arrays;
}

/* Scratch full of not-a-numbers: whoever reads it before writing shows. */
void probe_spoil_scratch(Probe *probe)
{
    double *scratch = probe->kernel->block + model_doubles(probe->model->n);
    for (size_t k = 0; k < work_doubles(probe->model->n); k++) scratch[k] = NAN;
    Work *work = probe->work;
    double *const strip[] = {work->nn,     work->en,   work->ee,   work->unit, work->det,      work->bias_x,
                             work->bias_y, work->k_ee, work->k_en, work->k_nn, work->per_pivot};
    for (size_t k = 0; k < sizeof strip / sizeof *strip; k++)
        for (int i = 0; i < STRIP_ROOM; i++) strip[k][i] = NAN;
    for (int k = 0; k < 2; k++)
        probe->work->end_force[k] = probe->work->end_position[k] = probe->work->end_velocity[k] = NAN;
    work->top = (Motion){{NAN, NAN}, {NAN, NAN}, {NAN, NAN}};
    work->guide = NULL;
}

/* The same of the solver's vectors and the factors, before a start. */
void probe_spoil_solver(Probe *probe)
{
    const int n = probe->model->n;
    double *factors = probe->kernel->block + model_doubles(n) + work_doubles(n);
    for (size_t k = 0; k < solver_doubles(n); k++) probe->stages[k] = NAN;
    for (size_t k = 0; k < linear_doubles(n); k++) factors[k] = NAN;
}

/* Like sincos_array_portable(); 0 and nothing done where the processor has no AVX2. */
int probe_sincos_avx2(int count, const double *angle, double *sine, double *cosine)
{
#if defined(__x86_64__)
    if (processor_has_avx2()) {
        sincos_array_avx2(count, angle, sine, cosine);
        return 1;
    }
#endif
    (void)count, (void)angle, (void)sine, (void)cosine;
    return 0;
}

/* Fast and good enough to scatter arguments: xorshift64*, Marsaglia and Vigna. */
static uint64_t scattered(uint64_t *state)
{
    *state ^= *state >> 12, *state ^= *state << 25, *state ^= *state >> 27;
    return *state * 0x2545f4914f6cdd1du;
}

static double ulps_off(double found, long double exact)
{
    int exponent;
    frexpl(exact, &exponent);
    return (double)(fabsl((long double)found - exact) / ldexpl(1.0L, exponent - 53));
}

/*
 * The largest error of sine and cosine in units in the last place, against the platform's long double functions, over
 * `blocks` times 1000 arguments scattered over [-reach, reach]; -1 if the two variants ever differ in a bit.
 */
double probe_sincos_worst(int blocks, double reach, uint64_t seed)
{
    double angle[1000], found[4][1000], worst = 0.0;
    for (int block = 0; block < blocks; block++) {
        for (int i = 0; i < 1000; i++) angle[i] = reach * ((double)(scattered(&seed) >> 11) * 0x1p-52 - 1.0);
        sincos_array_portable(1000, angle, found[0], found[1]);
        if (probe_sincos_avx2(1000, angle, found[2], found[3]) && memcmp(found[0], found[2], 2 * sizeof *found))
            return -1.0;
        for (int i = 0; i < 1000; i++) {
            const double off = ulps_off(found[0][i], sinl(angle[i])), too = ulps_off(found[1][i], cosl(angle[i]));
            worst = fmax(worst, fmax(off, too));
        }
    }
    return worst;
}

/* Choose the compiled variant; whether the wide one is in use afterwards. */
int probe_use_avx2(Probe *probe, int wanted)
{
    probe->model->variant = wanted && processor_has_avx2() ? &AVX2 : &PORTABLE;
    return probe->model->variant == &AVX2;
}

void probe_derivatives(Probe *probe, const double *x, const double *u, double *derivative)
{
    cable_derivatives(probe->model, x, u, probe->work, derivative);
}

/* Many evaluations, each at a point that depends on the one before, for whoever holds the clock. */
void probe_repeat(Probe *probe, double *x, const double *u, double *derivative, int times)
{
    for (int k = 0; k < times; k++) {
        cable_derivatives(probe->model, x, u, probe->work, derivative);
        x[1] += 1e-12 * derivative[1];
    }
}

/* The same for sine, cosine and elimination alone, after probe_repeat(): what no arrangement of the rest can undercut. */
void probe_repeat_core(Probe *probe, double *x, const double *u, double *derivative, int times)
{
    Model *model = probe->model;
    Work *work = probe->work;
    double *acceleration = derivative + model_coordinates(model);
    for (int k = 0; k < times; k++) {
#if defined(__x86_64__)
        if (model->variant == &AVX2) {
            sincos_array_avx2(model->n, x + 1, work->sine, work->cosine);
            chain_accelerations_avx2(model, x, u, work, acceleration);
            x[1] += 1e-12 * acceleration[1];
            continue;
        }
#endif
        sincos_array_portable(model->n, x + 1, work->sine, work->cosine);
        chain_accelerations_portable(model, x, u, work, acceleration);
        x[1] += 1e-12 * acceleration[1];
    }
}

/* With derivative == NULL the outputs that need no derivatives; else after probe_derivatives() of the same x. */
void probe_outputs(Probe *probe, const double *x, const double *u, const double *derivative, double *output)
{
    cable_outputs(probe->model, x, u, derivative, probe->work, output, derivative != NULL);
    if (derivative && motion_is_given(probe->model) &&
        directional_point(probe->model, x, probe->work, derivative, probe->linear))
        effective_masses(probe->model, probe->linear, output);
}

/* Directional derivatives of right-hand side and outputs at (x, u); 0 where there are none. */
int probe_directional(Probe *probe, const double *x, const double *u, const double *dx, const double *du,
                      double *derivative, double *d_derivative, double *d_output)
{
    cable_derivatives(probe->model, x, u, probe->work, derivative);
    if (!directional_point(probe->model, x, probe->work, derivative, probe->linear)) return 0;
    directional_derivatives(probe->model, x, probe->linear, dx, du, d_derivative, d_output);
    return 1;
}

/* Adjoint derivatives there: what the sum weighted by the seeds changes by with every state and input; 0 where there are none. */
int probe_adjoint(Probe *probe, const double *x, const double *u, const double *seed_derivative,
                  const double *seed_output, double *derivative, double *to_state, double *to_input)
{
    cable_derivatives(probe->model, x, u, probe->work, derivative);
    if (!directional_point(probe->model, x, probe->work, derivative, probe->linear)) return 0;
    adjoint_derivatives(probe->model, x, probe->linear, seed_derivative, seed_output, to_state, to_input);
    return 1;
}

/* At (x, u): L change = force with the given weights; how many pivots are negative. back: L change once more, by
 * linear_apply(), which has no factors; end[0 ... 1]: what the relation of a held end is to be, then what it is but for
 * the force through that end, through[0 ... 1]. */
int probe_linear(Probe *probe, const double *x, const double *u, const double *weights, const double *force,
                 double *end, double *change, double *back, double *through)
{
    const int half = model_coordinates(probe->model);
    double *derivative = probe->stages, *dq = derivative + 2 * half, *dv = dq + half, *da = dv + half;
    Linear *linear = probe->linear;
    cable_derivatives(probe->model, x, u, probe->work, derivative);
    linear_point(probe->model, x, probe->work, derivative, linear);
    const int negative = linear_factor(probe->model, (Weights){weights[0], weights[1], weights[2]}, linear);
    if (negative < 0) return negative;
    linear_solve(probe->model, linear, force, end, change);
    for (int k = 0; k < 2; k++) through[k] = linear->is_held ? linear->through[k] : 0.0;
    for (int k = 0; k < half; k++) {
        dq[k] = weights[0] * change[k], dv[k] = weights[1] * change[k], da[k] = weights[2] * change[k];
    }
    linear_apply(probe->model, linear, dq, dv, da, back, end);
    return negative;
}

/* The same many times, for whoever holds the clock: what 1 is a factorisation, 2 a solution, 3 a product. */
void probe_repeat_linear(Probe *probe, int what, const double *weights, double *force, double *change, int times)
{
    double end[2] = {0.0, 0.0};
    for (int k = 0; k < times; k++) {
        if (what == 1) linear_factor(probe->model, (Weights){weights[0], weights[1], weights[2]}, probe->linear);
        if (what == 2) linear_solve(probe->model, probe->linear, force, end, change);
        if (what == 3) linear_apply(probe->model, probe->linear, force, force, force, change, end);
        force[0] += 1e-12 * change[0];
    }
}

/* u_k(t) = constant_k + amplitude_k sin(pulsation_k t + phase_k); pulsation in rad/s. From still_from to still_to they do not change. */
typedef struct {
    const double *constant, *amplitude, *pulsation, *phase;
    double still_from, still_to;
} Waves;

static bool waves_at(void *source, double time, double *u)
{
    const Waves *waves = source;
    if (time > waves->still_from && time < waves->still_to) time = waves->still_from;
    for (int k = 0; k < INPUT_COUNT; k++) {
        u[k] = waves->constant[k] + waves->amplitude[k] * sin(waves->pulsation[k] * time + waves->phase[k]);
        if (!isfinite(u[k])) return false;
    }
    return true;
}

void probe_restart(Probe *probe, double tolerance, int choice)
{
    memset(&probe->memory, 0, sizeof probe->memory);
    probe->memory.tolerance = tolerance;
    probe->memory.choice = (SolverChoice)choice;
    probe->memory.energy.is_kept = true;
    solver_restart(&probe->memory);
}

/* What the solver remembers is forgotten, by its own means. */
void probe_forget(Probe *probe)
{
    solver_restart(&probe->memory);
}

/* The parts of the energy balance since the start: work of the inputs, what drag and dampers took [J]. */
void probe_energy(const Probe *probe, double *parts)
{
    parts[0] = probe->memory.energy.work, parts[1] = probe->memory.energy.taken;
}

/*
 * `steps` implicit steps of size h from (t, x) on, none of them refused; `between` is the state at that share of the last one.
 * The result is the last one's scaled error at tolerance 1. With `still` the inputs look constant to whoever measures their slopes.
 */
double probe_implicit_steps(Probe *probe, double t, double h, int steps, int still, double share, double *x,
                            const double *waves, double *between)
{
    Waves source = {waves, waves + INPUT_COUNT, waves + 2 * INPUT_COUNT, waves + 3 * INPUT_COUNT, 0.0, 0.0};
    const System system = {probe->model, probe->work, probe->linear, waves_at, &source, false, NULL};
    SolverMemory *memory = &probe->memory;
    const size_t count = (size_t)model_states(probe->model);
    double *next = probe->stages, error = NAN;
    Vectors vectors;
    double **const all[] = {&vectors.slope, &vectors.trial,   &vectors.right_side, &vectors.force,
                            &vectors.spare, &vectors.fastest, &vectors.begin,      &vectors.end};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++, next += count) *all[k] = next;
    for (int j = 0; j < ROSENBROCK_MOST_DENSE; j++, next += count) vectors.bend[j] = next;
    for (int j = 0; j < METHOD_STAGES; j++, next += count) vectors.stage[j] = next;
    probe_restart(probe, 1.0, SOLVER_IMPLICIT);
    for (int k = 0; k < steps; k++) {
        const double from = t + k * h, to = t + (k + 1) * h;
        source.still_from = from, source.still_to = still ? from + h / 256.0 : from;
        waves_at(&source, from, memory->slope_u);
        cable_derivatives(probe->model, x, memory->slope_u, probe->work, vectors.slope);
        linear_point(probe->model, x, probe->work, vectors.slope, probe->linear);
        if (!implicit_attempt(&system, memory, &vectors, from, to, x, &error)) return NAN;
        if (k == steps - 1) {
            dense_remember(&system, memory, &vectors, from, to, x);
            dense_state(&system, memory, &vectors, from + share * h, between);
        }
        memcpy(x, vectors.trial, count * sizeof *x);
    }
    return error;
}

/* One communication step of the solver; waves[4][INPUT_COUNT] as in Waves. */
int probe_advance(Probe *probe, double *t, double t_end, double *x, const double *waves, double *counter)
{
    Waves source = {waves, waves + INPUT_COUNT, waves + 2 * INPUT_COUNT, waves + 3 * INPUT_COUNT, 0.0, 0.0};
    bool rest = true;
    for (int k = 0; k < INPUT_COUNT; k++) rest &= waves[INPUT_COUNT + k] == 0.0;
    const System system = {probe->model, probe->work, probe->linear, waves_at, &source, rest, NULL};
    const SolverStatus status = solver_advance(&system, &probe->memory, probe->stages, t, t_end, x);
    double output[OUTPUT_COUNT], u[INPUT_COUNT];
    waves_at(&source, *t, u);
    cable_outputs(probe->model, x, u, NULL, probe->work, output, false);
    probe->memory.counter[SOLVER_energy_residual] = solver_energy_residual(&probe->memory, output[Y_energy]);
    memcpy(counter, probe->memory.counter, sizeof probe->memory.counter);
    return (int)status;
}

/* Stages of the explicit pair; a is the full square by rows, zeros included. */
int probe_tableau(double *a, double *b, double *b_embedded, double *c)
{
    const Tableau *table = &DORMAND_PRINCE_54;
    const double *next = table->a;
    for (int i = 0; i < table->stages; i++) {
        for (int j = 0; j < i; j++) a[i * table->stages + j] = *next++;
        b[i] = table->b[i];
        b_embedded[i] = table->b_embedded[i];
        c[i] = table->c[i];
    }
    return table->stages;
}

/* [other_rosenbrock_tables.c] */
extern const RosenbrockTable RODAS4, RODAS4P2;

static const RosenbrockTable *const ROSENBROCK[] = {&RODAS4, &RODAS4P2, &RODAS5P};

/* Name of the which'th method, and its size: stages, order, order without the error, rows of dense output. */
const char *probe_rosenbrock_size(int which, double *size)
{
    const RosenbrockTable *table = ROSENBROCK[which];
    size[0] = table->stages, size[1] = table->order, size[2] = table->error_order, size[3] = table->dense_terms;
    return table->name;
}

/* Its coefficients: triangles[2] as full squares by rows (a, c), rows[4][stages] (m, e, alpha, d); result: gamma. */
double probe_rosenbrock(int which, double *triangles, double *rows, double *dense)
{
    const RosenbrockTable *table = ROSENBROCK[which];
    const int stages = table->stages;
    const double *const triangle[] = {table->a, table->c};
    const double *const row[] = {table->m, table->e, table->alpha, table->d};
    for (int k = 0; k < 2; k++) {
        const double *next = triangle[k];
        for (int i = 0; i < stages; i++)
            for (int j = 0; j < stages; j++) *triangles++ = j < i ? *next++ : 0.0;
    }
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < stages; i++) *rows++ = row[k][i];
    for (int i = 0; i < table->dense_terms * stages; i++) dense[i] = table->dense[i];
    return table->gamma;
}

/* Names as the C compiler read them from variables.def, in slot order. */
#define PARAMETER(name, unit, least, description) [P_##name] = #name,
static const char *const PARAMETER_NAME[PARAMETER_COUNT] = {
#include "../../fmu_src/kernel/variables.def"
};

#define INPUT(name, unit, description) [U_##name] = #name,
static const char *const INPUT_NAME[INPUT_COUNT] = {
#include "../../fmu_src/kernel/variables.def"
};

#define OUTPUT(name, unit, nominal, description) [Y_##name] = #name,
static const char *const OUTPUT_NAME[OUTPUT_COUNT] = {
#include "../../fmu_src/kernel/variables.def"
};

#define SOLVER(name, unit, description) [SOLVER_##name] = #name,
static const char *const COUNTER_NAME[SOLVER_COUNT] = {
#include "../../fmu_src/kernel/variables.def"
};

/* The slot'th name of list 0 ... 3 (parameters, inputs, outputs, counters); NULL behind the end. */
const char *probe_name(int list, int slot)
{
    static const struct {
        const char *const *name;
        int count;
    } LISTS[] = {{PARAMETER_NAME, PARAMETER_COUNT},
                 {INPUT_NAME, INPUT_COUNT},
                 {OUTPUT_NAME, OUTPUT_COUNT},
                 {COUNTER_NAME, SOLVER_COUNT}};
    return slot < LISTS[list].count ? LISTS[list].name[slot] : NULL;
}
