#include "visit.h"

#include <stdlib.h>
#include <string.h>

void open_account(Account *account, FILE *out)
{
    memset(account, 0, sizeof *account);
    account->hash = 14695981039346656037u;
    account->out = out;
}

static void note_bytes(Account *account, const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;
    for (size_t k = 0; k < count; k++) account->hash = (account->hash ^ byte[k]) * 1099511628211u;
}

void note_status(Account *account, int status)
{
    note_bytes(account, &status, sizeof status);
}

void note_values(Account *account, const double *value, size_t count)
{
    note_bytes(account, value, count * sizeof *value);
}

void note_message(Account *account, int status, const char *message)
{
    note_status(account, status);
    note_bytes(account, message, strlen(message));
    if (strlen(message) >= sizeof account->message) give_up("a message is too long", message);
    strcpy(account->message, message);
    account->messages++;
    if (account->out) fprintf(account->out, "%s\n", message);
}

void note_step(Account *account, int k)
{
    if (account->out) fprintf(account->out, "%d %016llx\n", k, (unsigned long long)account->hash);
}

_Noreturn void give_up(const char *what, const char *detail)
{
    fprintf(stderr, "host: %s: %s\n", what, detail);
    exit(1);
}

void must_be_ok(Visit *visit, int status, const char *call)
{
    note_status(&visit->account, status);
    if (status != 0) give_up(call, visit->account.message);
}

void must_be_refused(Visit *visit, int status, const char *call)
{
    note_status(&visit->account, status);
    if (status != 3) give_up("not refused", call);
}

/* Serialized, deserialized into another handle, and put back from there. */
static void go_back(const States *states, Visit *visit)
{
    uint8_t bytes[MOST_IMAGE];
    size_t size;
    void *other = NULL, *c = visit->component;
    must_be_ok(visit, states->size(c, visit->state, &size), "the size of a state");
    if (size > sizeof bytes) give_up("too large an image", "of a small scene");
    must_be_ok(visit, states->write(c, visit->state, bytes, size), "serializing a state");
    must_be_ok(visit, states->read(c, bytes, size, &other), "deserializing a state");
    must_be_ok(visit, states->set(c, other), "setting a state");
    must_be_ok(visit, states->drop(c, &other), "freeing a state");
    if (other) give_up("not NULL", "a state that was freed");
}

void detour(const Api *api, Visit *visit, int k)
{
    const unsigned asked = visit->asked;
    const Account before = visit->account;
    must_be_ok(visit, api->states->get(visit->component, &visit->state), "getting a state");
    visit->account = before, visit->account.out = NULL;
    api->step(visit, k);
    const uint64_t first = visit->account.hash;
    go_back(api->states, visit);
    visit->asked = asked, visit->account = before, visit->account.out = NULL;
    api->step(visit, k);
    if (visit->account.hash != first) give_up("not the bits of before", api->name);
    must_be_ok(visit, api->states->set(visit->component, visit->state), "setting a state");
    visit->asked = asked, visit->account = before;
}

size_t real_variables(const Scene *scene, uint32_t *reference)
{
    size_t count = 0;
    for (uint32_t k = 0; k < scene->variables; k++)
        if (k != scene->solver) reference[count++] = k;
    return count;
}

int choice_for(double mass)
{
    return 1 + (int)mass % 3;
}

double force_at(int k)
{
    return 100.0 * (k * 7 % 11 - 5);
}
