/* The scenes of the instances, read once; later the FMU opens them in memory. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fmi/resource.h"
#include "host.h"

enum { MOST_SCENES = 32 };
Scene scenes[MOST_SCENES];
size_t scene_count;

/* Not by fopen(), which is the FMU's below. */
static uint8_t *read_file(const char *path, size_t *size)
{
    enum { MOST = 1 << 20 };
    const int file = open(path, O_RDONLY);
    if (file < 0) return NULL;
    uint8_t *bytes = malloc(MOST);
    const ssize_t got = read(file, bytes, MOST);
    close(file);
    *size = got > 0 ? (size_t)got : 0;
    return bytes;
}

/* In place of fopen(), by -Dfopen=fuzz_fopen: "/scene/3/cable.bin" is the fourth scene, nothing else exists. */
FILE *fopen(const char *path, const char *mode)
{
    if (strncmp(path, "/scene/", 7) != 0) return NULL;
    const size_t which = (size_t)strtoul(path + 7, NULL, 10);
    return which < scene_count ? fmemopen(scenes[which].bytes, scenes[which].size, mode) : NULL;
}

/* Its facts, by the FMU's own reader. */
bool learn_scene(Scene *scene)
{
    Resource resource;
    Text why;
    text_start(&why);
    if (!resource_read(&resource, scene->location, &why)) return false;
    resource_token(&resource, scene->token);
    scene->variables = resource.variables;
    scene->states = 2u * (resource.n + 1u);
    resource_free(&resource);
    return true;
}

const char *location_of(size_t which)
{
    static char locations[MOST_SCENES][40];
    snprintf(locations[which], sizeof locations[which], which % 2 ? "file:///%%73cene/%zu/" : "/scene/%zu", which);
    return locations[which];
}

void read_scenes(const char *folder)
{
    for (;; scene_count++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%zu.bin", folder, scene_count);
        Scene *scene = &scenes[scene_count];
        scene->bytes = scene_count < MOST_SCENES ? read_file(path, &scene->size) : NULL;
        if (!scene->bytes) break;
        scene->location = location_of(scene_count++);
        if (!learn_scene(scene)) give_up("a scene cannot be read", path);
        scene_count--;
    }
    if (!scene_count) give_up("no scenes in", folder);
}
