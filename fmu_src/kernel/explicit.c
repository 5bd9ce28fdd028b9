#include <math.h>
#include <string.h>

#include "dynamics.h"
#include "solver.h"

/*
 * Explicit steps with error control. The step follows Gustafsson's PI rule,
 *     h <- h * 0.9 * err^-0.16 * err_before^0.04,   limited to [0.2, 5] times,
 * after Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, section IV.2 of volume II for
 * the PI form. err is the largest over all states of |x_5 - x_4| / (tol (1 + |x|)): the largest and not the
 * mean, since a whip at the free end moves few of many links.
 */
enum { STAGES = 7, BLOCKS = STAGES + 1 };
static const double SAFETY = 0.9, LEAST_CHANGE = 0.2, MOST_CHANGE = 5.0;
static const double SMALLEST_ERROR = 1e-6;                     /* keeps the rule's roots away from zero */
static const double RESOLUTION = 16.0 * 2.220446049250313e-16; /* of time, relative: steps below it are none */

/* Views into the method's block: the slopes k_1 ... k_7 and the point being tried. */
typedef struct {
    double *slope[STAGES];
    double *trial;
} Stages;

size_t explicit_doubles(int n)
{
    return (size_t)BLOCKS * 2u * ((size_t)n + 1u);
}

void solver_restart(SolverMemory *memory)
{
    memory->step = 0.0;
    memory->error_before = 1.0;
    memory->has_slope = false;
}

double fifth_root(double x)
{
    /* Dividing the exponent by five in the bits gives the root within some per cent: a start for Newton. */
    const uint64_t one_fifths = 0x3ff0000000000000u / 5u * 4u;
    uint64_t bits;
    double root;
    memcpy(&bits, &x, sizeof bits);
    bits = bits / 5u + one_fifths;
    memcpy(&root, &bits, sizeof root);
    for (int k = 0; k < 5; k++) {
        const double squared = root * root;
        root = 0.8 * root + 0.2 * x / (squared * squared);
    }
    return root;
}

static bool slope_at(const System *system, SolverMemory *memory, double t, const double *x, double *slope, double *u)
{
    if (!system->inputs(system->source, t, u)) return false;
    cable_derivatives(system->model, x, u, system->work, slope);
    memory->counter[SOLVER_rhs]++;
    return true;
}

static void combine(const System *system, const double *x, int terms, const double *weight, double *const *slope,
                    double *out)
{
    system->model->variant->combine(model_states(system->model), x, terms, weight, slope, out);
}

/* The largest |value| / (1 + |x|) over all states, |x| being the larger of two points; NaN if anything is. */
static double largest_scaled(const System *system, const double *value, const double *x, const double *y)
{
    return system->model->variant->largest_scaled(model_states(system->model), value, x, y);
}

/*
 * A first step such that an Euler step's change and its change of slope stay small (Hairer's rule, section II.4),
 * and not below `least`: the rule only guesses, and what is too small for time is for the error to say.
 */
static bool first_step(const System *system, SolverMemory *memory, const Stages *stages, double t, double span,
                       double least, const double *x)
{
    double *const slope = stages->slope[0], *const ahead = stages->slope[1], *const change = stages->trial;
    const double size = largest_scaled(system, x, x, x), speed = largest_scaled(system, slope, x, x);
    double step = speed > 1e-10 ? fmin(0.01 * (1e-3 + size) / speed, span) : span * 1e-3;
    double u[INPUT_COUNT];
    combine(system, x, 1, &step, stages->slope, stages->trial);
    if (!slope_at(system, memory, t + step, stages->trial, ahead, u)) return false;
    combine(system, NULL, 2, (const double[]){-1.0, 1.0}, stages->slope, change);
    const double bend = largest_scaled(system, change, x, x) / step;
    const double fastest = fmax(speed, bend);
    const double by_error = fastest > 1e-12 ? fifth_root(fmax(memory->tolerance / fastest, 1e-60)) : span;
    memory->step = fmin(fmax(fmin(100.0 * step, by_error), least), span);
    return true;
}

/* trial = x + h sum_{j < stage} a_{stage, j} k_j */
static void stage_point(const System *system, int stage, double h, const double *x, const Stages *stages)
{
    const double *a = DORMAND_PRINCE_54.a + stage * (stage - 1) / 2;
    double weight[STAGES];
    for (int j = 0; j < stage; j++) weight[j] = h * a[j];
    combine(system, x, stage, weight, stages->slope, stages->trial);
}

/* err = max |h sum (b - b_embedded)_j k_j| / scale; NaN if anything in it is not a number. Overwrites k_2. */
static double scaled_error(const System *system, double h, double tolerance, const double *x, const Stages *stages)
{
    const Tableau *table = &DORMAND_PRINCE_54;
    double weight[STAGES], *const error = stages->slope[1];
    for (int j = 0; j < STAGES; j++) weight[j] = h * (table->b[j] - table->b_embedded[j]);
    combine(system, NULL, STAGES, weight, stages->slope, error);
    return largest_scaled(system, error, x, stages->trial) / tolerance;
}

static double change_of_step(double error, double error_before)
{
    const double now = fmax(error, SMALLEST_ERROR), before = fmax(error_before, SMALLEST_ERROR);
    const double squared = now * now;
    return SAFETY / fifth_root(fifth_root(squared * squared / before));
}

/* One attempt from t to t_new; the new point is left in stages->trial, its slope in the last stage. */
static bool attempt(const System *system, SolverMemory *memory, const Stages *stages, double t, double t_new,
                    const double *x, double *error)
{
    const double h = t_new - t;
    double u[INPUT_COUNT];
    for (int stage = 1; stage < STAGES; stage++) {
        const double c = DORMAND_PRINCE_54.c[stage];
        stage_point(system, stage, h, x, stages);
        const double time = c == 1.0 ? t_new : t + c * h;
        if (!slope_at(system, memory, time, stages->trial, stages->slope[stage], u)) return false;
    }
    memcpy(memory->slope_u, u, sizeof u);
    *error = scaled_error(system, h, memory->tolerance, x, stages);
    return true;
}

/* The slope at the present point is the last step's, unless the inputs have jumped since. */
static bool ensure_slope(const System *system, SolverMemory *memory, const Stages *stages, double t, const double *x)
{
    double u[INPUT_COUNT];
    if (!system->inputs(system->source, t, u)) return false;
    if (memory->has_slope && memcmp(u, memory->slope_u, sizeof u) == 0) return true;
    memcpy(memory->slope_u, u, sizeof u);
    cable_derivatives(system->model, x, u, system->work, stages->slope[0]);
    memory->counter[SOLVER_rhs]++;
    memory->has_slope = true;
    return true;
}

static Stages stages_in(double *block, int count)
{
    Stages stages;
    for (int j = 0; j < STAGES; j++) stages.slope[j] = block + (size_t)j * (size_t)count;
    stages.trial = block + (size_t)STAGES * (size_t)count;
    return stages;
}

/* The next step's wish after an accepted step of size h with its scaled error. */
static void accept(SolverMemory *memory, double h, double error, bool rejected_before)
{
    double change = fmin(fmax(change_of_step(error, memory->error_before), LEAST_CHANGE), MOST_CHANGE);
    if (rejected_before) change = fmin(change, 1.0);
    /* A step cut short by the communication point that went well says nothing against the longer wish. */
    const bool cut_short = h < memory->step && change >= 1.0;
    memory->step = cut_short ? fmax(memory->step, h * change) : h * change;
    memory->error_before = error;
    memory->counter[SOLVER_steps]++;
}

/* error may be NaN: then nothing is known but that the step was far too long. */
static void reject(SolverMemory *memory, double h, double error)
{
    const double change = error == error ? change_of_step(error, 1.0) : LEAST_CHANGE;
    memory->step = h * fmin(fmax(change, LEAST_CHANGE), SAFETY);
    memory->counter[SOLVER_rejected]++;
}

SolverStatus explicit_advance(const System *system, SolverMemory *memory, double *block, double *t, double t_end,
                              double *x)
{
    const int count = model_states(system->model);
    const Stages stages = stages_in(block, count);
    const double least = RESOLUTION * fmax(fabs(*t), fabs(t_end));
    bool rejected_before = false;
    if (!ensure_slope(system, memory, &stages, *t, x)) return SOLVER_INPUT_FAILED;
    if (memory->step == 0.0 && !first_step(system, memory, &stages, *t, t_end - *t, least, x))
        return SOLVER_INPUT_FAILED;

    for (int tries = 0; *t < t_end; tries++) {
        if (tries == SOLVER_MOST_STEPS) return SOLVER_TOO_MANY_STEPS;
        const double remaining = t_end - *t, wish = memory->step;
        const bool last = wish >= remaining;
        if (wish < least && !last) return SOLVER_STEP_TOO_SMALL;
        /* The last two steps share what remains, so that no sliver is left over. */
        const double h = last ? remaining : (2.0 * wish > remaining ? 0.5 * remaining : wish);
        const double t_new = last ? t_end : *t + h;

        double error;
        if (!attempt(system, memory, &stages, *t, t_new, x, &error)) return SOLVER_INPUT_FAILED;
        if (!(error <= 1.0)) {
            reject(memory, h, error);
            rejected_before = true;
            continue;
        }
        accept(memory, h, error, rejected_before);
        rejected_before = false;
        memcpy(x, stages.trial, (size_t)count * sizeof *x);
        memcpy(stages.slope[0], stages.slope[STAGES - 1], (size_t)count * sizeof *x);
        *t = t_new;
        if (angle_out_of_range(system->model, x)) return SOLVER_ANGLE_TOO_LARGE;
    }
    return SOLVER_OK;
}
