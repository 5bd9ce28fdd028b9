#include "resource.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "sha256.h"

enum { HEADER_BYTES = 72 };
static const long MOST_BYTES = 64L * 1024 * 1024; /* 10,000 links with every variable take 1.5 MB */

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

static void percent_decode(char *text)
{
    char *out = text;
    for (const char *in = text; *in; in++) {
        const int high = in[0] == '%' ? hex_digit(in[1]) : -1;
        const int low = high >= 0 ? hex_digit(in[2]) : -1;
        if (low >= 0 && high + low > 0) {
            *out++ = (char)(16 * high + low);
            in += 2;
        } else {
            *out++ = *in;
        }
    }
    *out = '\0';
}

/* "/C:/p" of a URI is "C:/p" to Windows; elsewhere it is as good a name as any. */
static void drop_slash_of_drive(char *path)
{
#if defined(_WIN32)
    if (path[0] == '/' && path[1] && path[2] == ':') memmove(path, path + 1, strlen(path));
#else
    (void)path;
#endif
}

/*
 * The file's path in fresh memory, or NULL without memory. Hosts pass file:/p, file:///p,
 * file://localhost/p (percent-encoded) or, most of all in FMI 3, a bare path, with or without a slash
 * at the end.
 */
static char *resource_path(const char *directory)
{
    const size_t length = strlen(directory);
    char *path = malloc(length + sizeof "/" RESOURCE_NAME);
    if (!path) return NULL;
    const char *start = directory;
    const bool uri = strncmp(directory, "file:", 5) == 0;
    if (uri) {
        start += 5;
        if (strncmp(start, "//", 2) == 0) {
            start += 2;
            start += strcspn(start, "/"); /* the authority: empty or localhost */
        }
    }
    strcpy(path, start);
    if (uri) percent_decode(path);
    drop_slash_of_drive(path);
    const size_t used = strlen(path);
    strcpy(path + used, used && path[used - 1] == '/' ? RESOURCE_NAME : "/" RESOURCE_NAME);
    return path;
}

static bool fail(Text *why, const char *path, const char *what)
{
    text_add(why, "resource file ");
    text_add(why, path);
    text_add(why, ": ");
    text_add(why, what);
    return false;
}

/* NULL, or what went wrong. */
static const char *read_all(FILE *file, Resource *resource)
{
    static const char UNREADABLE[] = "cannot be read";
    if (fseek(file, 0, SEEK_END) != 0) return UNREADABLE;
    const long size = ftell(file);
    if (size < 0 || size > MOST_BYTES || fseek(file, 0, SEEK_SET) != 0) return UNREADABLE;
    resource->bytes = malloc(size ? (size_t)size : 1u);
    if (!resource->bytes) return "out of memory";
    resource->size = fread(resource->bytes, 1, (size_t)size, file);
    return resource->size == (size_t)size ? NULL : UNREADABLE;
}

static uint32_t word_at(const uint8_t *bytes, size_t offset)
{
    uint32_t word;
    memcpy(&word, bytes + offset, sizeof word);
    return word;
}

static const double *take(const double **next, size_t count)
{
    const double *taken = *next;
    *next += count;
    return taken;
}

/* Sets the pointers; false unless counts, sizes and kinds are as this library expects them. */
static bool lay_out_file(Resource *resource)
{
    const uint8_t *bytes = resource->bytes;
    if (resource->size < HEADER_BYTES || memcmp(bytes, "CABLEFMU", 8) != 0) return false;
    resource->n = word_at(bytes, 12);
    resource->terminal = word_at(bytes, 16);
    resource->drag = word_at(bytes, 20);
    memcpy(&resource->present, bytes + 24, sizeof resource->present);
    resource->variables = word_at(bytes, 44);
    resource->solver = word_at(bytes, 48);
    resource->initial = word_at(bytes, 52);
    resource->shape = word_at(bytes, 56);
    resource->top = word_at(bytes, 64);
    const bool listed = resource->shape == SHAPE_LISTED;
    const bool counts = word_at(bytes, 8) == RESOURCE_VERSION && word_at(bytes, 32) == PARAMETER_COUNT &&
                        word_at(bytes, 36) == INPUT_COUNT && word_at(bytes, 40) == OUTPUT_COUNT &&
                        word_at(bytes, 60) == (listed ? 0 : WHOLE_COUNT) && word_at(bytes, 68) == 0;
    if (!counts || resource->n < 1 || resource->n > MOST_LINKS || resource->top >= TOP_COUNT ||
        resource->terminal >= TERMINAL_COUNT || resource->drag >= DRAG_COUNT || resource->present >> PARAMETER_COUNT ||
        resource->solver >= SOLVER_CHOICES || resource->initial >= INITIAL_COUNT || resource->shape >= SHAPE_COUNT)
        return false;
    const size_t n = resource->n, coordinates = n + 1 + (resource->top == TOP_FREE);
    const size_t of_cable = listed ? LINK_COLUMNS * n + 2 * coordinates : WHOLE_COUNT;
    const size_t doubles = PARAMETER_COUNT + INPUT_COUNT + 2 + of_cable;
    if (resource->size != HEADER_BYTES + 8 * doubles + 8 * (size_t)resource->variables) return false;

    const double *next = (const double *)(const void *)(bytes + HEADER_BYTES);
    resource->parameter = take(&next, PARAMETER_COUNT);
    resource->input_start = take(&next, INPUT_COUNT);
    resource->rest = take(&next, 2);
    if (listed) {
        resource->link = take(&next, LINK_COLUMNS * n);
        resource->position = take(&next, coordinates);
        resource->velocity = take(&next, coordinates);
    } else {
        resource->whole = take(&next, WHOLE_COUNT);
    }
    resource->variable = (const Variable *)(const void *)next;
    return true;
}

static bool values_are_sane(const Resource *resource)
{
    const size_t n = resource->n;
    for (const double *value = resource->parameter; value < (const double *)(const void *)resource->variable; value++)
        if (!isfinite(*value)) return false;
    const double *whole = resource->whole;
    if (whole)
        return whole[WHOLE_L] > 0.0 && whole[WHOLE_D] > 0.0 && whole[WHOLE_rho_cable] > 0.0 && whole[WHOLE_EI] >= 0.0;
    for (size_t i = 0; i < n; i++) {
        for (size_t column = 0; column < LINK_COLUMNS; column++) {
            const double value = resource->link[column * n + i];
            if (column <= LINK_INERTIA ? !(value > 0.0) : value < 0.0) return false; /* length, mass, inertia */
        }
    }
    return true;
}

static bool variables_are_sane(const Resource *resource)
{
    const uint32_t coordinates = resource->n + 1u + (resource->top == TOP_FREE);
    const uint32_t states = resource->whole ? ARRAY_COUNT : 2u * coordinates;
    const uint32_t statics = resource->initial == INITIAL_EQUILIBRIUM ? STATICS_COUNT : 0u;
    const uint32_t whole = resource->whole ? WHOLE_COUNT : 0u, links = resource->whole ? 1u : 0u;
    const uint32_t preloads = resource->whole ? PARAMETER_COUNT : 0u;
    const uint32_t limit[VARIABLE_KINDS] = {1u,      PARAMETER_COUNT, INPUT_COUNT,  states,
                                            states,  OUTPUT_COUNT,    SOLVER_COUNT, 1u,
                                            statics, whole,           links,        preloads};
    for (uint32_t k = 0; k < resource->variables; k++) {
        const Variable variable = resource->variable[k];
        if (variable.kind >= VARIABLE_KINDS || variable.index >= limit[variable.kind]) return false;
    }
    return true;
}

static bool read_file(Resource *resource, const char *path, Text *why)
{
    FILE *file = file_open_to_read(path);
    if (!file) return fail(why, path, errno == ENOMEM ? "out of memory" : "cannot be opened");
    const char *trouble = read_all(file, resource);
    fclose(file);
    if (trouble) return fail(why, path, trouble);
    if (!lay_out_file(resource)) return fail(why, path, "is not a cable of this version, or is damaged");
    if (!values_are_sane(resource) || !variables_are_sane(resource)) return fail(why, path, "holds impossible values");
    return true;
}

bool resource_read(Resource *resource, const char *directory, Text *why)
{
    memset(resource, 0, sizeof *resource);
    if (!directory || !*directory) return fail(why, "(none)", "the host gave no resource location");
    char *path = resource_path(directory);
    if (!path) return fail(why, directory, "out of memory");
    const bool good = read_file(resource, path, why);
    free(path);
    if (!good) resource_free(resource);
    return good;
}

void resource_free(Resource *resource)
{
    free(resource->bytes);
    memset(resource, 0, sizeof *resource);
}

void resource_token(const Resource *resource, char token[39])
{
    static const char digit[] = "0123456789abcdef";
    uint8_t digest[32];
    sha256(resource->bytes, resource->size, digest);
    char *out = token;
    *out++ = '{';
    for (int i = 0; i < 16; i++) {
        if (i == 4 || i == 6 || i == 8 || i == 10) *out++ = '-';
        *out++ = digit[digest[i] >> 4];
        *out++ = digit[digest[i] & 15];
    }
    *out++ = '}';
    *out = '\0';
}
