#include "image.h"

#include <math.h>
#include <string.h>

#include "../kernel/method.h"
#include "sha256.h"
#include "version.h"

enum { FORMAT = 2, MOST_COUNT = 1000000000 };
static const char MAGIC[8] = {'C', 'A', 'B', 'L', 'E', 'S', 'T', 'A'};

typedef struct {
    char magic[8];
    uint32_t format, layout;
    char version[16], token[40];
    uint32_t n, interface;
    uint64_t size;
} Header;

/* Those below are passed member by member: whoever adds one must pass it as well. */
_Static_assert(sizeof(Header) == 88, "a header has no padding");
_Static_assert(sizeof(ChoiceMemory) == 64, "a member of ChoiceMemory came or went");
_Static_assert(sizeof(EnergyMemory) == 216, "a member of EnergyMemory came or went");
_Static_assert(sizeof(SolverMemory) == 448 + 32 + 2 * 13 * 8, "a member of SolverMemory came or went");

/* One list of members serves four ends: what passes is counted, goes out, is looked at or comes in. */
typedef enum { COUNTING, WRITING, CHECKING, READING } Way;

typedef struct {
    Way way;
    uint8_t *out;
    const uint8_t *in;
    size_t used, size; /* bytes so far; bytes that there are when they come from outside */
    bool is_good;
} Stream;

static void pass(Stream *stream, void *value, size_t bytes)
{
    if (stream->way == CHECKING && bytes > stream->size - stream->used) {
        stream->is_good = false;
        return;
    }
    if (stream->way == WRITING) memcpy(stream->out + stream->used, value, bytes);
    if (stream->way == READING) memcpy(value, stream->in + stream->used, bytes);
    stream->used += bytes;
}

static void pass_doubles(Stream *stream, double *value, size_t count)
{
    pass(stream, value, count * sizeof *value);
}

/* Returns the number that passes, which *value becomes only when it comes in. */
static int pass_int(Stream *stream, int *value, int least, int most)
{
    int32_t passing = *value;
    if (stream->way == CHECKING && sizeof passing <= stream->size - stream->used)
        memcpy(&passing, stream->in + stream->used, sizeof passing);
    pass(stream, &passing, sizeof passing);
    if (passing < least || passing > most) stream->is_good = false;
    if (stream->way == READING) *value = passing;
    return passing;
}

static bool pass_flag(Stream *stream, bool *value)
{
    int passing = *value;
    const bool passed = pass_int(stream, &passing, 0, 1) != 0;
    *value = passing != 0;
    return passed;
}

static void pass_mode(Stream *stream, Instance *instance)
{
    const bool steps = instance->interface == CO_SIMULATION;
    const int never = MODE_ASKED | MODE_ACCEPTED | (steps ? MODE_EVENT | MODE_CONTINUOUS : MODE_STEP);
    int mode = (int)instance->mode;
    const int passed = pass_int(stream, &mode, MODE_INSTANTIATED, MODE_ACCEPTED);
    if (passed < MODE_INSTANTIATED || (passed & (passed - 1)) != 0 || passed & never) stream->is_good = false;
    instance->mode = (Mode)mode;
}

static void pass_experiment(Stream *stream, Instance *instance)
{
    pass_mode(stream, instance);
    pass_flag(stream, &instance->start_is_current);
    pass_doubles(stream, &instance->time, 1);
    pass_doubles(stream, instance->model.parameter, PARAMETER_COUNT);
    if (instance->link) pass_doubles(stream, instance->whole, WHOLE_COUNT);
    pass_doubles(stream, instance->u, INPUT_COUNT);
    pass_int(stream, &instance->u_orders, 0, INPUT_ORDERS);
    for (int end = 0; end < 2; end++) {
        pass_flag(stream, &instance->has_before[end]);
        pass_doubles(stream, &instance->time_before[end], 1);
        pass_doubles(stream, instance->velocity_before[end], 2);
    }
    int given = (int)instance->u_given;
    pass_int(stream, &given, 0, (1 << INPUT_COUNT) - 1);
    instance->u_given = (uint32_t)given;
    for (int order = 0; order < INPUT_ORDERS; order++) pass_doubles(stream, instance->u_derivative[order], INPUT_COUNT);
    pass_doubles(stream, instance->statics, STATICS_COUNT);
}

/* Returns whether there are directions to iterate from. */
static bool pass_choice(Stream *stream, ChoiceMemory *chosen)
{
    bool has_directions = chosen->limit != 0.0;
    const bool passed = pass_flag(stream, &has_directions);
    pass_doubles(stream, &chosen->limit, 1);
    pass_doubles(stream, &chosen->trust, 1);
    pass_doubles(stream, &chosen->lowest_error, 1);
    pass_doubles(stream, &chosen->advance, 1);
    int *const count[] = {&chosen->until_look,  &chosen->tried,  &chosen->wait,
                          &chosen->until_trial, &chosen->waited, &chosen->trial_left};
    for (size_t k = 0; k < sizeof count / sizeof *count; k++) pass_int(stream, count[k], -MOST_COUNT, MOST_COUNT);
    return passed;
}

static void pass_energy(Stream *stream, EnergyMemory *energy)
{
    enum {
        HISTORY = sizeof energy->time / sizeof *energy->time,
        PLACES = sizeof energy->place / sizeof *energy->place
    };
    pass_flag(stream, &energy->is_kept);
    pass_flag(stream, &energy->has_start);
    pass_flag(stream, &energy->place_is_old);
    pass_int(stream, &energy->points, 0, HISTORY);
    pass_doubles(stream, &energy->start, 1);
    pass_doubles(stream, &energy->work, 1);
    pass_doubles(stream, &energy->taken, 1);
    pass_doubles(stream, &energy->level, 1);
    pass_doubles(stream, energy->time, HISTORY);
    pass_doubles(stream, energy->loss, HISTORY);
    pass_doubles(stream, energy->place, PLACES);
    pass_doubles(stream, energy->speed, PLACES);
    pass_doubles(stream, energy->force, PLACES);
}

/* Which vectors of the solver's block will be read before they are written. */
typedef struct {
    bool slope, fastest, dense;
} Needed;

static Needed pass_solver(Stream *stream, SolverMemory *memory)
{
    Needed needed;
    int choice = (int)memory->choice;
    pass_int(stream, &choice, 0, SOLVER_CHOICES - 1);
    memory->choice = (SolverChoice)choice;
    pass_flag(stream, &memory->is_implicit);
    needed.slope = pass_flag(stream, &memory->has_slope);
    pass_flag(stream, &memory->has_moved);
    pass_flag(stream, &memory->has_point);
    needed.dense = pass_flag(stream, &memory->is_inside);
    pass_flag(stream, &memory->rested);
    pass_doubles(stream, &memory->tolerance, 1);
    pass_doubles(stream, &memory->step, 1);
    pass_doubles(stream, &memory->span, 1);
    pass_doubles(stream, &memory->error_before, 1);
    pass_doubles(stream, memory->slope_u, INPUT_COUNT);
    pass_doubles(stream, memory->trial_u, INPUT_COUNT);
    pass_doubles(stream, &memory->dense_from, 1);
    pass_doubles(stream, &memory->dense_to, 1);
    pass_doubles(stream, memory->counter, SOLVER_COUNT);
    needed.fastest = pass_choice(stream, &memory->chosen);
    pass_energy(stream, &memory->energy);
    return needed;
}

static Needed pass_members(Stream *stream, Instance *instance)
{
    pass_experiment(stream, instance);
    return pass_solver(stream, &instance->solver);
}

static void pass_vectors(Stream *stream, Instance *instance, Needed needed)
{
    const size_t states = (size_t)model_states(&instance->model);
    const Vectors vectors = vectors_in(instance->solver_block, (int)states);
    pass_doubles(stream, instance->x, states);
    if (instance->guess) pass_doubles(stream, instance->guess, states);
    if (needed.slope) pass_doubles(stream, vectors.slope, states);
    if (needed.fastest) pass_doubles(stream, vectors.fastest, states);
    if (!needed.dense) return;
    pass_doubles(stream, vectors.begin, states);
    pass_doubles(stream, vectors.end, states);
    for (int k = 0; k < ROSENBROCK_MOST_DENSE; k++) pass_doubles(stream, vectors.bend[k], states);
}

/* Bytes of what does not grow with n. */
static uint32_t layout_of(Instance *instance)
{
    Stream stream = {.way = COUNTING, .is_good = true};
    pass_members(&stream, instance);
    return (uint32_t)stream.used;
}

static Header header_of(Instance *instance)
{
    Header header = {.format = FORMAT, .layout = layout_of(instance), .version = CABLE_VERSION};
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    memcpy(header.token, instance->token, sizeof instance->token);
    header.n = (uint32_t)instance->model.n;
    header.interface = (uint32_t)instance->interface;
    header.size = image_size(instance);
    return header;
}

size_t image_size(Instance *instance)
{
    Stream stream = {.way = COUNTING, .used = sizeof(Header), .is_good = true};
    const Needed needed = pass_members(&stream, instance);
    pass_vectors(&stream, instance, needed);
    return stream.used;
}

void image_write(Instance *instance, uint8_t *bytes)
{
    const Header header = header_of(instance);
    memcpy(bytes, &header, sizeof header);
    Stream stream = {.way = WRITING, .out = bytes, .used = sizeof header, .is_good = true};
    const Needed needed = pass_members(&stream, instance);
    pass_vectors(&stream, instance, needed);
}

void image_seal(uint8_t *bytes, size_t size)
{
    sha256(bytes, size, bytes + size);
}

static bool refuse_image(Text *why, const char *what, const char *found, const char *here)
{
    text_add(why, what);
    text_add(why, found);
    text_add(why, "; expected is ");
    text_add(why, here);
    return false;
}

static bool refuse_number(Text *why, const char *what, uint64_t found, uint64_t here)
{
    Text found_text, here_text;
    text_start(&found_text), text_start(&here_text);
    text_integer(&found_text, found), text_integer(&here_text, here);
    return refuse_image(why, what, found_text.line, here_text.line);
}

static bool refuse_damaged(Text *why)
{
    text_add(why, "it is damaged; the bytes that were serialized are expected");
    return false;
}

/* Of this library, so that the rest of the header means what it says. */
static bool is_ours(Instance *instance, const Header *found, Text *why)
{
    if (memcmp(found->magic, MAGIC, sizeof MAGIC) != 0) {
        text_add(why, "it is not a state of a cable");
        return false;
    }
    if (found->format != FORMAT) return refuse_number(why, "its format is ", found->format, FORMAT);
    if (strncmp(found->version, CABLE_VERSION, sizeof found->version) != 0) {
        char version[sizeof found->version + 1] = {0};
        memcpy(version, found->version, sizeof found->version);
        return refuse_image(why, "its library's version is ", version, CABLE_VERSION);
    }
    const uint32_t layout = layout_of(instance);
    return found->layout == layout || refuse_number(why, "its layout is ", found->layout, layout);
}

static const char *name_of(uint32_t interface)
{
    return interface == CO_SIMULATION ? "Co-Simulation" : "Model Exchange";
}

static bool is_of_this_cable(const Instance *instance, const Header *found, Text *why)
{
    if (strncmp(found->token, instance->token, sizeof found->token) != 0) {
        char token[sizeof found->token + 1] = {0};
        memcpy(token, found->token, sizeof found->token);
        return refuse_image(why, "it is of another cable, whose token is ", token, instance->token);
    }
    if (found->n != (uint32_t)instance->model.n)
        return refuse_number(why, "its number of links is ", found->n, (uint64_t)instance->model.n);
    return found->interface == (uint32_t)instance->interface ||
           refuse_image(why, "its interface is ", name_of(found->interface), name_of(instance->interface));
}

bool image_fits(Instance *instance, const uint8_t *bytes, Text *why)
{
    Header found;
    memcpy(&found, bytes, sizeof found);
    return is_ours(instance, &found, why) && is_of_this_cable(instance, &found, why);
}

static bool checksum_matches(const uint8_t *bytes, size_t size)
{
    uint8_t digest[IMAGE_CHECKSUM];
    sha256(bytes, size, digest);
    return memcmp(digest, bytes + size, sizeof digest) == 0;
}

/* Whoever makes a checksum of his own may have put any numbers in front of it. */
static bool values_are_finite(Instance *instance, const uint8_t *bytes, size_t size)
{
    Stream stream = {.way = CHECKING, .in = bytes, .used = sizeof(Header), .size = size, .is_good = true};
    const Needed needed = pass_members(&stream, instance);
    pass_vectors(&stream, instance, needed);
    return stream.is_good && stream.used == size;
}

bool image_is_sound(Instance *instance, const uint8_t *bytes, size_t size, Text *why)
{
    Header found;
    if (size < sizeof found + IMAGE_CHECKSUM)
        return refuse_number(why, "its bytes are ", size, sizeof found + IMAGE_CHECKSUM);
    memcpy(&found, bytes, sizeof found);
    if (!is_ours(instance, &found, why)) return false;
    const uint64_t expected = found.size + IMAGE_CHECKSUM;
    if (size != expected) return refuse_number(why, "its bytes are ", size, expected);
    if (!checksum_matches(bytes, (size_t)found.size)) return refuse_damaged(why);
    if (!is_of_this_cable(instance, &found, why)) return false;
    return values_are_finite(instance, bytes, (size_t)found.size) || refuse_damaged(why);
}

void image_read(Instance *instance, const uint8_t *bytes)
{
    double parameter[PARAMETER_COUNT];
    memcpy(parameter, instance->model.parameter, sizeof parameter);
    Stream stream = {.way = READING, .in = bytes, .used = sizeof(Header), .is_good = true};
    const Needed needed = pass_members(&stream, instance);
    pass_vectors(&stream, instance, needed);
    instance->stop_time = INFINITY;  /* who goes on from a state says himself how far */
    instance->linear_is_lent = true; /* what the solver left there was of another state */
    if (!instance->link && memcmp(parameter, instance->model.parameter, sizeof parameter) == 0)
        invalidate_state(instance);
    else
        invalidate_model(instance);
}
