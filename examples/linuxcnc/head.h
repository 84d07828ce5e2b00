/*
 * A head with two rotary axes for plant.c: the geometry of head.hal, and errors that draw.py has drawn.
 *
 *     bed -> part        bed -> X -> Y -> Z -> C -> B -> tool
 *
 * In: the types of plant.c, drawn.h. Out: the chain, mm and rad.
 */
#include "drawn.h"

static const double tool[3] = {0, 0, -280}, part[3] = {0, 0, 0};

static const Link links[] = {
    {.letter = 'x', .along = X, .way = +1, DRAWN_X},
    {.letter = 'y', .along = Y, .way = +1, DRAWN_Y},
    {.letter = 'z', .along = Z, .way = +1, DRAWN_Z},
    {.letter = 'c', .along = C, .way = +1, DRAWN_C},
    {.letter = 'b', .along = B, .way = -1, DRAWN_B},
};
