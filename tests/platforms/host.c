/*
 * A small FMI 2 Co-Simulation host for any platform. The environment says what it runs: HOST_LIBRARY, HOST_RESOURCES,
 * HOST_TOKEN, HOST_SCRIPT, HOST_RESULT, so that on Windows no start-up code is needed to take a command line apart. The
 * script, in this machine's byte order: int32 inputs, outputs, steps, solver (its value, and its reference); double step,
 * tolerance; uint32 references of inputs, then of outputs; double inputs[steps][inputs]. The result: double
 * outputs[steps + 1][outputs].
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#if defined(_WIN32)
#include <windows.h>
static void *open_library(const char *path)
{
    return (void *)LoadLibraryA(path);
}
static void *find(void *library, const char *name)
{
    return (void *)(uintptr_t)GetProcAddress((HMODULE)library, name);
}
#else
#include <dlfcn.h>
static void *open_library(const char *path)
{
    return dlopen(path, RTLD_NOW | RTLD_LOCAL);
}
static void *find(void *library, const char *name)
{
    return dlsym(library, name);
}
#endif

typedef struct {
    int32_t inputs, outputs, steps, solver, solver_reference, unused;
    double step, tolerance;
} Header;

/* Into the result's place: there is no standard error without start-up code. */
static void fail(const char *what)
{
    const char *path = getenv("HOST_RESULT");
    FILE *file = path ? fopen(path, "wb") : NULL;
    if (file) {
        fwrite(what, 1, strlen(what), file);
        fclose(file);
    }
    exit(1);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category;
    fail(message);
}

static void take(void *to, size_t size, size_t count, FILE *file)
{
    if (count && fread(to, size, count, file) != count) fail("the script is too short");
}

static void *room(size_t count, size_t size)
{
    void *made = calloc(count ? count : 1, size);
    if (!made) fail("out of memory");
    return made;
}

#define FIND(name) name##TYPE *name = (name##TYPE *)(uintptr_t)find(library, #name)

static void run(void *library, const Header *head, const uint32_t *input, const uint32_t *output, FILE *script,
                FILE *result)
{
    FIND(fmi2Instantiate);
    FIND(fmi2SetupExperiment);
    FIND(fmi2EnterInitializationMode);
    FIND(fmi2ExitInitializationMode);
    FIND(fmi2SetInteger);
    FIND(fmi2SetReal);
    FIND(fmi2GetReal);
    FIND(fmi2DoStep);
    FIND(fmi2FreeInstance);
    const fmi2CallbackFunctions callbacks = {log_message, NULL, NULL, NULL, NULL};
    fmi2Component c = fmi2Instantiate("a", fmi2CoSimulation, getenv("HOST_TOKEN"), getenv("HOST_RESOURCES"), &callbacks,
                                      fmi2False, fmi2False);
    if (!c) fail("no instance");
    const size_t inputs = (size_t)head->inputs, outputs = (size_t)head->outputs;
    double *u = room(inputs, sizeof *u), *y = room(outputs, sizeof *y);
    const uint32_t solver = (uint32_t)head->solver_reference;
    int bad = fmi2SetInteger(c, &solver, 1, &head->solver) != fmi2OK;
    bad |= fmi2SetupExperiment(c, fmi2True, head->tolerance, 0.0, fmi2False, 0.0) != fmi2OK;
    bad |= fmi2EnterInitializationMode(c) != fmi2OK || fmi2ExitInitializationMode(c) != fmi2OK;
    for (int k = 0; !bad; k++) {
        bad |= fmi2GetReal(c, output, outputs, y) != fmi2OK;
        fwrite(y, sizeof *y, outputs, result);
        if (k == head->steps) break;
        take(u, sizeof *u, inputs, script);
        bad |= fmi2SetReal(c, input, inputs, u) != fmi2OK;
        bad |= fmi2DoStep(c, k * head->step, head->step, fmi2True) != fmi2OK;
    }
    if (bad) fail("the FMU refused a call");
    fmi2FreeInstance(c);
    free(u);
    free(y);
}

static FILE *open_named(const char *variable, const char *mode)
{
    const char *path = getenv(variable);
    FILE *file = path ? fopen(path, mode) : NULL;
    if (!file) fail("the script or the result cannot be opened");
    return file;
}

static int host(void)
{
    const char *path = getenv("HOST_LIBRARY");
    void *library = path ? open_library(path) : NULL;
    if (!library) fail("the library cannot be opened");
    FILE *script = open_named("HOST_SCRIPT", "rb"), *result = open_named("HOST_RESULT", "wb");
    Header head;
    take(&head, sizeof head, 1, script);
    uint32_t *input = room((size_t)head.inputs, sizeof *input), *output = room((size_t)head.outputs, sizeof *output);
    take(input, sizeof *input, (size_t)head.inputs, script);
    take(output, sizeof *output, (size_t)head.outputs, script);
    run(library, &head, input, output, script, result);
    free(input);
    free(output);
    fclose(script);
    return fclose(result) != 0;
}

#if defined(_WIN32)
void mainCRTStartup(void);
void mainCRTStartup(void)
{
    exit(host());
}
#else
int main(void)
{
    return host();
}
#endif
