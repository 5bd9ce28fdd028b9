#include "statics.h"

#include <math.h>
#include <string.h>

#include "dynamics.h"

/*
 * Equilibrium: the forces g(q), the gradient of the potential energy with the work of the inputs taken off, vanish.
 * Newton's step solves with the tangent stiffness wherever that is positive definite. Elsewhere each link's share of it
 * that comes of the pull R, -(l/2) (R_i + R_{i+1}).e, which is negative under compression, is brought closer to the
 * largest that it can become as the link turns, (l/2) |R_i + R_{i+1}|: as the energy of a link under a constant pull
 * lies below the parabola of that curvature, such a step goes downhill, and turns links over that stand on their head.
 * It goes no further that way than it must: long steps lead along what is nearly soft. A step that fails is taken in
 * part, or shortened by a share of the inertia matrix. So the search goes downhill only, and what it finds is stable;
 * from where forces balance but the cable would not stay (upside down, buckled), a small push leads away.
 *
 * An anchor that weighs nothing and is held by its mass alone stays where it is, as the pin does: by a force R through
 * P_n, which is found along with the angles. Far from equilibrium R says little and P_n may be far from its pin, so a
 * spring holds the end at first, and takes as its preload what it carried when the cable had come to rest, which
 * brings the end closer (the method of multipliers); the pin takes over when it is close.
 */
enum { MOST_ITERATIONS = 4000, MOST_PUSHES = 20, MOST_PRELOADS = 30 };
static const double LARGEST_TURN = 1.0;   /* of a link in a step [rad] */
static const double LEAST_PART = 1e-3;    /* of the stretch that makes up for compression */
static const double LEAST_REACH = 0.01;   /* of a step before another one is tried */
static const double FIRST_SHARE = 1.0;    /* of the inertia matrix [1/s^2] */
static const double LARGEST_SHARE = 1e12; /* beyond it, nothing moves */
static const double PUSH = 1e-2;          /* away from what is not stable [rad] */
static const double FLAT = 2e-13;         /* of the energy: rounding */
static const double CONVERGED = 1e-8;     /* steps below it are only followed to their end [rad, m] */
static const double FAR = 1e4;            /* of the cable's length: what goes there is not held */
static const double STIFF = 30.0;         /* spring in place of a pin, over forces per length */
static const double CLOSE = 1e-6;         /* of the cable's length: where the pin takes over */
static const double ON_THE_PIN = 1e-11;   /* of the cable's length */

/* Views into the block, and what the search knows. */
typedef struct {
    const Model *model;
    double u[INPUT_COUNT]; /* of statics_inputs() */
    Work *work;
    Linear *linear;
    double *x, *trial;         /* velocities are zero */
    double *force, *step;      /* as long as q */
    double *force_x, *force_y; /* R through the nodes, n + 1 */
    bool is_held;
    Motion guide;        /* where a held end is, at rest */
    double through[2];   /* R there */
    double energy, size; /* at x: potential [J]; largest force over inertia [1/s^2] */
} Search;

size_t statics_doubles(int n)
{
    return 8u * (size_t)most_coordinates(n);
}

bool statics_holds_end(const Model *model)
{
    return end_is_given(model) || model->terminal == TERMINAL_ANCHOR_MASS;
}

void statics_inputs(const double *u, double *still)
{
    memcpy(still, u, INPUT_COUNT * sizeof *still);
    for (Input k = U_vx_1; k <= U_ay_1; k++) still[k] = 0.0;
    for (Input k = U_vx_2; k <= U_ay_2; k++) still[k] = 0.0;
}

static Search search_in(const Model *model, const double *u, Work *work, Linear *linear, double *block, double *x)
{
    const size_t half = (size_t)most_coordinates(model->n);
    Search search = {.model = model, .work = work, .linear = linear, .x = x};
    statics_inputs(u, search.u);
    search.trial = block;
    double **const rest[] = {&search.force, &search.step, &search.force_x, &search.force_y};
    for (size_t k = 0; k < 4; k++) *rest[k] = block + (2 + k) * half;
    search.is_held = statics_holds_end(model);
    return search;
}

/* Potential energy with the work of the inputs taken off, at a state of rest; leaves sines and P_n in `work`. */
static double potential(const Search *search, const double *x)
{
    const Model *model = search->model;
    Work *work = search->work;
    const double *u = search->u, *end = work->end_position, *top = work->top.position;
    model->variant->orientation(model, x, work);
    top_motion(model, x, u, work);
    terminal_force(model, x, u, work);
    terminal_motion(model, x, work, work->end_position, work->end_velocity);
    const double on_top = u[U_u_m1x] * top[0] + u[U_u_m1] * top[1];
    return cable_energy(model, x, work) - on_top - u[U_F_cx] * end[0] - (u[U_F_cy] + u[U_u_m2]) * end[1];
}

/* R up the cable, and the missing forces g, after potential() of the same x. */
static void forces(Search *search, const double *x)
{
    const Model *model = search->model;
    const Work *work = search->work;
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *p = model->parameter, *u = search->u;
    double rx = search->is_held ? search->through[0] : -work->end_force[0];
    double ry = search->is_held ? search->through[1] : -work->end_force[1];
    double torque_below = 0.0;
    search->force_x[n] = rx, search->force_y[n] = ry;
    for (int i = n - 1; i >= 0; i--) {
        const double nx = work->cosine[i], ny = -work->sine[i], above = i ? x[i] : 0.0;
        const double torque = model->stiffness[i] * (x[i + 1] - above);
        search->force[i + 1] =
            0.5 * length[i] * (nx * (2.0 * rx) + ny * (2.0 * ry - model->weight[i])) + (torque - torque_below);
        ry -= model->weight[i];
        search->force_x[i] = rx, search->force_y[i] = ry;
        torque_below = torque;
    }
    search->force[0] = top_is_given(model) ? 0.0 : ry + p[P_k_m1] * x[0] + p[P_static_load] - u[U_u_m1];
    if (model->top == TOP_FREE) search->force[n + 1] = rx + p[P_k_m1H] * x[n + 1] + p[P_static_pull] - u[U_u_m1x];
}

/* The largest force over the inertia of its coordinate by itself [m/s^2, rad/s^2]. */
static double size_of(const Search *search)
{
    const Model *model = search->model;
    const double mass = model->parameter[P_M_1];
    double largest = top_is_given(model) ? 0.0 : fabs(search->force[0]) / mass;
    if (model->top == TOP_FREE) largest = fmax(largest, fabs(search->force[model->n + 1]) / mass);
    for (int i = 0; i < model->n; i++) largest = fmax(largest, fabs(search->force[i + 1]) * model->per_rotary[i]);
    return largest;
}

static void look(Search *search)
{
    search->energy = potential(search, search->x);
    forces(search, search->x);
    search->size = size_of(search);
    linear_rest(search->model, search->work, search->force_x, search->force_y, search->linear);
    if (search->is_held) linear_pin(search->linear);
}

/* Every link's pull by this part of the way to as large as it can become. */
static void stretch(Search *search, double part)
{
    Linear *linear = search->linear;
    for (int i = 0; i < search->model->n; i++) {
        const double rx = search->force_x[i] + search->force_x[i + 1], ry = search->force_y[i] + search->force_y[i + 1];
        const double pull = rx * linear->sine[i] + ry * linear->cosine[i];
        linear->pull[i] = pull - part * (size_of_pair(rx, ry) + pull);
    }
}

static double length_of(const Model *model)
{
    double length = 0.0;
    for (int i = 0; i < model->n; i++) length += model->link[LINK_LENGTH][i];
    return length;
}

/* How far P_n is from where it is to be [m]. */
static double off_the_pin(const Search *search)
{
    const Model *model = search->model;
    double *position = search->work->end_position;
    const double *place = search->guide.position;
    model->variant->orientation(model, search->x, search->work);
    top_motion(model, search->x, search->u, search->work);
    terminal_motion(model, search->x, search->work, position, search->work->end_velocity);
    return size_of_pair(place[0] - position[0], place[1] - position[1]);
}

/* Where the end is to be: of an anchor of mass, where it is. */
static void find_pin(Search *search)
{
    search->guide = *terminal_guide(search->model, search->u);
    off_the_pin(search);
    if (end_is_given(search->model)) return;
    memcpy(search->guide.position, search->work->end_position, sizeof search->guide.position);
}

/* R through a held end as it would be if the cable were let go here. */
static void guess_through(Search *search)
{
    const Model *model = search->model;
    cable_derivatives(model, search->x, search->u, search->work, search->trial);
    linear_point(model, search->x, search->work, search->trial, search->linear);
    search->through[0] = search->linear->force_x[model->n];
    search->through[1] = search->linear->force_y[model->n];
}

/* The same cable on a spring, about as stiff to the end as the cable is when it hangs with some slack. */
static Model on_a_spring(const Search *search, double length)
{
    Model model = *search->model;
    double force = fabs(model.parameter[P_static_load] - search->u[U_u_m1]), bend = 0.0;
    for (int i = 0; i < model.n; i++) {
        force += fabs(model.weight[i]);
        bend = fmax(bend, model.stiffness[i] / model.n);
    }
    const double spring = STIFF * (force + bend / length) / length;
    model.terminal = TERMINAL_ANCHOR_SPRING;
    model.has_spring = true;
    model.end_is_heavy = false;
    model.end_mass = model.end_weight = 0.0;
    for (int k = 0; k < 2; k++) {
        model.spring[k] = spring > 0.0 ? spring : 1.0;
        model.rest[k] = search->guide.position[k];
        model.preload[k] = -search->through[k];
    }
    return model;
}

/* The step with so much of the inertia matrix added; false where that is not positive definite. */
static bool find_step(Search *search, double share)
{
    const int half = model_coordinates(search->model);
    const double on_the_pin[2] = {0.0, 0.0};
    if (linear_factor(search->model, (Weights){1.0, 0.0, share}, search->linear) != 0) return false;
    for (int k = 0; k < half; k++) search->force[k] = -search->force[k];
    linear_solve(search->model, search->linear, search->force, on_the_pin, search->step);
    for (int k = 0; k < half; k++) search->force[k] = -search->force[k];
    return true;
}

static double largest_turn(const Search *search)
{
    double largest = 0.0;
    for (int i = 0; i < search->model->n; i++) largest = fmax(largest, fabs(search->step[i + 1]));
    return largest;
}

static void trial_point(Search *search, double reach)
{
    const int half = model_coordinates(search->model);
    for (int k = 0; k < half; k++)
        search->trial[k] = search->x[k] + reach * search->step[k], search->trial[half + k] = 0.0;
    if (search->is_held) pin_project(search->model, search->u, search->work, &search->guide, search->trial);
}

/* Change of the energy with the step, to first order [J]. */
static double slope_of(const Search *search)
{
    double slope = 0.0;
    for (int k = 0; k < model_coordinates(search->model); k++) slope += search->force[k] * search->step[k];
    return slope;
}

/*
 * How much of a step to take. Steps that are none of Newton's are cautious, so twice as much for as long as that leads
 * further down: a loop that wanders along a stiff cable would take thousands. Too long a step is halved.
 */
static double find_reach(Search *search, bool newton)
{
    const double most = newton ? 0.0 : 0.5 * LARGEST_TURN / largest_turn(search);
    if (!(slope_of(search) < -FLAT * fabs(search->energy))) return 1.0; /* not to be seen in the energy */
    trial_point(search, 1.0);
    double reach = 1.0, lower = potential(search, search->trial);
    if (!(lower < search->energy)) {
        while (reach > LEAST_REACH && !(lower < search->energy)) {
            reach *= 0.5;
            trial_point(search, reach);
            lower = potential(search, search->trial);
        }
        return lower < search->energy ? reach : 1.0;
    }
    while (reach <= most) {
        trial_point(search, 2.0 * reach);
        const double further = potential(search, search->trial);
        if (!(further < lower)) break;
        lower = further;
        reach *= 2.0;
    }
    return reach;
}

/* Takes the step if it lowers the energy as its slope promises, or, where that is flat to rounding, the forces. */
static bool take_step(Search *search, double reach)
{
    const int half = model_coordinates(search->model);
    const double before = search->size, energy = search->energy, slope = slope_of(search);
    trial_point(search, reach);
    const double lower = potential(search, search->trial), flat = 0.5 * FLAT * (fabs(energy) + fabs(lower));
    if (!isfinite(lower)) return false;
    const double through[2] = {search->through[0], search->through[1]};
    for (int k = 0; k < 2 && search->is_held; k++) search->through[k] += search->linear->through[k];
    forces(search, search->trial);
    const double size = size_of(search);
    if (lower <= energy + 1e-4 * fmin(reach, 1.0) * slope - flat || (lower <= energy + flat && size < before)) {
        memcpy(search->x, search->trial, 2u * (size_t)half * sizeof *search->x);
        return true;
    }
    memcpy(search->through, through, sizeof through);
    return false;
}

/* Where forces balance but the cable would not stay: every link turns a little, each another way. */
static void push(Search *search, int times)
{
    uint64_t state = 0x9e3779b97f4a7c15u * (uint64_t)(times + 1);
    memcpy(search->trial, search->x, (size_t)model_states(search->model) * sizeof *search->x);
    for (int i = 1; i <= search->model->n; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u; /* Knuth's generator */
        search->x[i] += PUSH * ((double)(state >> 11) * 0x1p-52 - 1.0);
    }
    if (search->is_held) pin_project(search->model, search->u, search->work, &search->guide, search->x);
}

static bool is_lost(const Search *search)
{
    if (top_is_given(search->model)) return false;
    const double *top = search->work->top.position;
    return !(fabs(top[0]) + fabs(top[1]) < FAR * length_of(search->model));
}

/* How far a step that is none of Newton's is shortened. */
typedef struct {
    double part;  /* of the stretch */
    double share; /* of the inertia matrix [1/s^2] */
} Caution;

static void more(Caution *caution)
{
    if (caution->part < 1.0) {
        caution->part = fmin(4.0 * caution->part, 1.0);
    } else {
        caution->share = fmax(8.0 * caution->share, FIRST_SHARE);
    }
}

static void less(Caution *caution)
{
    if (caution->share == 0.0) caution->part = fmax(0.25 * caution->part, LEAST_PART);
    caution->share = caution->share > FIRST_SHARE * 1e-6 ? caution->share / 8.0 : 0.0;
}

/* The step from here: Newton's where it may be taken, else one that goes downhill, and not too far. */
static bool choose_step(Search *search, Caution *caution, bool *newton)
{
    *newton = caution->share == 0.0 && find_step(search, 0.0) && largest_turn(search) < LARGEST_TURN;
    if (*newton) return true;
    for (;;) {
        stretch(search, caution->part);
        if (find_step(search, caution->share) && !(largest_turn(search) > LARGEST_TURN)) return true;
        more(caution);
        if (caution->share > LARGEST_SHARE) return false;
    }
}

/* From x downhill until Newton's steps no longer get smaller; how many iterations it took. */
static StaticsStatus descend(Search *search, double *iterations)
{
    Caution caution = {1.0, 0.0};
    double last = HUGE_VAL;
    int pushes = 0;
    for (; *iterations < MOST_ITERATIONS; ++*iterations) {
        bool newton;
        look(search);
        if (!isfinite(search->energy) || !isfinite(search->size)) return STATICS_NOT_FINITE;
        if (is_lost(search) || !choose_step(search, &caution, &newton)) return STATICS_NO_BALANCE;
        const double surged = search->model->top == TOP_FREE ? fabs(search->step[search->model->n + 1]) : 0.0;
        const double turn = fmax(largest_turn(search), fmax(fabs(search->step[0]), surged));
        const bool converged = newton && turn < CONVERGED;
        if (converged && !(turn < 0.5 * last)) return STATICS_OK;
        last = newton ? turn : HUGE_VAL;
        if (take_step(search, find_reach(search, newton))) {
            if (!newton && turn < CONVERGED && caution.share < FIRST_SHARE && pushes++ < MOST_PUSHES)
                push(search, pushes);
            less(&caution);
        } else if (converged) {
            return STATICS_OK; /* as low as rounding lets it come */
        } else if (caution.share < FIRST_SHARE && turn < CONVERGED) {
            if (pushes++ == MOST_PUSHES) return STATICS_NO_BALANCE;
            push(search, pushes);
        } else {
            more(&caution);
        }
    }
    return STATICS_NO_BALANCE;
}

/* With the end on a spring until it is close to where it is to be, then held there. */
static StaticsStatus descend_held(Search *search, double *iterations)
{
    const Model *const held = search->model;
    const double length = length_of(held);
    find_pin(search);
    if (off_the_pin(search) < CLOSE * length) guess_through(search);
    Model sprung = on_a_spring(search, length);
    search->model = &sprung;
    search->is_held = false;
    double off = HUGE_VAL;
    for (int k = 0; k < MOST_PRELOADS && !(off < CLOSE * length); k++) {
        const StaticsStatus status = descend(search, iterations);
        if (status != STATICS_OK) return status;
        potential(search, search->x);
        memcpy(sprung.preload, search->work->end_force, sizeof sprung.preload);
        const double last = off;
        off = off_the_pin(search);
        for (int axis = 0; axis < 2 && off > 0.1 * last; axis++) sprung.spring[axis] *= 10.0; /* a taut cable */
    }
    search->model = held;
    search->is_held = true;
    for (int k = 0; k < 2; k++) search->through[k] = -sprung.preload[k];
    pin_project(held, search->u, search->work, &search->guide, search->x);
    const StaticsStatus status = descend(search, iterations);
    /* A cable that is straight between its ends, with a force across it, gives way without end as its pull grows. */
    return status == STATICS_OK && off_the_pin(search) > ON_THE_PIN * length ? STATICS_NO_BALANCE : status;
}

StaticsStatus statics_solve(const Model *model, const double *u, Work *work, Linear *linear, double *block, double *x,
                            double *figure)
{
    const int half = model_coordinates(model);
    Search search = search_in(model, u, work, linear, block, x);
    memset(x + half, 0, (size_t)half * sizeof *x);
    figure[STATICS_iterations] = 0.0;
    double *iterations = &figure[STATICS_iterations];
    const StaticsStatus status = search.is_held ? descend_held(&search, iterations) : descend(&search, iterations);
    cable_derivatives(model, x, search.u, work, search.trial);
    figure[STATICS_residual] = 0.0;
    for (int k = 0; k < half; k++)
        figure[STATICS_residual] = fmax(figure[STATICS_residual], fabs(search.trial[half + k]));
    return status == STATICS_OK && !isfinite(figure[STATICS_residual]) ? STATICS_NOT_FINITE : status;
}
