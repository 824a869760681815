// SPDX-License-Identifier: MIT
#include "octavo/trace/instances.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr std::size_t kMostObjects = std::size_t{1} << 20;
constexpr std::uint32_t kObjectsInALeaf = 2;

/// Farther from a grid than this a cell's number might leave 32 bits.
constexpr double kFarthest = 1 << 29;

dmat4 grid_matrix(const Grid& grid) {  // from grid space to the space that the grid lies in
    dmat4 m(grid.voxel_size);
    m[3] = dvec4(grid.origin, 1.0);
    return m;
}

dvec3 transform(const dmat4& m, const dvec3& point) {
    return dvec3(m * dvec4(point, 1.0));
}

/// A box that holds the eight corners of this one after the transform.
Box transform(const dmat4& m, const Box& box) {
    Box result;
    for (unsigned i = 0; i < 8; ++i)
        result.extend(transform(m, {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                                    i & 4 ? box.high.z : box.low.z}));
    return result;
}

bool is_finite(const dmat4& m) {
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            if (!std::isfinite(m[i][k])) return false;
    return true;
}

bool touches(const Box& box, const dvec3& origin, const dvec3& inv, double t_min, double t_max) {
    const dvec3 a = (box.low - origin) * inv;
    const dvec3 b = (box.high - origin) * inv;
    const dvec3 low = glm::min(a, b), high = glm::max(a, b);
    // Not a number, from 0 * infinity on a border, must not hide the box.
    const auto below = [](double x, double bound) { return x > bound ? x : bound; };
    const auto above = [](double x, double bound) { return x < bound ? x : bound; };
    const double enter = below(low.x, below(low.y, below(low.z, t_min)));
    const double leave = above(high.x, above(high.y, above(high.z, t_max)));
    return enter <= leave * (1.0 + 1e-6) + 1e-6;
}

}  // namespace

Instances::Instances(std::vector<Instance> objects, WideWalk walk)
    : walk_(walk), objects_(std::move(objects)) {
    if (objects_.empty() || objects_.size() > kMostObjects)
        throw Error(Errc::bad_argument, "a scene has 1 to 2^20 objects");
    const dmat4 common = grid_matrix(objects_.front().grid);
    std::map<const std::uint32_t*, std::shared_ptr<Partitions>> by_words;
    for (const Instance& object : objects_) {
        const dmat4& p = object.placement;
        Frame frame;
        frame.to_common = glm::inverse(common) * p * grid_matrix(object.grid);
        frame.to_object = glm::inverse(frame.to_common);
        if (p[0][3] != 0.0 || p[1][3] != 0.0 || p[2][3] != 0.0 || p[3][3] != 1.0 ||
            !is_finite(frame.to_common) || !is_finite(frame.to_object))
            throw Error(Errc::bad_argument, "an object's placement is not an invertible map");
        frame.same = p == dmat4(1.0) && object.grid == objects_.front().grid;
        if (frame.same) frame.to_common = frame.to_object = dmat4(1.0);
        for (int i = 0; i < 3; ++i)
            frame.scale =
                std::max(i == 0 ? 0.0 : frame.scale, glm::length(dvec3(frame.to_common[i])));
        const double side = std::ldexp(1.0, object.grid.depth);
        frame.box = transform(frame.to_common, Box{dvec3(0.0), dvec3(side)});
        if (walk != WideWalk::one_by_one) {
            std::shared_ptr<Partitions>& of_dag = by_words[object.dag.words().data()];
            if (!of_dag) of_dag = std::make_shared<Partitions>(object.dag);
            frame.partitions = of_dag;
        }
        frames_.push_back(frame);
    }
    order_.resize(objects_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.emplace_back();
    split(0, 0, static_cast<std::uint32_t>(order_.size()));
}

void Instances::split(std::uint32_t node, std::uint32_t first, std::uint32_t end) {
    Box box, centres;
    for (std::uint32_t i = first; i < end; ++i) {
        box.extend(frames_[order_[i]].box);
        centres.extend(frames_[order_[i]].box.centre());
    }
    nodes_[node].box = box;
    if (end - first <= kObjectsInALeaf) {
        nodes_[node].first = first;
        nodes_[node].count = end - first;
        return;
    }
    const dvec3 size = centres.size();
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = first + (end - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                         const double x = frames_[a].box.centre()[axis];
                         const double y = frames_[b].box.centre()[axis];
                         return x < y || (x == y && a < b);
                     });
    const auto children = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node].first = children;
    split(children, first, middle);
    split(children + 1, middle, end);
}

Box Instances::bounds() const {
    return transform(grid_matrix(grid()), nodes_.front().box);
}

vec3 Instances::normal_to_common(std::uint32_t object, const vec3& normal) const {
    if (frames_[object].same) return normal;
    return vec3(
        glm::normalize(glm::transpose(glm::dmat3(frames_[object].to_object)) * dvec3(normal)));
}

shared::GridRay Instances::ray_in(std::uint32_t object, const shared::GridRay& ray) const {
    const Frame& frame = frames_[object];
    if (frame.same) return ray;
    const dvec3 origin =
        glm::clamp(transform(frame.to_object, origin_of(ray)), -kFarthest, kFarthest);
    shared::GridRay result =
        grid_ray(origin, vec3(glm::dmat3(frame.to_object) * dvec3(ray.dir)), ray.t_max);
    result.t_min = ray.t_min;
    return result;
}

shared::Stop Instances::stop_in(std::uint32_t object, shared::Stop stop) const {
    stop.cone = static_cast<float>(static_cast<double>(stop.cone) / frames_[object].scale);
    return stop;
}

void Instances::sort_rays(std::span<const shared::GridRay> rays,
                          std::vector<std::vector<std::uint32_t>>& lists) const {
    for (std::uint32_t i = 0; i < rays.size(); ++i) {
        const shared::GridRay& ray = rays[i];
        const dvec3 origin = origin_of(ray);
        const dvec3 inv = 1.0 / dvec3(ray.dir);
        std::uint32_t stack[64];
        int top = 0;
        stack[top++] = 0;
        while (top > 0) {
            const Node& node = nodes_[stack[--top]];
            if (!touches(node.box, origin, inv, static_cast<double>(ray.t_min),
                         static_cast<double>(ray.t_max)))
                continue;
            if (node.count == 0) {
                stack[top++] = node.first;
                stack[top++] = node.first + 1;
            }
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
                if (touches(frames_[order_[k]].box, origin, inv, static_cast<double>(ray.t_min),
                            static_cast<double>(ray.t_max)))
                    lists[order_[k]].push_back(i);
        }
    }
}

void Instances::trace_closest(std::span<const shared::GridRay> rays, const shared::Stop& stop,
                              std::span<InstanceHit> hits) const {
    std::vector<shared::GridHit> found(rays.size());
    if (objects_.size() == 1 && frames_[0].same) {
        trace_closest_wide(objects_[0].dag, rays, stop, found, walk_);
        for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = {0, rays[i], found[i]};
        return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
        hits[i] = {0, rays[i], shared::make_miss(rays[i].t_max, 0)};
    std::vector<std::vector<std::uint32_t>> lists(objects_.size());
    sort_rays(rays, lists);
    std::vector<shared::GridRay> some;
    for (std::uint32_t object = 0; object < objects_.size(); ++object) {
        some.clear();
        for (const std::uint32_t i : lists[object]) {
            some.push_back(ray_in(object, rays[i]));
            some.back().t_max = hits[i].hit.t;  // of the hit so far, or the ray's own
        }
        found.resize(some.size());
        trace_closest_wide(objects_[object].dag, some, stop_in(object, stop), found, walk_);
        for (std::size_t k = 0; k < some.size(); ++k)
            if (found[k].face != shared::kFaceNone)
                hits[lists[object][k]] = {object, some[k], found[k]};
    }
}

void Instances::trace_any(std::span<const shared::GridRay> rays, const shared::Stop& stop,
                          std::span<std::uint8_t> occluded) const {
    if (objects_.size() == 1 && frames_[0].same)
        return trace_any_wide(objects_[0].dag, rays, stop, occluded, frames_[0].partitions.get(),
                              walk_);
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    std::vector<std::vector<std::uint32_t>> lists(objects_.size());
    sort_rays(rays, lists);
    std::vector<shared::GridRay> some;
    std::vector<std::uint32_t> numbers;
    std::vector<std::uint8_t> found;
    for (std::uint32_t object = 0; object < objects_.size(); ++object) {
        some.clear();
        numbers.clear();
        for (const std::uint32_t i : lists[object]) {
            if (occluded[i] != 0) continue;
            some.push_back(ray_in(object, rays[i]));
            numbers.push_back(i);
        }
        found.resize(some.size());
        trace_any_wide(objects_[object].dag, some, stop_in(object, stop), found,
                       frames_[object].partitions.get(), walk_);
        for (std::size_t k = 0; k < some.size(); ++k) occluded[numbers[k]] |= found[k];
    }
}

bool Instances::trace_any(const shared::GridRay& ray) const {
    if (objects_.size() == 1 && frames_[0].same)
        return shared::trace_any(shared::view(objects_[0].dag), ray, shared::stop_at_voxels());
    std::uint8_t occluded = 0;
    trace_any(std::span(&ray, 1), shared::stop_at_voxels(), std::span(&occluded, 1));
    return occluded != 0;
}

}  // namespace octavo
