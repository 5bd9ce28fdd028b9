/*
 * resources/cable.bin: the scene's numbers and its table of variables.
 *
 *   "CABLEFMU"                                        8 bytes
 *   version, n, terminal, drag                        4 x uint32
 *   present                                           uint64, bit P_x: the scene has parameter x
 *   parameters, inputs, outputs, variables            4 x uint32, counts
 *   solver, initial, shape, whole                     4 x uint32
 *   top, 0                                            2 x uint32
 *   parameter[parameters], input_start[inputs], rest[2], then link[8][n], position and velocity, each as long as q, if
 *   the shape is listed, else whole[whole]            doubles
 *   (kind, index)[variables]                          2 x uint32 each, in order of value references
 *
 * All little-endian, nothing behind the end. The token of the FMU (guid, instantiationToken) is made of
 * the file's SHA-256, so a description and a resource file that do not belong together are refused.
 */
#ifndef CABLE_RESOURCE_H
#define CABLE_RESOURCE_H

#include "../kernel/model.h"
#include "../kernel/solver.h"
#include "text.h"

#define RESOURCE_NAME    "cable.bin"
#define RESOURCE_VERSION 4u
#define MOST_LINKS       10000u

typedef enum {
    VARIABLE_TIME,
    VARIABLE_PARAMETER,
    VARIABLE_INPUT,
    VARIABLE_STATE,
    VARIABLE_DERIVATIVE,
    VARIABLE_OUTPUT,
    VARIABLE_SOLVER,
    VARIABLE_SOLVER_CHOICE,
    VARIABLE_STATICS,
    VARIABLE_WHOLE,
    VARIABLE_LINKS,   /* n */
    VARIABLE_PRELOAD, /* a parameter of the model that follows from the rest shape */
    VARIABLE_KINDS
} VariableKind;

/* What a run starts from: the position in the file, or the equilibrium near it. */
typedef enum { INITIAL_SHAPE, INITIAL_EQUILIBRIUM, INITIAL_COUNT } Initial;

/* The start shape: link by link, or of a cable that can be divided into any number of links [structure.h]. */
typedef enum { SHAPE_LISTED, SHAPE_STRAIGHT, SHAPE_CATENARY, SHAPE_COUNT } Shape;

#define WHOLE(name, unit, least, description) WHOLE_##name,
typedef enum {
#include "../kernel/variables.def"
    WHOLE_COUNT
} Whole;

/* Where an array stands in the state vector, for variables of kind STATE and DERIVATIVE in place of an index there. */
typedef enum {
    ARRAY_HEAVE,
    ARRAY_ANGLES,
    ARRAY_HEAVE_RATE,
    ARRAY_RATES,
    ARRAY_SURGE,
    ARRAY_SURGE_RATE,
    ARRAY_COUNT
} Array;

typedef struct {
    uint32_t kind, index;
} Variable;

typedef struct {
    uint8_t *bytes; /* the whole file; everything below points into it */
    size_t size;
    uint32_t n, top, terminal, drag, variables, solver, initial, shape;
    uint64_t present;
    const double *parameter, *input_start, *rest;
    const double *link, *position, *velocity; /* NULL unless the shape is listed */
    const double *whole;                      /* NULL if it is */
    const Variable *variable;
} Resource;

/* Reads DIRECTORY/cable.bin, DIRECTORY being a path or a file: URI. On failure false, and why. */
bool resource_read(Resource *resource, const char *directory, Text *why);
void resource_free(Resource *resource);

/* "{8-4-4-4-12}" of the first 16 bytes of the SHA-256 of the file. */
void resource_token(const Resource *resource, char token[39]);

#endif
