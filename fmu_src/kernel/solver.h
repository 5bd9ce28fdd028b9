/*
 * From t to t_end: error-controlled integration of x' = f(t, x), its memory kept from call to call.
 *
 * Two methods, explicit [explicit.c] and implicit [implicit.c]; steps, their size and rejection are the same for both
 * [solver.c], and so is what chooses between them [choice.c]. What a host sees of them are the counters, and the reason
 * why they stopped.
 */
#ifndef CABLE_SOLVER_H
#define CABLE_SOLVER_H

#include "linear.h"

typedef enum {
    SOLVER_OK,
    SOLVER_TOO_MANY_STEPS,  /* more than SOLVER_MOST_STEPS attempts in one call */
    SOLVER_STEP_TOO_SMALL,  /* the error asks for steps below the resolution of time */
    SOLVER_ANGLE_TOO_LARGE, /* a link has wound up beyond SINCOS_RANGE */
    SOLVER_INPUT_FAILED,    /* the source of inputs gave up or gave no finite number */
    SOLVER_STOPPED          /* who was told of an accepted step gave up */
} SolverStatus;

/* Numbers as in the resource file. */
typedef enum { SOLVER_AUTOMATIC, SOLVER_EXPLICIT, SOLVER_IMPLICIT, SOLVER_CHOICES } SolverChoice;

/* Bounded work instead of a hang: attempts per call. The hardest shipped scene takes a few hundred. */
#ifndef SOLVER_MOST_STEPS
#define SOLVER_MOST_STEPS 1000000
#endif

/* What is integrated. The inputs at time t go to u[INPUT_COUNT]; true on success. */
typedef struct {
    const Model *model;
    Work *work;
    Linear *linear;
    bool (*inputs)(void *source, double time, double *u);
    void *source;
    bool inputs_rest; /* they are the same at all times of this call, and known to be so beyond its end */
    /* Told of every accepted step, with t and x there; may lower t_end to no less than `time`; true to go on. Or NULL. */
    bool (*accepted)(void *source, double time, double *t_end);
} System;

/* What the automatic choice remembers [choice.c]. */
typedef struct {
    double limit;        /* largest stable step of the explicit method, as last measured [s]; 0: not known */
    double trust;        /* share of it that has proved stable */
    double lowest_error; /* since the last look, while nothing happens */
    int until_look;      /* attempts until the next look */
    double advance;      /* of the attempts since the last look [s] */
    int tried;           /* and their number */
    int wait;            /* explicit attempts near the limit until a trial of the implicit method, errors above CALM */
    int until_trial;     /* of them to go */
    int waited;          /* attempts near the limit since the last trial */
    int trial_left;      /* attempts that the present trial may still take; 0: there is none */
} ChoiceMemory;

/* Energy that came and went since the start [energy_balance.c]. */
typedef struct {
    bool is_kept; /* whether anybody wants to know */
    bool has_start;
    double start;                        /* energy at the start [J] */
    double work;                         /* of the inputs [J] */
    double taken;                        /* by drag and dampers [J] */
    int points;                          /* of the history that follows, newest first */
    double time[4], loss[4];             /* power taken at these times [s], [W] */
    bool place_is_old;                   /* the terminal's, where no force acts on it */
    double place[4], speed[4], force[4]; /* of floater 1 and the terminal, and the forces there, at the newest */
    double level;                        /* energy at the newest, where a motion is given [J] */
} EnergyMemory;

/* Memory across calls: plain data, so that it can be saved with the state. */
typedef struct {
    SolverChoice choice;
    bool is_implicit;    /* the method in use */
    double tolerance;    /* relative, and absolute in rad, m, rad/s, m/s */
    double step;         /* proposed next step [s]; 0: none yet */
    double span;         /* of the present call [s] */
    double error_before; /* scaled error of the last accepted step */
    bool has_slope;      /* the block holds f(t, x) of the present point for the inputs slope_u */
    bool has_moved;      /* the present point was reached by a step, and nothing was evaluated there yet */
    bool has_point;      /* the linearised chain is that of the present point */
    double slope_u[INPUT_COUNT], trial_u[INPUT_COUNT]; /* the latter of an explicit step's end */
    bool is_inside;               /* the present point is inside a step that was made already [dense.c] */
    bool rested;                  /* the inputs did not change from the last call to this one */
    double dense_from, dense_to;  /* that step [s] */
    double counter[SOLVER_COUNT]; /* since the start, as hosts read them */
    ChoiceMemory chosen;
    EnergyMemory energy;
} SolverMemory;

/* Doubles of the block that both methods share. */
size_t solver_doubles(int n);

/* From *t to t_end by the method of memory->choice; on failure t and x are where it ended. */
SolverStatus solver_advance(const System *system, SolverMemory *memory, double *block, double *t, double t_end,
                            double *x);

/* Forget the step size and the slope: before a run. Whoever moves a state moves all of its memory with it. */
void solver_restart(SolverMemory *memory);

/* Energy now [J], less that at the start, less the work of the inputs, plus what drag and dampers took. */
double solver_energy_residual(const SolverMemory *memory, double energy);

/* x^(1/5) for normal x > 0 within 2 units in the last place, by Newton's method: the same bits everywhere, unlike
 * pow() of libm. */
double fifth_root(double x);

#endif
