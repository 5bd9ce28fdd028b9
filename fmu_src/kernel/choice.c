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
 * lambda being the eigenvalue of the Jacobian of largest modulus and R the stability function of Dormand and Prince's pair.
 * lambda is measured now and then by power iteration with exact directional derivatives: in
 * (q, v) -> (v, a), a = J (q, v), the last three vectors obey a = s v + p q with lambda^2 = s lambda + p.
 *   - explicit, and its steps come near h_s: the implicit method is tried, and kept if its steps become so much longer that
 *     it pays. It may take a while until it has damped what the explicit one kept alive at the limit of its stability. So trials
 *     get longer, and rarer: each costs a tenth of the explicit steps before it, and these double from one to the next;
 *   - implicit, and steps no longer than h_s would cost less: back to the explicit method.
 * While nothing happens and the inputs rest, an explicit step is kept below h_s, or rounding would grow up to the tolerance.
 * The eigenvalue of largest modulus need not be the one that bounds h: one with less damping may. So if errors grow although
 * nothing happens, h_s was too large, and from then on counts for less.
 */
enum { EXPLICIT_WINDOW = 64, IMPLICIT_WINDOW = 16, TRIAL_WINDOW = 2 };
enum { FIRST_INTERVAL = 256, LEAST_TRIAL = 4, STEPS_PER_TRIAL_STEP = 40 };
enum { FIRST_ITERATIONS = 8, ITERATIONS = 3, QUIET_ITERATIONS = 40 };
static const double IMPLICIT_COST = 4.0; /* explicit steps that an implicit one costs [docs/numerics.md] */
static const double GAIN = 1.2;          /* by which the other method must be cheaper */
static const double NEAR = 0.4;          /* of h_s: longer steps are limited by stability */
static const double SAFE = 0.85;         /* of h_s: power iteration comes from below */
static const double GROWN = 64.0;        /* times the lowest error, while quiet: an instability */
static const double ROUNDING = 2e-15;    /* local errors below it say nothing */
static const double QUIET = 1e-3;        /* scaled errors below it say that nothing happens */

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
    while (s < 4.0 && growth(s + step, c) <= 1.0 + 1e-6) s += step;
    return s;
}

static double dot(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int k = 0; k < count; k++) sum += a[k] * b[k];
    return sum;
}

/* h_s from q, v = "q'", a = "q''" along the fastest direction; 0 where nothing can be said. */
static double limit_from(const double *q, const double *v, const double *a, int half)
{
    const double vv = dot(v, v, half), vq = dot(v, q, half), qq = dot(q, q, half), va = dot(v, a, half),
                 qa = dot(q, a, half);
    const double det = vv * qq - vq * vq;
    if (!(det > 1e-24 * vv * qq)) { /* q and v are parallel: lambda is real, and already in their ratio */
        const double rate = sqrt(vv / qq);
        return isfinite(rate) && rate > 0.0 ? reach_of_stability(va < 0.0 ? -1.0 : 0.0) / rate : 0.0;
    }
    const double s = (va * qq - vq * qa) / det, p = (vv * qa - vq * va) / det, root = s * s + 4.0 * p;
    const double modulus = root < 0.0 ? sqrt(-p) : 0.5 * (fabs(s) + sqrt(root));
    const double cosine = root < 0.0 ? 0.5 * s / modulus : (s < 0.0 ? -1.0 : 0.0);
    return modulus > 0.0 && isfinite(modulus) ? reach_of_stability(fmin(cosine, 0.0)) / modulus : 0.0;
}

/* Neighbouring links against each other: near the fastest motion of any chain. */
static void first_direction(double *direction, int half)
{
    for (int k = 0; k < half; k++) direction[k] = 0.0, direction[half + k] = k % 2 ? 1.0 : -1.0;
    direction[half] = 0.0;
}

/* Measures h_s at x, after which the linearised chain is no longer that of an implicit step. */
static void measure(const System *system, SolverMemory *memory, const Vectors *vectors, const double *x, int iterations)
{
    const Model *model = system->model;
    const int half = model->n + 1;
    const double no_inputs[INPUT_COUNT] = {0.0};
    double *const w = vectors->fastest, *const next = vectors->spare, *const slope = vectors->right_side;
    memory->has_point = false;
    memory->counter[SOLVER_rhs]++;
    cable_derivatives(model, x, memory->slope_u, system->work, slope);
    if (!directional_point(model, x, system->work, slope, system->linear)) return;
    if (memory->chosen.limit == 0.0) first_direction(w, half);
    for (int k = -iterations; k < 0; k++) {
        directional_derivatives(model, x, system->linear, w, no_inputs, next, NULL);
        const double size = sqrt(dot(next + half, next + half, half));
        if (!(size > 0.0 && isfinite(size))) return;
        if (k == -1) memory->chosen.limit = memory->chosen.trust * limit_from(w, next, next + half, half);
        for (int i = 0; i < 2 * half; i++) w[i] = next[i] / size;
    }
}

static void begin_window(ChoiceMemory *chosen, int attempts)
{
    chosen->until_look = attempts;
    chosen->advance = 0.0;
    chosen->tried = 0;
    chosen->lowest_error = HUGE_VAL;
}

/* An explicit step while nothing happens. */
static void keep_quiet(SolverMemory *memory, double h, double error)
{
    ChoiceMemory *chosen = &memory->chosen;
    if (h < NEAR * chosen->limit) chosen->lowest_error = HUGE_VAL; /* stable: errors grow with the step */
    chosen->lowest_error = fmin(chosen->lowest_error, fmax(error, ROUNDING / memory->tolerance));
    if (error > GROWN * chosen->lowest_error && chosen->limit > 0.0) {
        chosen->trust *= 0.5;
        chosen->limit = fmin(0.5 * chosen->limit, 0.5 * h);
        chosen->lowest_error = error;
    }
    if (chosen->limit > 0.0) memory->step = fmin(memory->step, SAFE * chosen->limit);
}

static void change_to(SolverMemory *memory, bool implicit)
{
    memory->is_implicit = implicit;
    memory->has_slope = memory->has_slope && !implicit;
    memory->error_before = 1.0;
    if (!implicit) memory->step = fmin(memory->step, SAFE * memory->chosen.limit);
    begin_window(&memory->chosen, implicit ? TRIAL_WINDOW : EXPLICIT_WINDOW);
}

static void after_explicit(const System *system, SolverMemory *memory, const Vectors *vectors, double h, double error,
                           const double *x)
{
    ChoiceMemory *chosen = &memory->chosen;
    if (error < QUIET && system->inputs_rest) keep_quiet(memory, h, error);
    if (chosen->until_look > 0) return;
    const double mean = chosen->advance / chosen->tried;
    chosen->trust = fmin(1.0, 1.1 * chosen->trust);
    measure(system, memory, vectors, x, ITERATIONS);
    begin_window(chosen, EXPLICIT_WINDOW);
    if (!(mean > NEAR * chosen->limit)) return;
    chosen->until_trial -= EXPLICIT_WINDOW;
    if (chosen->until_trial > 0) return;
    const int length = chosen->interval / STEPS_PER_TRIAL_STEP;
    chosen->trial_left = length > LEAST_TRIAL ? length : LEAST_TRIAL;
    change_to(memory, true);
}

static void back_to_explicit(SolverMemory *memory)
{
    ChoiceMemory *chosen = &memory->chosen;
    const bool failed = chosen->trial_left > 0;
    chosen->interval = failed && chosen->interval < SOLVER_MOST_STEPS ? 2 * chosen->interval : FIRST_INTERVAL;
    chosen->until_trial = chosen->interval;
    chosen->trial_left = 0;
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
    chosen->interval = chosen->until_trial = FIRST_INTERVAL;
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
