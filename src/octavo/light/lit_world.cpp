// SPDX-License-Identifier: MIT
#include "octavo/light/lit_world.h"

#include <algorithm>
#include <cmath>

#include "octavo/core/error.h"
#include "octavo/light/cell_views.h"
#include "octavo/light/point_text.h"

namespace octavo {
namespace {

/// How far a point on a face is moved out where it must be rounded into another space; in voxels.
constexpr double kOffFace = 1e-2;

std::vector<Instance> instances_of(const LitScene& scene) {
    if (scene.objects.empty()) throw Error(Errc::bad_argument, "a scene has 1 to 2^20 objects");
    std::vector<Instance> instances;
    for (const LitObject& object : scene.objects)
        instances.push_back({object.dag, object.grid, object.placement});
    return instances;
}

}  // namespace

LitWorld::LitWorld(const LitScene& scene, const std::optional<dvec3>& centre, WideWalk walk)
    : scene_(scene), instances_(instances_of(scene), walk) {
    for (const Light& light : scene.lights) lamps_.emplace_back(light, instances_.grid());
    const Box lit = instances_.bounds();
    grid_ = LightGrid(scene.lights, lit, centre.value_or(lit.centre()));
    emitters_ = Emitters(scene, instances_);
}

LitPoint LitWorld::point(const InstanceHit& hit, bool smooth, NormalCaches& normals) const {
    const shared::DagView dag = shared::view(instances_.objects()[hit.object].dag);
    const shared::GridHit open = shared::move_to_open_face(dag, hit.ray, hit.hit);
    const vec3 face = shared::face_normal(hit.ray, open);
    const vec3 normal = smooth ? normals[hit.object].get(dag, hit.ray, open) : face;
    return point(hit.object, shared::leave_hit(hit.ray, open, face), open.face, normal);
}

LitPoint LitWorld::point(std::uint32_t object, const shared::GridRay& on_face, int face,
                         const vec3& normal) const {
    LitPoint point{on_face, face, instances_.normal_to_common(object, normal)};
    point.start.t_min = 0.0f;
    point.start.t_max = 1e30f;
    const vec3 outwards = face < shared::kFaceInside ? direction_vector(face) : normal;
    double scale = 1.0;
    vec3 out = outwards;
    if (!instances_.in_place(object)) {
        const dmat4& to_common = instances_.to_common(object);
        out = instances_.normal_to_common(object, outwards);
        scale = glm::length(dvec3(to_common * dvec4(dvec3(outwards), 0.0)));
        const dvec3 at = dvec3(to_common * dvec4(origin_of(on_face), 1.0));
        point.start = grid_ray(at + kOffFace * scale * dvec3(out), point.normal, 1e30f);
        point.face = shared::kFaceNone;
    }
    point.start.dir = point.normal;
    if (face >= shared::kFaceInside || normal == outwards) return point;

    // From before the middle of the face's half of the open voxel to the lifted place.
    const dvec3 from = origin_of(point.start) + 0.5 * scale * dvec3(out);
    for (const double part : {1.0, 0.6, 0.3}) {
        const dvec3 lifted = origin_of(point.start) + part * 1.5 * scale * dvec3(point.normal);
        // A little longer than the way, so that the end is not inside a voxel either.
        if (instances_.trace_any(grid_ray(from, vec3(lifted - from), 1.001f))) continue;
        point.start = grid_ray(lifted, point.normal, 1e30f);
        point.face = shared::kFaceNone;
        return point;
    }
    return point;
}

CellSide LitWorld::side(const InstanceHit& hit) const {
    const LitObject& object = scene_.objects[hit.object];
    CellSide side{hit.object, CellSide::kNoCell, hit.hit.face};
    if (hit.hit.face >= shared::kFaceInside) {  // the ray began in it: seen from where it came
        const vec3 way = glm::abs(hit.ray.dir);
        const int axis = way.x >= std::max(way.y, way.z) ? 0 : way.y >= way.z ? 1 : 2;
        side.direction = 2 * axis + (hit.ray.dir[axis] < 0.0f ? 1 : 0);
    }
    if (object.attributes.empty()) return side;
    const int finer = object.dag.depth() - hit.hit.height - object.attributes.level();
    const uvec3 path = finer >= 0 ? hit.hit.path >> static_cast<unsigned>(finer)
                                  : hit.hit.path << static_cast<unsigned>(-finer);
    side.cell = object.attributes.cells().find(path).value_or(CellSide::kNoCell);
    return side;
}

vec3 LitWorld::albedo(const CellSide& side) const {
    const Attributes& attributes = scene_.objects[side.object].attributes;
    if (side.cell == CellSide::kNoCell || !attributes.has_color()) return shared::clay();
    return linear_from_srgb8(attributes.color(side.cell, direction_vector(side.direction)));
}

vec3 LitWorld::emission(const CellSide& side) const {
    const Attributes& attributes = scene_.objects[side.object].attributes;
    if (side.cell == CellSide::kNoCell || !attributes.has_emission()) return vec3(0.0f);
    return attributes.emission(side.cell, direction_vector(side.direction));
}

vec3 LitWorld::stored_light(const InstanceHit& hit, const CellSide& side) const {
    const CellLight& light = scene_.objects[side.object].light;
    if (side.cell == CellSide::kNoCell || light.empty()) return vec3(0.0f);
    return shared::side_light(shared::view(light), static_cast<std::uint32_t>(side.cell),
                              side.direction, -hit.ray.dir);
}

}  // namespace octavo
