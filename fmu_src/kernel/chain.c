#include "dynamics.h"
#include "ends.h"

/*
 * Forward dynamics of the chain in O(n), by elimination from both ends at once [docs/model.md, "In O(n)"].
 *
 * Node P_0 is the top, link i (from 0) hangs between P_i and P_{i+1}, P_n is the terminal; R_i is the force through
 * P_i on what hangs below it. The centripetal part C of the accelerations is known, so it goes to the loads: with
 * a_i = b_i - C_i for the nodes, axes n and e of a link, h = l/2,
 *     b_{i+1} = b_i + l n th''       H = W + m (C_i + h w^2 e)
 *     m (b_i + h n th'') = R_i - R_{i+1} + H          I th'' = torque - h n.(R_i + R_{i+1})
 *
 * From the tip, P_i answers with R_i = A b_i + f. One link up, with J = J0 + l^2 n.A n (all of it below the link),
 * u = (l A n + m h n) / J, s = torque + h n.H and M = 1 - u (l n)^T:
 *     th'' = (s - l n.f)/J - u.b_i       f <- M f + u s - H       b_{i+1} = M^T b_i + l n (s - l n.f)/J
 * From the top, P_i answers with b_i = c - A^-1 R_i. One link down, with K^-1 = 1 + m A^-1 + (m h^2/I) n n^T,
 * g = m h/I, B = 1 - g h n n^T, q = m c + g n torque - H and M = B K:
 *     R_i = M^T R_{i+1} + K q            c <- (B K q + H + g n torque)/m
 * So both ends have the same three recursions, run side by side in two lanes:
 *     inertia inwards [ends.h]       bias inwards, z <- M z + constant       answer outwards, y <- M^T y + constant
 * Everything between them is one link at a time, and the compiler takes several links at once.
 *
 * At a heavy end C is counted from that end, so that it is zero there and nothing large cancels.
 *
 * Behind an end that cannot move, links that line up within some 1e-6 rad leave the recursion from the tip no digits.
 * Such a cable is eliminated from the top alone, whose recursion does not mind: its middle is its end [model.c].
 */

/* Whatever the compiler thinks of their size: a constant argument must reach their loops. */
#define INLINED static inline __attribute__((always_inline))

/*
 * Links 0 ... middle - 1 are eliminated from the top, the others from the tip. While the lane of the top is at link i,
 * that of the tip is at link n - 1 - i; if n is odd, the tip takes one link before that, while the top waits. From
 * the top alone, the tip's lane does the same as the top's. What the two ways have in common is written once and
 * inlined twice, with a constant for `alone`: neither pays for the other [docs/lean.md].
 */
static inline bool is_odd(const Model *model, bool alone)
{
    return !alone && model->n % 2 == 1;
}

static inline int first_tip(const Model *model, bool alone)
{
    return model->n - 1 - is_odd(model, alone);
}

static inline int partner_of(int first, bool alone, int link)
{
    return alone ? link : first - link;
}

/*
 * The sweep inwards goes strip by strip, links from ... to - 1 and their partners, so that what one pass leaves for
 * the next is still in the first cache: 32 links of both ends take some 20 kB.
 */
typedef struct {
    int from, to;         /* links at the top */
    int tip_from, tip_to; /* links at the tip, the odd one included */
} Strip;

/* Where a link's scratch lies: from the top 0 ... STRIP - 1, from the tip behind that. */
static inline int top_place(Strip strip, int link)
{
    return link - strip.from;
}

static inline int tip_place(Strip strip, int link)
{
    return STRIP + (link - strip.tip_from);
}

static inline Strip strip_at(const Model *model, bool alone, int from)
{
    const int middle = model->middle, to = from + STRIP < middle ? from + STRIP : middle;
    const int first = first_tip(model, alone);
    if (alone) return (Strip){from, to, from + STRIP, from + STRIP};
    return (Strip){from, to, first - to + 1, from ? first - from + 1 : model->n};
}

static inline bool top_waits(const Model *model, bool alone, Strip strip)
{
    return strip.from == 0 && is_odd(model, alone);
}

static inline Lanes at(const double *array, int top, int tip)
{
    return (Lanes){array[top], array[tip]};
}

static inline void put(double *array, int top, int tip, Lanes value)
{
    array[top] = value[FROM_TOP];
    array[tip] = value[FROM_TIP];
}

/* H of links from ... to - 1; C is counted from where it has the value `origin`. */
static void drive_links(const Model *model, const double *x, Work *work, int from, int to, double origin_x,
                        double origin_y)
{
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const double *rate = rates_in(model, x), *sine = work->sine, *cosine = work->cosine;
    const double *inward_x = work->inward_x, *inward_y = work->inward_y;
    const double *load_x = work->load_x, *load_y = work->load_y;
    double *drive_x = work->drive_x, *drive_y = work->drive_y;
    LINKS_ARE_INDEPENDENT
    for (int i = from; i < to; i++) {
        const double inward = 0.5 * length[i] * (rate[i] * rate[i]);
        drive_x[i] = load_x[i] + mass[i] * ((inward_x[i] - origin_x) + inward * sine[i]);
        drive_y[i] = load_y[i] + mass[i] * ((inward_y[i] - origin_y) + inward * cosine[i]);
    }
}

INLINED Inertia inertia_past(const Model *model, Work *work, Strip strip, bool alone, Inertia a, int top, int tip)
{
    const int top_at = top_place(strip, top), tip_at = tip_place(strip, tip);
    put(work->nn, top_at, tip_at, a.nn);
    put(work->en, top_at, tip_at, a.en);
    put(work->ee, top_at, tip_at, a.ee);
    put(work->unit, top_at, tip_at, a.unit);
    put(work->det, top_at, tip_at, a.det);
    const LinkInertia link = {at(model->link[LINK_MASS], top, tip), at(model->reach, top, tip),
                              at(model->swing, top, tip), at(model->skew, top, tip)};
    const Lanes cosine = at(work->turn_cosine, top + 1, alone ? top + 1 : tip);
    const Lanes sine = {work->turn_sine[top + 1], alone ? work->turn_sine[top + 1] : -work->turn_sine[tip]};
    return turned(past_link(a, link), cosine, sine);
}

static Inertia with_top_of(Inertia a, Inertia before)
{
    Lanes *const lane[] = {&a.nn, &a.en, &a.ee, &a.unit, &a.det};
    const Lanes old[] = {before.nn, before.en, before.ee, before.unit, before.det};
    for (int k = 0; k < 5; k++) (*lane[k])[FROM_TOP] = old[k][FROM_TOP];
    return a;
}

/* Passes a strip of links, keeping the inertia at every link's outer end, in the link's axes. */
INLINED Inertia inertia_inwards(const Model *model, Work *work, Strip strip, bool alone, Inertia a)
{
    const int first = first_tip(model, alone);
    if (top_waits(model, alone, strip)) a = with_top_of(inertia_past(model, work, strip, false, a, 0, model->n - 1), a);
    for (int i = strip.from; i < strip.to; i++) {
        a = inertia_past(model, work, strip, alone, a, i, partner_of(first, alone, i));
        if (i % 8 == 7) a = rescaled(a);
    }
    return a;
}

/* At the middle the top stands in the axes of the link below it, the tip in those of the one above: both in the first. */
static Inertia in_middle_axes(const Model *model, const Work *work, Inertia a)
{
    const int middle = model->middle;
    return rescaled(turned(a, (Lanes){1.0, work->turn_cosine[middle]}, (Lanes){0.0, work->turn_sine[middle]}));
}

/* M and the bias' constant of the links above the middle, and K in the link's axes. */
INLINED void gains_from_top(const Model *model, Work *work, Strip strip)
{
    const double *mass = model->link[LINK_MASS], *swing = model->swing, *lever = model->lever;
    const double *rest = model->rest_share, *sine = work->sine, *cosine = work->cosine;
    const double *nn = work->nn, *en = work->en, *ee = work->ee;
    const double *unit = work->unit, *det = work->det, *torque = work->torque;
    const double *drive_x = work->drive_x, *drive_y = work->drive_y;
    double *k_ee = work->k_ee, *k_en = work->k_en, *k_nn = work->k_nn;
    double *m_xx = work->m_xx, *m_xy = work->m_xy, *m_yx = work->m_yx, *m_yy = work->m_yy;
    double *constant_x = work->constant_x, *constant_y = work->constant_y;
    LINKS_ARE_INDEPENDENT
    for (int i = strip.from; i < strip.to; i++) {
        const int at = top_place(strip, i);
        const double ex = sine[i], ey = cosine[i], nx = ey, ny = -ex, m = mass[i], per_mass = 1.0 / m;
        const double across = det[at] + m * nn[at];
        const double scale = 1.0 / (across + swing[i] * (ee[at] + m * unit[at])); /* 1 / det' of past_link() */
        const double kee = (det[at] + swing[i] * ee[at]) * scale, ken = swing[i] * en[at] * scale;
        const double knn = swing[i] * per_mass * across * scale;
        const double mne = rest[i] * ken, mnn = rest[i] * knn; /* B acts on n alone, with the factor 1 - m h^2 / I */
        const double p_x = kee * ex + mne * nx, p_y = kee * ey + mne * ny; /* M e */
        const double q_x = ken * ex + mnn * nx, q_y = ken * ey + mnn * ny; /* M n */
        const double mxx = p_x * ex + q_x * nx, mxy = p_x * ey + q_x * ny;
        const double myx = p_y * ex + q_y * nx, myy = p_y * ey + q_y * ny;
        const double push = lever[i] * torque[i];
        const double minus_x = push * nx - drive_x[i], minus_y = push * ny - drive_y[i]; /* q - m c */
        constant_x[i] = per_mass * ((mxx * minus_x + mxy * minus_y) + (push * nx + drive_x[i]));
        constant_y[i] = per_mass * ((myx * minus_x + myy * minus_y) + (push * ny + drive_y[i]));
        m_xx[i] = mxx, m_xy[i] = mxy, m_yx[i] = myx, m_yy[i] = myy;
        k_ee[at] = kee, k_en[at] = ken, k_nn[at] = knn;
    }
}

/* M and the bias' constant of the links below the middle, u and 1 / J. */
INLINED void gains_from_tip(const Model *model, Work *work, Strip strip)
{
    const double *length = model->link[LINK_LENGTH], *mass = model->link[LINK_MASS];
    const double *reach = model->reach, *per_rotary = model->per_rotary;
    const double *sine = work->sine, *cosine = work->cosine, *torque = work->torque;
    const double *nn = work->nn, *en = work->en, *unit = work->unit;
    const double *drive_x = work->drive_x, *drive_y = work->drive_y;
    double *u_x = work->u_x, *u_y = work->u_y, *per_pivot = work->per_pivot;
    double *m_xx = work->m_xx, *m_xy = work->m_xy, *m_yx = work->m_yx, *m_yy = work->m_yy;
    double *constant_x = work->constant_x, *constant_y = work->constant_y, *turning = work->turning;
    LINKS_ARE_INDEPENDENT
    for (int i = strip.tip_from; i < strip.tip_to; i++) {
        const int at = tip_place(strip, i);
        const double ex = sine[i], ey = cosine[i], nx = ey, ny = -ex, l = length[i];
        const double scale = per_rotary[i] / (unit[at] + reach[i] * nn[at]); /* 1 / (J unit) */
        const double along = l * en[at] * scale, across = l * (nn[at] + 0.5 * mass[i] * unit[at]) * scale;
        const double ux = across * nx + along * ex, uy = across * ny + along * ey;
        const double s = torque[i] + 0.5 * l * (nx * drive_x[i] + ny * drive_y[i]);
        m_xx[i] = 1.0 - ux * (l * nx), m_xy[i] = -ux * (l * ny);
        m_yx[i] = -uy * (l * nx), m_yy[i] = 1.0 - uy * (l * ny);
        constant_x[i] = ux * s - drive_x[i];
        constant_y[i] = uy * s - drive_y[i];
        u_x[i] = ux, u_y[i] = uy;
        per_pivot[at] = unit[at] * scale;
        turning[i] = s;
    }
}

INLINED Planar bias_past(Work *work, Strip strip, Planar z, int top, int tip)
{
    put(work->bias_x, top_place(strip, top), tip_place(strip, tip), z.x);
    put(work->bias_y, top_place(strip, top), tip_place(strip, tip), z.y);
    return (Planar){at(work->m_xx, top, tip) * z.x + (at(work->m_xy, top, tip) * z.y + at(work->constant_x, top, tip)),
                    at(work->m_yx, top, tip) * z.x + (at(work->m_yy, top, tip) * z.y + at(work->constant_y, top, tip))};
}

/* z <- M z + constant over a strip; z at every link's outer end is kept. */
INLINED Planar bias_inwards(const Model *model, Work *work, Strip strip, bool alone, Planar z)
{
    const int first = first_tip(model, alone);
    if (top_waits(model, alone, strip)) {
        const Planar next = bias_past(work, strip, z, 0, model->n - 1);
        z.x[FROM_TIP] = next.x[FROM_TIP], z.y[FROM_TIP] = next.y[FROM_TIP];
    }
    for (int i = strip.from; i < strip.to; i++) z = bias_past(work, strip, z, i, partner_of(first, alone, i));
    return z;
}

/* Constant of the answer above the middle: K q. */
INLINED void answers_from_top(const Model *model, Work *work, Strip strip)
{
    const double *mass = model->link[LINK_MASS], *lever = model->lever, *sine = work->sine, *cosine = work->cosine;
    const double *bias_x = work->bias_x, *bias_y = work->bias_y, *torque = work->torque;
    const double *k_ee = work->k_ee, *k_en = work->k_en, *k_nn = work->k_nn;
    const double *drive_x = work->drive_x, *drive_y = work->drive_y;
    double *constant_x = work->constant_x, *constant_y = work->constant_y;
    LINKS_ARE_INDEPENDENT
    for (int i = strip.from; i < strip.to; i++) {
        const int at = top_place(strip, i);
        const double ex = sine[i], ey = cosine[i], nx = ey, ny = -ex, push = lever[i] * torque[i];
        const double q_x = mass[i] * bias_x[at] + (push * nx - drive_x[i]);
        const double q_y = mass[i] * bias_y[at] + (push * ny - drive_y[i]);
        const double q_e = q_x * ex + q_y * ey, q_n = q_x * nx + q_y * ny;
        const double r_e = k_ee[at] * q_e + k_en[at] * q_n, r_n = k_en[at] * q_e + k_nn[at] * q_n;
        constant_x[i] = r_e * ex + r_n * nx;
        constant_y[i] = r_e * ey + r_n * ny;
    }
}

/* Below it: (s - l n.f)/J, the link's acceleration if its node stood still, and that times l n. */
INLINED void answers_from_tip(const Model *model, Work *work, Strip strip)
{
    const double *length = model->link[LINK_LENGTH], *sine = work->sine, *cosine = work->cosine;
    const double *bias_x = work->bias_x, *bias_y = work->bias_y, *per_pivot = work->per_pivot;
    double *constant_x = work->constant_x, *constant_y = work->constant_y, *turning = work->turning;
    LINKS_ARE_INDEPENDENT
    for (int i = strip.tip_from; i < strip.tip_to; i++) {
        const int at = tip_place(strip, i);
        const double lx = length[i] * cosine[i], ly = -length[i] * sine[i];
        const double free = (turning[i] - (lx * bias_x[at] + ly * bias_y[at])) * per_pivot[at];
        turning[i] = free;
        constant_x[i] = lx * free;
        constant_y[i] = ly * free;
    }
}

/* y <- M^T y + constant from the middle: R above, b below. answer[i + 1] is at link i's inner end, answer[0] is R_0. */
INLINED void pass_outwards(const Model *model, Work *work, bool alone, Planar y)
{
    const int first = first_tip(model, alone);
    for (int i = model->middle - 1; i >= 0; i--) {
        const int tip = partner_of(first, alone, i);
        put(work->answer_x, i + 1, tip + 1, y.x);
        put(work->answer_y, i + 1, tip + 1, y.y);
        y = (Planar){at(work->m_xx, i, tip) * y.x + (at(work->m_yx, i, tip) * y.y + at(work->constant_x, i, tip)),
                     at(work->m_xy, i, tip) * y.x + (at(work->m_yy, i, tip) * y.y + at(work->constant_y, i, tip))};
    }
    const int last = is_odd(model, alone) ? model->n : 0; /* the tip's last link, if it is one ahead */
    put(work->answer_x, 0, last, (Lanes){y.x[FROM_TOP], last ? y.x[FROM_TIP] : y.x[FROM_TOP]});
    put(work->answer_y, 0, last, (Lanes){y.y[FROM_TOP], last ? y.y[FROM_TIP] : y.y[FROM_TOP]});
}

/* Functions of their own: in the middle of everything else this loop runs out of registers. */
static __attribute__((noinline)) void answers_from_middle(const Model *model, Work *work, Planar y)
{
    pass_outwards(model, work, false, y);
}

static __attribute__((noinline)) void answers_from_terminal(const Model *model, Work *work, Planar y)
{
    pass_outwards(model, work, true, y);
}

INLINED void turn_links(const Model *model, const Work *work, int middle, double *acceleration)
{
    const double *half_per_inertia = model->half_per_inertia, *per_inertia = model->per_inertia;
    const double *sine = work->sine, *cosine = work->cosine, *torque = work->torque;
    const double *answer_x = work->answer_x, *answer_y = work->answer_y;
    const double *u_x = work->u_x, *u_y = work->u_y, *turning = work->turning;
    LINKS_ARE_INDEPENDENT
    for (int i = 0; i < middle; i++) {
        const double pull = cosine[i] * (answer_x[i] + answer_x[i + 1]) - sine[i] * (answer_y[i] + answer_y[i + 1]);
        acceleration[i] = per_inertia[i] * torque[i] - half_per_inertia[i] * pull;
    }
    LINKS_ARE_INDEPENDENT
    for (int i = middle; i < model->n; i++)
        acceleration[i] = turning[i] - (u_x[i] * answer_x[i + 1] + u_y[i] * answer_y[i + 1]);
}

/* Along n and e of a link, in the fields x and y, what is given along x and y of the world; and back. */
static inline Planar in_axes(Planar v, double sine, double cosine)
{
    return (Planar){cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

static inline Planar in_world(Planar v, double sine, double cosine)
{
    return (Planar){cosine * v.x + sine * v.y, cosine * v.y - sine * v.x};
}

/*
 * At the middle b = d - A_t^-1 R and R = A_b b + f, t for top and b for tip, d = c - S with the sum S of C from both
 * sides. With A = N / unit and det = det(N) / unit, without an inverse and symmetric in the two ends:
 *     D = unit_b det_t + det_b unit_t + tr(N_b adj N_t)          P = unit_b det_t 1 + N_t adj N_b
 *     R = ((det_t N_b + det_b N_t) d + P f) / D                  b = (P^T d - (unit_t adj N_b + unit_b adj N_t) f) / D
 * All in axes n and e. Returns R in the top's lane and b in the tip's.
 */
static Planar meet(Inertia a, Planar free, Planar force)
{
    const double t_det = a.det[FROM_TOP], t_unit = a.unit[FROM_TOP], b_det = a.det[FROM_TIP], b_unit = a.unit[FROM_TIP];
    const double t_nn = a.nn[FROM_TOP], t_en = a.en[FROM_TOP], t_ee = a.ee[FROM_TOP];
    const double b_nn = a.nn[FROM_TIP], b_en = a.en[FROM_TIP], b_ee = a.ee[FROM_TIP];
    const double d_n = free.x[FROM_TOP], d_e = free.y[FROM_TOP], f_n = force.x[FROM_TIP], f_e = force.y[FROM_TIP];
    const double both = b_unit * t_det;
    const double scale = 1.0 / ((both + b_det * t_unit) + ((b_nn * t_ee + b_ee * t_nn) - 2.0 * (b_en * t_en)));
    const double p_nn = both + (t_nn * b_ee - t_en * b_en), p_ne = t_en * b_nn - t_nn * b_en;
    const double p_en = t_en * b_ee - t_ee * b_en, p_ee = both + (t_ee * b_nn - t_en * b_en);
    const double s_nn = t_det * b_nn + b_det * t_nn, s_ne = t_det * b_en + b_det * t_en,
                 s_ee = t_det * b_ee + b_det * t_ee;
    const double c_nn = t_unit * b_ee + b_unit * t_ee, c_ne = -(t_unit * b_en + b_unit * t_en);
    const double c_ee = t_unit * b_nn + b_unit * t_nn;
    return (Planar){{((s_nn * d_n + s_ne * d_e) + (p_nn * f_n + p_ne * f_e)) * scale,
                     ((p_nn * d_n + p_en * d_e) - (c_nn * f_n + c_ne * f_e)) * scale},
                    {((s_ne * d_n + s_ee * d_e) + (p_en * f_n + p_ee * f_e)) * scale,
                     ((p_ne * d_n + p_ee * d_e) - (c_ne * f_n + c_ee * f_e)) * scale}};
}

/* Inertia and bias of both parts where they meet, in the axes of the link `axes`. */
typedef struct {
    Inertia inertia;
    Planar bias;
    int axes;
} Meeting;

/* From the top alone the other part is the terminal itself. */
static Meeting meeting_at_terminal(const Model *model, const Work *work, Inertia inertia, Planar bias,
                                   const Port port[ENDS])
{
    const int last = model->n - 1;
    const Lanes cosine = at(work->cosine, last, last), sine = at(work->sine, last, last);
    const Planar ports = bias_of(port);
    bias.x[FROM_TIP] = ports.x[FROM_TIP], bias.y[FROM_TIP] = ports.y[FROM_TIP];
    return (Meeting){rescaled(with_top_of(turned(inertia_of(port), cosine, sine), inertia)), bias, last};
}

INLINED void accelerations(const Model *model, const double *x, const double *u, Work *work, bool alone,
                           double *acceleration)
{
    const int n = model->n, middle = model->middle;
    const double sum_x = work->inward_x[n], sum_y = work->inward_y[n];
    Port port[ENDS];
    top_port(model, x, u, work, &port[FROM_TOP]);
    terminal_port(model, work, &port[FROM_TIP]);
    const Port start[ENDS] = {port[FROM_TOP], alone ? port[FROM_TOP] : port[FROM_TIP]};
    const int outermost = alone ? 0 : n - 1;
    Planar bias = bias_of(start);
    Inertia inertia = turned(inertia_of(start), at(work->cosine, 0, outermost), at(work->sine, 0, outermost));
    work->turn_sine[n] = 0.0, work->turn_cosine[n] = 1.0; /* behind the last link there are no other axes */

    int from = 0;
    do {
        const Strip strip = strip_at(model, alone, from);
        drive_links(model, x, work, strip.from, strip.to, 0.0, 0.0);
        drive_links(model, x, work, strip.tip_from, strip.tip_to, sum_x, sum_y);
        inertia = inertia_inwards(model, work, strip, alone, inertia);
        gains_from_top(model, work, strip);
        gains_from_tip(model, work, strip);
        bias = bias_inwards(model, work, strip, alone, bias);
        answers_from_top(model, work, strip);
        answers_from_tip(model, work, strip);
        from = strip.to;
    } while (from < middle);

    const Meeting at_middle = {in_middle_axes(model, work, inertia), bias, middle};
    const Meeting where = alone ? meeting_at_terminal(model, work, inertia, bias, port) : at_middle;
    const double sine = work->sine[where.axes], cosine = work->cosine[where.axes];
    const Planar free = {where.bias.x - (sum_x + port[FROM_TIP].given_x),
                         where.bias.y - (sum_y + port[FROM_TIP].given_y)};
    const Planar met = meet(where.inertia, in_axes(free, sine, cosine), in_axes(where.bias, sine, cosine));
    Planar answer = in_world(met, sine, cosine);
    if (alone) answer.x[FROM_TIP] = answer.x[FROM_TOP], answer.y[FROM_TIP] = answer.y[FROM_TOP];
    if (alone)
        answers_from_terminal(model, work, answer);
    else
        answers_from_middle(model, work, answer);
    top_acceleration(model, x, u, work->answer_x[0], work->answer_y[0], acceleration);
    turn_links(model, work, middle, acceleration + 1);
}

void VARIANT(chain_accelerations)(const Model *model, const double *x, const double *u, Work *work,
                                  double *acceleration)
{
    if (model->middle == model->n)
        accelerations(model, x, u, work, true, acceleration);
    else
        accelerations(model, x, u, work, false, acceleration);
}
