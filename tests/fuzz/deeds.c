/* What a host does in several calls, so that files need not find their order: and what must hold of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"
#include "host.h"

enum { OPEN_2, OPEN_3, CLOSE, RUN_UP, CONTINUE, AS_NEW, ROLL_BACK, IN_STEP, TO_IMAGE, DAMAGE, STEP };

Image image;

bool real_at(Slot *slot, uint32_t reference, double *value)
{
    if (slot->fmi == 2) return fmi2GetReal(slot->component, &reference, 1, value) == fmi2OK;
    return fmi3GetFloat64(slot->component, &reference, 1, value, 1) == fmi3OK;
}

double now(Slot *slot)
{
    double time = 0.0;
    real_at(slot, 0, &time); /* value reference 0, in both versions */
    return time;
}

int run_up(Slot *slot, double tolerance)
{
    void *c = slot->component;
    if (slot->fmi == 2) {
        if (fmi2SetupExperiment(c, fmi2True, tolerance, 0.0, fmi2False, 0.0) != fmi2OK) return fmi2Error;
        if (fmi2EnterInitializationMode(c) != fmi2OK) return fmi2Error;
        return (int)fmi2ExitInitializationMode(c);
    }
    if (fmi3EnterInitializationMode(c, true, tolerance, 0.0, false, 0.0) != fmi3OK) return fmi3Error;
    return (int)fmi3ExitInitializationMode(c);
}

void shorten(Slot *slot)
{
    enum { FEW_LINKS = 16 };
    void *c = slot->component;
    if (slot->fmi != 3 || fmi3EnterConfigurationMode(c) != fmi3OK) return;
    for (uint32_t reference = 0; reference < slot->scene->variables; reference++) {
        uint64_t links = 0;
        if (fmi3GetUInt64(c, &reference, 1, &links, 1) != fmi3OK || links <= FEW_LINKS) continue;
        links = FEW_LINKS;
        if (fmi3SetUInt64(c, &reference, 1, &links, 1) != fmi3OK) give_up("n cannot be set", slot->scene->location);
    }
    if (fmi3ExitConfigurationMode(c) != fmi3OK) give_up("no end of configuration mode", slot->scene->location);
}

int do_step(Slot *slot, double point, double step)
{
    bool word;
    double time;
    if (slot->fmi == 2) return (int)fmi2DoStep(slot->component, point, step, fmi2True);
    return (int)fmi3DoStep(slot->component, point, step, true, &word, &word, &word, &time);
}

void close_slot(Slot *slot)
{
    for (int k = 0; k < STATES_KEPT && slot->component; k++) {
        if (slot->fmi == 2) fmi2FreeFMUstate(slot->component, &slot->state[k]);
        if (slot->fmi == 3) fmi3FreeFMUState(slot->component, &slot->state[k]);
    }
    if (slot->fmi == 2) fmi2FreeInstance(slot->component);
    if (slot->fmi == 3) fmi3FreeInstance(slot->component);
    memset(slot, 0, sizeof *slot);
}

static void open_slot(Slot *slot, const Record *record, int fmi)
{
    close_slot(slot);
    slot->scene = &scenes[record->value[2] % scene_count];
    slot->fmi = fmi;
    if (fmi == 2)
        open2(slot, record);
    else
        open3(slot, record);
    if (!slot->component) close_slot(slot);
}

/* FNV-1a over the bits of every real variable that can be read, and whether it can. */
static uint64_t hash_of_values(Slot *slot, uint64_t hash)
{
    for (uint32_t reference = 0; reference < slot->scene->variables; reference++) {
        double value = 0.0;
        const bool known = real_at(slot, reference, &value);
        uint8_t bytes[sizeof value];
        memcpy(bytes, &value, sizeof value);
        for (size_t k = 0; k < sizeof value; k++) hash = (hash ^ bytes[k] ^ known) * 0x100000001b3u;
    }
    return hash;
}

static uint64_t journey(Slot *slot)
{
    uint64_t hash = hash_of_values(slot, 0xcbf29ce484222325u);
    if (run_up(slot, 1e-4) != 0) give_up("a new instance cannot be initialized", slot->scene->location);
    for (int k = 0; k < 2 && slot->is_cosimulation; k++)
        if (do_step(slot, 0.125 * k, 0.125) != 0) give_up("a new instance cannot be stepped", slot->scene->location);
    hash = hash_of_values(slot, hash);
    return hash ? hash : 1u;
}

static uint64_t journey_of_a_new_one(const Slot *slot)
{
    uint64_t *known = &slot->scene->journey[slot->fmi - 2][slot->is_cosimulation];
    if (*known) return *known;
    Slot fresh = {.fmi = slot->fmi, .scene = slot->scene};
    const Record plain = {.value = {slot->is_cosimulation, 0, 0}};
    if (slot->fmi == 2)
        open2(&fresh, &plain);
    else
        open3(&fresh, &plain);
    *known = journey(&fresh);
    close_slot(&fresh);
    return *known;
}

static bool reset(Slot *slot)
{
    return (slot->fmi == 2 ? (int)fmi2Reset(slot->component) : (int)fmi3Reset(slot->component)) == 0;
}

/* One that is asked for its inputs goes other ways between communication points. */
static void as_new(Slot *slot)
{
    if (slot->listens) return;
    if (!reset(slot)) give_up("cannot be reset", slot->scene->location);
    if (journey(slot) != journey_of_a_new_one(slot)) give_up("not as new after a reset", slot->scene->location);
    reset(slot);
}

static int state_call(Slot *slot, bool set, void **state)
{
    if (slot->fmi == 2)
        return set ? (int)fmi2SetFMUstate(slot->component, *state) : (int)fmi2GetFMUstate(slot->component, state);
    return set ? (int)fmi3SetFMUState(slot->component, *state) : (int)fmi3GetFMUState(slot->component, state);
}

/* The same step twice from one saved state. */
static void roll_back(Slot *slot)
{
    slot->callbacks = MOST_CALLBACKS;
    const double time = now(slot);
    if (state_call(slot, false, &slot->state[0]) != 0) return;
    uint64_t hash[2];
    int status[2];
    for (int k = 0; k < 2; k++) {
        status[k] = do_step(slot, time, 0.05);
        hash[k] = hash_of_values(slot, 0xcbf29ce484222325u);
        if (state_call(slot, true, &slot->state[0]) != 0)
            give_up("a state of its own was refused", slot->scene->location);
        if (status[0] != 0) return; /* past the stop time, perhaps, which is none of the state */
    }
    if (status[0] != status[1] || hash[0] != hash[1])
        give_up("not the same step from the same state", slot->scene->location);
}

static void to_image(Slot *slot, int which)
{
    size_t size = 0;
    void *c = slot->component, *state = slot->state[which];
    if (slot->fmi == 2 ? fmi2SerializedFMUstateSize(c, state, &size) != fmi2OK
                       : fmi3SerializedFMUStateSize(c, state, &size) != fmi3OK)
        return;
    free(image.bytes);
    image.bytes = malloc(size);
    image.size = size;
    if (slot->fmi == 2 ? fmi2SerializeFMUstate(c, state, (fmi2Byte *)image.bytes, size) != fmi2OK
                       : fmi3SerializeFMUState(c, state, image.bytes, size) != fmi3OK)
        give_up("cannot be serialized", slot->scene->location);
}

void deed(Slot *slot, const Record *record)
{
    if (record->function == OPEN_2 || record->function == OPEN_3) {
        open_slot(slot, record, record->function == OPEN_2 ? 2 : 3);
        return;
    }
    if (!slot->component) return;
    switch (record->function) {
    case CLOSE: close_slot(slot); break;
    case RUN_UP: run_up(slot, 1e-4); break;
    case CONTINUE:
        if (slot->fmi == 2)
            fmi2EnterContinuousTimeMode(slot->component);
        else
            fmi3EnterContinuousTimeMode(slot->component);
        break;
    case AS_NEW: as_new(slot); break;
    case ROLL_BACK: roll_back(slot); break;
    case IN_STEP: slot->in_step = *record, slot->callbacks = 0; break;
    case TO_IMAGE: to_image(slot, record->flags >> 3 & 1); break;
    case DAMAGE:
        if (image.size)
            image.bytes[(size_t)(record->value[0] * 256 + record->value[1]) % image.size] ^= 1u + record->value[2];
        break;
    case STEP: do_step(slot, now(slot), 0.05); break;
    default: break;
    }
}
