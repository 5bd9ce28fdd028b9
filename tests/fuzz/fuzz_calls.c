/* libFuzzer's way in: sequences of calls on up to three instances. */
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
    static const char *const OF_STATUS[] = {NULL, "logStatusWarning", "logStatusDiscard", "logStatusError"};
    if (!message || !*message) give_up("a message without words", category);
    if (status < 1 || status > 3 || strcmp(category, OF_STATUS[status]) != 0) give_up("status and category", message);
    slot->messages++;
}

int checked_call(Slot *slot, const Record *record)
{
    const size_t count = slot->fmi == 2 ? FUNCTIONS2_COUNT : FUNCTIONS3_COUNT;
    const size_t which = (size_t)record->function - FIRST_FUNCTION;
    if (record->function < FIRST_FUNCTION || which >= count) return 0;
    const Function *function = slot->fmi == 2 ? &FUNCTIONS2[which] : &FUNCTIONS3[which];
    Arguments a;
    const bool sets = strstr(function->name, "Set");
    make_arguments(&a, slot, record, sets);
    if (record->flags < 128) a.point = now(slot);
    const unsigned long before = slot->messages;
    const int status = function->call(slot->component, &a);
    if (status < 0 || status > 3) give_up("no status of FMI's", function->name);
    if (status == 0) check_written(&a, sets, function->name);
    if (!slot->is_silent && status != 0 && slot->messages == before) give_up("refused without a word", function->name);
    if (status == 0 && slot->messages != before && slot->in_step.function == 0) give_up("OK, but", function->name);
    free_arguments(&a);
    return status;
}

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count, (void)arguments;
    const char *folder = getenv("FUZZ_SCENES");
    if (!folder) give_up("FUZZ_SCENES", "the folder of scenes is expected");
    read_scenes(folder);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Slot slots[SLOTS];
    memset(slots, 0, sizeof slots);
    for (; size >= sizeof(Record); data += sizeof(Record), size -= sizeof(Record)) {
        Record record;
        memcpy(&record, data, sizeof record);
        Slot *slot = &slots[record.slot % SLOTS];
        if (record.function < FIRST_FUNCTION)
            deed(slot, &record);
        else if (slot->component)
            checked_call(slot, &record);
    }
    for (int k = 0; k < SLOTS; k++) close_slot(&slots[k]);
    free(image.bytes);
    image = (Image){NULL, 0};
    return 0;
}
