/*
 * A host of the cable's FMUs in C: one visit is one instance from Instantiate to Free, with fifty steps under
 * changing forces and every wrong call there is in between. What the FMU answers goes into an account, so that
 * two visits can be compared to the last bit, wherever and beside whatever else they ran.
 */
#ifndef VISIT_H
#define VISIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "states.h"

enum { STEPS = 50, MOST_VARIABLES = 256, MOST_STATES = 64, MESSAGE_BYTES = 1100, MOST_IMAGE = 16384 };
static const double STEP = 0.0625; /* [s], exact in binary */

typedef struct {
    const char *location, *token; /* of the resources */
    uint32_t variables, states;   /* how many; value references are 0 ... variables - 1 */
    uint32_t force, mass, solver; /* value references of u_m1 and M_1, or F_cx and m_c, and of solver */
} Scene;

typedef struct {
    uint64_t hash; /* FNV-1a over every value, status and message */
    size_t messages;
    char message[MESSAGE_BYTES]; /* the last one */
    FILE *out;                   /* where messages and the hash after every step are printed, or NULL */
} Account;

typedef struct {
    const Scene *scene;
    Account account;
    void *component;
    unsigned asked; /* intermediate updates so far */
    void *state;    /* that was taken last, or NULL */
} Visit;

typedef struct {
    const char *name;
    bool (*open)(Visit *visit);
    void (*mistakes)(Visit *visit); /* legal before initialization; leaves the instance as new */
    void (*start)(Visit *visit, double mass);
    void (*step)(Visit *visit, int k);
    void (*reset)(Visit *visit);
    void (*close)(Visit *visit);
    const States *states;
} Api;

extern const Api FMI2_CS, FMI2_ME, FMI3_CS, FMI3_CS_ASKED, FMI3_ME;

/* Every function of the API with nothing but zeros, for an instance c or for NULL; wrong2.c and wrong3.c. */
void fmi2_every_call(Account *a, void *c);
void fmi3_every_call(Account *a, void *c);
/* Mistakes with a meaning, each of which must be refused. */
void fmi2_every_refusal(Visit *visit);
void fmi3_every_refusal(Visit *visit);

void open_account(Account *account, FILE *out);
void note_status(Account *account, int status);
void note_values(Account *account, const double *value, size_t count);
void note_message(Account *account, int status, const char *message);
void note_step(Account *account, int k);

/* Ends the program, saying what went wrong. */
_Noreturn void give_up(const char *what, const char *detail);
/* Statuses 0 = OK and 3 = Error are the same in both versions of FMI. */
void must_be_ok(Visit *visit, int status, const char *call);
void must_be_refused(Visit *visit, int status, const char *call);

/* Takes the state, makes step k, goes back through bytes, and makes it again: the account must be the same. Nothing of it
 * stays but the visit's state. */
void detour(const Api *api, Visit *visit, int k);

/* References of all real variables, reference[MOST_VARIABLES]; how many. */
size_t real_variables(const Scene *scene, uint32_t *reference);

/* One of the solvers 1, 2, 3 for each mass that a host sets, so that visits beside each other differ in both. */
int choice_for(double mass);

/* A force over time that needs no library: -500 ... 500 N. */
double force_at(int k);

#endif
