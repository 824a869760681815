// SPDX-License-Identifier: MIT
#include "octavo/attributes/triangle_pieces.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace octavo {
namespace {

using Corners = std::array<dvec3, 3>;
using Cell = std::array<int, 3>;  // x, y, z

constexpr int kSide = 8;

/// Corners in and around the grid of 8^3 cells, some of them on faces of cells.
class RandomTriangles {
public:
    Corners operator()() {
        Corners corners;
        const bool whole = random_() % 4 == 0;
        for (dvec3& corner : corners)
            for (int axis = 0; axis < 3; ++axis) {
                corner[axis] = place_(random_);
                if (whole) corner[axis] = std::floor(corner[axis]);
            }
        return corners;
    }

private:
    std::mt19937 random_{7};
    std::uniform_real_distribution<double> place_{-2.0, kSide + 2.0};
};

std::map<Cell, double> areas_of_pieces(const Corners& corners) {
    const TrianglePieces pieces(corners);
    std::map<Cell, double> areas;
    pieces.for_each(ivec3(0), ivec3(kSide), [&](const TrianglePieces::Piece& piece) {
        const ivec3 cell = pieces.in_place(piece.cell);
        areas[{cell.x, cell.y, cell.z}] += piece.area;
    });
    return areas;
}

/// What is left of a polygon on one side of a plane at right angles to an axis.
std::vector<dvec3> clipped(const std::vector<dvec3>& polygon, int axis, double plane, double side) {
    std::vector<dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3& a = polygon[i];
        const dvec3& b = polygon[(i + 1) % polygon.size()];
        const double from_a = side * (a[axis] - plane), from_b = side * (b[axis] - plane);
        if (from_a >= 0.0) kept.push_back(a);
        if ((from_a < 0.0) != (from_b < 0.0))
            kept.push_back(a + (b - a) * (from_a / (from_a - from_b)));
    }
    return kept;
}

/// The oracle: the triangle clipped by the six faces of a cell.
double area_in_cell(const Corners& corners, const Cell& cell) {
    std::vector<dvec3> polygon(corners.begin(), corners.end());
    for (int axis = 0; axis < 3; ++axis) {
        const int low = cell[static_cast<unsigned>(axis)];
        polygon = clipped(polygon, axis, low, 1.0);
        polygon = clipped(polygon, axis, low + 1, -1.0);
    }
    dvec3 twice(0.0);
    for (std::size_t i = 2; i < polygon.size(); ++i)
        twice += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    return 0.5 * glm::length(twice);
}

TEST(TrianglePieces, HaveTheAreaOfTheTriangleInEachCell) {
    RandomTriangles random;
    for (int i = 0; i < 300; ++i) {
        const Corners corners = random();
        const auto areas = areas_of_pieces(corners);
        for (int code = 0; code < kSide * kSide * kSide; ++code) {
            const Cell cell{code % kSide, code / kSide % kSide, code / (kSide * kSide)};
            const auto found = areas.find(cell);
            EXPECT_NEAR(found == areas.end() ? 0.0 : found->second, area_in_cell(corners, cell),
                        1e-9)
                << "triangle " << i << ", cell " << cell[0] << " " << cell[1] << " " << cell[2];
        }
    }
}

TEST(TrianglePieces, HaveTheirCentreInTheirCellAndOnTheTriangle) {
    RandomTriangles random;
    for (int i = 0; i < 300; ++i) {
        const Corners corners = random();
        const TrianglePieces pieces(corners);
        pieces.for_each(ivec3(0), ivec3(kSide), [&](const TrianglePieces::Piece& piece) {
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(piece.centre[axis], piece.cell[axis] - 1e-9);
                EXPECT_LE(piece.centre[axis], piece.cell[axis] + 1 + 1e-9);
            }
            const dvec3 from_corner = pieces.in_place(piece.centre) - corners[0];
            EXPECT_NEAR(glm::dot(from_corner, pieces.normal()), 0.0, 1e-9);
        });
    }
}

TEST(TrianglePieces, OfATriangleBetweenTwoLayersLieInBoth) {
    const auto areas = areas_of_pieces({dvec3(1, 1, 3), dvec3(2, 1, 3), dvec3(1, 2, 3)});
    EXPECT_EQ(areas, (std::map<Cell, double>{{{1, 1, 2}, 0.5}, {{1, 1, 3}, 0.5}}));
}

TEST(TrianglePieces, OfALineAreNone) {
    EXPECT_TRUE(areas_of_pieces({dvec3(1, 1, 1), dvec3(2, 3, 4), dvec3(3, 5, 7)}).empty());
}

}  // namespace
}  // namespace octavo
