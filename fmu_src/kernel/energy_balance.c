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
enum { HISTORY = 4, PLACES = 3 };

/* Power that drag and dampers take [W]; `work` as the right-hand side left it for x. */
static double power_lost(const Model *model, const double *x, const Work *work)
{
    const int n = model->n;
    const double *v = x + n + 1, *rate = v + 1, *p = model->parameter;
    double joints = model->damping[0] * rate[0] * rate[0], water = 0.0;
    for (int i = 1; i < n && model->has_damping; i++) {
        const double bending = rate[i] - rate[i - 1];
        joints += model->damping[i] * bending * bending;
    }
    for (int i = 0; i < n && model->has_drag; i++) {
        const double across = speed_across(model, work, i, rate[i]);
        water += model->drag_factor[i] * fabs(across) * across * across;
    }
    double ends = p[P_c_m1] * v[0] * v[0];
    for (int k = 0; k < 2 && model->has_spring; k++)
        ends += model->damper[k] * work->end_velocity[k] * work->end_velocity[k];
    return joints + water + ends;
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

/* Forces of the inputs where they act: on floater 1 along y, on the terminal along x and y. */
static void forces_of(const double *u, double force[PLACES])
{
    force[0] = u[U_u_m1], force[1] = u[U_F_cx], force[2] = u[U_F_cy] + u[U_u_m2];
}

/* The terminal's is worth a sum over all links only where a force acts on it; else what stood there stays. */
static void places_of(const Model *model, const double *x, const Work *work, bool terminal, double *place,
                      double *speed)
{
    place[0] = x[0], speed[0] = x[model->n + 1];
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

void energy_restart(const System *system, SolverMemory *memory, double t, const double *x)
{
    EnergyMemory *energy = &memory->energy;
    if (!energy->is_kept) return;
    if (!energy->has_start) {
        terminal_motion(system->model, x, system->work, system->work->end_position, system->work->end_velocity);
        energy->start = cable_energy(system->model, x, system->work);
        energy->has_start = true;
    }
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
    forces_of(memory->slope_u, force);
    memcpy(middle, force, sizeof middle);
    if (memcmp(force, energy->force, sizeof force) != 0 && system->inputs(system->source, t - 0.5 * h, u))
        forces_of(u, middle);
    memcpy(place, energy->place, sizeof place);
    memcpy(speed, energy->speed, sizeof speed);
    const bool pulled = pulls_terminal(force) || pulls_terminal(energy->force);
    places_of(system->model, x, system->work, pulled, place, speed);
    if (pulled && energy->place_is_old) /* a force that begins without a jump: it was zero there */
        for (int k = 1; k < PLACES; k++) energy->place[k] = place[k] - h * speed[k], energy->speed[k] = speed[k];
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
