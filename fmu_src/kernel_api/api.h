/* The kernel for Python, see api.c; the structure is for the tests' probe, which adds to it [tests/kernel/probe.c]. */
#ifndef CABLE_API_H
#define CABLE_API_H

#include "../kernel/catenary.h"
#include "../kernel/dynamics.h"
#include "../kernel/effective_mass.h"
#include "../kernel/statics.h"

#if defined(_WIN32)
#define VISIBLE __declspec(dllexport)
#else
#define VISIBLE __attribute__((visibility("default")))
#endif

/* One cable; the derived constants, scratch and factors share one block. */
typedef struct {
    Model model;
    Work work;
    Linear linear;
    double *block, *statics_block;
    double *x, *derivative; /* the state of rest */
} Kernel;

VISIBLE Kernel *kernel_new(int n, int top, int terminal, int drag, uint64_t present, const double *parameter,
                           const double *rest, const double *link);
VISIBLE void kernel_free(Kernel *kernel);
VISIBLE int kernel_derivatives(Kernel *kernel, const double *x, const double *u, double *derivative);
VISIBLE int kernel_outputs(Kernel *kernel, const double *x, const double *u, double *output);
VISIBLE int kernel_pulls(Kernel *kernel, const double *x, const double *u, double *pull);
VISIBLE int kernel_equilibrium(Kernel *kernel, const double *u, double *q, double *figure);
VISIBLE int kernel_rest(Kernel *kernel, const double *u, const double *q, double *force, double *acceleration);
VISIBLE int kernel_factor(Kernel *kernel, double stiffness, double mass);
VISIBLE void kernel_solve(Kernel *kernel, const double *force, double *change, double *through);
VISIBLE void kernel_product(Kernel *kernel, double stiffness, double mass, const double *change, double *force);
VISIBLE int kernel_catenary(int n, const double *length, const double *weight, const double *end, double *angle,
                            double *pull);

#endif
