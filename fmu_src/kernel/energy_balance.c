#include "dynamics.h"
#include "method.h"

#include <math.h>
#include <string.h>

/*
 * Where the energy went: E(t) - E(0) = work of the inputs - what drag and dampers took, but for the error of the solution
 * and of two quadratures, both of order 4 like the steps:
 *     work      Simpson's rule on force times velocity, the middle velocity by Hermite's cubic of the place; exact for
 *               a constant force, whatever the place did
 *     loss      the cubic through the power at the last four points
 * A jump of the inputs begins a new history, as the power has a kink there.
 */
enum { HISTORY = 4, PLACES = 4 };

/* Power that goes to those who give the ends their motion [W]: -R_1 on the one, R_{n+1} on the other. */
static double power_to_vessels(const Model *model, const Work *work)
{
    const int n = model->n;
    const double *top = work->top.velocity, *end = work->end_velocity;
    double power = 0.0;
    if (top_is_given(model)) power -= work->answer_x[0] * top[0] + work->answer_y[0] * top[1];
    if (model->terminal == TERMINAL_MOTION) power += work->answer_x[n] * end[0] + work->answer_y[n] * end[1];
    return power;
}

/* Power that drag and dampers take, and vessels [W]; `work` as the right-hand side left it for x. */
static double power_lost(const Model *model, const double *x, const Work *work)
{
    const int n = model->n;
    const double *rate = rates_in(model, x), *p = model->parameter;
    double joints = model->damping[0] * rate[0] * rate[0], water = 0.0;
    for (int i = 1; i < n && model->has_damping; i++) {
        const double bending = rate[i] - rate[i - 1];
        joints += model->damping[i] * bending * bending;
    }
    for (int i = 0; i < n && model->has_drag; i++) {
        const double across = speed_across(model, work, i, rate[i]);
        water += model->drag_factor[i] * fabs(across) * across * across;
    }
    const double *top = work->top.velocity;
    double ends = p[P_c_m1H] * top[0] * top[0] + p[P_c_m1] * top[1] * top[1];
    for (int k = 0; k < 2 && model->has_spring; k++)
        ends += model->damper[k] * work->end_velocity[k] * work->end_velocity[k];
    return joints + water + ends + power_to_vessels(model, work);
}

/* The polynomial through `points` of the history at time t, by Neville's rule. */
static double loss_at(const EnergyMemory *energy, int points, double t)
{
    double value[HISTORY];
    memcpy(value, energy->loss, sizeof value);
    for (int reach = 1; reach < points; reach++)
        for (int k = 0; k + reach < points; k++) {
            const double t_near = energy->time[k], t_far = energy->time[k + reach];
            value[k] = ((t - t_far) * value[k] - (t - t_near) * value[k + 1]) / (t_near - t_far);
        }
    return value[0];
}

/* Between the two newest points: two Gauss points are exact for a cubic. */
static double newest_loss(const EnergyMemory *energy)
{
    const double from = energy->time[1], h = energy->time[0] - from, off = 0.5 * h / sqrt(3.0), middle = from + 0.5 * h;
    return 0.5 * h * (loss_at(energy, energy->points, middle - off) + loss_at(energy, energy->points, middle + off));
}

static void remember_loss(EnergyMemory *energy, double t, double loss)
{
    memmove(energy->time + 1, energy->time, (HISTORY - 1) * sizeof *energy->time);
    memmove(energy->loss + 1, energy->loss, (HISTORY - 1) * sizeof *energy->loss);
    energy->time[0] = t, energy->loss[0] = loss;
    if (energy->points < HISTORY) energy->points++;
}

/* Forces of the inputs where they act: on floater 1 along y, on the terminal along x and y, on floater 1 along x. */
static void forces_of(const double *u, double force[PLACES])
{
    force[0] = u[U_u_m1], force[1] = u[U_F_cx], force[2] = u[U_F_cy] + u[U_u_m2], force[3] = u[U_u_m1x];
}

/* The terminal's is worth a sum over all links only where a force acts on it; else what stood there stays. */
static void places_of(const Model *model, const double *x, const Work *work, bool terminal, double *place,
                      double *speed)
{
    const Motion *top = &work->top;
    place[0] = top->position[1], speed[0] = top->velocity[1];
    place[3] = top->position[0], speed[3] = top->velocity[0];
    if (terminal) terminal_motion(model, x, work, place + 1, speed + 1);
}

static bool pulls_terminal(const double *force)
{
    return force[1] != 0.0 || force[2] != 0.0;
}

static double simpson(double h, const double *force, const double *middle, const double *force_new, const double *place,
                      const double *place_new, const double *speed, const double *speed_new)
{
    double work = 0.0;
    for (int k = 0; k < PLACES; k++) {
        const double between = 1.5 * (place_new[k] - place[k]) / h - 0.25 * (speed[k] + speed_new[k]);
        work += h / 6.0 * (force[k] * speed[k] + 4.0 * middle[k] * between + force_new[k] * speed_new[k]);
    }
    return work;
}

/* Energy at x, `work` being the right-hand side's. */
static double energy_at(const System *system, const double *x)
{
    terminal_motion(system->model, x, system->work, system->work->end_position, system->work->end_velocity);
    return cable_energy(system->model, x, system->work);
}

/* Given motions that jump bring energy of their own. */
static void keep_level(const System *system, EnergyMemory *energy, const double *x, bool jumped)
{
    if (!motion_is_given(system->model)) return;
    const double level = energy_at(system, x);
    if (jumped) energy->work += level - energy->level;
    energy->level = level;
}

void energy_restart(const System *system, SolverMemory *memory, double t, const double *x)
{
    EnergyMemory *energy = &memory->energy;
    if (!energy->is_kept) return;
    if (!energy->has_start) {
        energy->start = energy->level = energy_at(system, x);
        energy->has_start = true;
    }
    keep_level(system, energy, x, true);
    energy->points = 0;
    remember_loss(energy, t, power_lost(system->model, x, system->work));
    forces_of(memory->slope_u, energy->force);
    places_of(system->model, x, system->work, true, energy->place, energy->speed);
    energy->place_is_old = false;
}

void energy_advance(const System *system, SolverMemory *memory, double t, const double *x)
{
    EnergyMemory *energy = &memory->energy;
    if (!energy->is_kept) return;
    double force[PLACES], middle[PLACES], place[PLACES], speed[PLACES], u[INPUT_COUNT];
    const double h = t - energy->time[0];
    remember_loss(energy, t, power_lost(system->model, x, system->work));
    energy->taken += newest_loss(energy);
    keep_level(system, energy, x, false);
    forces_of(memory->slope_u, force);
    memcpy(middle, force, sizeof middle);
    if (memcmp(force, energy->force, sizeof force) != 0 && system->inputs(system->source, t - 0.5 * h, u))
        forces_of(u, middle);
    memcpy(place, energy->place, sizeof place);
    memcpy(speed, energy->speed, sizeof speed);
    const bool pulled = pulls_terminal(force) || pulls_terminal(energy->force);
    places_of(system->model, x, system->work, pulled, place, speed);
    if (pulled && energy->place_is_old) /* a force that begins without a jump: it was zero there */
        for (int k = 1; k <= 2; k++) energy->place[k] = place[k] - h * speed[k], energy->speed[k] = speed[k];
    energy->place_is_old = !pulled;
    energy->work += simpson(h, energy->force, middle, force, energy->place, place, energy->speed, speed);
    memcpy(energy->force, force, sizeof force);
    memcpy(energy->place, place, sizeof place);
    memcpy(energy->speed, speed, sizeof speed);
}

double solver_energy_residual(const SolverMemory *memory, double energy)
{
    const EnergyMemory *kept = &memory->energy;
    return kept->has_start ? energy - kept->start - kept->work + kept->taken : 0.0;
}
