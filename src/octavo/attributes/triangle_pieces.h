// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "octavo/core/vec.h"

namespace octavo {

/// Cuts a triangle along the faces of cells, slab by slab: first along one axis of the plane that
/// the triangle looks most towards, then along the other, then across. Squares of that plane that
/// lie wholly inside the triangle's shadow are not cut at all.
///
/// Coordinates are in cells. A piece lies in one cell; a triangle in the plane between two layers
/// has its pieces in both, as both are touched by it.
class TrianglePieces {
public:
    struct Piece {
        ivec3 cell;    // along axes()
        double area;   // in cells' faces
        dvec3 centre;  // of its area; along axes()
    };

    explicit TrianglePieces(const std::array<dvec3, 3>& corners) : corners_(corners) {
        const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const dvec3 size = glm::abs(normal);
        w_ = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
        u_ = (w_ + 1) % 3;
        v_ = (w_ + 2) % 3;
        if (size[w_] == 0.0) return;
        slope_u_ = -normal[u_] / normal[w_];
        slope_v_ = -normal[v_] / normal[w_];
        stretch_ = glm::length(normal) / size[w_];
        normal_ = normal / glm::length(normal);
        area_ = 0.5 * glm::length(normal);
    }

    /// The axes in the order in which pieces have them: the triangle looks most along the last.
    [[nodiscard]] ivec3 axes() const { return {u_, v_, w_}; }
    /// From along axes() to along x, y and z.
    template <class Vector>
    [[nodiscard]] Vector in_place(const Vector& along) const {
        Vector p;
        p[u_] = along.x;
        p[v_] = along.y;
        p[w_] = along.z;
        return p;
    }

    [[nodiscard]] double area() const { return area_; }  // 0: it is a line or a point
    [[nodiscard]] const dvec3& normal() const { return normal_; }

    /// Calls visit(piece) for the pieces in the cells from `low` to before `high`; x, y, z.
    template <class Visit>
    void for_each(const ivec3& low, const ivec3& high, const Visit& visit) const {
        if (area_ == 0.0) return;
        Polygon rest;
        rest.count = 3;
        for (unsigned i = 0; i < 3; ++i)
            rest.points[i] = {corners_[i][u_], corners_[i][v_], corners_[i][w_]};
        const CellBox box{{low[u_], low[v_], low[w_]}, {high[u_], high[v_], high[w_]}};
        Polygon cut;
        for (int axis = 0; axis < 3; ++axis) {
            // What lies in the border itself stays: it touches the cells on both sides.
            if (rest.range(axis)[0] < box.first[axis]) rest.split(axis, box.first[axis], cut, rest);
            if (rest.count < 3) return;
            if (rest.range(axis)[1] > box.end[axis]) rest.split(axis, box.end[axis], rest, cut);
            if (rest.count < 3) return;
        }
        const auto [u_low, u_high] = rest.range(0);
        for (int u = whole(u_low, box.first[0], box.end[0]);
             rest.count >= 3 && u < box.end[0] && u < u_high; ++u) {
            Polygon strip;
            rest.split(0, u + 1, strip, rest);
            if (strip.count >= 3) visit_strip(strip, u, box, visit);
        }
    }

private:
    /// Cells from `first` to before `end`; along u, v and w.
    struct CellBox {
        ivec3 first, end;
    };

    /// Convex; points are (u, v, w). Clipping a triangle by six planes and cutting it by six more
    /// gives at most 15.
    struct Polygon {
        std::array<dvec3, 16> points;
        unsigned count = 0;

        /// The parts with coordinate <= plane and >= plane. Either may be this polygon, but not
        /// both.
        void split(int axis, double plane, Polygon& below, Polygon& above) const {
            const auto [low, high] = range(axis);
            if (high <= plane) return give(below, above);
            if (low >= plane) return give(above, below);
            // Either result may be this polygon, so its points are read from a copy.
            std::array<dvec3, 16> whole;
            const unsigned corners = count;
            std::copy_n(points.begin(), corners, whole.begin());
            below.count = above.count = 0;
            for (unsigned i = 0; i < corners; ++i) {
                const dvec3& a = whole[i];
                const dvec3& b = whole[i + 1 == corners ? 0 : i + 1];
                const double from_a = a[axis] - plane, from_b = b[axis] - plane;
                if (from_a <= 0.0) below.points[below.count++] = a;
                if (from_a >= 0.0) above.points[above.count++] = a;
                if ((from_a < 0.0 && from_b > 0.0) || (from_a > 0.0 && from_b < 0.0)) {
                    // From the lower end, so that the same edge is cut at the same point.
                    dvec3 crossing = from_a < 0.0 ? a + (b - a) * (from_a / (from_a - from_b))
                                                  : b + (a - b) * (from_b / (from_b - from_a));
                    crossing[axis] = plane;
                    below.points[below.count++] = crossing;
                    above.points[above.count++] = crossing;
                }
            }
        }
        [[nodiscard]] std::array<double, 2> range(int axis) const {
            double low = points[0][axis], high = low;
            for (unsigned i = 1; i < count; ++i) {
                low = std::min(low, points[i][axis]);
                high = std::max(high, points[i][axis]);
            }
            return {low, high};
        }

    private:
        void give(Polygon& all, Polygon& none) const {
            if (&all != this) {
                all.count = count;
                std::copy_n(points.begin(), count, all.points.begin());
            }
            none.count = 0;
        }
    };

    static int whole(double x, int low, int high) {
        return std::clamp(static_cast<int>(std::floor(x)), low, high);
    }

    [[nodiscard]] double height(double u, double v) const {
        return corners_[0][w_] + slope_u_ * (u - corners_[0][u_]) +
               slope_v_ * (v - corners_[0][v_]);
    }

    template <class Visit>
    void visit_strip(Polygon& rest, int u, const CellBox& box, const Visit& visit) const {
        const auto [v_low, v_high] = rest.range(1);
        int v = whole(v_low, box.first[1], box.end[1]);
        const auto [full, full_end] = full_squares(rest, u);
        Polygon column;
        while (v < box.end[1] && v < v_high) {
            if (v == full && full < full_end) {
                for (; v < full_end; ++v) visit_square(u, v, box, visit);
                rest.split(1, v, column, rest);
            } else {
                rest.split(1, ++v, column, rest);
                if (column.count >= 3) visit_column(column, u, v - 1, box, visit);
            }
            if (rest.count < 3) return;
        }
    }

    /// The squares of a strip whose four corners, and so all of them, lie inside it.
    static std::array<int, 2> full_squares(const Polygon& strip, int u) {
        double low[2] = {0, 0}, high[2] = {-1, -1};  // along both long sides
        for (unsigned i = 0; i < strip.count; ++i)
            for (int side = 0; side < 2; ++side) {
                if (strip.points[i].x != u + side) continue;
                const double v = strip.points[i].y;
                if (low[side] > high[side]) {
                    low[side] = high[side] = v;
                } else {
                    low[side] = std::min(low[side], v);
                    high[side] = std::max(high[side], v);
                }
            }
        if (low[0] > high[0] || low[1] > high[1]) return {0, 0};
        return {static_cast<int>(std::ceil(std::max(low[0], low[1]))),
                static_cast<int>(std::floor(std::min(high[0], high[1])))};
    }

    template <class Visit>
    void visit_square(int u, int v, const CellBox& box, const Visit& visit) const {
        const double middle = height(u + 0.5, v + 0.5);
        const double reach = 0.5 * (std::abs(slope_u_) + std::abs(slope_v_));
        const double floor = std::floor(middle - reach);
        if (middle + reach < floor + 1.0 && (reach > 0.0 || middle > floor))
            return give({u, v, static_cast<int>(floor)}, 1.0, {u + 0.5, v + 0.5, middle}, box,
                        visit);
        Polygon square;
        square.count = 4;
        unsigned i = 0;
        for (const auto& [x, y] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 1}})
            square.points[i++] = {u + x, v + y, height(u + x, v + y)};
        visit_column(square, u, v, box, visit);
    }

    template <class Visit>
    void visit_column(Polygon& rest, int u, int v, const CellBox& box, const Visit& visit) const {
        const auto [low, high] = rest.range(2);
        int w = static_cast<int>(std::floor(low));
        if (low == high && low == w) give({u, v, w - 1}, rest, box, visit);
        Polygon part;
        for (; high > w + 1; ++w) {
            rest.split(2, w + 1, part, rest);
            if (part.count >= 3) give({u, v, w}, part, box, visit);
            if (rest.count < 3) return;
        }
        give({u, v, w}, rest, box, visit);
    }

    template <class Visit>
    void give(const ivec3& cell, const Polygon& p, const CellBox& box, const Visit& visit) const {
        // As a fan around its first point.
        double twice = 0.0;
        dvec3 weighted(0.0);
        const dvec3& origin = p.points[0];
        for (unsigned i = 2; i < p.count; ++i) {
            const dvec3 a = p.points[i - 1] - origin, b = p.points[i] - origin;
            const double part = std::abs(a.x * b.y - a.y * b.x);
            twice += part;
            weighted += part * (a + b);
        }
        if (twice <= 1e-12) return;
        give(cell, 0.5 * twice, origin + weighted / (3.0 * twice), box, visit);
    }

    template <class Visit>
    void give(const ivec3& cell, double shadow, const dvec3& centre, const CellBox& box,
              const Visit& visit) const {
        if (cell.z < box.first.z || cell.z >= box.end.z) return;
        visit(Piece{cell, shadow * stretch_, centre});
    }

    std::array<dvec3, 3> corners_;
    int u_ = 0, v_ = 1, w_ = 2;  // w: the axis that the normal has most of
    double slope_u_ = 0.0, slope_v_ = 0.0;
    double stretch_ = 1.0;  // area of the triangle over that of its shadow
    double area_ = 0.0;
    dvec3 normal_{0.0};
};

}  // namespace octavo
