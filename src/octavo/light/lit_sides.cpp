// SPDX-License-Identifier: MIT
#include "octavo/light/lit_sides.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "octavo/light/side_starts.h"

namespace octavo {
namespace {

constexpr std::uint64_t kBlockCells = 512;  // that are lit together, and change together

/// A box around a box of an object's grid, in common space.
Box placed(const LitWorld& world, std::uint32_t object, const Box& box) {
    const dmat4& to_common = world.instances().to_common(object);
    Box result;
    for (unsigned i = 0; i < 8; ++i)
        result.extend(
            dvec3(to_common * dvec4(i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                                    i & 4 ? box.high.z : box.low.z, 1.0)));
    return result;
}

}  // namespace

ObjectSides find_sides(const LitScene& scene, const LitWorld& world, std::uint32_t number,
                       CellWords& words) {
    const LitObject& object = scene.objects[number];
    ObjectSides o;
    o.object = number;
    o.first_word = words.first_word(number);
    if (object.attributes.empty()) return o;
    const CellIndex& cells = object.attributes.cells();
    const std::uint64_t blocks = (cells.count() + kBlockCells - 1) / kBlockCells;
    std::vector<std::vector<LitSide>> found(blocks);
    tbb::parallel_for(std::uint64_t{0}, blocks, [&](std::uint64_t b) {
        const CellRange range{b * kBlockCells, std::min((b + 1) * kBlockCells, cells.count())};
        cells.for_each(range, [&](std::uint64_t cell, const uvec3& at) {
            for (int direction = 0; direction < 6; ++direction)
                if (const auto normal = side_normal(object, at, direction))
                    found[b].push_back(
                        {static_cast<std::uint32_t>(cell),
                         pack_normal(*normal) << 8 | static_cast<std::uint32_t>(direction)});
        });
    });
    for (const auto& some : found) {
        SideBlock block{o.sides.size(), 0, {}};
        o.sides.insert(o.sides.end(), some.begin(), some.end());
        block.end = o.sides.size();
        if (block.first < block.end) o.blocks.push_back(block);
    }
    for (const LitSide& side : o.sides) words.set_seen(o.word_of(side));
    place_blocks(scene, world, o);
    return o;
}

void place_blocks(const LitScene& scene, const LitWorld& world, ObjectSides& o) {
    const CellIndex& cells = scene.objects[o.object].attributes.cells();
    const double width = cell_width(scene, o.object);
    tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
        SideBlock& block = o.blocks[b];
        const CellRange range{o.sides[block.first].cell, o.sides[block.end - 1].cell + 1ull};
        Box box;
        cells.for_each(range, [&](std::uint64_t, const uvec3& at) {
            box.extend(width * dvec3(at));
            box.extend(width * (dvec3(at) + 1.0));
        });
        block.box = placed(world, o.object, box);
    });
}

Box object_box(const LitScene& scene, const LitWorld& world, const ObjectSides& o) {
    Box box;
    for (const SideBlock& block : o.blocks) {
        box.extend(block.box.low);
        box.extend(block.box.high);
    }
    if (!box.empty()) return box;
    const double width = std::ldexp(1.0, scene.objects[o.object].dag.depth());
    return placed(world, o.object, {dvec3(0.0), dvec3(width)});
}

Box box_with_margin(const LitScene& scene, const LitWorld& world, const ObjectSides& o) {
    const bool lit = !scene.objects[o.object].attributes.empty();
    const dvec3 edge(world.instances().to_common(o.object)[0]);
    const double by = glm::length(edge) * (lit ? cell_width(scene, o.object) : 1.0);
    const Box box = object_box(scene, world, o);
    return {box.low - by, box.high + by};
}

double cell_width(const LitScene& scene, std::uint32_t object) {
    const LitObject& lit = scene.objects[object];
    return std::ldexp(1.0, lit.dag.depth() - lit.attributes.level());
}

}  // namespace octavo
