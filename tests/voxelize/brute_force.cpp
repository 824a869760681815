// SPDX-License-Identifier: MIT
#include "voxelize/brute_force.h"

#include <algorithm>
#include <vector>

namespace octavo::test {
namespace {

__extension__ typedef __int128 Wide;
using Point = std::array<Wide, 3>;

Point subtract(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Wide magnitude(Wide x) { return x < 0 ? -x : x; }

/// Gottschalk, Lin, Manocha 1996: two convex solids are apart exactly when they are apart along a normal
/// of one of them or along a cross product of their edges. Everything is doubled, so that the voxel's
/// centre is whole.
bool separating_axes_meet(const std::array<Point, 3>& doubled, const Point& centre, Wide side) {
    std::array<Point, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = subtract(doubled[i], centre);

    std::vector<Point> axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    axes.push_back(cross(subtract(p[1], p[0]), subtract(p[2], p[0])));
    for (int edge = 0; edge < 3; ++edge)
        for (int a = 0; a < 3; ++a)
            axes.push_back(cross(subtract(p[(edge + 1) % 3], p[edge]), axes[static_cast<unsigned>(a)]));

    return std::none_of(axes.begin(), axes.end(), [&](const Point& axis) {
        const Wide reach = side * (magnitude(axis[0]) + magnitude(axis[1]) + magnitude(axis[2]));
        const auto [low, high] = std::minmax({dot(p[0], axis), dot(p[1], axis), dot(p[2], axis)});
        return low > reach || high < -reach;
    });
}

/// docs/voxel-rules.md, "thin", term by term.
bool thin_meets(const std::array<Point, 3>& doubled, const Point& centre, Wide side) {
    std::array<Point, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = subtract(doubled[i], centre);

    for (int a = 0; a < 3; ++a) {
        const auto [low, high] = std::minmax({p[0][a], p[1][a], p[2][a]});
        if (low > side || high < -side) return false;
    }
    const Point n = cross(subtract(p[1], p[0]), subtract(p[2], p[0]));
    const Wide main = std::max({magnitude(n[0]), magnitude(n[1]), magnitude(n[2])});
    if (magnitude(dot(n, p[0])) > side * main) return false;

    for (int w = 0; w < 3; ++w) {  // the projection along axis w
        const int u = (w + 1) % 3, v = (w + 2) % 3;
        for (int k = 0; k < 3; ++k) {
            const Point& from = p[k];
            const Point edge = subtract(p[(k + 1) % 3], from);
            const Wide turn = n[w] < 0 ? -1 : 1;
            const Wide inward_u = -edge[v] * turn, inward_v = edge[u] * turn;
            const Wide at_centre = -(inward_u * from[u] + inward_v * from[v]);
            if (at_centre + side * std::max(magnitude(inward_u), magnitude(inward_v)) < 0) return false;
        }
    }
    return true;
}

}  // namespace

bool meets(const std::array<FixedPoint, 3>& corners, const FixedMesh& mesh, const ivec3& voxel,
           VoxelRule rule) {
    const Wide unit = Wide{1} << mesh.fraction_bits();
    std::array<Point, 3> doubled;
    Point centre;
    for (int a = 0; a < 3; ++a) centre[a] = (2 * Wide{voxel[a] - mesh.base()[a]} + 1) * unit;
    for (int i = 0; i < 3; ++i)
        doubled[i] = {2 * Wide{corners[i].x}, 2 * Wide{corners[i].y}, 2 * Wide{corners[i].z}};
    // A segment or a point has no sides for the thin rule to choose from: it marks what it meets.
    if (rule == VoxelRule::conservative || is_degenerate(corners))
        return separating_axes_meet(doubled, centre, unit);
    return thin_meets(doubled, centre, unit);
}

VoxelSet brute_force_voxels(const Scene& scene, const Grid& grid, VoxelRule rule) {
    const FixedMesh mesh(scene, grid);
    const ivec3 last(static_cast<int>(grid.resolution()) - 1);
    VoxelSet voxels;
    std::array<FixedPoint, 3> c;
    for (std::size_t t = 0; t < mesh.size(); ++t) {
        if (!mesh.corners(t, c)) continue;
        ivec3 low, high;
        for (int a = 0; a < 3; ++a) {
            const auto [least, most] = a == 0   ? std::minmax({c[0].x, c[1].x, c[2].x})
                                       : a == 1 ? std::minmax({c[0].y, c[1].y, c[2].y})
                                                : std::minmax({c[0].z, c[1].z, c[2].z});
            low[a] = std::clamp((least >> mesh.fraction_bits()) + mesh.base()[a] - 1, 0, last[a]);
            high[a] = std::clamp((most >> mesh.fraction_bits()) + mesh.base()[a] + 1, 0, last[a]);
        }
        ivec3 v;
        for (v.z = low.z; v.z <= high.z; ++v.z)
            for (v.y = low.y; v.y <= high.y; ++v.y)
                for (v.x = low.x; v.x <= high.x; ++v.x)
                    if (meets(c, mesh, v, rule)) voxels.emplace(v.x, v.y, v.z);
    }
    return voxels;
}

}  // namespace octavo::test
