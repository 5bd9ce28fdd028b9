#include "method.h"

#include <math.h>
#include <string.h>

#include "dynamics.h"

/*
 * Steps with error control. Their size follows Gustafsson's PI rule,
 *     h <- h * 0.9 * err^-0.16 * err_before^0.04,   limited to [0.2, 5] times,
 * for both methods, whose error estimates are of order 4; after Hairer, Norsett & Wanner, Solving Ordinary Differential
 * Equations I, section II.4, and section IV.2 of volume II for the PI form. err is the largest over all states of
 * |error| / (tol (1 + |x|)): the largest and not the mean, since a whip at the free end moves few of many links.
 */
static const double SAFETY = 0.9, LEAST_CHANGE = 0.2, MOST_CHANGE = 5.0;
static const double STRETCH = 1.1;                             /* raises the error by 1.6, which 0.9^5 makes up for */
static const double SMALLEST_ERROR = 1e-6;                     /* keeps the rule's roots away from zero */
static const double RESOLUTION = 16.0 * 2.220446049250313e-16; /* of time, relative: steps below it are none */

size_t solver_doubles(int n)
{
    return (size_t)VECTORS * 2u * (size_t)most_coordinates(n);
}

Vectors vectors_in(double *block, int count)
{
    Vectors vectors;
    double **const all[] = {&vectors.slope, &vectors.trial,   &vectors.right_side, &vectors.force,
                            &vectors.spare, &vectors.fastest, &vectors.begin,      &vectors.end};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++, block += count) *all[k] = block;
    for (int j = 0; j < ROSENBROCK_MOST_DENSE; j++, block += count) vectors.bend[j] = block;
    for (int j = 0; j < METHOD_STAGES; j++, block += count) vectors.stage[j] = block;
    return vectors;
}

void solver_restart(SolverMemory *memory)
{
    memory->step = 0.0;
    memory->error_before = 1.0;
    memory->is_implicit = false;
    memset(&memory->chosen, 0, sizeof memory->chosen);
    memory->has_slope = memory->has_point = memory->has_moved = memory->is_inside = memory->rested = false;
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

bool slope_at(const System *system, SolverMemory *memory, double t, const double *x, double *slope, double *u)
{
    if (!system->inputs(system->source, t, u)) return false;
    cable_derivatives(system->model, x, u, system->work, slope);
    memory->counter[SOLVER_rhs]++;
    return true;
}

void combine_states(const System *system, const double *x, int terms, const double *weight, double *const *vector,
                    double *out)
{
    system->model->variant->combine(model_states(system->model), x, terms, weight, vector, out);
}

double largest_of_states(const System *system, const double *value, const double *x, const double *y)
{
    return system->model->variant->largest_scaled(model_states(system->model), value, x, y);
}

/*
 * A first step such that an Euler step's change and its change of slope stay small (Hairer's rule, section II.4),
 * and not below `least`: the rule only guesses, and what is too small for time is for the error to say.
 */
static bool first_step(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double span,
                       double least, const double *x)
{
    double *const slopes[] = {vectors->slope, vectors->stage[0]}, *const change = vectors->trial;
    const double size = largest_of_states(system, x, x, x), speed = largest_of_states(system, vectors->slope, x, x);
    double step = speed > 1e-10 ? fmin(0.01 * (1e-3 + size) / speed, span) : span * 1e-3;
    double u[INPUT_COUNT];
    combine_states(system, x, 1, &step, slopes, vectors->trial);
    if (!slope_at(system, memory, t + step, vectors->trial, slopes[1], u)) return false;
    combine_states(system, NULL, 2, (const double[]){-1.0, 1.0}, slopes, change);
    const double bend = largest_of_states(system, change, x, x) / step;
    const double fastest = fmax(speed, bend);
    const double by_error = fastest > 1e-12 ? fifth_root(fmax(memory->tolerance / fastest, 1e-60)) : span;
    memory->step = fmin(fmax(fmin(100.0 * step, by_error), least), span);
    return true;
}

static double change_of_step(double error, double error_before)
{
    const double now = fmax(error, SMALLEST_ERROR), before = fmax(error_before, SMALLEST_ERROR);
    const double squared = now * now;
    return SAFETY / fifth_root(fifth_root(squared * squared / before));
}

/* The slope at the present point is the last step's, unless the inputs have jumped since; an implicit step needs the
 * linearised chain there as well, for which the right-hand side must have been the last thing in `work`. */
static bool ensure_point(const System *system, SolverMemory *memory, const Vectors *vectors, double t, const double *x)
{
    double u[INPUT_COUNT];
    if (!system->inputs(system->source, t, u)) return false;
    const bool same = memory->has_slope && memcmp(u, memory->slope_u, sizeof u) == 0;
    if (same && (!memory->is_implicit || memory->has_point)) return true;
    memcpy(memory->slope_u, u, sizeof u);
    cable_derivatives(system->model, x, u, system->work, vectors->slope);
    memory->counter[SOLVER_rhs]++;
    if (memory->has_moved)
        energy_advance(system, memory, t, x);
    else if (!same)
        energy_restart(system, memory, t, x);
    memory->has_moved = false;
    memory->has_slope = true;
    memory->has_point = memory->is_implicit;
    if (memory->is_implicit) linear_point(system->model, x, system->work, vectors->slope, system->linear);
    return true;
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
    memory->counter[SOLVER_step_size] = h;
    memory->counter[SOLVER_error_estimate] = fmax(memory->counter[SOLVER_error_estimate], error * memory->tolerance);
}

/* error may be NaN: then nothing is known but that the step was far too long. */
static void reject(SolverMemory *memory, double h, double error)
{
    const double change = error == error ? change_of_step(error, 1.0) : LEAST_CHANGE;
    memory->step = h * fmin(fmax(change, LEAST_CHANGE), SAFETY);
    memory->counter[SOLVER_rejected]++;
}

bool back_to_guide(const System *system, double t, double *x)
{
    const Model *model = system->model;
    if (!end_is_given(model)) return true;
    double u[INPUT_COUNT] = {0.0};
    if (motion_is_given(model) && !system->inputs(system->source, t, u)) return false;
    pin_project(model, u, system->work, terminal_guide(model, u), x);
    return true;
}

/* The trial point becomes the present one. */
static bool move_on(const System *system, SolverMemory *memory, const Vectors *vectors, double t_new, double *t,
                    double *x)
{
    const size_t bytes = (size_t)model_states(system->model) * sizeof *x;
    memcpy(x, vectors->trial, bytes);
    *t = t_new;
    memory->has_point = false;
    memory->has_slope = !memory->is_implicit; /* the last stage of an explicit step is the next one's first */
    memory->has_moved = memory->is_implicit;
    if (memory->has_slope) {
        memcpy(vectors->slope, vectors->stage[5], bytes);
        memcpy(memory->slope_u, memory->trial_u, sizeof memory->slope_u);
        energy_advance(system, memory, *t, x);
    }
    return back_to_guide(system, t_new, x);
}

static bool attempt(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                    const double *x, double *error)
{
    return memory->is_implicit ? implicit_attempt(system, memory, vectors, t, t_new, x, error)
                               : explicit_attempt(system, memory, vectors, t, t_new, x, error);
}

static bool start(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_end,
                  double least, const double *x)
{
    if (memory->choice != SOLVER_AUTOMATIC) memory->is_implicit = memory->choice == SOLVER_IMPLICIT;
    memory->counter[SOLVER_error_estimate] = 0.0;
    memory->span = t_end - t;
    double before[INPUT_COUNT];
    memcpy(before, memory->slope_u, sizeof before);
    const bool had_slope = memory->has_slope;
    if (!ensure_point(system, memory, vectors, t, x)) return false;
    memory->rested = had_slope && memcmp(before, memory->slope_u, sizeof before) == 0;
    memory->is_inside = memory->is_inside && memory->rested && system->inputs_rest;
    if (memory->step != 0.0) return true;
    if (!first_step(system, memory, vectors, t, t_end - t, least, x)) return false;
    if (memory->choice == SOLVER_AUTOMATIC) choose_at_start(system, memory, vectors, x);
    return true;
}

/* Inside a step that was made already: to t_end, or to that step's end if it comes first. */
static bool go_inside(const System *system, SolverMemory *memory, const Vectors *vectors, double *t, double t_end,
                      double *x)
{
    memory->has_slope = memory->has_point = false;
    memory->has_moved = true;
    if (t_end < memory->dense_to) {
        *t = t_end;
        return dense_state(system, memory, vectors, t_end, x);
    }
    *t = memory->dense_to;
    memcpy(x, vectors->end, (size_t)model_states(system->model) * sizeof *x);
    memory->is_inside = false;
    return true;
}

/* Who wants to know of an accepted step finds the inputs evaluated there, as the next step would find them. */
static SolverStatus tell(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double *t_end,
                         const double *x)
{
    if (!system->accepted) return SOLVER_OK;
    if (!ensure_point(system, memory, vectors, t, x)) return SOLVER_INPUT_FAILED;
    return system->accepted(system->source, t, t_end) ? SOLVER_OK : SOLVER_STOPPED;
}

/*
 * Where the next step ends: as far as it wishes, not beyond t_end unless it may. The last two steps share what remains, so
 * that no sliver is left over, and a step is stretched by as little as the error forgives if that saves one.
 */
static double next_time(const System *system, const SolverMemory *memory, double t, double t_end)
{
    const double remaining = t_end - t, wish = memory->step, stretched = STRETCH * wish;
    if (stretched < remaining) return t + (2.0 * stretched > remaining ? 0.5 * remaining : wish);
    const bool beyond = memory->is_implicit && system->inputs_rest && memory->rested && wish > 1.2 * remaining;
    return beyond ? t + wish : t_end;
}

SolverStatus solver_advance(const System *system, SolverMemory *memory, double *block, double *t, double t_end,
                            double *x)
{
    const Vectors vectors = vectors_in(block, model_states(system->model));
    const double least = RESOLUTION * fmax(fabs(*t), fabs(t_end));
    bool rejected_before = false;
    SolverStatus told = SOLVER_OK;
    if (!start(system, memory, &vectors, *t, t_end, least, x)) return SOLVER_INPUT_FAILED;
    if (memory->is_inside) {
        if (!go_inside(system, memory, &vectors, t, t_end, x)) return SOLVER_INPUT_FAILED;
        told = tell(system, memory, &vectors, *t, &t_end, x);
    }

    for (int tries = 0; *t < t_end && told == SOLVER_OK; tries++) {
        if (tries == SOLVER_MOST_STEPS) return SOLVER_TOO_MANY_STEPS;
        if (!ensure_point(system, memory, &vectors, *t, x)) return SOLVER_INPUT_FAILED;
        const double t_new = next_time(system, memory, *t, t_end), h = t_new - *t;
        if (memory->step < least && t_new < t_end) return SOLVER_STEP_TOO_SMALL;

        double error;
        if (!attempt(system, memory, &vectors, *t, t_new, x, &error)) return SOLVER_INPUT_FAILED;
        const bool accepted = error <= 1.0;
        if (accepted) {
            accept(memory, h, error, rejected_before);
            memory->is_inside = t_new > t_end;
            if (memory->is_inside) dense_remember(system, memory, &vectors, *t, t_new, x);
            if (!move_on(system, memory, &vectors, t_new, t, x)) return SOLVER_INPUT_FAILED;
            if (memory->is_inside && !go_inside(system, memory, &vectors, t, t_end, x)) return SOLVER_INPUT_FAILED;
            if (angle_out_of_range(system->model, x)) return SOLVER_ANGLE_TOO_LARGE;
        } else {
            reject(memory, h, error);
        }
        rejected_before = !accepted;
        if (memory->choice == SOLVER_AUTOMATIC) choose_method(system, memory, &vectors, h, accepted, error, x);
        if (accepted) told = tell(system, memory, &vectors, *t, &t_end, x);
    }
    if (told != SOLVER_OK) return told;
    memory->counter[SOLVER_stiff] = memory->is_implicit;
    /* The inputs may jump behind t_end: what belongs to this side of it is evaluated now, and kept if they do not. */
    return ensure_point(system, memory, &vectors, *t, x) ? SOLVER_OK : SOLVER_INPUT_FAILED;
}
