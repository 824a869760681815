// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/mesh/shapes.h"

/// Parts of buildings, each along the local x axis with y up; the builder's placement puts them
/// where they belong. Lengths are in metres.
namespace octavo::architecture {

/// Plinth, base, swelling shaft, capital and abacus.
void column(ShapeBuilder& shapes, const dvec3& foot, double height, double radius);

struct Arch {
    double span;       // from column axis to column axis: local x from 0 to span
    double spring;     // where the arch begins to bend
    double top;        // of the wall
    double radius;     // of the opening
    double thickness;  // of the wall, half of it on either side of z = 0
};

/// A wall over two columns with a round arch in it, its mouldings and its keystone.
void arch(ShapeBuilder& shapes, const Arch& arch);

/// Rails and turned balusters from x = 0 to length, standing on y = floor.
void balustrade(ShapeBuilder& shapes, double length, double floor);

struct Slope {
    double length;      // of the eaves on the x axis: local x from 0 to length
    double low, high;   // heights of the eaves and of the ridge
    double out, depth;  // the eaves are at z = -out, the ridge at z = depth
    int rows;           // of tiles
    double mitre;  // 1 where the ridge is shorter than the eaves, as on a pyramid; -1 where longer
};

/// A roof of rounded tiles whose ends are mitred for a slope at a right angle to it.
void tiled_slope(ShapeBuilder& shapes, const Slope& slope);

}  // namespace octavo::architecture
