/* What a method of integration is to the loop over steps [solver.c], and what they share. */
#ifndef CABLE_METHOD_H
#define CABLE_METHOD_H

#include "rosenbrock.h"
#include "solver.h"

/* Vectors as long as x in the solver's block. */
enum { METHOD_STAGES = ROSENBROCK_MOST_STAGES };
typedef struct {
    double *slope;                /* f(t, x) of the present point */
    double *trial;                /* the point that is being tried */
    double *stage[METHOD_STAGES]; /* slopes or increments of the stages */
    double *right_side;           /* implicit: f at a stage, and what becomes of it */
    double *force;                /* implicit: two vectors as long as q */
    double *fastest;              /* directions of the largest eigenvalues, two as long as q [choice.c] */
    double *spare;
    double *begin, *end;                 /* of the last step that went beyond t_end [dense.c] */
    double *bend[ROSENBROCK_MOST_DENSE]; /* w_k of its dense output */
} Vectors;

Vectors vectors_in(double *block, int count);

enum { VECTORS = METHOD_STAGES + ROSENBROCK_MOST_DENSE + 8 };

/* One attempt from (t, x) to t_new. The new point goes to vectors->trial, its local error, scaled so that 1 is just
 * accepted, to *error; NaN if anything was not finite. False if there were no inputs. */
bool explicit_attempt(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                      const double *x, double *error);
bool implicit_attempt(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                      const double *x, double *error);

/* solver.c: a held end back where the inputs of time t want it; false if there were no inputs. */
bool back_to_guide(const System *system, double t, double *x);

/* dense.c: remembers an implicit step from (t, x) to the trial point beyond t_end, and gives the state at a
 * time inside it; false if there were no inputs. */
void dense_remember(const System *system, SolverMemory *memory, const Vectors *vectors, double t, double t_new,
                    const double *x);
bool dense_state(const System *system, const SolverMemory *memory, const Vectors *vectors, double t, double *x);

/* slope = f(t, x), counted; the inputs that it took go to u. */
bool slope_at(const System *system, SolverMemory *memory, double t, const double *x, double *slope, double *u);

/* out = x + sum weight_j vector_j over all states; x may be NULL, for 0. */
void combine_states(const System *system, const double *x, int terms, const double *weight, double *const *vector,
                    double *out);

/* The largest |value| / (1 + |x|) over all states, |x| being the larger of two points; NaN if anything is. */
double largest_of_states(const System *system, const double *value, const double *x, const double *y);

/* choice.c: which method begins, memory->step being what the error would allow; and after an attempt of size h, which one
 * goes on. */
void choose_at_start(const System *system, SolverMemory *memory, const Vectors *vectors, const double *x);
void choose_method(const System *system, SolverMemory *memory, const Vectors *vectors, double h, bool accepted,
                   double error, const double *x);

/* energy_balance.c: at a point whose slope was just evaluated; restart where the inputs jump. */
void energy_advance(const System *system, SolverMemory *memory, double t, const double *x);
void energy_restart(const System *system, SolverMemory *memory, double t, const double *x);

#endif
