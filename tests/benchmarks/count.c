/*
 * A submerged cable of argv[1] links, its right-hand side argv[2] times: for callgrind, which counts instructions.
 * argv[3] names what the cable has: w water that drags and bears, b water that bears alone, k joint springs, c joint
 * dampers, r a terminal with rotary inertia, u forces on both ends; and what it ends on, s springs, f a second floater,
 * p a pin, otherwise a load. argv[4], if given, counts something else in place of the right-hand side: "adjoint" the
 * right-hand side at a new state, its linearisation and one adjoint derivative, of every derivative and every output;
 * "adjoint of states" the same of derivatives alone; "another adjoint" one more at that state; "directional" and
 * "another directional" likewise.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fmu_src/kernel/adjoint.h"
#include "../../fmu_src/kernel/directional.h"
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
    model->drag = strchr(features, 'w') ? DRAG_COEFFICIENT : DRAG_NONE;
    double *p = model->parameter;
    p[P_g] = 9.81, p[P_M_1] = 6000.0, p[P_k_m1] = 1200.0, p[P_c_m1] = 237.6, p[P_m_c] = 60.0;
    p[P_rho_w] = strpbrk(features, "wb") ? 1000.0 : 0.0;
    p[P_I_Rc] = strchr(features, 'r') ? 50.0 : 0.0;
}

static void fill_end(Model *model, const char *features)
{
    double *p = model->parameter;
    model->terminal = TERMINAL_LOAD;
    model->rest[0] = model->rest[1] = 100.0;
    if (strchr(features, 'p')) model->terminal = TERMINAL_PIN;
    if (strchr(features, 's')) {
        model->terminal = TERMINAL_ANCHOR_SPRING;
        p[P_k_cH] = p[P_k_cV] = 1.2e5, p[P_c_cH] = p[P_c_cV] = 7920.0;
    }
    if (strchr(features, 'f')) {
        model->terminal = TERMINAL_FLOATER;
        p[P_M_2] = 6000.0, p[P_k_m2H] = p[P_k_m2V] = 1200.0, p[P_c_m2H] = p[P_c_m2V] = 237.6;
    }
}

/* `times` times; whether something came of it. */
static bool repeat_derivatives(const char *what, int times, const Model *model, const double *x, const double *u,
                               Work *work, double *derivative)
{
    const size_t states = (size_t)model_states(model);
    const bool anew = !strstr(what, "another"), all = !strstr(what, "of states");
    double outputs[OUTPUT_COUNT], inputs[INPUT_COUNT] = {1.0, 1.0, 1.0, 1.0};
    double *block = calloc(linear_doubles(model->n) + 2 * states, sizeof(double)), *given = block,
           *found = given + states;
    if (!block) return false;
    Linear linear;
    linear_layout(&linear, model->n, found + states);
    for (size_t k = 0; k < states; k++) given[k] = 1.0;
    for (int k = 0; k < OUTPUT_COUNT; k++) outputs[k] = 1.0;
    bool done = directional_point(model, x, work, derivative, &linear);
    for (int k = 0; k < times; k++) {
        if (anew) {
            cable_derivatives(model, x, u, work, derivative);
            done &= directional_point(model, x, work, derivative, &linear);
        }
        if (strstr(what, "adjoint"))
            adjoint_derivatives(model, x, &linear, given, all ? outputs : NULL, found, inputs);
        else
            directional_derivatives(model, x, &linear, given, inputs, found, all ? outputs : NULL);
    }
    done &= found[states - 1] != 0.0;
    free(block);
    return done;
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
    fill_end(&model, text[3]);
    double *x = next, *derivative = next + states;
    double u[INPUT_COUNT] = {0};
    for (int k = 0; k < INPUT_COUNT && strchr(text[3], 'u'); k++) u[k] = 1000.0;
    for (int i = 1; i <= n; i++) x[i] = 0.78 + 0.1 * sin(0.7 * i), x[n + 1 + i] = 0.1 * cos(1.3 * i);
    model_prepare(&model);
    const char *what = count > 4 ? text[4] : NULL;
    for (int k = 0; k < (what ? 1 : times); k++) cable_derivatives(&model, x, u, &work, derivative);
    bool moved = derivative[n + 1] != 0.0;
    if (what) moved &= repeat_derivatives(what, times, &model, x, u, &work, derivative);
    free(block);
    return moved ? 0 : 1;
}
