/* What variables are called in messages, and what values parameters may have. */
#include "instance.h"

typedef struct {
    const char *name, *least; /* "-inf", "0", or "+0" for above zero */
} Named;

#define PARAMETER(name, unit, least, description) {#name, #least},
static const Named PARAMETER_INFO[] = {
#include "../kernel/variables.def"
};

#define WHOLE(name, unit, least, description) {#name, #least},
static const Named WHOLE_INFO[] = {
#include "../kernel/variables.def"
};

#define OUTPUT(name, unit, nominal, description) #name,
static const char *const OUTPUT_NAME[] = {
#include "../kernel/variables.def"
};

#define SOLVER(name, unit, description) "solver." #name,
static const char *const SOLVER_NAME[] = {
#include "../kernel/variables.def"
};

#define STATICS(name, unit, description) "statics." #name,
static const char *const STATICS_NAME[] = {
#include "../kernel/variables.def"
};

#define INPUT(name, unit, description) #name,
static const char *const INPUT_NAME[] = {
#include "../kernel/variables.def"
};

static const char *const ARRAY_NAME[] = {"y_m1", "theta", "v_m1", "omega", "x_m1", "vx_m1"};

void text_state(Text *text, const Instance *instance, size_t k)
{
    const size_t half = (size_t)model_coordinates(&instance->model);
    if (k % half == 0 || k % half > (size_t)instance->model.n) {
        const char *const name[] = {"y_m1", "v_m1", "x_m1", "vx_m1"};
        text_add(text, name[(k % half ? 2 : 0) + k / half]);
        return;
    }
    text_add(text, k < half ? "theta[" : "omega[");
    text_integer(text, k % half);
    text_add(text, "]");
}

static void text_state_variable(Text *text, const Instance *instance, uint32_t index)
{
    if (instance->link)
        text_add(text, ARRAY_NAME[index]);
    else
        text_state(text, instance, index);
}

void text_variable(Text *text, const Instance *instance, const Variable *variable)
{
    const uint32_t index = variable->index;
    switch ((VariableKind)variable->kind) {
    case VARIABLE_PRELOAD:
    case VARIABLE_PARAMETER: text_add(text, PARAMETER_INFO[index].name); break;
    case VARIABLE_INPUT: text_add(text, INPUT_NAME[index]); break;
    case VARIABLE_OUTPUT: text_add(text, OUTPUT_NAME[index]); break;
    case VARIABLE_SOLVER: text_add(text, SOLVER_NAME[index]); break;
    case VARIABLE_STATICS: text_add(text, STATICS_NAME[index]); break;
    case VARIABLE_SOLVER_CHOICE: text_add(text, "solver"); break;
    case VARIABLE_WHOLE: text_add(text, WHOLE_INFO[index].name); break;
    case VARIABLE_LINKS: text_add(text, "n"); break;
    case VARIABLE_STATE: text_state_variable(text, instance, index); break;
    case VARIABLE_DERIVATIVE:
        text_add(text, "der(");
        text_state_variable(text, instance, index);
        text_add(text, ")");
        break;
    default: text_add(text, "time");
    }
}

const char *least_of(const Variable *variable)
{
    return (variable->kind == VARIABLE_WHOLE ? WHOLE_INFO : PARAMETER_INFO)[variable->index].least;
}
