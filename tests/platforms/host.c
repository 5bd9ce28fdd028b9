/*
 * A small Co-Simulation host of FMI 2 and FMI 3 for any platform. The environment says what it runs: HOST_LIBRARY,
 * HOST_TOKEN, HOST_SCRIPT, HOST_RESULT, so that on Windows no start-up code is needed to take a command line apart. The
 * script, in this machine's byte order: the Header below; uint32 references of inputs, then of outputs; double
 * inputs[steps][inputs]. The result: double outputs[steps + 1][outputs].
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"
#include "fmi3FunctionTypes.h"

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
    int32_t fmi, inputs, outputs, steps, solver, solver_reference; /* fmi: 2 or 3 */
    double step, tolerance;
    char resources[1024]; /* what the FMU is told: a URI or a path, UTF-8, which Windows' environment could not carry */
} Header;

typedef struct {
    const Header *head;
    const uint32_t *input, *output; /* references */
    double *u, *y;
    FILE *script, *result;
} Task;

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

static void message2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                     fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category;
    fail(message);
}

static void message3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment, (void)status, (void)category;
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

static void run2(void *library, Task t)
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
    const Header *head = t.head;
    const fmi2CallbackFunctions callbacks = {message2, NULL, NULL, NULL, NULL};
    fmi2Component c =
        fmi2Instantiate("a", fmi2CoSimulation, getenv("HOST_TOKEN"), head->resources, &callbacks, fmi2False, fmi2False);
    if (!c) fail("no instance");
    const size_t inputs = (size_t)head->inputs, outputs = (size_t)head->outputs;
    const uint32_t solver = (uint32_t)head->solver_reference;
    int bad = fmi2SetInteger(c, &solver, 1, &head->solver) != fmi2OK;
    bad |= fmi2SetupExperiment(c, fmi2True, head->tolerance, 0.0, fmi2False, 0.0) != fmi2OK;
    bad |= fmi2EnterInitializationMode(c) != fmi2OK || fmi2ExitInitializationMode(c) != fmi2OK;
    for (int k = 0; !bad; k++) {
        bad |= fmi2GetReal(c, t.output, outputs, t.y) != fmi2OK;
        fwrite(t.y, sizeof *t.y, outputs, t.result);
        if (k == head->steps) break;
        take(t.u, sizeof *t.u, inputs, t.script);
        bad |= fmi2SetReal(c, t.input, inputs, t.u) != fmi2OK;
        bad |= fmi2DoStep(c, k * head->step, head->step, fmi2True) != fmi2OK;
    }
    if (bad) fail("the FMU refused a call");
    fmi2FreeInstance(c);
}

static void run3(void *library, Task t)
{
    FIND(fmi3InstantiateCoSimulation);
    FIND(fmi3EnterInitializationMode);
    FIND(fmi3ExitInitializationMode);
    FIND(fmi3SetInt64);
    FIND(fmi3SetFloat64);
    FIND(fmi3GetFloat64);
    FIND(fmi3DoStep);
    FIND(fmi3FreeInstance);
    const Header *head = t.head;
    fmi3Instance c = fmi3InstantiateCoSimulation("a", getenv("HOST_TOKEN"), head->resources, false, false, false, false,
                                                 NULL, 0, NULL, message3, NULL);
    if (!c) fail("no instance");
    const size_t inputs = (size_t)head->inputs, outputs = (size_t)head->outputs;
    const uint32_t reference = (uint32_t)head->solver_reference;
    const int64_t solver = head->solver;
    bool event, terminate, early;
    double reached;
    int bad = fmi3SetInt64(c, &reference, 1, &solver, 1) != fmi3OK;
    bad |= fmi3EnterInitializationMode(c, true, head->tolerance, 0.0, false, 0.0) != fmi3OK;
    bad |= fmi3ExitInitializationMode(c) != fmi3OK;
    for (int k = 0; !bad; k++) {
        bad |= fmi3GetFloat64(c, t.output, outputs, t.y, outputs) != fmi3OK;
        fwrite(t.y, sizeof *t.y, outputs, t.result);
        if (k == head->steps) break;
        take(t.u, sizeof *t.u, inputs, t.script);
        bad |= fmi3SetFloat64(c, t.input, inputs, t.u, inputs) != fmi3OK;
        bad |= fmi3DoStep(c, k * head->step, head->step, true, &event, &terminate, &early, &reached) != fmi3OK;
    }
    if (bad) fail("the FMU refused a call");
    fmi3FreeInstance(c);
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
    double *u = room((size_t)head.inputs, sizeof *u), *y = room((size_t)head.outputs, sizeof *y);
    (head.fmi == 3 ? run3 : run2)(library, (Task){&head, input, output, u, y, script, result});
    free(input);
    free(output);
    free(u);
    free(y);
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
