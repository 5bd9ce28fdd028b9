/* libFuzzer's way in: bytes as resources/cable.bin, and if they pass for a cable, all that can be done with it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host.h"

_Noreturn void give_up(const char *what, const char *detail)
{
    fprintf(stderr, "broken: %s: %s\n", what, detail);
    abort();
}

void note_message(Slot *slot, int status, const char *category, const char *message)
{
    if (!message || !*message) give_up("a message without words", category);
    slot->messages += status != 0;
}

int checked_call(Slot *slot, const Record *record)
{
    (void)slot, (void)record;
    return 0;
}

/* A step of a cable whose numbers may be impossible: refused or finite. */
static void travel(Slot *slot)
{
    /* Thousands of links with impossible numbers take long to be given up, and no other branch than a few do. */
    shorten(slot);
    for (int k = 0; k < 2; k++) {
        for (uint32_t reference = 0; reference < slot->scene->variables; reference++) {
            double value = 0.0;
            const unsigned long before = slot->messages;
            const bool known = real_at(slot, reference, &value);
            if (known && !isfinite(value)) give_up("OK, but not a finite number", "of a damaged file");
            if (!known && slot->messages == before) give_up("refused without a word", "of a damaged file");
        }
        if (k == 0 && (run_up(slot, 1e-3) != 0 || (slot->is_cosimulation && do_step(slot, 0.0, 0.01) != 0))) return;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Scene *scene = &scenes[0];
    *scene = (Scene){.location = location_of(0), .bytes = malloc(size + 1), .size = size};
    memcpy(scene->bytes, data, size);
    scene_count = 1;
    const bool is_cable = size > 0 && learn_scene(scene);
    for (int k = 0; k < 4 && (is_cable || k < 2); k++) {
        Slot slot = {.fmi = 2 + k % 2, .scene = scene};
        const Record plain = {.value = {(uint8_t)(k / 2), 0, 0}};
        if (!is_cable) strcpy(scene->token, "{}");
        if (slot.fmi == 2)
            open2(&slot, &plain);
        else
            open3(&slot, &plain);
        /* FMI 2 has no arrays: it may refuse what FMI 3 takes; and Model Exchange motions without accelerations. */
        if (slot.component ? !is_cable : is_cable && slot.fmi == 3 && slot.is_cosimulation)
            give_up("an instance of no cable, or none of one", "");
        if (!slot.component && !slot.messages) give_up("refused without a word", "a file");
        if (slot.component) travel(&slot);
        close_slot(&slot);
    }
    free(scene->bytes);
    return 0;
}
