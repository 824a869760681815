// SPDX-License-Identifier: MIT
#include "nanovdb_tracer.h"

#include "octavo/core/error.h"
#include "octavo/core/memory.h"

#if OCTAVO_HAS_NANOVDB

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wall"
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/Ray.h>
#pragma GCC diagnostic pop

#include <bit>

namespace octavo::cli {
namespace {

/// What NanoVDB's builder takes for a block of 8^3 voxels, before it is frozen.
constexpr std::uint64_t kBuilderBytes = 2200;

using Builder = nanovdb::GridBuilder<float, nanovdb::Fp4>;
using Accessor = decltype(std::declval<Builder&>().getAccessor());

/// Sets the voxels below a node.
void add(const Dag& dag, std::uint64_t word, int level, const ivec3& corner, Accessor& grid) {
    if (level == dag.leaf_level()) {
        for (std::uint64_t left = dag.leaf(word); left != 0; left &= left - 1) {
            const int b = std::countr_zero(left);
            grid.setValue(nanovdb::Coord(corner.x + (b & 1) + (b >> 2 & 2),
                                         corner.y + (b >> 1 & 1) + (b >> 3 & 2),
                                         corner.z + (b >> 2 & 1) + (b >> 4 & 2)),
                          1.0f);
        }
        return;
    }
    const std::uint32_t mask = dag.words()[word] & kChildMaskBits;
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        const int half = 1 << (dag.depth() - level - 1);
        add(dag, dag.words()[word + static_cast<unsigned>(child_offset(mask, i))], level + 1,
            corner + half * ivec3(i & 1, i >> 1 & 1, i >> 2), grid);
    }
}

void check_memory(const Model& model) {
    // Counted, as no reader has compared what the file says of the octree.
    const auto levels = compute_statistics(model.dag).levels;
    const auto level = static_cast<std::size_t>(std::max(0, model.dag.depth() - 3));
    const std::uint64_t bytes = levels[level].svo_nodes * kBuilderBytes;
    if (bytes > machine_memory_bytes() / 2)
        throw Error(Errc::limit, "NanoVDB's grid of these voxels would take some " +
                                     std::to_string(bytes >> 30) +
                                     " GiB to build; a lower resolution would fit");
}

}  // namespace

struct NanovdbTracer::Impl {
    nanovdb::GridHandle<> handle;
    const nanovdb::NanoGrid<nanovdb::Fp4>* grid = nullptr;
};

NanovdbTracer::NanovdbTracer(const Model& model) : impl_(std::make_unique<Impl>()) {
    check_memory(model);
    Builder builder(0.0f);
    {
        auto accessor = builder.getAccessor();
        if (!model.dag.empty()) add(model.dag, 0, 0, ivec3(0), accessor);
    }
    impl_->handle = builder.getHandle<>();
    impl_->grid = impl_->handle.grid<nanovdb::Fp4>();
}

NanovdbTracer::~NanovdbTracer() = default;

std::uint64_t NanovdbTracer::size_bytes() const {
    return impl_->handle.size();
}

void NanovdbTracer::trace(std::span<const shared::GridRay> rays,
                          std::span<std::uint8_t> occluded) const {
    using NanoRay = nanovdb::Ray<float>;
    auto accessor = impl_->grid->getAccessor();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const vec3 start = vec3(rays[i].cell) + rays[i].frac;
        const vec3 dir = rays[i].dir;
        NanoRay ray({start.x, start.y, start.z}, {dir.x, dir.y, dir.z}, rays[i].t_min,
                    std::min(rays[i].t_max, 1e19f));
        nanovdb::Coord voxel;
        float t = 0.0f;
        occluded[i] = nanovdb::firstActive(ray, accessor, voxel, t) ? 1 : 0;
    }
}

}  // namespace octavo::cli

#else

namespace octavo::cli {

struct NanovdbTracer::Impl {};

NanovdbTracer::NanovdbTracer(const Model&) {
    throw Error(Errc::unsupported,
                "this program was built without NanoVDB: install libnanovdb-dev and build again");
}
NanovdbTracer::~NanovdbTracer() = default;
std::uint64_t NanovdbTracer::size_bytes() const {
    return 0;
}
void NanovdbTracer::trace(std::span<const shared::GridRay>, std::span<std::uint8_t>) const {}

}  // namespace octavo::cli

#endif
