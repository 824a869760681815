// SPDX-License-Identifier: MIT
//
// The space that a sheaf of rays goes through, and the cells of the DAG in it. Compiled once for
// each SIMD target.
#if defined(OCTAVO_TRACE_WIDE_SHAFT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_SHAFT_INL_H
#undef OCTAVO_TRACE_WIDE_SHAFT_INL_H
#else
#define OCTAVO_TRACE_WIDE_SHAFT_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "octavo/trace/dag_view.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The space that some rays go through: between two planes across its main axis, a rectangle on
/// each and what lies between them. Every line through both rectangles is inside, so a shaft may be
/// parallel, grow wider or grow narrower. Grid space.
struct Shaft {
    int axis = 0;       // the main one; the others are (axis + 1) % 3 and (axis + 2) % 3
    float first_z = 0;  // the planes
    float last_z = 0;
    // Of each of the other axes at low_z, and by how much they grow with z.
    float low_z = 0;
    float low[2] = {}, high[2] = {};
    float low_slope[2] = {}, high_slope[2] = {};
    ivec3 down{0};  // 1 on axes where the rays go down

    [[nodiscard]] float width(float z) const {
        const float along = std::clamp(z, first_z, last_z) - low_z;
        return std::max(high[0] - low[0] + along * (high_slope[0] - low_slope[0]),
                        high[1] - low[1] + along * (high_slope[1] - low_slope[1]));
    }
};

/// A cell of the DAG that some rays may pass.
struct ShaftCell {
    std::uint32_t node;
    ivec3 corner;  // real
    int height;    // 2 or more
};

/// The cells that exist and that a shaft may touch, about as wide as the shaft, from its rays'
/// starts on. Nodes are read as cells are asked for.
class ShaftWalk {
public:
    /// @param least  no cell is lower than this, 2 to depth - 1
    void begin(shared::DagView dag, const Shaft& shaft, int least) {
        shaft_ = shaft;
        least_ = std::max(least, 2);
        a_ = shaft.axis;
        b_ = (a_ + 1) % 3;
        e_ = (a_ + 2) % 3;
        down_ = shared::child_number(shaft.down);
        for (int i = 0; i < 4; ++i) {
            low_[i] = shaft.low[i & 1];
            high_[i] = shaft.high[i & 1];
            low_slope_[i] = shaft.low_slope[i & 1];
            high_slope_[i] = shaft.high_slope[i & 1];
        }
        frames_ = 0;
        push(dag, 0, ivec3(0), dag.depth);
    }

    /// @return false  there are no more
    [[nodiscard]] bool next(shared::DagView dag, ShaftCell& cell) {
        while (frames_ > 0) {
            Frame& frame = stack_[frames_ - 1];
            if (frame.to_visit == 0) {
                --frames_;
                continue;
            }
            const int mirrored = shared::lowest_bit(frame.to_visit);
            frame.to_visit &= frame.to_visit - 1;
            const int child = mirrored ^ down_;
            const int height = frame.height - 1;
            const ivec3 corner =
                frame.corner + (ivec3(child & 1, child >> 1 & 1, child >> 2) << height);
            const std::uint32_t node = shared::load_child(dag, frame.node, 1u << child);
            const auto width = static_cast<float>(1 << height);
            if (height <= least_ ||
                width <= kWidths * shaft_.width(static_cast<float>(corner[a_]) + 0.5f * width)) {
                cell = {node, corner, height};
                return true;
            }
            push(dag, node, corner, height);
        }
        return false;
    }

private:
    /// A cell is not opened where it is narrower than this many times the shaft. With 1, rays take
    /// a quarter fewer steps of their own, and the shaft's cells cost three times as much.
    static constexpr float kWidths = 4.0f;

    struct Frame {
        std::uint32_t node;
        std::uint32_t to_visit;  // children, mirrored
        ivec3 corner;
        int height;
    };

    HWY_INLINE void push(shared::DagView dag, std::uint32_t node, const ivec3& corner, int height) {
        const std::uint32_t children = shared::dag_load(dag, node) & touched(corner, height);
        if (children == 0) return;
        stack_[frames_++] = {node, shared::mirror_children(children, shaft_.down), corner, height};
    }

    /// The children of a cell that the shaft may touch. Lanes: the two other axes in the lower half
    /// of the cell by z, and in the upper.
    HWY_INLINE std::uint32_t touched(const ivec3& corner, int height) const {
        const Four d4;
        const auto zero = hn::Zero(d4);
        const auto size = hn::Set(d4, static_cast<float>(1 << (height - 1)));
        const auto below =
            hn::MulAdd(hn::Load(d4, kUpper), size, hn::Set(d4, static_cast<float>(corner[a_])));
        const auto along = hn::Sub(below, hn::Set(d4, shaft_.low_z));
        const auto low_slope = hn::Load(d4, low_slope_), high_slope = hn::Load(d4, high_slope_);
        const auto low = hn::Add(hn::MulAdd(along, low_slope, hn::Load(d4, low_)),
                                 hn::Min(zero, hn::Mul(low_slope, size)));
        const auto high = hn::Add(hn::MulAdd(along, high_slope, hn::Load(d4, high_)),
                                  hn::Max(zero, hn::Mul(high_slope, size)));
        const auto first = hn::OddEven(hn::Set(d4, static_cast<float>(corner[e_])),
                                       hn::Set(d4, static_cast<float>(corner[b_])));
        const auto middle = hn::Add(first, size);
        const auto in_z = hn::And(hn::Le(below, hn::Set(d4, shaft_.last_z)),
                                  hn::Ge(hn::Add(below, size), hn::Set(d4, shaft_.first_z)));
        const auto in_low = hn::And(in_z, hn::And(hn::Ge(high, first), hn::Le(low, middle)));
        const auto in_high =
            hn::And(in_z, hn::And(hn::Ge(high, middle), hn::Le(low, hn::Add(middle, size))));
        std::uint8_t low_bits[8] = {}, high_bits[8] = {};
        hn::StoreMaskBits(d4, in_low, low_bits);
        hn::StoreMaskBits(d4, in_high, high_bits);
        const std::uint32_t l = low_bits[0], h = high_bits[0];
        const auto part = [&](int axis, int bit) {
            return kHalves[axis][(l >> bit & 1u) | (h >> bit & 1u) << 1];
        };
        return (kHalves[a_][1] & part(b_, 0) & part(e_, 1)) |
               (kHalves[a_][2] & part(b_, 2) & part(e_, 3));
    }

    /// The children of the lower half on an axis, of the upper, of both.
    static constexpr std::uint32_t kHalves[3][4] = {
        {0, 0x55, 0xaa, 0xff}, {0, 0x33, 0xcc, 0xff}, {0, 0x0f, 0xf0, 0xff}};

    using Four = hn::FixedTag<float, 4>;
    HWY_ALIGN static constexpr float kUpper[4] = {0.0f, 0.0f, 1.0f, 1.0f};

    HWY_ALIGN float low_[4], high_[4], low_slope_[4], high_slope_[4];
    Shaft shaft_;
    int least_ = 2;
    int a_ = 0, b_ = 1, e_ = 2;
    int down_ = 0;
    int frames_ = 0;
    std::array<Frame, kMaxDepth + 1> stack_;
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
