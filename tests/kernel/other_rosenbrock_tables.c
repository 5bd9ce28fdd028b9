#include "../../fmu_src/kernel/rosenbrock.h"

/*
 * Two methods of the kind of RODAS5P [fmu_src/kernel/rosenbrock_tables.c] that were measured and not taken: for the tests
 * that judge methods, and for benchmarks that compile them in its place. All digits as published.
 */

/* A triangle has a row a line. */
/* clang-format off */

/*
 * Hairer & Wanner, Solving Ordinary Differential Equations II, 2nd ed. 1996, section VI.4; digits of their code RODAS
 * (METH = 1). Six stages, order 4(3), dense output of order 3. On stiff equations order 2 only.
 */
static const double RODAS4_A[] = {
    1.544,
    0.9466785280815826, 0.2557011698983284,
    3.314825187068521, 2.896124015972201, 0.9986419139977817,
    1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950,
    1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0,
};
static const double RODAS4_C[] = {
    -5.6688,
    -2.430093356833875, -0.2063599157091915,
    -0.1073529058151375, -9.594562251023355, -20.47028614809616,
    7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160,
    8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054,
};
static const double RODAS4_M[] = {
    1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0, 1.0,
};
static const double RODAS4_ALPHA[] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};
static const double RODAS4_D[] = {0.25, -0.1043, 0.1035, -0.03620000000000023, 0.0, 0.0};
static const double RODAS4_DENSE[] = {
    10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662, 0.0,
    -0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872, 0.0,
};

/*
 * Steinebach, "Improvement of Rosenbrock-Wanner method RODASP", in Reis, Grundel & Schoeps (eds.), Progress in
 * Differential-Algebraic Equations II, Springer 2020, 165-184; digits as in the Julia package OrdinaryDiffEq
 * (Rodas4P2). Six stages, order 4(3), dense output of order 3. Keeps its order on linear stiff equations, and order 2
 * with any approximation of J and f_t.
 */
static const double RODAS4P2_A[] = {
    3.0,
    0.906377755268814, -0.189707390391685,
    3.758617027739064, 1.161741776019525, -0.849258085312803,
    7.089566927282776, 4.573591406461604, -8.423496976860259, -0.959280113459775,
    7.089566927282776, 4.573591406461604, -8.423496976860259, -0.959280113459775, 1.0,
};
static const double RODAS4P2_C[] = {
    -12.0,
    -6.354581592719008, 0.338972550544623,
    -8.575016317114033, -7.606483992117508, 12.224997650124820,
    -5.888975457523102, -8.157396617841821, 24.805546872612922, 12.790401512796979,
    -4.408651676063871, -6.692003137674639, 24.625568527593117, 16.627521966636085, -5.714285714285718,
};
static const double RODAS4P2_M[] = {
    7.089566927282776, 4.573591406461604, -8.423496976860259, -0.959280113459775, 1.0, 1.0,
};
static const double RODAS4P2_ALPHA[] = {0.0, 0.75, 0.321448134013046, 0.519745732277726, 1.0, 1.0};
static const double RODAS4P2_D[] = {0.25, -0.5, -0.189532918363016, 0.085612108792769, 0.0, 0.0};
static const double RODAS4P2_DENSE[] = {
    -5.323528268423303, -10.042123754867493, 17.175254928256965, -5.079931171878093, -0.016185991706112, 0.0,
    6.984505741529879, 6.914061169603662, -0.849178943070653, 18.104410789349338, -3.516963011559032, 0.0,
};

/* clang-format on */

static const double LAST_OF_SIX[] = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};

const RosenbrockTable RODAS4 = {
    .name = "Rodas4",
    .stages = 6,
    .order = 4,
    .error_order = 3,
    .gamma = 0.25,
    .a = RODAS4_A,
    .c = RODAS4_C,
    .m = RODAS4_M,
    .e = LAST_OF_SIX,
    .alpha = RODAS4_ALPHA,
    .d = RODAS4_D,
    .dense_terms = 2,
    .dense = RODAS4_DENSE,
};

const RosenbrockTable RODAS4P2 = {
    .name = "Rodas4P2",
    .stages = 6,
    .order = 4,
    .error_order = 3,
    .gamma = 0.25,
    .a = RODAS4P2_A,
    .c = RODAS4P2_C,
    .m = RODAS4P2_M,
    .e = LAST_OF_SIX,
    .alpha = RODAS4P2_ALPHA,
    .d = RODAS4P2_D,
    .dense_terms = 2,
    .dense = RODAS4P2_DENSE,
};
