/*
 * A submerged cable of argv[1] links, its right-hand side argv[2] times: for callgrind, which counts instructions.
 * argv[3] names what the cable has: w water, k joint springs, c joint dampers.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fmu_src/kernel/dynamics.h"

static void fill(Model *model, double *column, const char *features)
{
    const int n = model->n;
    const double length = 240.0 / n, mass = 2.466 * length;
    const double value[LINK_COLUMNS] = {[LINK_LENGTH] = length,
                                        [LINK_MASS] = mass,
                                        [LINK_INERTIA] = mass * length * length / 12.0,
                                        [LINK_VOLUME] = mass / 7850.0,
                                        [LINK_JOINT_STIFFNESS] = strchr(features, 'k') ? 524.0 / length : 0.0,
                                        [LINK_JOINT_DAMPING] = strchr(features, 'c') ? 2.8 : 0.0,
                                        [LINK_DRAG_AREA] = 0.02 * length,
                                        [LINK_DRAG] = 1.0};
    for (int k = 0; k < LINK_COLUMNS; k++) {
        model->link[k] = column + (size_t)k * (size_t)n;
        for (int i = 0; i < n; i++) column[k * n + i] = value[k];
    }
    const bool water = strchr(features, 'w') != NULL;
    model->drag = water ? DRAG_COEFFICIENT : DRAG_NONE;
    model->terminal = TERMINAL_LOAD;
    double *p = model->parameter;
    p[P_g] = 9.81, p[P_M_1] = 6000.0, p[P_k_m1] = 1200.0, p[P_c_m1] = 237.6, p[P_m_c] = 60.0;
    p[P_rho_w] = water ? 1000.0 : 0.0;
}

int main(int count, char **text)
{
    if (count < 4) return 2;
    const int n = atoi(text[1]), times = atoi(text[2]);
    const size_t states = 2u * ((size_t)n + 1u);
    Model model = {.n = n};
    Work work;
    double *block = calloc(model_doubles(n) + work_doubles(n) + LINK_COLUMNS * (size_t)n + 2 * states, sizeof(double));
    if (!block) return 1;
    double *next = block;
    model_layout(&model, next), next += model_doubles(n);
    work_layout(&work, n, next), next += work_doubles(n);
    fill(&model, next, text[3]), next += LINK_COLUMNS * (size_t)n;
    double *x = next, *derivative = next + states;
    const double u[INPUT_COUNT] = {0};
    for (int i = 1; i <= n; i++) x[i] = 0.78 + 0.1 * sin(0.7 * i), x[n + 1 + i] = 0.1 * cos(1.3 * i);
    model_prepare(&model);
    for (int k = 0; k < times; k++) cable_derivatives(&model, x, u, &work, derivative);
    const bool moved = derivative[n + 1] != 0.0;
    free(block);
    return moved ? 0 : 1;
}
