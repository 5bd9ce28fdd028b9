/*
 * From t to t_end: error-controlled integration of x' = f(t, x), its memory kept from call to call.
 *
 * Two methods, explicit [explicit.c] and implicit [rosenbrock.c], and what chooses between them [solver.c]. What a host
 * sees of them are the counters and the reason why they stopped.
 */
#ifndef CABLE_SOLVER_H
#define CABLE_SOLVER_H

#include "model.h"

typedef enum {
    SOLVER_OK,
    SOLVER_TOO_MANY_STEPS,  /* more than SOLVER_MOST_STEPS attempts in one call */
    SOLVER_STEP_TOO_SMALL,  /* the error asks for steps below the resolution of time */
    SOLVER_ANGLE_TOO_LARGE, /* a link has wound up beyond SINCOS_RANGE */
    SOLVER_INPUT_FAILED     /* the source of inputs gave up or gave no finite number */
} SolverStatus;

/* Numbers as in the resource file. */
typedef enum { SOLVER_AUTOMATIC, SOLVER_EXPLICIT, SOLVER_IMPLICIT, SOLVER_CHOICES } SolverChoice;

/* Bounded work instead of a hang: attempts per call. The hardest shipped scene takes a few hundred. */
#define SOLVER_MOST_STEPS 1000000

/* What is integrated. The inputs at time t go to u[INPUT_COUNT]; true on success. */
typedef struct {
    const Model *model;
    Work *work;
    bool (*inputs)(void *source, double time, double *u);
    void *source;
} System;

/* Memory across calls: plain data, so that it can be saved with the state. */
typedef struct {
    SolverChoice choice;
    double tolerance;    /* relative, and absolute in rad, m, rad/s, m/s */
    double step;         /* proposed next step [s]; 0: none yet */
    double error_before; /* scaled error of the last accepted step */
    bool has_slope;      /* slope holds f(t, x) of the present point for the inputs slope_u */
    double slope_u[INPUT_COUNT];
    double counter[SOLVER_COUNT]; /* since the start: whole numbers, as hosts read them */
} SolverMemory;

/* Doubles of the block that both methods share. */
size_t solver_doubles(int n);

/* From *t to t_end by the method of memory->choice; on failure t and x are where it ended. */
SolverStatus solver_advance(const System *system, SolverMemory *memory, double *block, double *t, double t_end,
                            double *x);

/* Forget the step size and the slope: after a reset or when somebody else moved the state. */
void solver_restart(SolverMemory *memory);

/* An embedded explicit Runge-Kutta pair whose last stage is the next step's first. Its tables are data. */
typedef struct {
    const char *name;
    int stages, order;
    const double *a; /* strictly lower triangle by rows, stages (stages - 1) / 2 entries */
    const double *b, *b_embedded, *c;
} Tableau;

extern const Tableau DORMAND_PRINCE_54;

size_t explicit_doubles(int n);
SolverStatus explicit_advance(const System *system, SolverMemory *memory, double *block, double *t, double t_end,
                              double *x);

/* x^(1/5) for normal x > 0 within 2 units in the last place, by Newton's method: the same bits everywhere, unlike
 * pow() of libm. */
double fifth_root(double x);

#endif
