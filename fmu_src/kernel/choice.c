#include <math.h>
#include <string.h>

#include "directional.h"
#include "dynamics.h"
#include "method.h"

/*
 * Explicit or implicit? Both control the same error with methods of the same order, so where accuracy asks for the steps
 * their lengths are alike, and the explicit method is cheaper. Only its stability can make it the dearer one: it must not
 * step beyond
 *     h_s = the largest h with |R(h lambda)| <= 1,   R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 + z^5/120 + z^6/600,
 * for every eigenvalue lambda of the Jacobian, R being the stability function of Dormand and Prince's pair. Two of them are
 * measured now and then, by power iteration with exact directional derivatives: that of the stiffest shape, the largest
 * of M^-1 K, with the damping that M^-1 C gives to it, and the fastest decay, the largest of M^-1 C.
 *   - explicit, and its steps come near h_s: the implicit method is tried, and kept if its steps become so much longer that
 *     it pays. That is tried soon where errors say that accuracy would allow it; else it may take a while until it has
 *     damped what the explicit one kept alive at the limit of its stability. So trials get longer, and rarer: each costs
 *     a tenth of the explicit steps before it, and the waiting doubles from one to the next;
 *   - implicit, and steps no longer than h_s would cost less: back to the explicit method.
 * Explicit steps are kept below h_s: beyond it vibrations would grow up to the tolerance, and an implicit trial would have
 * to follow them. While nothing happens, errors that grow say that h_s was too
 * large after all, and from then on it counts for less.
 */
enum { EXPLICIT_WINDOW = 64, IMPLICIT_WINDOW = 16, TRIAL_WINDOW = 2 };
enum { FIRST_WAIT = 256, CALM_COUNTS = 16, LEAST_TRIAL = 4, STEPS_PER_TRIAL_STEP = 40 };
enum { FIRST_ITERATIONS = 8, ITERATIONS = 2, QUIET_ITERATIONS = 40 };
static const double IMPLICIT_COST = 4.0; /* explicit steps that an implicit one costs [docs/solvers.md] */
static const double GAIN = 1.2;          /* by which the other method must be cheaper */
static const double NEAR = 0.4;          /* of h_s: longer steps are limited by stability */
static const double GROWTH = 3e-3;       /* of |R|^2 that counts as none: it takes hundreds of steps to be seen */
static const double SAFE = 0.97;         /* of h_s: power iteration comes from below */
static const double CALM = 1e-3;         /* four times as long: the implicit method would pay */
static const double QUIET = 1e-3;        /* nothing happens */
static const double GROWN = 64.0;        /* times the lowest error, while quiet: an instability */
static const double ROUNDING = 2e-15;    /* local errors below it say nothing */

/* |R(s e^(i phi))|^2 by Horner's rule in the complex plane, c = cos phi. */
static double growth(double s, double c)
{
    static const double TERM[] = {1.0 / 600, 1.0 / 120, 1.0 / 24, 1.0 / 6, 1.0 / 2, 1.0, 1.0};
    const double zx = s * c, zy = s * sqrt(fmax(1.0 - c * c, 0.0));
    double x = 0.0, y = 0.0;
    for (size_t k = 0; k < sizeof TERM / sizeof *TERM; k++) {
        const double next = zx * x - zy * y + TERM[k];
        y = zx * y + zy * x;
        x = next;
    }
    return x * x + y * y;
}

/* The largest s with |R| <= 1 along the ray of cosine c. */
static double reach_of_stability(double c)
{
    const double step = 1.0 / 32;
    double s = step;
    while (s < 4.0 && growth(s + step, c) <= 1.0 + GROWTH) s += step;
    return s;
}

static double dot(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int k = 0; k < count; k++) sum += a[k] * b[k];
    return sum;
}

/* Neighbouring links against each other: near the fastest motion of any chain. */
static void first_direction(double *direction, int half)
{
    direction[0] = 0.0;
    for (int k = 1; k < half; k++) direction[k] = k % 2 ? 1.0 : -1.0;
}

/* What of the accelerations changes with the positions (of_speed = 0) or velocities (1) in `direction`, each as long as q. */
static const double *response(const System *system, const Vectors *vectors, const double *x, const double *direction,
                              int of_speed)
{
    const double no_inputs[INPUT_COUNT] = {0.0};
    const int half = model_coordinates(system->model);
    double *const dx = vectors->stage[0];
    memset(dx, 0, 2u * (size_t)half * sizeof *dx);
    memcpy(dx + of_speed * half, direction, (size_t)half * sizeof *dx);
    directional_derivatives(system->model, x, system->linear, dx, no_inputs, vectors->spare, NULL);
    return vectors->spare + half;
}

/* Power iteration: the direction, of length 1, becomes that of the largest eigenvalue, whose modulus is returned. */
static double largest(const System *system, const Vectors *vectors, const double *x, double *direction, int of_speed,
                      int iterations)
{
    const int half = model_coordinates(system->model);
    double value = 0.0;
    for (int k = 0; k < iterations; k++) {
        const double *found = response(system, vectors, x, direction, of_speed);
        value = sqrt(dot(found, found, half) / dot(direction, direction, half));
        if (!(value > 0.0 && isfinite(value))) return 0.0;
        for (int i = 0; i < half; i++) direction[i] = found[i] / value;
    }
    return value;
}

static bool is_damped(const Model *model)
{
    return model->has_damping || model->has_drag || model->has_spring || model->parameter[P_c_m1] != 0.0 ||
           model->parameter[P_c_m1H] != 0.0;
}

/* Of lambda^2 + 2 decay lambda + stiffness = 0. */
static double limit_of(double stiffness, double decay)
{
    const double modulus = sqrt(stiffness);
    if (decay < modulus) return reach_of_stability(-fmax(decay, 0.0) / modulus) / modulus;
    return reach_of_stability(-1.0) / (decay + sqrt(decay * decay - stiffness));
}

/* Measures h_s at x, after which the linearised chain is no longer that of an implicit step. */
static void measure(const System *system, SolverMemory *memory, const Vectors *vectors, const double *x, int iterations)
{
    const Model *model = system->model;
    const int half = model_coordinates(model);
    double *const slope = vectors->right_side, *const stiffest = vectors->fastest, *const fastest = stiffest + half;
    memory->has_point = false;
    memory->counter[SOLVER_rhs]++;
    cable_derivatives(model, x, memory->slope_u, system->work, slope);
    if (!directional_point(model, x, system->work, slope, system->linear)) return;
    if (memory->chosen.limit == 0.0) first_direction(stiffest, half), first_direction(fastest, half);
    const double stiffness = largest(system, vectors, x, stiffest, 0, iterations);
    double decay = 0.0, limit = HUGE_VAL;
    if (is_damped(model)) {
        const double *damped = response(system, vectors, x, stiffest, 1);
        decay = -0.5 * dot(damped, stiffest, half) / dot(stiffest, stiffest, half);
        const double rate = largest(system, vectors, x, fastest, 1, iterations);
        if (rate > 0.0) limit = reach_of_stability(-1.0) / rate;
    }
    if (stiffness > 0.0) limit = fmin(limit, limit_of(stiffness, decay));
    if (isfinite(limit)) memory->chosen.limit = memory->chosen.trust * limit;
}

static void begin_window(ChoiceMemory *chosen, int attempts)
{
    chosen->until_look = attempts;
    chosen->advance = 0.0;
    chosen->tried = 0;
    chosen->lowest_error = HUGE_VAL;
}

/* While nothing happens, errors that grow from step to step are an instability. */
static void watch(SolverMemory *memory, double h, double error)
{
    ChoiceMemory *chosen = &memory->chosen;
    if (h < NEAR * chosen->limit) chosen->lowest_error = HUGE_VAL; /* stable: errors grow with the step */
    chosen->lowest_error = fmin(chosen->lowest_error, fmax(error, ROUNDING / memory->tolerance));
    if (!(error > GROWN * chosen->lowest_error)) return;
    chosen->trust *= 0.5;
    chosen->limit = fmin(0.5 * chosen->limit, 0.5 * h);
    chosen->lowest_error = error;
}

static void change_to(SolverMemory *memory, bool implicit)
{
    memory->is_implicit = implicit;
    memory->has_slope = memory->has_slope && !implicit;
    memory->error_before = 1.0;
    if (!implicit) memory->step = fmin(memory->step, SAFE * memory->chosen.limit);
    begin_window(&memory->chosen, implicit ? TRIAL_WINDOW : EXPLICIT_WINDOW);
}

/* Implicit steps end on communication points, unless the inputs rest: too near ones leave them nothing to gain. */
static bool may_pay(const System *system, const SolverMemory *memory)
{
    return (system->inputs_rest && memory->rested) || memory->span > IMPLICIT_COST * SAFE * memory->chosen.limit;
}

static void begin_trial(SolverMemory *memory)
{
    ChoiceMemory *chosen = &memory->chosen;
    const int length = chosen->waited / STEPS_PER_TRIAL_STEP;
    chosen->trial_left = length > LEAST_TRIAL ? length : LEAST_TRIAL;
    change_to(memory, true);
}

static void after_explicit(const System *system, SolverMemory *memory, const Vectors *vectors, double h, double error,
                           const double *x)
{
    ChoiceMemory *chosen = &memory->chosen;
    const bool limited = h > NEAR * chosen->limit;
    if (error < QUIET && system->inputs_rest && chosen->limit > 0.0) watch(memory, h, error);
    if (chosen->limit > 0.0) memory->step = fmin(memory->step, SAFE * chosen->limit);
    if (limited) chosen->waited++, chosen->until_trial -= error < CALM ? CALM_COUNTS : 1;
    if (chosen->until_look > 0 && chosen->until_trial > 0) return;
    chosen->trust = fmin(1.0, 1.1 * chosen->trust);
    measure(system, memory, vectors, x, ITERATIONS);
    begin_window(chosen, EXPLICIT_WINDOW);
    if (chosen->until_trial > 0) return;
    chosen->until_trial = chosen->wait;
    if (h > NEAR * chosen->limit && may_pay(system, memory)) begin_trial(memory);
}

static void back_to_explicit(SolverMemory *memory)
{
    ChoiceMemory *chosen = &memory->chosen;
    const bool failed = chosen->trial_left > 0;
    chosen->wait = failed && chosen->wait < SOLVER_MOST_STEPS ? 2 * chosen->wait : FIRST_WAIT;
    chosen->until_trial = chosen->wait;
    chosen->trial_left = chosen->waited = 0;
    change_to(memory, false);
}

static void after_implicit(const System *system, SolverMemory *memory, const Vectors *vectors, const double *x)
{
    ChoiceMemory *chosen = &memory->chosen;
    if (chosen->until_look > 0) return;
    const double mean = chosen->advance / chosen->tried;
    if (chosen->trial_left > 0) {
        const bool pays = mean > IMPLICIT_COST * SAFE * chosen->limit;
        if (!pays && chosen->trial_left <= TRIAL_WINDOW) {
            back_to_explicit(memory);
            return;
        }
        chosen->trial_left = pays ? 0 : chosen->trial_left - TRIAL_WINDOW;
        begin_window(chosen, pays ? IMPLICIT_WINDOW : TRIAL_WINDOW);
        return;
    }
    measure(system, memory, vectors, x, ITERATIONS);
    begin_window(chosen, IMPLICIT_WINDOW);
    if (IMPLICIT_COST * fmin(mean, SAFE * chosen->limit) > GAIN * mean) back_to_explicit(memory);
}

void choose_at_start(const System *system, SolverMemory *memory, const Vectors *vectors, const double *x)
{
    ChoiceMemory *chosen = &memory->chosen;
    chosen->trust = 1.0;
    measure(system, memory, vectors, x, FIRST_ITERATIONS);
    /* A start from rest: only stability bounds the steps, and must be known well. */
    if (memory->step > chosen->limit) measure(system, memory, vectors, x, QUIET_ITERATIONS);
    chosen->wait = chosen->until_trial = FIRST_WAIT;
    memory->is_implicit = chosen->limit > 0.0 && memory->step > IMPLICIT_COST * GAIN * chosen->limit;
    begin_window(chosen, memory->is_implicit ? IMPLICIT_WINDOW : EXPLICIT_WINDOW);
    if (!memory->is_implicit && chosen->limit > 0.0) memory->step = fmin(memory->step, SAFE * chosen->limit);
}

void choose_method(const System *system, SolverMemory *memory, const Vectors *vectors, double h, bool accepted,
                   double error, const double *x)
{
    ChoiceMemory *chosen = &memory->chosen;
    chosen->until_look--;
    chosen->tried++;
    if (accepted) chosen->advance += h;
    if (memory->is_implicit)
        after_implicit(system, memory, vectors, x);
    else
        after_explicit(system, memory, vectors, h, error, x);
}
