/*
 * host TASK NUMBER LOCALE {LOCATION TOKEN VARIABLES STATES FORCE MASS SOLVER} ...
 *
 *   tour         every scene through every API, with everything printed
 *   interleaved  NUMBER instances, one step of each in turn
 *   threads      NUMBER threads, each through every API
 *   scarce       each request for memory refused in turn
 *   growth       NUMBER times instantiate, reset and free
 *   cycles       NUMBER times save the state, step, restore the state
 *
 * Exits with 0 if every comparison holds, else says what does not. The locale is set before all else.
 */
#include <locale.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "scarce.h"
#include "visit.h"

static const Api *const APIS[] = {&FMI2_CS, &FMI2_ME, &FMI3_CS, &FMI3_CS_ASKED, &FMI3_ME};
enum { API_COUNT = sizeof APIS / sizeof *APIS, MOST_SCENES = 16, MOST_VISITS = 1000, MOST_THREADS = 64 };

static Scene scenes[MOST_SCENES];
static int scene_count;

/* The k-th of all ways to combine API, scene and mass. */
static const Api *api_of(int k)
{
    return APIS[k % API_COUNT];
}

static const Scene *scene_of(int k)
{
    return &scenes[k / API_COUNT % scene_count];
}

static double mass_of(int k)
{
    return 500.0 + k % 7;
}

static void begin(Visit *visit, int k, FILE *out)
{
    memset(visit, 0, sizeof *visit);
    open_account(&visit->account, out);
    visit->scene = scene_of(k);
    if (!api_of(k)->open(visit)) give_up("no instance", visit->account.message);
    api_of(k)->mistakes(visit);
    api_of(k)->start(visit, mass_of(k));
}

static uint64_t alone(int k, FILE *out)
{
    Visit visit;
    begin(&visit, k, out);
    for (int step = 0; step < STEPS; step++) api_of(k)->step(&visit, step);
    api_of(k)->reset(&visit);
    api_of(k)->start(&visit, mass_of(k));
    for (int step = 0; step < STEPS; step++) {
        if (step % 10 == 5) detour(api_of(k), &visit, step);
        api_of(k)->step(&visit, step);
    }
    api_of(k)->close(&visit); /* and with it the state that nobody freed */
    return visit.account.hash;
}

static void tour(void)
{
    for (int k = 0; k < API_COUNT * scene_count; k++) {
        printf("--- %s, scene %d\n", api_of(k)->name, k / API_COUNT);
        alone(k, stdout);
    }
}

static void refused(const char *why, Scene scene)
{
    Visit visit = {.scene = &scene};
    for (int k = 0; k < API_COUNT; k++) {
        open_account(&visit.account, stdout);
        if (APIS[k]->open(&visit)) give_up("instantiated", why);
        if (visit.account.messages != 1) give_up("not one message", why);
    }
}

static void refused_instances(void)
{
    Scene scene = scenes[0];
    scene.token = NULL;
    refused("without a token", scene);
    scene.token = "{00000000-0000-0000-0000-000000000000}";
    refused("with another's token", scene);
    scene.location = NULL;
    refused("without a location", scene);
    scene.location = "/no such folder/100% \xc3\xbc";
    refused("in a folder that does not exist", scene);
    scene.location = "";
    refused("in no folder", scene);
}

static void interleaved(int count)
{
    static Visit visits[MOST_VISITS];
    static uint64_t expected[MOST_VISITS];
    for (int k = 0; k < count; k++) expected[k] = alone(k, NULL);
    for (int k = 0; k < count; k++) begin(&visits[k], k, NULL);
    for (int round = 0; round < 2; round++) {
        for (int step = 0; step < STEPS; step++)
            for (int k = 0; k < count; k++) api_of(k)->step(&visits[k], step);
        for (int k = 0; k < count && round == 0; k++) {
            api_of(k)->reset(&visits[k]);
            api_of(k)->start(&visits[k], mass_of(k));
        }
    }
    for (int k = 0; k < count; k++) {
        api_of(k)->close(&visits[k]);
        if (visits[k].account.hash != expected[k]) give_up("not the bits of an instance alone", api_of(k)->name);
    }
}

static pthread_barrier_t start_line;
static uint64_t expected_of_all[API_COUNT * MOST_SCENES];

/* Each thread begins elsewhere, so that all APIs run at once; thread 0 and the last begin with the same. */
static void *run_all(void *number)
{
    const int first = *(const int *)number, count = API_COUNT * scene_count;
    pthread_barrier_wait(&start_line);
    for (int k = 0; k < count; k++) {
        const int which = (first + k) % count;
        if (alone(which, NULL) != expected_of_all[which])
            give_up("not the bits of a thread alone", api_of(which)->name);
    }
    return NULL;
}

static void threads(int count)
{
    pthread_t thread[MOST_THREADS];
    int first[MOST_THREADS];
    for (int k = 0; k < API_COUNT * scene_count; k++) expected_of_all[k] = alone(k, NULL);
    pthread_barrier_init(&start_line, NULL, (unsigned)count);
    for (int k = 0; k < count; k++) {
        first[k] = k % (count - 1);
        if (pthread_create(&thread[k], NULL, run_all, &first[k]) != 0) give_up("no thread", "pthread_create");
    }
    for (int k = 0; k < count; k++) pthread_join(thread[k], NULL);
    pthread_barrier_destroy(&start_line);
}

/* A state takes two blocks; without them there is a message, and the instance is as before. */
static void scarce_state(const Api *api, Visit *visit)
{
    const long before = scarce_in_use();
    for (long requests = 1;; requests++) {
        open_account(&visit->account, NULL);
        scarce_fail(requests);
        if (api->states->get(visit->component, &visit->state) == 0) break;
        if (visit->account.messages != 1) give_up("not one message for a lack of memory", api->name);
        if (scarce_in_use() != before || visit->state) give_up("memory lost after a refusal", api->name);
        printf("%s: %s\n", api->name, visit->account.message);
    }
    scarce_fail(1); /* used again, put back and freed without any */
    must_be_ok(visit, api->states->get(visit->component, &visit->state), "getting a state again");
    must_be_ok(visit, api->states->set(visit->component, visit->state), "setting a state");
    must_be_ok(visit, api->states->drop(visit->component, &visit->state), "freeing a state");
    scarce_fail(0);
    if (scarce_in_use() != before) give_up("memory lost by a state", api->name);
}

static void scarce(void)
{
    for (int k = 0; k < API_COUNT; k++) {
        Visit visit = {.scene = &scenes[0]};
        long requests = 1;
        for (;; requests++) {
            open_account(&visit.account, NULL);
            scarce_fail(requests);
            if (APIS[k]->open(&visit)) break;
            if (visit.account.messages != 1) give_up("not one message for a lack of memory", APIS[k]->name);
            if (scarce_in_use() != 0) give_up("memory lost after a refusal", APIS[k]->name);
            printf("%s: %s\n", APIS[k]->name, visit.account.message);
        }
        if (requests < 2) give_up("no request for memory was seen", APIS[k]->name);
        scarce_fail(1); /* once instantiated, an FMU needs no more but for states */
        APIS[k]->start(&visit, mass_of(k));
        APIS[k]->step(&visit, 0);
        APIS[k]->reset(&visit);
        scarce_fail(0);
        scarce_state(APIS[k], &visit);
        APIS[k]->close(&visit);
    }
}

/* The allocator's own tables and the program's pages are there after a while; what the kernel says is off by some pages, as
 * it counts them in lots. A lost byte a round would be at least 32 of the heap, 3 MB in the end. */
enum { WARMING_UP = 1000, ALLOWED_PAGES = 64 };

/* Pages of memory that the process holds, from the second number in statm. */
static long resident_pages(void)
{
    long total, resident;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &total, &resident) != 2) give_up("cannot be read", "/proc/self/statm");
    fclose(file);
    return resident;
}

static void growth(int count)
{
    long before = 0;
    Visit visit;
    for (int k = 0; k < WARMING_UP + count; k++) {
        if (k == WARMING_UP) before = resident_pages();
        memset(&visit, 0, sizeof visit);
        visit.scene = &scenes[0];
        open_account(&visit.account, NULL);
        if (!api_of(k)->open(&visit)) give_up("no instance", visit.account.message);
        api_of(k)->start(&visit, mass_of(k));
        api_of(k)->reset(&visit);
        api_of(k)->close(&visit);
    }
    const long after = resident_pages();
    printf("%ld pages before, %ld after\n", before, after);
    if (after > before + ALLOWED_PAGES) give_up("memory has grown", "see the pages");
}

/* One instance per API, saved again and again into the state that it has; now and then through bytes. */
static void cycles(int count)
{
    enum { STEP_OF_CYCLE = 7, THROUGH_BYTES = 101 };
    static Visit visits[API_COUNT];
    uint64_t expected[API_COUNT];
    long before = 0;
    for (int k = 0; k < API_COUNT; k++) {
        begin(&visits[k], k, NULL);
        for (int step = 0; step < STEP_OF_CYCLE; step++) APIS[k]->step(&visits[k], step);
    }
    for (int k = 0; k < WARMING_UP + count; k++) {
        if (k == WARMING_UP) before = resident_pages();
        const Api *api = APIS[k % API_COUNT];
        Visit *visit = &visits[k % API_COUNT];
        open_account(&visit->account, NULL);
        if (k % THROUGH_BYTES == 0) detour(api, visit, STEP_OF_CYCLE);
        open_account(&visit->account, NULL);
        must_be_ok(visit, api->states->get(visit->component, &visit->state), "getting a state");
        api->step(visit, STEP_OF_CYCLE);
        must_be_ok(visit, api->states->set(visit->component, visit->state), "setting a state");
        if (k < API_COUNT) expected[k] = visit->account.hash;
        if (visit->account.hash != expected[k % API_COUNT]) give_up("not the bits of the first cycle", api->name);
    }
    const long after = resident_pages();
    printf("%ld pages before, %ld after\n", before, after);
    for (int k = 0; k < API_COUNT; k++) APIS[k]->close(&visits[k]);
    if (after > before + ALLOWED_PAGES) give_up("memory has grown", "see the pages");
}

static void read_scenes(int count, char **argument)
{
    enum { EACH = 7, NUMBERS = EACH - 2 };
    scene_count = count / EACH;
    if (count % EACH || scene_count < 1 || scene_count > MOST_SCENES) give_up("seven words for each scene", "usage");
    for (int k = 0; k < scene_count; k++, argument += EACH) {
        uint32_t number[NUMBERS];
        for (int i = 0; i < NUMBERS; i++) number[i] = (uint32_t)strtoul(argument[2 + i], NULL, 10);
        scenes[k] = (Scene){argument[0], argument[1], number[0], number[1], number[2], number[3], number[4]};
        if (number[0] > MOST_VARIABLES || number[1] > MOST_STATES) give_up("too large a scene", argument[0]);
    }
}

/* A locale that was asked for must be there and, as all that are used here, write a comma. */
static void use_locale(const char *name)
{
    char half[8];
    if (!setlocale(LC_ALL, name)) give_up("no such locale", name);
    snprintf(half, sizeof half, "%.1f", 0.5);
    if (strcmp(name, "C") != 0 && strcmp(half, "0,5") != 0) give_up("the locale writes no comma", name);
}

int main(int count, char **argument)
{
    if (count < 5) give_up("host TASK NUMBER LOCALE SCENES", "usage");
    const char *task = argument[1];
    const int number = atoi(argument[2]);
    use_locale(argument[3]);
    read_scenes(count - 4, argument + 4);
    if (strcmp(task, "tour") == 0)
        tour(), refused_instances();
    else if (strcmp(task, "interleaved") == 0 && number <= MOST_VISITS)
        interleaved(number);
    else if (strcmp(task, "threads") == 0 && number > 1 && number <= MOST_THREADS)
        threads(number);
    else if (strcmp(task, "scarce") == 0)
        scarce();
    else if (strcmp(task, "growth") == 0)
        growth(number);
    else if (strcmp(task, "cycles") == 0)
        cycles(number);
    else
        give_up("no such task", task);
    if (scarce_in_use() != 0) give_up("memory was not given back", task);
    return 0;
}
