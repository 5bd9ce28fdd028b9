#include "state.h"

#include <stdlib.h>
#include <string.h>

#include "image.h"

/* In the list of the instance that made it, from which it can take itself without knowing whose it is. */
struct State {
    uint64_t mark;
    State *next, **place; /* whose `next` it is */
    size_t size, room;    /* bytes of the image; bytes that there are for it */
    uint8_t *image;
};

static const uint64_t MARK = 0x5441545345424143u;

static Status refuse_state(Instance *instance, const char *call, const char *why)
{
    Text text;
    text_start(&text);
    text_add(&text, call);
    text_add(&text, ": ");
    text_add(&text, why);
    return instance_fail(instance, &text);
}

static Status refuse_handle(Instance *instance, const char *call)
{
    return refuse_state(instance, call, "this is not a state of the FMU, or was freed");
}

static const State *known(const void *handle)
{
    const State *state = handle;
    return state && state->mark == MARK ? state : NULL;
}

static State *state_new(Instance *instance)
{
    State *state = calloc(1, sizeof *state);
    if (!state) return NULL;
    *state = (State){.mark = MARK, .next = instance->states, .place = &instance->states};
    if (state->next) state->next->place = &state->next;
    instance->states = state;
    return state;
}

static void state_delete(State *state)
{
    *state->place = state->next;
    if (state->next) state->next->place = state->place;
    state->mark = 0;
    free(state->image);
    free(state);
}

void states_free(Instance *instance)
{
    while (instance->states) state_delete(instance->states);
}

/* Room for an image of this size; what was in it is lost. */
static bool make_room(State *state, size_t size)
{
    if (size > state->room) {
        uint8_t *image = malloc(size);
        if (!image) return false;
        free(state->image);
        state->image = image, state->room = size;
    }
    state->size = size;
    return true;
}

/* The state that the host wants to be used again, or a new one, with room; NULL after a message. */
static State *state_for(Instance *instance, void **handle, size_t size, const char *call)
{
    State *state = NULL;
    if (!handle) {
        refuse_state(instance, call, "a null pointer was given");
        return NULL;
    }
    if (*handle && !known(*handle)) {
        refuse_handle(instance, call);
        return NULL;
    }
    state = *handle ? *handle : state_new(instance);
    if (state && make_room(state, size)) return state;
    if (state && !*handle) state_delete(state);
    refuse_state(instance, call, "out of memory");
    return NULL;
}

Status state_get(Instance *instance, void **handle)
{
    State *state = state_for(instance, handle, image_size(instance), "getting the state");
    if (!state) return STATUS_ERROR;
    image_write(instance, state->image);
    *handle = state;
    return STATUS_OK;
}

Status state_set(Instance *instance, const void *handle)
{
    static const char CALL[] = "setting the state";
    const State *state = known(handle);
    if (!state) return refuse_handle(instance, CALL);
    Text why;
    text_start(&why);
    if (!image_fits(instance, state->image, &why)) return refuse_state(instance, CALL, why.line);
    image_read(instance, state->image);
    return STATUS_OK;
}

Status state_free(Instance *instance, void **handle)
{
    if (!handle || !*handle) return STATUS_OK;
    if (!known(*handle)) return refuse_handle(instance, "freeing a state");
    state_delete(*handle);
    *handle = NULL;
    return STATUS_OK;
}

Status state_size(Instance *instance, const void *handle, size_t *size)
{
    static const char CALL[] = "the size of a serialized state";
    const State *state = known(handle);
    if (!state) return refuse_handle(instance, CALL);
    if (!size) return refuse_state(instance, CALL, "a null pointer was given");
    *size = state->size + IMAGE_CHECKSUM;
    return STATUS_OK;
}

Status state_serialize(Instance *instance, const void *handle, uint8_t *bytes, size_t size)
{
    static const char CALL[] = "serializing a state";
    const State *state = known(handle);
    if (!state) return refuse_handle(instance, CALL);
    if (!bytes) return refuse_state(instance, CALL, "a null pointer was given");
    if (size != state->size + IMAGE_CHECKSUM) {
        Text text;
        text_start(&text);
        text_integer(&text, size);
        text_add(&text, " bytes were given; expected are ");
        text_integer(&text, state->size + IMAGE_CHECKSUM);
        return refuse_state(instance, CALL, text.line);
    }
    memcpy(bytes, state->image, state->size);
    image_seal(bytes, state->size);
    return STATUS_OK;
}

Status state_deserialize(Instance *instance, const uint8_t *bytes, size_t size, void **handle)
{
    static const char CALL[] = "deserializing a state";
    if (!bytes) return refuse_state(instance, CALL, "a null pointer was given");
    Text why;
    text_start(&why);
    if (!image_is_sound(instance, bytes, size, &why)) return refuse_state(instance, CALL, why.line);
    State *state = state_for(instance, handle, size - IMAGE_CHECKSUM, CALL);
    if (!state) return STATUS_ERROR;
    memcpy(state->image, bytes, state->size);
    *handle = state;
    return STATUS_OK;
}
