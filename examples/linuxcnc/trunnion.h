/*
 * A trunnion for plant.c: the geometry of trunnion.hal, and errors that draw.py has drawn.
 *
 *     bed -> A -> C -> part        bed -> X -> Y -> Z -> tool
 *
 * In: the types of plant.c, drawn.h. Out: the chain, mm and rad.
 */
#include "drawn.h"

static const double tool[3] = {0, 0, -120}, part[3] = {-200, -150, 300};

static const Link links[] = {
    {.letter = 'a', .carries_part = true, .along = A, .way = +1, .origin = {200, 162, -340}, DRAWN_A},
    {.letter = 'c', .carries_part = true, .along = C, .way = +1, .origin = {0, -12, 40}, DRAWN_C},
    {.letter = 'x', .along = X, .way = +1, DRAWN_X},
    {.letter = 'y', .along = Y, .way = +1, DRAWN_Y},
    {.letter = 'z', .along = Z, .way = +1, DRAWN_Z},
};
