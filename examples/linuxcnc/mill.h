/*
 * A mill for plant.c, with the numbers that mill-12.yaml states as a calibration would.
 *
 *     bed -> Y saddle -> X table -> part        bed -> Z head -> tool
 *
 * In: the types of plant.c. Out: the chain, mm and rad.
 */

/* From the origin of the head to the tip of the tool; and the part's frame is that of the table. */
static const double tool[3] = {0, 0, 120}, part[3] = {0, 0, 0};

static const Link links[] = {
    /* The saddle moves along a line that is not square to X. */
    {
        .letter = 'y', .carries_part = true, .along = Y, .way = -1, .play = 0.012,
        .motion = {
            [X] = {{0, 4e-5, -2e-7}}, [Y] = {{0, -90e-6}},
            [A] = {{0, 0.25e-6}}, [B] = {{0, -0.1e-6}}, [C] = {{0, 0.15e-6}},
        },
        .aligned = {[C] = 140e-6},
    },
    /* The table is long, and grows with its temperature. */
    {
        .letter = 'x', .carries_part = true, .along = X, .way = -1, .play = 0.009, .expansion = 11e-6,
        .motion = {
            [X] = {{0, 60e-6, -9e-8}}, [Y] = {{0, 8e-5, -3e-7}}, [Z] = {{0, 5e-5}},
            [A] = {{0, 0.12e-6}}, [B] = {{30e-6, -0.35e-6}}, [C] = {{0, 0.2e-6}},
        },
    },
    /* The head moves along a line that is square to neither X nor Y. */
    {
        .letter = 'z', .along = Z, .way = +1, .play = 0.005,
        .motion = {[X] = {{0, 3e-5}}, [Z] = {{0, 110e-6}}, [A] = {{0, 0.3e-6}}, [B] = {{0, -0.2e-6}}},
        .aligned = {[A] = -80e-6, [B] = 70e-6},
    },
};
