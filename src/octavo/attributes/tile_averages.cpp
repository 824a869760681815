// SPDX-License-Identifier: MIT
#include "octavo/attributes/tile_averages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "octavo/attributes/nearest_triangle.h"
#include "octavo/core/morton.h"

namespace octavo {
namespace {

constexpr double kAreaUnits = 4294967296.0;  // of a cell's face
constexpr std::size_t kMostPartsUnderCap = 65536;
// Linux maps up to 64 kB around what is looked at: 4 MiB at most for what is known of them.
constexpr int kTrianglesBeforeRoom = 64;
// Triangles that face further away from the front than this are the back: some 105 degrees.
constexpr float kOpposed = -0.25f;

using Channel = Attributes::Channel;

/// How wide the pieces of a triangle are: a cell, or less where all of it is less.
double footprint_of(double area) {
    return std::min(1.0, std::sqrt(area));
}

}  // namespace

TileAverager::TileAverager(const CellIndex& cells, const SurfaceTiles& triangles,
                           const SurfaceSampler& surfaces, const AttributeOptions& wanted,
                           std::function<void()> make_room)
    : cells_(cells),
      triangles_(triangles),
      surfaces_(surfaces),
      wanted_(wanted),
      make_room_(std::move(make_room)),
      tile_depth_(triangles.tile_depth()),
      unit_(std::ldexp(1.0, -triangles.frame().fraction_bits)),
      kept_{wanted.color, true, wanted.emission, wanted.emission, wanted.normal, wanted.normal},
      most_parts_(wanted.is_on_disk() ? kMostPartsUnderCap
                                      : std::numeric_limits<std::size_t>::max()),
      glows_wanted_(wanted.emission && surfaces.greatest_emission() > 0.0f),
      color_alone_(!wanted.normal && !(surfaces.greatest_emission() > 0.0f)),
      srgb8_(srgb8_of_linear16()),
      masks_(std::size_t{1} << 3 * std::max(0, tile_depth_ - 2)),
      firsts_(masks_.size()) {
    for (std::uint32_t i = 0; i < 1u << tile_depth_; ++i)
        spread_.push_back(static_cast<std::uint32_t>(detail::spread_bits_by_3(i)));
}

void TileAverager::average(const uvec3& tile, const CellRange& range, TileValues& out) {
    find_cells(range);
    tile_ = tile;
    to_tile_ = dvec3(triangles_.frame().base) - dvec3(tile << static_cast<unsigned>(tile_depth_));
    for (std::size_t c = 0; c < out.size(); ++c) out[c].resize(kept_[c] ? codes_.size() : 0);
    const auto count = static_cast<std::uint32_t>(codes_.size());
    auto at_once = static_cast<std::uint32_t>(
        std::min<std::size_t>(count, std::max<std::size_t>(1, most_parts_ / 2)));
    for (begin_ = 0; begin_ < count; begin_ = end_) {
        take_cells(begin_, begin_ + std::min(at_once, count - begin_));
        facets_.clear();
        start_parts();
        for_each_triangle(
            [&](const Corners& corners, std::size_t in_scene) { cut(corners, in_scene); });
        at_once = end_ - begin_;
        touch_bare_cells();
        for (std::uint32_t cell = begin_; cell < end_; ++cell) write(cell, out);
    }
}

void TileAverager::start_parts() {
    parts_.resize(end_ - begin_);
    for (Part& part : parts_) {
        part.next = kNone;
        part.area = 0;
    }
    if (glows_wanted_) glows_.resize(parts_.size());
}

inline void TileAverager::add_part(std::uint32_t cell, std::uint32_t facet, std::uint64_t area,
                                   const Tint& tint, const Glow& glow) {
    // Field by field: a part that is put together first is copied before its halves have arrived.
    const auto put = [&](std::size_t place, std::uint32_t next) {
        Part& part = parts_[place];
        part.next = next;
        part.facet = facet;
        part.area = area;
        part.tint = tint;
        if (glows_wanted_) glows_[place] = glow;
    };
    const std::uint32_t first = cell - begin_;
    if (parts_[first].area == 0) return put(first, kNone);
    const auto place = static_cast<std::uint32_t>(parts_.size());
    parts_.emplace_back();
    if (glows_wanted_) glows_.emplace_back();
    put(place, std::exchange(parts_[first].next, place));
}

void TileAverager::take_cells(std::uint32_t begin, std::uint32_t end) {
    begin_ = begin;
    end_ = end;
    constexpr double kFar = std::numeric_limits<double>::max();
    near_ = {dvec3(-kFar), dvec3(kFar)};
    if (end - begin == codes_.size()) return;
    near_ = {};
    for (std::uint32_t cell = begin; cell < end; ++cell)
        near_.extend(dvec3(morton_decode(codes_[cell])));
    // The cells themselves, and one more as a triangle between two layers is in both.
    near_ = {near_.low - 1.0, near_.high + 2.0};
}

/// Half of the cells wait for the next time.
void TileAverager::take_fewer_cells() {
    if (end_ - begin_ < 2) return;
    take_cells(begin_, begin_ + (end_ - begin_) / 2);
    const std::vector<Part> parts = std::exchange(parts_, {});
    const std::vector<Glow> glows = std::exchange(glows_, {});
    start_parts();
    for (std::uint32_t cell = begin_; cell < end_; ++cell)
        for (std::uint32_t p = cell - begin_; p != kNone && parts[p].area != 0; p = parts[p].next)
            add_part(cell, parts[p].facet, parts[p].area, parts[p].tint,
                     glows_wanted_ ? glows[p] : Glow());
}

void TileAverager::find_cells(const CellRange& range) {
    for (const std::uint32_t block : blocks_) masks_[block] = 0;
    blocks_.clear();
    codes_.clear();
    const std::uint64_t in_tile = (std::uint64_t{1} << 3 * tile_depth_) - 1;
    cells_.for_each_code(range, [&](std::uint64_t, std::uint64_t in_grid) {
        const std::uint64_t code = in_grid & in_tile;
        const auto block = static_cast<std::uint32_t>(code >> 6);
        if (masks_[block] == 0) {
            blocks_.push_back(block);
            firsts_[block] = static_cast<std::uint32_t>(codes_.size());
        }
        masks_[block] |= std::uint64_t{1} << (code & 63u);
        codes_.push_back(static_cast<std::uint32_t>(code));
    });
}

inline std::uint32_t TileAverager::number_of(std::uint64_t code) const {
    const std::uint64_t mask = masks_[code >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (code & 63u);
    if (!(mask & bit)) return kNone;
    return firsts_[code >> 6] + static_cast<unsigned>(std::popcount(mask & (bit - 1)));
}

template <class Visit>
void TileAverager::for_each_triangle(const Visit& visit) const {
    triangles_.for_each(tile_, [&](const std::array<FixedPoint, 3>& fixed, std::size_t in_scene) {
        Corners corners;
        for (unsigned i = 0; i < 3; ++i)
            corners[i] = dvec3(fixed[i].x, fixed[i].y, fixed[i].z) * unit_ + to_tile_;
        visit(corners, in_scene);
    });
}

TileAverager::Facet TileAverager::facet_of(const TrianglePieces& pieces) {
    Facet facet{};
    if (!(pieces.area() > 0.0)) return facet;
    const dvec3 n = pieces.normal();
    for (int i = 0; i < 3; ++i)
        facet.normal[static_cast<unsigned>(i)] =
            static_cast<std::int16_t>(std::llround(n[i] * SurfaceFacet::kUnits));
    const dvec3 size = glm::abs(n);
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    facet.facing = static_cast<std::int16_t>(2 * axis + (n[axis] > 0.0));
    return facet;
}

void TileAverager::cut(const Corners& corners, std::size_t in_scene) {
    const auto& [a, b, c] = corners;
    if (glm::any(glm::lessThan(glm::max(a, glm::max(b, c)), near_.low)) ||
        glm::any(glm::greaterThan(glm::min(a, glm::min(b, c)), near_.high)))
        return;
    if (make_room_ && ++looked_at_ > kTrianglesBeforeRoom) {
        make_room_();
        looked_at_ = 0;
    }
    const TrianglePieces pieces(corners);
    const auto number = static_cast<std::uint32_t>(facets_.size());
    facets_.push_back(facet_of(pieces));
    const SurfaceSampler::Triangle surface =
        surfaces_.prepare(in_scene, corners, footprint_of(pieces.area()));
    const ivec3 axes = pieces.axes();
    const auto code_of = [&](const ivec3& cell) {
        std::uint32_t code = 0;
        for (int i = 0; i < 3; ++i) code |= spread_[static_cast<unsigned>(cell[i])] << axes[i];
        return code;
    };
    // Some pieces together, so that waiting for the texels of one goes on beside the next.
    std::array<TrianglePieces::Piece, 32> some;
    std::size_t count = 0;
    const auto sample_some = [&] {
        for (const TrianglePieces::Piece& piece : std::span(some).first(std::exchange(count, 0))) {
            const std::uint32_t cell = number_of(code_of(piece.cell));
            const auto area = static_cast<std::uint64_t>(piece.area * kAreaUnits + 0.5);
            if (cell < begin_ || cell >= end_ || area == 0) continue;  // or kNone
            const SurfaceSample sample = surface.at(pieces.in_place(piece.centre));
            if (sample.tint.opacity == 0) continue;
            add_part(cell, number, area, sample.tint, sample.emission);
            if (parts_.size() > most_parts_) take_fewer_cells();
        }
    };
    pieces.for_each(ivec3(0), ivec3(1 << tile_depth_), [&](const TrianglePieces::Piece& piece) {
        some[count++] = piece;
        if (count == some.size()) sample_some();
    });
    sample_some();
}

/// Cells that triangles only touch get one part from the nearest.
void TileAverager::touch_bare_cells() {
    struct Bare {
        std::uint32_t cell;
        dvec3 centre;
        NearestTriangle nearest{};
    };
    std::vector<Bare> bare;
    for (std::uint32_t cell = begin_; cell < end_; ++cell)
        if (parts_[cell - begin_].area == 0)
            bare.push_back({cell, dvec3(morton_decode(codes_[cell])) + 0.5});
    if (bare.empty()) return;

    // A triangle that touches the cell is no further from its middle.
    constexpr double kReach = 1.01;
    for_each_triangle([&](const Corners& c, std::size_t in_scene) {
        const dvec3 low = glm::min(c[0], glm::min(c[1], c[2])) - kReach;
        const dvec3 high = glm::max(c[0], glm::max(c[1], c[2])) + kReach;
        for (Bare& b : bare)
            if (glm::all(glm::greaterThanEqual(b.centre, low)) &&
                glm::all(glm::lessThanEqual(b.centre, high)))
                b.nearest.offer(b.centre, c, in_scene);
    });
    // Rounding may have moved the triangle that a voxel was set by: then whatever is nearest.
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < bare.size(); ++i)
        if (!bare[i].nearest.found()) missing.push_back(i);
    if (!missing.empty())
        for_each_triangle([&](const Corners& c, std::size_t in_scene) {
            for (const std::size_t i : missing) bare[i].nearest.offer(bare[i].centre, c, in_scene);
        });

    for (const Bare& b : bare) {
        SurfaceSample sample;
        sample.tint.color = {65535, 65535, 65535};
        const auto number = static_cast<std::uint32_t>(facets_.size());
        if (const NearestTriangle& t = b.nearest; t.found()) {
            facets_.push_back(facet_of(TrianglePieces(t.corners)));
            sample = surfaces_.prepare(t.in_scene, t.corners, 1.0).at(t.point);
        } else {
            facets_.push_back({});
        }
        add_part(b.cell, number, 1 << 16, {sample.tint.color, 65535}, sample.emission);
    }
}

void TileAverager::add_to(PartSum& sum, std::uint32_t part) const {
    sum.add(parts_[part], facets_[parts_[part].facet], glows_wanted_ ? glows_[part] : Glow());
}

/// Of a cell of one part, as most are.
TileAverager::Values TileAverager::values_of_one(std::uint32_t part) const {
    PartSum sum(color_alone_);
    if (!color_alone_) add_to(sum, part);
    Rgb8 color{};
    for (unsigned i = 0; i < 3; ++i) color[i] = srgb8_[parts_[part].tint.color[i]];
    return {.color = pack_rgb8(color),
            .emission = sum.emission(surfaces_.greatest_emission()),
            .normal = wanted_.normal ? pack_normal(sum.normal()) : 0};
}

/// Of the parts from this one on. The front is the way that most area faces: by main axes first,
/// then exactly.
TileAverager::Values TileAverager::values_of_several(std::uint32_t first) const {
    const auto for_parts = [&](const auto& visit) {
        for (std::uint32_t p = first; p != kNone; p = parts_[p].next)
            visit(p, facets_[parts_[p].facet]);
    };
    std::array<std::uint64_t, 6> facing{};
    bool one_way = true;
    for_parts([&](std::uint32_t p, const Facet& facet) {
        facing[static_cast<unsigned>(facet.facing)] += parts_[p].area;
        one_way = one_way && facet.facing == facets_[parts_[first].facet].facing;
    });
    PartSum front(color_alone_), back(color_alone_);
    std::uint32_t direction = 0;
    if (one_way) {
        for_parts([&](std::uint32_t p, const Facet&) { add_to(front, p); });
    } else {
        const int main =
            static_cast<int>(std::max_element(facing.begin(), facing.end()) - facing.begin());
        PartSum most(false);
        for_parts([&](std::uint32_t p, const Facet& facet) {
            if (facet.facing == main) add_to(most, p);
        });
        direction = pack_coarse_direction(most.normal());
        const vec3 towards = unpack_coarse_direction(direction);
        for_parts([&](std::uint32_t p, const Facet& facet) {
            const vec3 normal = vec3(facet.normal[0], facet.normal[1], facet.normal[2]) /
                                static_cast<float>(SurfaceFacet::kUnits);
            add_to(glm::dot(normal, towards) < kOpposed ? back : front, p);
        });
    }
    const float greatest = surfaces_.greatest_emission();
    Values values{.color = front.color(srgb8_),
                  .emission = front.emission(greatest),
                  .normal = wanted_.normal ? pack_normal(front.normal()) : 0};
    if (back.area() == 0) return values;
    const std::uint32_t back_color = back.color(srgb8_), back_emission = back.emission(greatest);
    // A second side that would look like the first is not kept.
    const bool differs = (wanted_.color && back_color != values.color) ||
                         (wanted_.emission && back_emission != values.emission) || wanted_.normal;
    if (!differs) return values;
    values.back = pack_back(back_color, direction);
    values.back_emission = back_emission;
    if (wanted_.normal) values.back_normal = pack_normal(back.normal());
    return values;
}

void TileAverager::write(std::uint32_t cell, TileValues& out) const {
    const std::uint32_t first = cell - begin_;
    const Values values =
        parts_[first].next == kNone ? values_of_one(first) : values_of_several(first);
    const auto put = [&](Channel channel, std::uint32_t value) {
        const auto c = static_cast<std::size_t>(channel);
        if (kept_[c]) out[c][cell] = value;
    };
    put(Channel::color, values.color);
    put(Channel::back, values.back);
    put(Channel::emission, values.emission);
    put(Channel::back_emission, values.back_emission);
    put(Channel::normal, values.normal);
    put(Channel::back_normal, values.back_normal);
}

}  // namespace octavo
